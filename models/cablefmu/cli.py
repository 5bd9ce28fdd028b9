"""The command `cablefmu`.

Exit status: 0 on success, 2 for a mistake in what the user gave, 1 when a run itself failed.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, CycloptsError, Parameter
from rich.console import Console

from .completion import COUPLING_NAME, COUPLING_OR_FILE, SCENE_NAME, SCENE_OR_COUPLING, SCENE_OR_FILE, SCENE_OR_FMU
from .couple_command import couple_and_show, export_coupling
from .coupling.description import load_coupling, shipped_couplings
from .coupling_report_command import names_coupling, write_coupling_reports
from .doctor_command import doctor
from .errors import CableError, OptionError, RunError
from .files import check_writable
from .fmu.archive import build_fmu, default_path, open_fmu
from .fmu.platforms import PLATFORMS
from .fmu.twin import build_twin
from .fmu.variables import ENUMERATIONS
from .gallery_command import gallery
from .plot import KINDS, Kind, check_picture, write_plot
from .plot_command import as_asked, plot
from .progress import showing_progress
from .provenance import version_text
from .report import LIMIT
from .report_command import Asked, write_scene_reports
from .results import write_results
from .saved_state import read_state
from .scene import Scene, load_scene, shipped_scenes
from .simulate import simulate
from .stress import stress
from .summary import print_summary
from .sweep_command import sweep
from .view_command import view

__all__ = ["app", "main"]

app = App(
    name="cablefmu",
    help="Functional Mock-up Units of underwater cables, from a scene file.",
    version=version_text,
    help_format="plaintext",
    suppress_keyboard_interrupt=False,  # main() says so
)

app.register_install_completion_command(help="Have the shell complete commands, options and names behind TAB.")

SceneName = Annotated[
    str, Parameter(help="A shipped scene's name (see `cablefmu scenes`) or the path of a TOML file."), SCENE_OR_FILE
]


@app.command
def scenes(name: Annotated[str | None, SCENE_NAME] = None, /) -> None:
    """List the scenes that ship; with NAME print that scene's TOML, ready to edit."""
    if name is not None:
        sys.stdout.write(load_scene(name).text)
        return
    for shipped in shipped_scenes():
        print(f"{shipped}  {load_scene(shipped).description}")


@app.command
def build(
    scene: SceneName,
    /,
    *,
    output: Annotated[
        Path | None, Parameter(name=["--output", "-o"], help="File to write; ./build/NAME.fmu by default.")
    ] = None,
    fmi: Annotated[Literal[2, 3] | None, Parameter(help="Version of FMI; 2 by default.")] = None,
    arrays: Annotated[
        bool,
        Parameter(
            negative=(),
            help="Link angles and rates as arrays, their number n a structural parameter (FMI 3): "
            "./build/NAME-fmi3-arrays.fmu.",
        ),
    ] = False,
    platforms: Annotated[
        list[str] | None,
        Parameter(consume_multiple=True, help=f"Machines that it is for, of {', '.join(PLATFORMS)}; all by default."),
    ] = None,
    twin: Annotated[
        bool, Parameter(negative=(), help="Build the reference model instead, in Python: ./build/NAME-twin.fmu.")
    ] = False,
) -> None:
    """Build a scene's FMU: Model Exchange and Co-Simulation in one archive."""
    if twin and fmi == 3:
        raise OptionError("fmi = 3: a twin is an FMU of version 2; leave --fmi out, or --twin")
    if twin and arrays:
        raise OptionError("arrays: a twin is an FMU of version 2, which has none; leave --arrays out, or --twin")
    if twin and platforms is not None:
        raise OptionError("platforms: a twin is Python and runs on all of them; leave --platforms out, or --twin")
    loaded = load_scene(scene)
    if twin:
        print(build_twin(loaded, output))
    else:
        print(build_fmu(loaded, output, fmi=fmi, arrays=arrays, platforms=platforms))


@app.command
def run(
    scene: Annotated[
        str, Parameter(help="A shipped scene's name, a TOML file, or an FMU from `cablefmu build`."), SCENE_OR_FMU
    ],
    /,
    *,
    fmi: Annotated[Literal[2, 3] | None, Parameter(help="Version of FMI; 2 unless an FMU or a state is given.")] = None,
    interface: Annotated[
        Literal["cs", "me"], Parameter(help="Co-Simulation, or Model Exchange under FMPy's CVode.")
    ] = "cs",
    stop_time: Annotated[float | None, Parameter(help="[s]; the scene's by default.")] = None,
    step: Annotated[
        float | None, Parameter(help="Communication step and output interval [s]; the scene's by default.")
    ] = None,
    tolerance: Annotated[
        float | None, Parameter(help="Relative tolerance; 1e-6 unless the scene says otherwise.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        Parameter(
            name="--set",
            consume_multiple=True,
            help="NAME=VALUE: parameters, constant inputs, start values (SI); solver=NAME.",
        ),
    ] = None,
    record: Annotated[
        list[str] | None,
        Parameter(
            consume_multiple=True,
            help="Beside what the scene asks for: theta, omega, or names such as theta[3]; nodes, tensions: where "
            "every node is, and the pull in every link; modes, stiffness: natural frequencies with mode shapes, and "
            "the cable's end stiffness, about the equilibrium for the inputs of the start.",
        ),
    ] = None,
    save_state: Annotated[
        Path | None,
        Parameter(
            help="File for the FMU's complete state at the stop time (Co-Simulation: CVode's own cannot be saved)."
        ),
    ] = None,
    from_state: Annotated[
        Path | None,
        Parameter(
            help="Go on from a file of --save-state, with the same bits as if the run had never stopped. Parameters, "
            "tolerance, step and constant inputs are those of the saved run; step and inputs can be given anew."
        ),
    ] = None,
    plot: Annotated[Path | None, Parameter(help="Picture of the run, FILE.png, .svg or .pdf.")] = None,
    plot_kind: Annotated[Kind, Parameter(help="What it shows, see `cablefmu plot --help`.")] = "frames",
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], help="Results, FILE.csv or FILE.nc; ./build/NAME.csv by default."),
    ] = None,
) -> None:
    """Build a scene's FMU (or take one), run it through FMPy, and write its outputs."""
    for option, values in (("set", set_), ("record", record)):
        if values == []:
            raise OptionError(f"{option}: at least one value is expected behind it")
    given = _assignments(set_ or [])
    if plot is None and plot_kind != "frames":
        raise OptionError(f"plot-kind = {plot_kind}: goes with --plot FILE.png, which is missing")
    asked = [name.strip() for text in record or [] for name in text.split(",")]
    saved_fmi = None if from_state is None else read_state(from_state).fmi
    what, of = _archive_for(scene, fmi, saved_fmi)
    name = of.name
    results = output or Path("build") / f"{name}.csv"
    if results.suffix not in {".csv", ".nc"}:
        raise OptionError(f"output = {results}: a name that ends with .csv or .nc is expected")
    check_writable(results)
    if plot:
        check_picture(plot)
    wanted = [*asked, *(KINDS[plot_kind] if plot else ())]
    failure: RunError | None = None
    with showing_progress(name) as progress:
        try:
            result = simulate(
                what, interface=interface, stop_time=stop_time, step=step, tolerance=tolerance, parameters=given,
                record=wanted, progress=progress, save_state=save_state, from_state=from_state,
            )  # fmt: skip
        except RunError as error:
            if error.partial is None:
                raise
            failure, result = error, error.partial  # type: ignore[assignment]
    written = write_results(as_asked(result, [*of.record, *asked]), results)
    if plot:
        write_plot(result, plot, plot_kind)
    print_summary(result, Console())
    also = {"picture": plot, "state": save_state if failure is None else None}
    print(
        f"results: {', '.join(map(str, written))}" + "".join(f", {what}: {path}" for what, path in also.items() if path)
    )
    if failure is not None:
        raise RunError(f"the run ended at t = {failure.time:g} s; the results up to then are kept.\n{failure}")


@app.command
def report(
    *names: Annotated[str, Parameter(help="Scenes, shipped or TOML files; or couplings, likewise."), SCENE_OR_COUPLING],
    all_: Annotated[bool, Parameter(name="--all", negative=(), help="All scenes that ship.")] = False,
    output: Annotated[
        Path, Parameter(name=["--output", "-o"], help="Folder for NAME.report.html, .json and .csv.")
    ] = Path("build") / "report",
    accuracy: Annotated[
        float | None,
        Parameter(
            help="Position error [m] that a setting is recommended for; 1e-4 for scenes, "
            "1 % of the motion for couplings."
        ),
    ] = None,
    limit: Annotated[float, Parameter(help="CPU time [s] that a single run may take.")] = LIMIT,
    peers: Annotated[bool, Parameter(help="Whether CVode and scipy's integrators are compared with.")] = True,
    markdown: Annotated[Path | None, Parameter(help="A table of all the scenes, FILE.md.")] = None,
) -> None:
    """Measure error against run time: solvers, tolerances, steps, numbers of links; of couplings, ways of coupling."""
    coupled = [name for name in names if names_coupling(name)]
    scenes = [name for name in names if name not in coupled]
    if coupled and markdown is not None:
        raise OptionError("markdown: a table of scenes; leave it out, or couplings")
    if coupled:
        write_coupling_reports(coupled, accuracy=accuracy, limit=limit, folder=output)
    if scenes or all_ or not coupled:
        asked = Asked(scenes, all_, accuracy=accuracy, limit=limit, peers=peers, markdown=markdown)
        write_scene_reports(asked, folder=output)


@app.command
def couplings(name: Annotated[str | None, COUPLING_NAME] = None, /) -> None:
    """List the couplings that ship; with NAME print that coupling's TOML, ready to edit."""
    if name is not None:
        sys.stdout.write(load_coupling(name).text)
        return
    for shipped in shipped_couplings():
        print(f"{shipped}  {load_coupling(shipped).spec.coupling.description}")


@app.command
def couple(
    coupling: Annotated[
        str, Parameter(help="A shipped coupling's name (see `cablefmu couplings`) or a TOML file."), COUPLING_OR_FILE
    ],
    /,
    *,
    engine: Annotated[
        Literal["own", "libcosim", "fmpy-ssp"],
        Parameter(help="Who steps: this package, libcosim, or FMPy's SSP runner."),
    ] = "own",
    ssp: Annotated[
        Path | None, Parameter(help="Write the coupling as SSP 1.0, FILE.ssp, instead of running it.")
    ] = None,
    osp: Annotated[
        Path | None, Parameter(help="Write it as OSP system structure into this FOLDER, instead of running it.")
    ] = None,
    stop_time: Annotated[float | None, Parameter(help="[s]; the coupling's by default.")] = None,
    plot: Annotated[Path | None, Parameter(help="Picture of positions, forces and powers over time, FILE.png.")] = None,
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], help="Results, FILE.csv or FILE.nc; ./build/NAME.csv by default."),
    ] = None,
) -> None:
    """Couple FMUs of cables with others, and write what all of them say over time."""
    if ssp is None and osp is None:
        couple_and_show(coupling, engine, output, stop_time=stop_time, plot=plot)
        return
    if engine != "own" or (output, stop_time, plot) != (None, None, None):
        raise OptionError("ssp, osp: nothing is run; leave --output, --engine, --stop-time and --plot out")
    export_coupling(coupling, ssp, osp)


app.command(stress)
app.command(plot)
app.command(gallery)
app.command(doctor)
app.command(view)
app.command(sweep)


def _archive_for(scene: str, fmi: int | None, saved_fmi: int | None) -> tuple[Path, Scene]:
    """The FMU to run, made anew unless it was given, and its scene."""
    if Path(scene).suffix == ".fmu":
        archive = open_fmu(scene)
        if fmi not in (None, archive.fmi):
            raise OptionError(f"fmi = {fmi}: {scene} is an FMU of version {archive.fmi}; leave --fmi out")
        return archive.path, archive.scene
    loaded = load_scene(scene)
    version = fmi or saved_fmi or 2
    path = build_fmu(loaded, default_path(loaded, version), fmi=version)
    return path, loaded


def _assignments(texts: list[str]) -> dict[str, float | str]:
    """NAME=VALUE, each name once; the values of enumerations stay words."""
    given: dict[str, float | str] = {}
    for text in texts:
        name, equals, word = text.partition("=")
        value = word if name in ENUMERATIONS else _number(word)
        if not equals or not name or value is None:
            raise OptionError(f"set {text}: NAME=VALUE with a number in SI units is expected, for example M_1=6000")
        if name in given:
            raise OptionError(f"set {text}: {name} was set before in the same command; once is allowed")
        given[name] = value
    return given


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: runs the command (of the process by default) and ends with its exit status.

    Raises
    ------
    SystemExit
        With 2 for a mistake in what the user gave, 1 when a run failed; none on success.
    """
    errors = Console(stderr=True, highlight=False, markup=False, soft_wrap=True)
    try:
        app(sys.argv[1:] if arguments is None else arguments, exit_on_error=False, print_error=False)
    except CycloptsError as error:
        errors.print(f"cablefmu: {str(error).strip()}")
        sys.exit(2)
    except CableError as error:
        errors.print(f"cablefmu: {error}")
        sys.exit(error.exit_status)
    except KeyboardInterrupt:
        errors.print("cablefmu: interrupted")
        sys.exit(130)
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(0)
