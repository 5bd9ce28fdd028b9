"""What can go wrong, and whose turn it is.

::

    CableError
    ├── UserError        the user can mend it; the command line ends with status 2
    │   ├── SceneError   something in a scene file (or in a file that it names)
    │   ├── OptionError  a command-line option or an argument of the Python API
    │   ├── FmuError     an archive that is not one of ours, or is damaged
    │   ├── CouplingError  something in a coupling file, or between the models that it couples
    │   ├── ResultError  a file that was given as results and is none, or is damaged
    │   ├── StateError   a saved state that is none, is damaged, or is of another run
    │   ├── SweepError   something in a sweep, or a store that is another sweep's
    │   ├── VesselError  something in a vessel's table (or in a file that it names)
    │   └── WavesError   something in a sea's table
    └── RunError         a run that could not go on; status 1, results up to then are kept

Every message is whole sentences for a person: what is wrong, where, and what is allowed.
"""

from __future__ import annotations

__all__ = [
    "CableError",
    "CouplingError",
    "FmuError",
    "OptionError",
    "ResultError",
    "RunError",
    "SceneError",
    "StateError",
    "SweepError",
    "UserError",
    "VesselError",
    "WavesError",
]


class CableError(Exception):
    """Base of everything that this package raises on purpose."""

    exit_status = 1


class UserError(CableError):
    """A mistake in what the user gave; the message says what is allowed instead."""

    exit_status = 2


class SceneError(UserError):
    """One or more mistakes in a scene file, one line each: file, key, value, what is allowed."""


class CouplingError(UserError):
    """One or more mistakes in a coupling, one line each: file, key or connection, what is allowed."""


class OptionError(UserError):
    """A wrong option, name or value on the command line or in a call of the Python API."""


class FmuError(UserError):
    """A file that was given as an FMU and cannot be used as one."""


class ResultError(UserError):
    """A file that was given as the results of a run and cannot be read as such."""


class StateError(UserError):
    """A file that was given as a saved state and cannot be gone on from."""


class SweepError(UserError):
    """One or more mistakes in a sweep, one line each: where, key, value, what is allowed."""


class VesselError(UserError):
    """One or more mistakes in a vessel's table, one line each: where, key, value, what is allowed."""


class WavesError(UserError):
    """One or more mistakes in a sea's table, one line each: where, key, value, what is allowed."""


class RunError(CableError):
    """A simulation that ended early, at `time` [s]; `partial` holds the results up to then."""

    def __init__(self, message: str, *, time: float | None = None, partial: object = None) -> None:
        super().__init__(message)
        self.time = time
        self.partial = partial
