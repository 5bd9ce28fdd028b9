"""How Sphinx makes the pages."""

from sphinx.application import Sphinx

from cablefmu import __version__

project = "cablefmu"
version = release = __version__
copyright = "cablefmu developers, BSD-3-Clause"

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["**/*.py"]
myst_heading_anchors = 4  # sections are linked to by the anchors that GitHub gives them
suppress_warnings = ["myst.header"]  # pages that begin below the first level

nb_execution_mode = "force"  # the notebook is stored without outputs
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_execution_show_tb = True

autodoc_typehints = "none"  # the signature has them
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False

html_theme = "furo"  # readable on phones, light and dark, without a build step of its own
html_title = f"cablefmu {version}"
html_show_sourcelink = False
html_copy_source = False


def _whole_sentences(_app: Sphinx, what: str, _name: str, _of: object, _options: object, lines: list[str]) -> None:
    """Undo what napoleon makes of an attribute's "words: more words", which it takes for a type and a text."""
    types = [k for k, line in enumerate(lines) if line.startswith(":type: ")] if what == "attribute" else []
    for k in reversed(types):
        lines[0] = f"{lines.pop(k).removeprefix(':type: ')}: {lines[0]}"


def setup(app: Sphinx) -> None:
    app.connect("autodoc-process-docstring", _whole_sentences, priority=900)  # after napoleon
