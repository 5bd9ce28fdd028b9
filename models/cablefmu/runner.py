"""An FMU that is read and unpacked once, and run many times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from fmpy import extract

from .drive import make_driver
from .errors import RunError
from .feed import Feed
from .fmu.archive import open_fmu
from .fmu.variables import Kind, Variable, elements_of
from .results import Recording
from .simulate import check_given, divided_scene, outputs_among, record_run, settings_for, variables_in

__all__ = ["Ended", "Runner"]


@dataclass(frozen=True, slots=True)
class Ended:
    """What a run leaves behind."""

    recording: Recording
    """Outputs over time, up to a failure."""
    failure: RunError | None
    seconds: float
    """What the run took, without instantiation."""


class Runner:
    """An FMU of ours, ready to be run with one set of parameters after the other.

    Parameters
    ----------
    path
        Of the archive.
    folder
        To unpack it in; the caller's to remove, after `close`.
    interface, stop_time, step, tolerance
        As those of `simulate`, the same in every run.

    Raises
    ------
    FmuError
        If the file is no FMU of ours, or cannot be loaded.
    OptionError
        If a setting is out of range.
    """

    def __init__(
        self, path: Path, folder: Path, *, interface: str = "cs", stop_time: float | None = None,
        step: float | None = None, tolerance: float | None = None,
    ) -> None:  # fmt: skip
        self._archive = open_fmu(path)
        self.scene = self._archive.scene
        self._variables = variables_in(self.scene, self._archive)
        self._asked = (interface, stop_time, step, tolerance)
        self.settings = settings_for(self.scene, self._variables, *self._asked, {}, ())
        self._folder = str(folder)
        extract(str(path), unzipdir=self._folder)
        # An instance that nobody runs: as long as it is there the library stays loaded.
        feed = Feed({name: self.scene.signals[name] for name in self.scene.cable.inputs})
        self._keeper = make_driver(self._archive.fmi, interface, self._archive.description, self._folder, feed)

    @property
    def outputs(self) -> list[Variable]:
        """What a run records."""
        return outputs_among(elements_of(self._variables, self.scene.cable.n))

    def check(self, name: str, value: float | str) -> None:
        """Find out before the runs whether this can be set.

        Raises
        ------
        OptionError
            If there is no such variable, it cannot be set, or not to this value.
        """
        check_given(name, value, {variable.name: variable for variable in self._variables})

    def run(self, given: Mapping[str, float | str]) -> Ended:
        """Run it from the start with these values; a failure is told, not raised.

        Raises
        ------
        OptionError
            If one of them cannot be set.
        """
        sized = any(variable.kind is Kind.LINKS for variable in self._variables)
        scene = divided_scene(self.scene, given) if sized else self.scene
        settings = settings_for(scene, self._variables, *self._asked, given, ())
        recording = Recording(outputs_among(elements_of(self._variables, scene.cable.n)))
        statistics, failure = record_run(self._archive, scene, self._variables, settings, self._folder, recording)
        return Ended(recording, failure, statistics["run_time"])

    def close(self) -> None:
        """Free the library."""
        self._keeper.close()
