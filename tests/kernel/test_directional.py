"""Directional derivatives against the dense equation's by complex step, every force by itself as well.

The expectations and what they are worth: tests/kernel/changes.py.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from cablefmu.cable import Drag, Floats, Terminal, Top
from cablefmu.reference import Reference
from tests.kernel.cases import Case, case
from tests.kernel.changes import Direction, expected_changes, random_directions, unit_directions
from tests.kernel.library import Kernel, inputs_of
from tests.random_cables import KINDS, TERMINALS, random_cable, random_inputs, random_state

EXACT = 1e-10
"""Largest error of a change over the largest change. Measured: 2e-11 where an end weighs a hundred cables or P_n is
far from its pin, so that much cancels; the median is 3e-15 (12 links), 1e-14 (60). For outputs alike, tensions being
sums over all links below: 3e-11 (60 links)."""
PULLS = ("tension_top", "tension_end", "tension_max")


def found_changes(c: Case, along: Direction) -> tuple[Floats, dict[str, float]]:
    """The same from the kernel; the first half of the derivative's change is that of the rates, to the bit."""
    x, dx = np.concatenate([c.q, c.v]), np.concatenate([along.q, along.v])
    found = c.kernel.directional(x, inputs_of(c.inputs), dx, inputs_of(along.inputs))
    assert found is not None
    changes, outputs = found
    half = c.cable.coordinates
    assert changes[:half].tobytes() == along.v.tobytes()
    return changes[half:], outputs


def least_change(c: Case, along: Direction) -> float:
    """What the floater alone would do under the change of the forces on it [m/s^2]: where a single link on a pin
    makes every change zero, this is what rounding is measured by. A given top brings accelerations of its own, of
    which a heavy end leaves little [5 m/s^2; with one link, 2e-10 of 1 m/s^2 was measured]."""
    if c.cable.top is Top.MOTION:
        return 5.0
    return sum(abs(force) for force in along.inputs.values()) / c.cable.parameters["M_1"]


def assert_changes_agree(c: Case, along: Iterator[Direction]) -> None:
    """Accelerations for each direction; outputs over their largest change in all directions, tensions alike."""
    found_outputs, expected_outputs = [], []
    for direction in along:
        (found, y), (expected, z) = found_changes(c, direction), expected_changes(c, direction)
        assert np.abs(found - expected).max() <= EXACT * max(np.abs(expected).max(), least_change(c, direction))
        found_outputs.append(y)
        expected_outputs.append(z)
    size = {name: max(abs(y[name]) for y in expected_outputs) for name in expected_outputs[0]}
    size |= dict.fromkeys(PULLS, max(size[name] for name in PULLS))
    forces = [name for name in size if name.startswith("F_")]
    size |= {name: max(size[name], *(size[other] for other in (*PULLS, *forces))) for name in forces}
    masses = [name for name in size if name.startswith("m_")]
    size |= dict.fromkeys(masses, max((size[name] for name in masses), default=0.0))
    for name, largest in size.items():
        errors = [abs(y[name] - z[name]) for y, z in zip(found_outputs, expected_outputs, strict=True)]
        assert max(errors) <= EXACT * largest, name


@pytest.mark.parametrize("kind", range(len(KINDS)))
@pytest.mark.parametrize("n", [1, 2, 3, 12])
def test_changes_with_every_state_and_input(library: ctypes.CDLL, n: int, kind: int) -> None:
    c = case(library, n, kind)
    assert_changes_agree(c, unit_directions(c.cable))


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_changes_of_sixty_links(library: ctypes.CDLL, kind: int) -> None:
    c = case(library, 60, kind)
    assert_changes_agree(c, random_directions(c.cable, 5))


@pytest.mark.parametrize("mass", [1e4, 1e5, 1e6, 8e8, 1e12, 1e20])
@pytest.mark.parametrize("terminal", [Terminal.ANCHOR_MASS, Terminal.FLOATER])
def test_changes_at_heavy_ends(library: ctypes.CDLL, terminal: Terminal, mass: float) -> None:
    """Where the end outweighs the cable a hundred times it is bordered: eliminated, it would cost its share of the
    mass, up to nine digits. Ends without weight, of which even long doubles would lose the cable's part."""
    kind = KINDS.index((terminal, True, Drag.COEFFICIENT))
    c = case(library, 12, kind, draw=0, **{"M_2" if terminal is Terminal.FLOATER else "m_c": mass})
    assert_changes_agree(c, unit_directions(c.cable))


# --- every force by itself ---

JOINTS = ("joint_stiffness", "joint_damping", "drag")
FORCES: dict[str, tuple[tuple[Terminal, ...], tuple[str, ...], float]] = {
    "weight": (TERMINALS, ("g",), 0.0),
    "joint springs": (TERMINALS, ("k_joint", "joint_stiffness"), 0.0),
    "joint dampers": (TERMINALS, ("c_joint", "joint_damping"), 0.01),
    "drag": (TERMINALS, ("Cd", "drag"), 1.0),
    "floater's spring": (TERMINALS, ("k_m1",), 0.0),
    "floater's damper": (TERMINALS, ("c_m1",), 0.01),
    "floater's load": (TERMINALS, ("static_load",), 0.0),
    "terminal's springs": ((Terminal.ANCHOR_SPRING, Terminal.FLOATER), ("k_cH", "k_cV", "k_m2H", "k_m2V"), 0.0),
    "terminal's dampers": ((Terminal.ANCHOR_SPRING, Terminal.FLOATER), ("c_cH", "c_cV", "c_m2H", "c_m2V"), 0.01),
    "terminal's preload": ((Terminal.ANCHOR_SPRING, Terminal.FLOATER), ("static_load_2", "static_pull_2"), 0.0),
    "inputs": (TERMINALS, ("inputs",), 0.0),
}
"""Force -> (terminals that know it, what of the cable it is made of, rates [rad/s, m/s] up to which it is seen: at rest
nothing else acts, and slow rates leave what is linear in them before what is square)."""


def singled_out(library: ctypes.CDLL, terminal: Terminal, kept: tuple[str, ...], rates: float) -> Case:
    """A cable of five unequal links in water on which nothing acts but `kept`, its pin included if it has one."""
    rng = np.random.default_rng([5, TERMINALS.index(terminal)])
    cable = random_cable(rng, 5, terminal, water=True)
    (q, v), inputs = random_state(rng, cable), random_inputs(rng, cable)
    inert = ("M_1", "m_c", "M_2", "I_Rc", "rho_w", "rho_c", "V_c")
    parameters = {name: value if name in (*inert, *kept) else 0.0 for name, value in cable.parameters.items()}
    links = replace(cable.links, **{name: np.zeros(5) for name in JOINTS if name not in kept})
    bare = replace(cable, parameters=parameters, links=links)
    inputs = {name: value if "inputs" in kept else 0.0 for name, value in inputs.items()}
    return Case(bare, q, rates * v, inputs, Kernel(library, bare), Reference(bare))


@pytest.mark.parametrize(
    ("force", "terminal"), [(force, terminal) for force, (terminals, _, _) in FORCES.items() for terminal in terminals]
)
def test_changes_of_one_force(library: ctypes.CDLL, force: str, terminal: Terminal) -> None:
    """Beside larger ones a wrong term could hide."""
    _, kept, rates = FORCES[force]
    c, bare = (singled_out(library, terminal, what, rates) for what in (kept, ()))
    assert_changes_agree(c, unit_directions(c.cable))
    with_it, without = (
        np.array([found_changes(each, along)[0] for along in unit_directions(c.cable)]) for each in (c, bare)
    )
    # the pin's own law is seen in any case: thousands of m/s^2 where P_n is far from it
    assert np.abs(with_it - without).max() > (1e-6 if terminal is Terminal.PIN else 0.1) * np.abs(with_it).max()


@pytest.mark.parametrize("terminal", TERMINALS)
def test_changes_of_turning_links_alone(library: ctypes.CDLL, terminal: Terminal) -> None:
    """No force but what the rates make: the centripetal pull, and a pin's."""
    c = singled_out(library, terminal, (), 1.0)
    assert_changes_agree(c, unit_directions(c.cable))
    assert np.abs(c.kernel.acceleration(c.q, c.v, c.inputs)).max() > 0.1


# --- where a branch is taken ---


def test_drag_at_rest_and_about_it(library: ctypes.CDLL) -> None:
    """|v| v is smooth once: at v_n = 0 its derivative is 0, as without drag."""
    kind = KINDS.index((Terminal.LOAD, True, Drag.COEFFICIENT))
    c = case(library, 6, kind)
    still = replace(c, v=np.zeros(7))
    dry = replace(c.cable, drag=Drag.NONE, links=replace(c.cable.links, drag=np.zeros(6), drag_area=np.zeros(6)))
    other = replace(still, cable=dry, kernel=Kernel(library, dry), reference=Reference(dry))
    for along in unit_directions(c.cable):
        found, expected = found_changes(still, along)[0], found_changes(other, along)[0]
        assert found == pytest.approx(expected, rel=0, abs=1e-15 * np.abs(expected).max())


def test_taut_level_cable_between_two_ends_that_cannot_give_has_no_derivatives(library: ctypes.CDLL) -> None:
    """All links level: neither heave nor turning moves P_n along the cable, and the pin's force is not determined."""
    cable = random_cable(np.random.default_rng(1), 3, Terminal.PIN, water=False)
    level = np.concatenate([[0.0], np.full(3, np.pi / 2)])
    x, none = np.concatenate([level, np.zeros(4)]), inputs_of({})
    assert Kernel(library, cable).directional(x, none, np.ones(8), none) is None
