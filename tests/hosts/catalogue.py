"""Which hosts take the cable's FMUs, in which ways, how exact each way is, and where a host's own limits are."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["HOSTS", "SCENES", "WAYS", "Way", "ways_of"]

SCENES = ("free-12-water", "load-diagonal-80", "heave-60-water")
"""No force; two constant ones, which are `start` values in the FMU; one that varies, which the host must feed."""

HOSTS = {
    "fmpy_host": "[FMPy](https://github.com/CATIA-Systems/FMPy)",
    "libcosim_host": "[libcosim](https://github.com/open-simulation-platform/libcosim) (`libcosimpy`)",
    "ecos_host": "[Ecos](https://github.com/Ecos-platform/ecos) (`ecospy`)",
    "pathsim_host": "[PathSim](https://github.com/pathsim/pathsim) (`pathsim-fmi`)",
    "casadi_host": "[casadi](https://github.com/casadi/casadi)",
    "toolbox_host": "[fmu-manipulation-toolbox](https://github.com/grouperenault/fmu_manipulation_toolbox)",
}
"""Script in inside/ -> what tables call the host."""

CO_SIMULATION = 1e-5
"""[m] The FMU's solver at its default tolerance, 1e-6, ends a scene within 3e-6 m; a force that is held over 2 ms at
its value in the middle adds some 5e-7 of the motion that it causes."""
ADAPTIVE = 1e-5
"""[m] Adaptive solvers of hosts at a tolerance of 1e-8."""
EULER = 1e-2
"""[m] Euler's method at 1 ms is of first order: 1 to 9 mm here, a tenth of it at 0.1 ms."""
HELD = 5e-3
"""[m] FMPy's CVode does not renew inputs where there are no event indicators, but at output times, 10 ms apart."""
JACOBIAN = 1e-10
"""Of the largest entry, as through any other host: both sides are exact but for rounding."""

SMOOTH, COARSE, FINE, SHORT = 0.1, 1e-2, 2e-3, 1e-3
"""[s] Steps: for forces that do not change; for FMPy's CVode; for forces that are held; for Euler's method."""


@dataclass(frozen=True)
class Way:
    """One host, one version of FMI, one interface. Pairs are for scenes of constant forces, and of varying ones."""

    host: str
    fmi: int
    interface: str
    """As tables say it."""
    ask: dict[str, str]
    """What the script is asked for beside the scene."""
    step: tuple[float, float] = (SMOOTH, FINE)
    """[s]"""
    allowed: tuple[float, float] = (CO_SIMULATION, CO_SIMULATION)
    """[m]; of the largest entry where a Jacobian is asked for."""
    refusal: str = ""
    """What the host says that takes no such FMU."""
    because: str = ""
    """Of a refusal, or of a second tolerance: the host's reason and its issue."""


_CS, _ME = {"interface": "cs"}, {"interface": "me"}
_LIBCOSIM_3 = "no FMI 3 yet ([libcosim 741](https://github.com/open-simulation-platform/libcosim/issues/741))"
_CASADI_3 = (
    "asks for `dependencies` even where everything depends on everything and FMI needs none (closed: "
    "[casadi 3942](https://github.com/casadi/casadi/issues/3942))"
)
_BOTH = (2, 3)

WAYS = (
    *(Way("fmpy_host", fmi, "CS", _CS) for fmi in _BOTH),
    *(
        Way(
            "fmpy_host", fmi, "ME, CVode", _ME | {"solver": "CVode"}, (SMOOTH, COARSE), (ADAPTIVE, HELD),
            because="it reads forces at output times only",
        )
        for fmi in _BOTH
    ),
    *(Way("fmpy_host", fmi, "ME, Euler", _ME | {"solver": "Euler"}, (SHORT, SHORT), (EULER, EULER)) for fmi in _BOTH),
    Way("libcosim_host", 2, "CS", _CS),
    Way("libcosim_host", 3, "CS", _CS, refusal="Unsupported FMI version", because=_LIBCOSIM_3),
    *(Way("ecos_host", fmi, "CS", _CS) for fmi in _BOTH),
    *(Way("pathsim_host", fmi, "CS", _CS) for fmi in _BOTH),
    *(Way("pathsim_host", fmi, "ME, RKDP54", _ME, (SMOOTH, SMOOTH), (ADAPTIVE, ADAPTIVE)) for fmi in _BOTH),
    Way("casadi_host", 2, "ME, CVODES", _ME, (SMOOTH, SMOOTH), (ADAPTIVE, ADAPTIVE)),
    Way("casadi_host", 2, "ME, Jacobian", _ME | {"compare": "jacobian"}, (SMOOTH, SMOOTH), (JACOBIAN, JACOBIAN)),
    Way("casadi_host", 3, "ME", _ME, refusal="Default 'dependencies' not implemented", because=_CASADI_3),
    *(Way("toolbox_host", fmi, "container, CS", _CS) for fmi in _BOTH),
    *(Way("toolbox_host", fmi, "checker", {"interface": "check"}) for fmi in _BOTH),
)  # fmt: skip


def ways_of(host: str) -> list[Way]:
    """The ways of one host, in the order of the table."""
    return [way for way in WAYS if way.host == host]
