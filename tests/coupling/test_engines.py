"""Three engines on one coupling, what the exports say, and what engines cannot do."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd, read_ssv
from libcosimpy import CosimExecution, CosimLogging, CosimObserver
from lxml import etree

from cablefmu.coupling.description import Coupling
from cablefmu.coupling.engines import ENGINES, run_with
from cablefmu.coupling.export_osp import STRUCTURE, write_osp
from cablefmu.coupling.export_ssp import write_ssp
from cablefmu.coupling.system import System, opened, varied
from cablefmu.errors import OptionError
from tests.coupling.oscillators import oscillators
from tests.coupling.ships import small

ROUNDING = 1e-11
"""Of every output's largest value: the engines' times differ in their last digits, as libcosim counts nanoseconds and
FMPy's runner adds up steps."""

# The FMUs' own default, as neither engine passes a tolerance on.
DEFAULT = ("tolerance = 1e-11", "tolerance = 1e-6")


def _coupling(cables: Path, *, start: float = 0.0) -> Coupling:
    """The oscillators without a gain, which FMPy's runner does not know; the spring pulls at the start if asked."""
    text = (
        oscillators(cables)
        .text.replace(*DEFAULT)
        .replace('"spring.F_a"\nto = "b.u_m1"\ngain = -1', '"spring.F_b"\nto = "b.u_m1"')
    )
    return Coupling.from_text(text.replace("= 0.3", f"= {start}").replace("= -0.2", "= 0.0"), name="two", folder=cables)


@pytest.fixture(scope="module")
def quiet(cables: Path) -> Iterator[System]:
    """Nothing pulls at the start: an input of 0 in the first step is right. A wave moves both."""
    text = _coupling(cables).text
    wave = '[[model]]\nname = "wave"\npartner = "wave_force"\nparameters = { amplitude = 20, period = 1, ramp = 0.5 }\n'
    text += wave + '[[connection]]\nfrom = "wave.force"\nto = "a.F_cy"\n'
    with opened(Coupling.from_text(text, name="quiet", folder=cables)) as system:
        yield system


@pytest.mark.parametrize("engine", ["libcosim", "fmpy-ssp"])
def test_engines_agree_but_for_rounding(engine: str, quiet: System) -> None:
    own, other = run_with("own", quiet), run_with(engine, quiet)
    assert other["time"].values == pytest.approx(own["time"].values[1:])
    assert other.attrs["engine"] == engine
    for name in ("a.y_m1", "a.v_m1", "b.y_m1", "spring.F_a", "wave.force", "a.tension_top"):
        found, expected = other[name].values, own[name].values[1:]
        assert np.abs(expected).max() > 0.01
        assert np.abs(found - expected).max() < ROUNDING * np.abs(expected).max(), name


def test_what_differs_at_a_start_under_force_is_the_first_step_alone(cables: Path) -> None:
    """libcosim initialises as this master does; FMPy's runner begins with all inputs 0.

    Mass a misses the spring's force of 75 N for one step of 0.02 s: 75 N * 0.02 s / 13.5 kg = 0.11 m/s.
    """
    with opened(_coupling(cables, start=0.3)) as system:
        own, libcosim, fmpy = (run_with(engine, system) for engine in ("own", "libcosim", "fmpy-ssp"))
    expected = own["a.v_m1"].values[1:]
    assert np.abs(libcosim["a.v_m1"].values - expected).max() < ROUNDING * 3.0
    assert fmpy["a.v_m1"].values[0] - expected[0] == pytest.approx(75.0 * 0.02 / 13.466, rel=0.02)


# --- a vessel and its cable, through the motion port ---

MASS, CABLE = 4000.0, 124.0
"""Of the vessel, and of the cable with its load [kg]"""
RATES = np.sqrt(np.array([4.0, 5.0]) * 4100.0 / MASS)
"""Of the vessel on its springs, along x and y [rad/s]"""


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[System]:
    """The cable's force is late by a step; inputs der(F_x) and the like have no source, and 0 is right for them."""
    folder = tmp_path_factory.mktemp("port")
    text = small(folder).text.replace('"gauss-seidel"', '"jacobi"')
    text = text.replace("extrapolation = 1", "extrapolation = 0\ntolerance = 1e-6")
    with opened(Coupling.from_text(text, name="port", folder=folder)) as system:
        yield system


@pytest.mark.parametrize("engine", ["libcosim", "fmpy-ssp"])
def test_engines_agree_on_a_vessel_and_its_cable_but_for_their_first_step(engine: str, port: System) -> None:
    """Both give the vessel a force in the first step h that is wrong by F: it starts with F h / m too little velocity.

    libcosim begins with all inputs 0 and repeats as often as there are models, twice. With a the right acceleration
    and m_a the mass that the cable adds, force is wrong by m_a a, then acceleration by m_a a / m, then force by
    m_a^2 a / m.
    FMPy's runner leaves them 0: the vessel misses all of its force, and the cable the acceleration of its top, which is
    as much as its mass times that in momentum. On its springs the vessel goes as far as that velocity over its rate.
    """
    off = []
    for step in (0.02, 0.01):
        system = varied(port, step=step)
        own, other = run_with("own", system), run_with(engine, system)
        force, a = (
            np.array([float(own[name.format(axis)][0]) for axis in "xy"]) for name in ("cable.F_1{}", "vessel.a{}")
        )
        if engine == "libcosim":
            missed = float(own["cable.m_1yy"][0]) ** 2 * a / MASS
            farthest = np.hypot(*missed)  # along either: the cable turns
        else:
            missed, farthest = force, np.abs(force) + CABLE * np.abs(a)
        slower = own["vessel.vy"].values[1] - other["vessel.vy"].values[0]
        assert slower == pytest.approx(missed[1] * step / MASS, rel=0.01)
        off.append([np.abs(other[f"vessel.{q}"].values - own[f"vessel.{q}"].values[1:]).max() for q in "xy"])
        assert np.all(off[-1] <= farthest * step / MASS / RATES)
        assert all(float(np.ptp(own[f"vessel.{q}"].values)) > 0.5 for q in "xy")  # m: there is something to agree on
    assert np.array(off[0]) / off[1] == pytest.approx([2.0, 2.0], abs=0.1)  # they tend to the same


def test_ssp_is_what_the_schemas_want_and_holds_the_fmus(quiet: System, tmp_path: Path) -> None:
    path = write_ssp(quiet, tmp_path / "quiet.ssp")
    ssd = read_ssd(str(path))  # both validate against the schemas of SSP 1.0 that FMPy ships
    values = {
        f"{name}.{parameter.name}": parameter.value
        for name in quiet.models
        for parameter in read_ssv(str(path), resource=f"resources/{name}.ssv").parameters
    }
    assert [component.name for component in ssd.system.elements] == ["a", "b", "spring", "wave"]
    assert ssd.system.elements[0].source == "resources/a.fmu"
    assert len(ssd.system.connections) == 7
    assert float(values["spring.stiffness"]) == 250.0 and float(values["a.F_cx"]) == 0.0
    assert "a.u_m1" not in values  # it is connected
    with zipfile.ZipFile(path) as archive:
        assert archive.read("resources/a.fmu") == quiet.models["a"].path.read_bytes()


def test_ssp_and_osp_say_gains_in_their_own_way(cables: Path, tmp_path: Path) -> None:
    with opened(oscillators(cables)) as system:
        write_ssp(system, tmp_path / "x.ssp")
        structure = etree.parse(write_osp(system, tmp_path / "osp"))
    with zipfile.ZipFile(tmp_path / "x.ssp") as archive:
        ssd = etree.fromstring(archive.read("SystemStructure.ssd"))
    (scaled,) = ssd.iter("{*}LinearTransformation")
    assert float(scaled.get("factor")) == -1.0
    assert scaled.getparent().get("endElement") == "b"
    (function,) = structure.iter("{*}LinearTransformation")
    assert (function.get("name"), float(function.get("factor"))) == ("gain_6", -1.0)
    ends = [[child.attrib.values() for child in c] for c in structure.iter("{*}SignalConnection")]
    assert ends == [[["spring", "F_a"], ["gain_6", "in"]], [["gain_6", "out"], ["b", "u_m1"]]]
    assert (tmp_path / "osp" / STRUCTURE).is_file() and (tmp_path / "osp" / "spring.fmu").is_file()


def test_libcosim_runs_the_ssp_as_well(quiet: System, tmp_path: Path) -> None:
    """It takes parameters and inputs from there, but no start values of outputs; here they are 0."""
    CosimLogging.log_output_level(CosimLogging.CosimLogLevel.FATAL)
    execution = CosimExecution.CosimExecution.from_ssp_file(str(write_ssp(quiet, tmp_path / "quiet.ssp")), 20_000_000)
    observer = CosimObserver.CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert all(execution.step() for _ in range(100))
    number = execution.slave_index_from_instance_name("b")
    (found,) = observer.last_real_values(number, [int(quiet.models["b"].variables["y_m1"].valueReference)])
    expected = run_with("own", quiet)["b.y_m1"].values
    assert found == pytest.approx(expected[-1], abs=ROUNDING * np.abs(expected).max())


def test_libcosim_applies_gains(cables: Path) -> None:
    text = oscillators(cables).text.replace(*DEFAULT)
    with opened(Coupling.from_text(text, name="two", folder=cables)) as system:
        own, other = run_with("own", system), run_with("libcosim", system)
    assert np.abs(other["b.y_m1"].values - own["b.y_m1"].values[1:]).max() < ROUNDING


@pytest.mark.parametrize(
    ("engine", "old", "new", "reason"),
    [
        ("libcosim", '"jacobi"', '"gauss-seidel"', 'algorithm = "gauss-seidel" is not in it; "jacobi" is expected'),
        ("fmpy-ssp", "extrapolation = 0", "extrapolation = 2", "extrapolation = 2: it holds inputs; 0 is expected"),
        ("libcosim", "step = 0.02", "step = 0.03", "stop_time = 2.0 s: a multiple of the step is expected"),
        (
            "libcosim",
            "y_m1 = 0.3",
            'solver = "implicit"',
            "model a: parameter solver is an enumeration, which it does not",
        ),
        (
            "fmpy-ssp",
            'name = "spring"',
            'name = "ab"',
            "model a: it takes parameters of ab for its own, whose name begins",
        ),
        ("fmpy-ssp", "a-2.fmu", "a-3.fmu", "model a is of FMI 3; 2 is expected"),
        ("libcosim", "a-2.fmu", "a-3.fmu", "model a is of FMI 3; 2 is expected"),
        (
            "libcosim",
            "tolerance",
            "adaptive = { tolerance = 1, smallest = 1, largest = 1 }\ntolerance",
            "leave adaptive out",
        ),
        ("fmpy-ssp", "gain = -1", "gain = -2", "connection spring.F_a -> b.u_m1: it knows no gain"),
        ("libcosim", "step = 0.02", "step = 6.25e-10", "a whole number of nanoseconds is expected"),
    ],
)
def test_what_an_engine_cannot_do_is_refused_before_the_run(
    engine: str, old: str, new: str, reason: str, cables: Path
) -> None:
    text = oscillators(cables).text
    assert old in text
    if "e-10" in new:
        text = text.replace("stop_time = 2", "stop_time = 6.25e-9")
    text = text.replace("spring.", "ab.") if '"ab"' in new else text
    text = text.replace(old, new).replace("tolerance = 1,", "tolerance = 0.1,")
    with opened(Coupling.from_text(text, name="two", folder=cables)) as system:
        with pytest.raises(OptionError) as raised:
            run_with(engine, system)
        assert f"engine = {engine}: " in str(raised.value) and reason in str(raised.value)


def test_names_of_engines() -> None:
    assert list(ENGINES) == ["own", "libcosim", "fmpy-ssp"]


def test_offsets_are_the_same_in_every_engine_and_format(cables: Path, tmp_path: Path) -> None:
    """A spring whose end is told 0.1 m further pulls as one that is 0.1 m longer."""
    text = oscillators(cables).text.replace(*DEFAULT)
    offset = text.replace('to = "spring.y_a"', 'to = "spring.y_a"\noffset = 0.1', 1)
    longer = text.replace("stiffness = 250", "stiffness = 250, rest = -0.1", 1)
    assert text not in (offset, longer)
    with opened(Coupling.from_text(offset, name="two", folder=cables)) as system:
        own, other = run_with("own", system), run_with("libcosim", system)
        with zipfile.ZipFile(write_ssp(system, tmp_path / "x.ssp")) as archive:
            ssd = etree.fromstring(archive.read("SystemStructure.ssd"))
        with pytest.raises(OptionError, match=r"connection a\.y_m1 -> spring\.y_a: it knows no offset"):
            run_with("fmpy-ssp", system)
    assert [element.attrib["offset"] for element in ssd.iter("{*}LinearTransformation")] == ["0.1", "0.0"]
    assert np.abs(other["b.y_m1"].values - own["b.y_m1"].values[1:]).max() < ROUNDING
    with opened(Coupling.from_text(longer, name="two", folder=cables)) as system:
        expected = run_with("own", system)
    assert np.abs(own["b.y_m1"].values - expected["b.y_m1"].values).max() < ROUNDING
