"""Defects to be planted in the kernel, and the tests that are put in front of them."""

from __future__ import annotations

from dataclasses import dataclass

from tests.sources import Change

__all__ = ["DEFECTS", "GUARDS", "Defect"]


@dataclass(frozen=True)
class Defect:
    """What is done to the sources, and who must notice."""

    what: str
    """In words, for docs/mutations.md"""
    changes: tuple[Change, ...]
    caught_by: tuple[str, ...]
    """Guards that fail, every one of them; others may fail as well."""
    stress: str = ""
    """A case of `cablefmu stress` that fails within seconds; for one defect of each kind."""


GUARDS = {
    "accelerations": "tests/kernel/test_chain.py::test_accelerations_are_those_of_the_dense_equation",
    "energy and power": "tests/kernel/test_energy.py::test_energy_changes_by_the_powers",
    "undamped energy": "tests/kernel/test_energy.py::test_undamped_fall_keeps_its_energy",
    "explicit motion": "tests/kernel/test_explicit.py::test_motion_is_that_of_another_integrator_on_the_dense_equation",
    "explicit order": "tests/kernel/test_explicit.py::test_fixed_steps_converge_with_order_five",
    "explicit tolerance": "tests/kernel/test_explicit.py::test_error_is_in_proportion_to_the_tolerance",
    "implicit motion": "tests/kernel/test_implicit.py::test_motion_is_that_of_another_integrator_on_the_dense_equation",
    "implicit order": "tests/kernel/test_implicit.py::test_fixed_steps_converge_with_order_five",
    "implicit tolerance": "tests/kernel/test_implicit.py::test_error_is_in_proportion_to_the_tolerance",
    "stiff tolerance": "tests/kernel/test_implicit.py::test_a_stiff_cable_stays_within_the_tolerance",
    "linear solution": "tests/kernel/test_linear.py::test_solutions_are_those_of_the_dense_matrix",
    "linear change": "tests/kernel/test_directional.py::test_changes_of_one_force",
}
"""Short name -> test function, with all its parameters."""

_PUSH = "joint[i] = stiffness[i] * (angle[i] - angle[i - 1])"

DEFECTS = {
    "wrong drag sign": Defect(
        "the water pushes a link the way it goes",
        (Change("water.c", "const double drag = -factor[i]", "const double drag = factor[i]"),),
        ("accelerations", "energy and power", "linear solution"),
        "links-1",
    ),
    "dropped Coriolis term": Defect(
        "links turn without the centripetal acceleration of the nodes above, all that Coriolis' terms are in these "
        "coordinates",
        (Change("motion.c", "inward = swing * rate[i];", "inward = 0.0 * swing;"),),
        ("accelerations", "energy and power", "undamped energy", "explicit motion", "implicit motion"),
        "shipped-free-12-air",
    ),
    "dropped Coriolis term of one link": Defect(
        "the centre of a link is without its own",
        (Change("chain.c", "const double inward = 0.5 * length[i]", "const double inward = 0.0 * length[i]"),),
        ("accelerations", "energy and power", "undamped energy", "explicit motion", "implicit motion"),
    ),
    "loosened error norm, explicit": Defect(
        "a hundred times the tolerance is accepted",
        (Change("explicit.c", "/ tolerance;", "/ (100.0 * tolerance);"),),
        ("undamped energy", "explicit motion", "explicit tolerance"),
        "load-1e-6",
    ),
    "loosened error norm, implicit": Defect(
        "a hundred times the tolerance is accepted",
        (
            Change(
                "implicit.c", "vectors->trial) / memory->tolerance;", "vectors->trial) / (100.0 * memory->tolerance);"
            ),
        ),
        ("implicit motion", "implicit tolerance", "stiff tolerance"),
    ),
    "stale Jacobian": Defect(
        "implicit steps go on with the linearised chain of the first one",
        (
            Change(
                "solver.c",
                "    if (memory->is_implicit) linear_point(",
                "    if (memory->is_implicit && memory->counter[SOLVER_steps] == 0.0) linear_point(",
            ),
        ),
        ("implicit order", "implicit tolerance"),
        "mooring-k-1e10",
    ),
    "damping missing in the Jacobian": Defect(
        "implicit steps know nothing of the joints' dampers",
        (Change("linear.c", "+ w.v * damping[i];", "+ 0.0 * damping[i];"),),
        ("implicit order", "linear solution"),
    ),
    "damping missing in the right-hand side": Defect(
        "joints with springs and dampers go without the dampers, but for the first",
        (Change("joints.c", f"{_PUSH} + damping[i] * (rate[i] - rate[i - 1]);", f"{_PUSH};"),),
        ("accelerations", "energy and power", "explicit motion", "implicit motion"),
        "shipped-free-12-air",
    ),
    "damping of the floater missing": Defect(
        "floater 1 heaves undamped",
        (Change("top.c", " - p[P_c_m1] * v[0];", ";"),),
        ("accelerations", "energy and power", "explicit motion", "implicit motion"),
    ),
}
