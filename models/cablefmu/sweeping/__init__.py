"""Many runs: a sweep's file or options become cases, cases become rows of a table, whatever happens in between.

- `schema`, `description`, `cases` what a file says
- `subjects` what is run: a scene's FMU or a coupling
- `figures` what is kept of a run
- `batches`, `worker`, `cluster` who runs it
- `store`, `table`, `statistics`, `picture` what is left
- `run` the table of contents
"""

from .api import open_sweep, sweep

__all__ = ["open_sweep", "sweep"]
