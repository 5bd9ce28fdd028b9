"""Run a scene or an FMU and collect what it says over time."""

from __future__ import annotations

import difflib
import math
import shutil
import tempfile
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from pathlib import Path

import xarray as xr
from fmpy import extract

from .along import ALONG, along_of, states_for
from .drive import Driver, make_driver
from .errors import OptionError, RunError
from .feed import Feed
from .fmu.archive import Archive, build_fmu, open_fmu
from .fmu.platforms import for_this_machine
from .fmu.table import Row, table
from .fmu.variables import Kind, Variable, elements_of, variables_of
from .results import Recording, dataset
from .saved_state import SavedState, check_saved, check_saving, hash_of, read_state, resume, write_state
from .scene import Scene, load_scene
from .scene_inputs import FOLLOWING
from .scene_schema import MAX_LINKS
from .signals import Constant
from .statics_results import STATICS_GROUPS, joined, statics_dataset
from .units import LARGEST, SMALLEST
from .whole import divided

__all__ = ["check_given", "divided_scene", "outputs_among", "record_run", "settings_for", "simulate", "variables_in"]

INTERFACES = ("cs", "me")
SETTABLE = (Kind.PARAMETER, Kind.WHOLE, Kind.LINKS, Kind.SOLVER_CHOICE, Kind.INPUT, Kind.STATE)
_CHOICES = (Kind.SOLVER_CHOICE, Kind.LINKS)
GROUPS = ("theta", "omega")
"""What `record` takes besides names of variables: all link angles, all link rates."""

_ROUNDING = 1e-12
"""Relative: times that differ by less are one."""

Progress = Callable[[float, float], None]
"""Called with the simulated and the stop time [s]."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How to run: checked, with the scene's values where the caller gave none."""

    interface: str
    stop_time: float
    step: float
    tolerance: float
    given: Mapping[str, float | str]
    record: tuple[str, ...]
    saved: SavedState | None = None
    """What the run goes on from."""
    save_state: Path | None = None

    @property
    def start_time(self) -> float:
        return self.saved.time if self.saved else 0.0

    def times(self) -> list[float]:
        """Output times: 0, step, 2 step, ..., and the stop time [s]; those from the start time on."""
        # Rounding of the quotient must not make one more interval; a step beyond the stop time makes one.
        count = math.ceil(self.stop_time / self.step * (1.0 - 1e-12))
        end, last = self.stop_time, count * self.step
        if self.save_state and abs(last - end) <= _ROUNDING * end:
            end = last  # a run that goes on from here must find the times of one that never stopped
        later = [k * self.step for k in range(count) if k * self.step > self.start_time * (1.0 + _ROUNDING)]
        return [self.start_time, *later, end]


def simulate(
    what: Scene | str | Path, *, fmi: int | None = None, interface: str = "cs", stop_time: float | None = None,
    step: float | None = None, tolerance: float | None = None, parameters: Mapping[str, float | str] | None = None,
    record: Sequence[str] = (), progress: Progress | None = None, save_state: str | Path | None = None,
    from_state: str | Path | None = None,
) -> xr.Dataset:  # fmt: skip
    """Build a scene's FMU, run it through FMPy, and return its outputs over time.

    Parameters
    ----------
    what
        A scene, the name of one that ships, the path of a TOML file, or of an FMU that `build_fmu` made.
    fmi
        Version, 2 (default) or 3; not for an FMU, which has its own.
    interface
        "cs": Co-Simulation, the FMU's own solver. "me": Model Exchange under FMPy's CVode.
    stop_time, step
        [s]; from the scene by default. `step` is both communication step and output interval.
    tolerance
        Relative tolerance of the solver.
    parameters
        Values of parameters, inputs (then constant, instead of the scene's force) and start values of
        states by name, SI, and the name of a solver: "automatic", "explicit" or "implicit" (used in
        Co-Simulation). What the scene derived at build time stays.
    record
        Further variables by name, beside those that the scene asks for; "theta" and "omega" stand for those of all
        links. "nodes": `node_x`, `node_y`, where every node is; "tensions": `tension`, the pull in every link. "modes"
        and "stiffness": natural frequencies with mode shapes, and the cable's end stiffness, about the equilibrium for
        the inputs of the start.
    progress
        Called with the simulated and the stop time [s] after every output interval.
    save_state
        File for the complete state at the stop time; an existing one is replaced. Co-Simulation only: in Model
        Exchange it is CVode that integrates, and its memory cannot be saved.
    from_state
        A file that `save_state` wrote of the same scene: the run goes on from there to a later stop time, with the same
        bits as if it had never stopped. Version of FMI, step and what was set are those of the saved run, unless the
        step or an input is given anew; parameters and tolerance cannot be.

    Returns
    -------
    xarray.Dataset
        Over `time` [s]; `attrs` hold scene, settings, versions and the solver's statistics.

    Raises
    ------
    UserError
        A mistake in what was given: SceneError, FmuError, StateError or OptionError.
    RunError
        If the run could not go on; its `partial` is the Dataset up to then.
    """
    scene, archive = _open(what, fmi)
    variables = variables_in(scene, archive)
    saved = None if from_state is None else read_state(from_state)
    version = archive.fmi if archive else fmi or (saved.fmi if saved else 2)
    given = dict(parameters or {})
    if saved:
        inputs = [variable.name for variable in variables if variable.kind is Kind.INPUT]
        arrays = archive is not None and archive.has_arrays
        check_saved(saved, scene, version, interface, tolerance, given, inputs, arrays=arrays)
        step = saved.step if step is None else step
        tolerance, given = saved.tolerance, {**saved.given, **given}
    if archive is not None and archive.has_arrays:
        scene = divided_scene(scene, given)
    asked = (*scene.record, *([record] if isinstance(record, str) else record))
    settings = settings_for(scene, variables, interface, stop_time, step, tolerance, given, asked)
    if save_state is not None:
        check_saving(Path(save_state), interface)
    settings = _between_states(settings, saved, save_state, archive)
    statics = statics_dataset(scene, settings.given, [name for name in STATICS_GROUPS if name in settings.record])
    folder = tempfile.mkdtemp(prefix="cablefmu-")
    try:
        if archive is None:
            archive = open_fmu(
                build_fmu(scene, Path(folder) / f"{scene.name}.fmu", fmi=version, platforms=for_this_machine())
            )
        extract(str(archive.path), unzipdir=str(Path(folder) / "fmu"))
        return joined(_run(archive, scene, variables, settings, str(Path(folder) / "fmu"), progress), statics)
    except RunError as error:
        if isinstance(error.partial, xr.Dataset):
            error.partial = joined(error.partial, statics)
        raise
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _open(what: Scene | str | Path, fmi: int | None) -> tuple[Scene, Archive | None]:
    if fmi not in (None, 2, 3):
        raise OptionError(f"fmi = {fmi!r}: 2 or 3 is expected")
    if isinstance(what, Scene):
        return what, None
    if Path(what).suffix == ".fmu":
        archive = open_fmu(what)
        if fmi not in (None, archive.fmi):
            raise OptionError(f"fmi = {fmi}: {what} is an FMU of version {archive.fmi}; leave the version out")
        return archive.scene, archive
    return load_scene(what), None


def variables_in(scene: Scene, archive: Archive | None) -> list[Variable]:
    """The variables of the FMU; a twin has none of the native solver's."""
    if archive is None:
        return variables_of(scene.cable, scene.dropped_outputs)
    present = {variable.name for variable in archive.description.modelVariables}
    return [variable for variable in archive.variables() if variable.name in present]


def divided_scene(scene: Scene, given: Mapping[str, float | str]) -> Scene:
    """The scene of an FMU with arrays for as many links as are asked for, and for the cable that was set."""
    n = given.get("n", scene.cable.n)
    if isinstance(n, str) or not 1 <= n <= MAX_LINKS or n != int(n):
        raise OptionError(f"set n={n}: a whole number of links from 1 to {MAX_LINKS} is expected")
    for name, row in table().whole.items():
        value = given.get(name, 1.0)
        _check_least(name, value, row)
        if row.least == "+0" and not SMALLEST <= float(value) <= LARGEST:
            raise OptionError(f"set {name}={value}: a number from {SMALLEST:g} to {LARGEST:g} [{row.unit}] is expected")
    numbers = {name: float(value) for name, value in given.items() if not isinstance(value, str)}
    return divided(scene, int(n), numbers)


# --- settings ---


def settings_for(
    scene: Scene, variables: list[Variable], interface: str, stop_time: float | None, step: float | None,
    tolerance: float | None, given: Mapping[str, float | str], record: Sequence[str],
) -> Settings:  # fmt: skip
    if interface not in INTERFACES:
        raise OptionError(f"interface = {interface!r}: cs (Co-Simulation) or me (Model Exchange) is expected")
    settings = Settings(
        interface,
        _positive("stop time", scene.stop_time if stop_time is None else stop_time, "s"),
        _positive("step", scene.step if step is None else step, "s"),
        _positive("tolerance", scene.tolerance if tolerance is None else tolerance, ""),
        dict(given),
        tuple(record),
    )
    if settings.stop_time / settings.step > 10_000_000:
        raise OptionError(f"step = {settings.step} s: more than 10,000,000 output times; a longer step is expected")
    if settings.tolerance > 0.1:
        raise OptionError(f"tolerance = {settings.tolerance}: at most 0.1 is expected")
    by_name = {variable.name: variable for variable in variables}
    for name, value in settings.given.items():
        check_given(name, value, by_name)
    over_time = (v.name for v in elements_of(variables, scene.cable.n) if v.kind not in (Kind.TIME, *_CHOICES))
    recordable = [*GROUPS, *ALONG, *STATICS_GROUPS, *over_time]
    for name in settings.record:
        if name in by_name and by_name[name].kind in _CHOICES:
            raise OptionError(f"record {name}: it is a fixed choice, not a number over time")
        if name not in recordable:
            raise OptionError(f"record {name}: there is no such variable{_nearest(name, recordable)}")
    return settings


def _positive(name: str, value: float, unit: str) -> float:
    if not (math.isfinite(value) and value > 0.0):
        raise OptionError(f"{name} = {value}: a number above 0{f' [{unit}]' if unit else ''} is expected")
    return float(value)


def check_given(name: str, value: float | str, variables: Mapping[str, Variable]) -> None:
    settable = [v.name for v in variables.values() if v.kind in SETTABLE and v.initial != "calculated"]
    if name not in variables:
        raise OptionError(f"set {name}: there is no such variable{_nearest(name, settable)}")
    if name in FOLLOWING and name in settable:
        raise OptionError(f"set {name}: it follows {FOLLOWING[name][0]}, whose derivative it is; that can be set")
    if name not in settable:
        raise OptionError(f"set {name}: it is calculated and cannot be set; parameters, inputs and start values can")
    enumeration = variables[name].enumeration
    if enumeration:
        allowed = [item.name for item in enumeration.items]
        if value not in allowed:
            raise OptionError(f"set {name}={value}: one of {', '.join(allowed)} is expected")
        return
    row = (table().parameters | table().whole).get(name)
    _check_least(name, value, row or Row(name, variables[name].unit, "", 0))


def _check_least(name: str, value: float | str, row: Row) -> None:
    if isinstance(value, str) or not math.isfinite(value):
        raise OptionError(f"set {name}={value}: a finite number [{row.unit}] is expected")
    if value < float(row.least) or (row.least == "+0" and value == 0.0):
        expected = "a number above 0" if row.least == "+0" else f"a number of {row.least} or more"
        raise OptionError(f"set {name}={value}: {expected} [{row.unit}] is expected")


def _between_states(
    settings: Settings, saved: SavedState | None, save_state: str | Path | None, archive: Archive | None
) -> Settings:
    """With what the run goes on from, and where its end is kept."""
    if archive and (saved or save_state) and not archive.description.coSimulation.canSerializeFMUstate:
        raise OptionError(f"{archive.path}: this FMU cannot save its state; one from `cablefmu build` can")
    settings = replace(settings, saved=saved, save_state=None if save_state is None else Path(save_state))
    if not settings.stop_time > settings.start_time * (1.0 + _ROUNDING):
        raise OptionError(
            f"stop time = {settings.stop_time} s: the state is of t = {settings.start_time:.12g} s; "
            "a later time is expected"
        )
    return settings


def _nearest(name: str, allowed: Sequence[str]) -> str:
    close = difflib.get_close_matches(name, allowed, n=1)
    return f"; did you mean {close[0]}?" if close else f"; allowed are {', '.join(a for a in allowed if '[' not in a)}"


# --- the run ---


def _run(
    archive: Archive, scene: Scene, variables: list[Variable], settings: Settings, folder: str,
    progress: Progress | None,
) -> xr.Dataset:  # fmt: skip
    elements = elements_of(variables, scene.cable.n)
    asked = [*outputs_among(elements), *_recorded(elements, settings.record)]
    names, behind = {variable.name for variable in asked}, states_for(scene.cable, settings.record)
    recording = Recording([*asked, *(v for v in _recorded(elements, behind) if v.name not in names)])
    statistics, failure = record_run(archive, scene, variables, settings, folder, recording, progress)
    about = {
        "fmi": archive.fmi, "interface": settings.interface, "step": settings.step, "stop_time": settings.stop_time,
        "tolerance": settings.tolerance, "set": " ".join(f"{k}={v}" for k, v in settings.given.items()),
    }  # fmt: skip
    result = dataset(recording.first(len(asked)), scene, about, statistics)
    if behind:
        everything = dataset(recording, scene, about, statistics)
        result = joined(result, along_of(everything, scene.cable, settings.given, settings.record))
    if failure is None:
        return result
    if not recording.times:
        raise failure
    result.attrs["ended_early"] = str(failure)
    raise RunError(str(failure), time=recording.times[-1], partial=result)


def record_run(
    archive: Archive, scene: Scene, variables: list[Variable], settings: Settings, folder: str, recording: Recording,
    progress: Progress | None = None,
) -> tuple[dict[str, float], RunError | None]:  # fmt: skip
    """Run an FMU that is unpacked in `folder`, and fill `recording`; statistics, and the error that ended it."""
    by_name = {variable.name: variable for variable in variables}
    signals = {name: scene.signals[name] for name in scene.cable.inputs}
    # A force that was set is constant, in place of the scene's; a vessel that was put somewhere rests there.
    signals |= {name: Constant(float(value)) for name, value in settings.given.items() if name in signals}
    rests = {name for name, (place, _) in FOLLOWING.items() if place in settings.given and name in signals}
    signals |= dict.fromkeys(rests, Constant(0.0))
    feed = Feed(signals)
    driver = make_driver(archive.fmi, settings.interface, archive.description, folder, feed)
    try:
        read = _reader(driver, recording.variables, scene.cable.n)
        started = clock.perf_counter()
        numbers, choices = _set_before(settings.given, by_name)
        if settings.saved:
            driver.resize(choices)
            resume(driver, settings.saved)
        else:
            driver.start(0.0, settings.stop_time, settings.tolerance, numbers, choices)
        failure = _advance(driver, read, feed, settings.times(), recording, progress)
        statistics: dict[str, float] = dict(driver.counters()) if failure is None else {}
        statistics["run_time"] = clock.perf_counter() - started
        if settings.save_state and failure is None:
            _save(driver, archive, settings)
    finally:
        driver.close()
    return statistics, failure


def _save(driver: Driver, archive: Archive, settings: Settings) -> None:
    assert settings.save_state
    write_state(settings.save_state, SavedState(
        scene=hash_of(archive.scene), fmi=archive.fmi, arrays=archive.has_arrays, time=settings.times()[-1],
        step=settings.step, tolerance=settings.tolerance, given=settings.given, image=driver.save(),
        source=str(settings.save_state),
    ))  # fmt: skip


def _set_before(
    given: Mapping[str, float | str], variables: Mapping[str, Variable]
) -> tuple[dict[int, float], dict[int, int]]:
    """Numbers and integers (values of enumerations, the number of links), each by reference."""
    numbers: dict[int, float] = {}
    choices: dict[int, int] = {}
    for name, value in given.items():
        reference, enumeration = variables[name].reference, variables[name].enumeration
        if enumeration:
            choices[reference] = enumeration.value_of(str(value))
        elif variables[name].kind is Kind.LINKS:
            choices[reference] = int(value)
        else:
            numbers[reference] = float(value)
    return numbers, choices


def outputs_among(variables: list[Variable]) -> list[Variable]:
    return [variable for variable in variables if variable.causality == "output"]


def _recorded(variables: list[Variable], record: Sequence[str]) -> list[Variable]:
    """The further variables that were asked for, each once, in the order of the table."""
    wanted = {v.name for v in variables for name in record if v.name == name or v.name.startswith(f"{name}[")}
    return [v for v in variables if v.name in wanted and v.causality != "output"]


def _reader(driver: Driver, variables: list[Variable], n: int) -> Callable[[], list[float]]:
    """What reads the present values of these variables; an array is read once, and its elements are taken out."""
    size = {variable.reference: n if variable.dimension is not None else 1 for variable in variables}
    before = dict(zip(size, accumulate(size.values(), initial=0), strict=False))
    places = [before[v.reference] + (v.index if v.dimension is not None else 0) for v in variables]
    references = list(size)

    def read() -> list[float]:
        values = driver.get(references)
        return [values[place] for place in places]

    return read


def _advance(
    driver: Driver, read: Callable[[], list[float]], feed: Feed, times: list[float], recording: Recording,
    progress: Progress | None,
) -> RunError | None:  # fmt: skip
    """From each output time to the next, in pieces that no jump of a force lies in; the error that ended it."""
    try:
        recording.add(times[0], read())
        for start, end in pairwise(times):
            time = start
            while time < end:
                reach = feed.next_break(time, end)
                driver.advance(time, reach)
                time = reach
            values = read()
            if not all(map(math.isfinite, values)):
                return RunError(f"an output is not a finite number at t = {end} s")
            recording.add(end, values)
            if progress:
                progress(end, times[-1])
    except RunError as error:
        return error
    return None
