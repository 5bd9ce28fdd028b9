"""Other people's FMI importers run the cable's FMUs, each in a virtual environment of its own.

    python -m tests.hosts --markdown docs/hosts.md --readme README.md    runs all and writes both tables

What a host needs is in inside/NAME.txt, what it does in inside/NAME.py; catalogue.py says in which ways it takes
FMUs and how exact each of them is. tests/benchmarks/hosts.py measures what implicit hosts make of stiff cables.
"""
