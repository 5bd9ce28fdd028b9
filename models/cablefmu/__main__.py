"""`python -m cablefmu` is the command `cablefmu`."""

from .cli import main

if __name__ == "__main__":
    main()
