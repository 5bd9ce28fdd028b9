"""The documentation as web pages: `python -m docs.site` makes build/docs/html of docs/ and checks every link in it.

By Sphinx with MyST: it reads the Markdown of docs/ as it stands, runs the notebook, and makes the API of docstrings.
"""
