"""The C kernel as a shared library of its own, and the one table that binds it.

It is compiled from the same sources by the same recipe as the FMU's binary, with its names visible, with the API for
Python (`fmu_src/kernel_api`) and with `probe.c` on top of that: flat functions, so that no layout of a C structure is
repeated here.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import platform
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numpy as np

from cablefmu.cable import Cable, Drag, Floats, SolverChoice, Terminal, Top
from cablefmu.fmu.table import table

__all__ = [
    "BINDINGS",
    "PROBE",
    "ROOT",
    "Kernel",
    "Run",
    "Solved",
    "Status",
    "Wave",
    "compile_kernel",
    "inputs_of",
    "load",
    "probe_sources",
    "toolchain",
]

ROOT = Path(os.environ.get("CABLEFMU_SOURCES", Path(__file__).parents[2]))
"""Above fmu_src; the tests of the tests point it at a copy with a planted defect [tests/mutations]."""
PROBE = ROOT / "tests" / "kernel" / "probe.c"
TABLES = ROOT / "tests" / "kernel" / "other_rosenbrock_tables.c"

_POINTER, _INT, _DOUBLE, _SIZE = ctypes.c_void_p, ctypes.c_int, ctypes.c_double, ctypes.c_size_t
_ARRAY = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")

BINDINGS: dict[str, tuple[Any, ...]] = {
    "probe_new": (_POINTER, _INT, _INT, _INT, _INT, ctypes.c_uint64, _ARRAY, _ARRAY, _ARRAY),
    "probe_free": (None, _POINTER),
    "probe_constants": (_SIZE, _POINTER, _POINTER),
    "probe_spoil_scratch": (None, _POINTER),
    "probe_spoil_solver": (None, _POINTER),
    "probe_derivatives": (None, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "probe_repeat": (None, _POINTER, _ARRAY, _ARRAY, _ARRAY, _INT),
    "probe_repeat_core": (None, _POINTER, _ARRAY, _ARRAY, _ARRAY, _INT),
    "probe_outputs": (None, _POINTER, _ARRAY, _ARRAY, _POINTER, _ARRAY),
    "probe_directional": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    "probe_adjoint": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    "probe_linear": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    "probe_repeat_linear": (None, _POINTER, _INT, _ARRAY, _ARRAY, _ARRAY, _INT),
    "probe_kernel": (_POINTER, _POINTER),
    "kernel_equilibrium": (_INT, _POINTER, _ARRAY, _ARRAY, _ARRAY),
    "probe_restart": (None, _POINTER, _DOUBLE, _INT),
    "probe_forget": (None, _POINTER),
    "probe_energy": (None, _POINTER, _ARRAY),
    "probe_implicit_steps": (_DOUBLE, _POINTER, _DOUBLE, _DOUBLE, _INT, _INT, _DOUBLE, _ARRAY, _ARRAY, _ARRAY),
    "probe_advance": (_INT, _POINTER, ctypes.POINTER(_DOUBLE), _DOUBLE, _ARRAY, _ARRAY, _ARRAY),
    "probe_tableau": (_INT, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
    "probe_rosenbrock_size": (ctypes.c_char_p, _INT, _ARRAY),
    "probe_rosenbrock": (_DOUBLE, _INT, _ARRAY, _ARRAY, _ARRAY),
    "probe_name": (ctypes.c_char_p, _INT, _INT),
    "sincos_array_portable": (None, _INT, _ARRAY, _ARRAY, _ARRAY),
    "probe_sincos_avx2": (_INT, _INT, _ARRAY, _ARRAY, _ARRAY),
    "probe_sincos_worst": (_DOUBLE, _INT, _DOUBLE, ctypes.c_uint64),
    "probe_use_avx2": (_INT, _POINTER, _INT),
    "fifth_root": (_DOUBLE, _DOUBLE),
    "catenary": (_INT, _INT, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY),
}
"""Function -> (type of the result, types of the arguments)."""

Wave = tuple[float, float, float] | tuple[float, float, float, float]
"""(constant, amplitude, pulsation [rad/s], phase [rad]) of an input constant + amplitude sin(pulsation t + phase)."""

Status = Literal["ok", "too many steps", "step too small", "angle too large", "input failed"]
_STATUS: tuple[Status, ...] = ("ok", "too many steps", "step too small", "angle too large", "input failed")


def toolchain(root: Path = ROOT) -> ModuleType:
    """The recipe `fmu_src/toolchain.py` for the sources beside it; it belongs to no package."""
    path = root / "fmu_src" / "toolchain.py"
    spec = importlib.util.spec_from_file_location("toolchain", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def probe_sources() -> list[Path]:
    """What the library is compiled from."""
    recipe = toolchain()
    return [*recipe.kernel_sources(), *recipe.kernel_api_sources(), PROBE, TABLES]


def compile_kernel(folder: Path, *, flags: list[str] | None = None, extra: list[Path] | None = None) -> Path:
    """Compile kernel and probe into `folder`.

    Parameters
    ----------
    folder
        One per process: two compilers must not write one file.
    flags
        In place of the release's own (less hidden names).
    extra
        C files to link in besides.
    """
    recipe = toolchain()
    chosen = [flag for flag in recipe.RELEASE if flag != "-fvisibility=hidden"] if flags is None else flags
    target, _ = recipe.TARGETS.get(f"{platform.machine()}-{sys.platform}", (None, None))
    path = folder / "kernel.so"
    recipe.compile_library(path, [*probe_sources(), *(extra or [])], chosen, target=target)
    return path


def load(path: Path) -> ctypes.CDLL:
    """The library with every function of `BINDINGS` typed."""
    library = ctypes.CDLL(str(path))
    for name, (result, *arguments) in BINDINGS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


@dataclass(frozen=True)
class Run:
    """What one run of the solver left."""

    status: Status
    time: float
    """Where it ended [s]"""
    q: Floats
    v: Floats
    counters: dict[str, float]
    """steps, rejected, rhs, ... without "solver." in front"""


@dataclass(frozen=True)
class Solved:
    """A solution with the linearised chain, and a product with it that uses no factors."""

    negative: int
    """How many pivots are negative"""
    change: Floats
    """shape (n + 1,)"""
    back: Floats
    """L change but for the force through a held end, shape (n + 1,) [N, N m]"""
    end: Floats
    """The relation at a held end likewise, shape (2,) [m/s^2]"""
    through: Floats
    """The force through a held end, shape (2,) [N]; zeros at others"""


class Kernel:
    """One cable in the C kernel, with the methods of `cablefmu.reference.Reference` and a solver."""

    def __init__(self, library: ctypes.CDLL, cable: Cable) -> None:
        rows, links = table(), cable.links
        self.cable = cable
        self.parameters = np.array([cable.parameters.get(name, 0.0) for name in rows.parameters])
        # the order of LinkColumn in model.h
        self.links = np.array([
            links.length, links.mass, links.inertia, links.volume,
            links.joint_stiffness, links.joint_damping, links.drag_area, links.drag,
        ])  # fmt: skip
        self._library = library
        self._handle = library.probe_new(
            cable.n,
            list(Top).index(cable.top),
            list(Terminal).index(cable.terminal),
            list(Drag).index(cable.drag),
            sum(1 << rows.parameters[name].slot for name in cable.parameters),
            self.parameters,
            np.array(cable.rest_position, dtype=float),
            self.links,
        )
        assert self._handle

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            self._library.probe_free(self._handle)

    def use_avx2(self, wanted: bool) -> bool:
        """Choose the compiled variant; whether the one for AVX2 is in use afterwards."""
        return bool(self._library.probe_use_avx2(self._handle, wanted))

    def padded(self, vector: Floats) -> Floats:
        """As the kernel has it: with a zero for the heave where the top's motion is given."""
        return np.ascontiguousarray(self.cable.padded(vector))

    def derivatives(self, x: Floats, u: Floats) -> Floats:
        """(q', v') of x = (q, v) for u as `inputs_of` makes it."""
        x = self.padded(x)
        derivative = np.full_like(x, np.nan)
        self._library.probe_derivatives(self._handle, x, u, derivative)
        return self.cable.unpadded(derivative)

    def repeat(self, x: Floats, u: Floats, times: int) -> None:
        """That many evaluations in a row, to be timed; moves `x` a little."""
        self._library.probe_repeat(self._handle, x, u, np.empty_like(x), times)

    def repeat_core(self, x: Floats, u: Floats, times: int) -> None:
        """The same of sine, cosine and elimination alone."""
        self._library.probe_repeat_core(self._handle, x, u, np.empty_like(x), times)

    def acceleration(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> Floats:
        """x'', as long as q [m/s^2, rad/s^2]."""
        return self.derivatives(np.concatenate([q, v]), inputs_of(inputs))[self.cable.coordinates :]

    def outputs(self, q: Floats, v: Floats, inputs: Mapping[str, float]) -> dict[str, float]:
        """Every output by name."""
        x = np.concatenate([q, v])
        derivative = self.padded(self.derivatives(x, inputs_of(inputs)))
        return self._outputs(x, inputs_of(inputs), derivative.ctypes.data)

    def outputs_without_tensions(
        self, q: Floats, v: Floats, inputs: Mapping[str, float] | None = None
    ) -> dict[str, float]:
        """The outputs that need no accelerations; NaN for the others."""
        self.spoil_scratch()
        return self._outputs(np.concatenate([q, v]), inputs_of(inputs or {}), None)

    def directional(self, x: Floats, u: Floats, dx: Floats, du: Floats) -> tuple[Floats, dict[str, float]] | None:
        """Change of the derivatives, as long as x, and of every output, with (dx, du); None where singular."""
        x, dx = self.padded(x), self.padded(dx)
        derivative, change, output = np.empty_like(x), np.empty_like(x), np.full(len(table().outputs), np.nan)
        if not self._library.probe_directional(self._handle, x, u, dx, du, derivative, change, output):
            return None
        return self.cable.unpadded(change), self._named(output)

    def adjoint(
        self, x: Floats, u: Floats, seed: Floats, output_seed: Mapping[str, float]
    ) -> tuple[Floats, dict[str, float]] | None:
        """What a weighted sum of derivatives and outputs changes by with every state and every input."""
        x, seed = self.padded(x), self.padded(seed)
        derivative, to_state, to_input = np.empty_like(x), np.full_like(x, np.nan), np.full(len(table().inputs), np.nan)
        seeds = np.array([output_seed.get(name, 0.0) for name in table().outputs])
        if not self._library.probe_adjoint(self._handle, x, u, seed, seeds, derivative, to_state, to_input):
            return None
        return self.cable.unpadded(to_state), dict(zip(table().inputs, to_input.tolist(), strict=True))

    def linear(self, x: Floats, u: Floats, weights: Floats, force: Floats, end: Floats) -> Solved | None:
        """Solve L change = force, the relation at a held end being off by `end`; None where there are no factors."""
        x, force = self.padded(x), self.padded(force)
        change, back, found, through = np.empty_like(force), np.empty_like(force), end.copy(), np.empty(2)
        negative = self._library.probe_linear(self._handle, x, u, weights, force, found, change, back, through)
        strip = self.cable.unpadded
        return Solved(negative, strip(change), strip(back), found, through) if negative >= 0 else None

    def repeat_linear(self, what: int, weights: Floats, force: Floats, times: int) -> None:
        """That many factorisations (1), solutions (2) or products (3) about the last point, to be timed."""
        self._library.probe_repeat_linear(self._handle, what, weights, force, np.empty_like(force), times)

    def equilibrium(self, q: Floats, inputs: Mapping[str, float]) -> tuple[int, Floats, float, int]:
        """Status, q of the equilibrium near `q`, residual acceleration and iterations of the search."""
        found, figure = self.padded(q).copy(), np.zeros(2)
        kernel = self._library.probe_kernel(self._handle)
        status = self._library.kernel_equilibrium(kernel, inputs_of(inputs), found, figure)
        return status, self.cable.unpadded(found), figure[0], int(figure[1])

    def constants(self) -> Floats:
        """A copy of the model's parameters and derived arrays."""
        copy = np.empty(self._library.probe_constants(self._handle, None))
        self._library.probe_constants(self._handle, copy.ctypes.data)
        return copy

    def spoil_scratch(self) -> None:
        """Fill the scratch arrays with NaN."""
        self._library.probe_spoil_scratch(self._handle)

    def spoil_solver(self) -> None:
        """Fill the solver's vectors and the factors with NaN; to be followed by a start."""
        self._library.probe_spoil_solver(self._handle)

    def start(
        self, time: float, q: Floats, v: Floats, *, tolerance: float, solver: SolverChoice = SolverChoice.EXPLICIT
    ) -> None:
        """Set the solver to a state at a time [s], with nothing remembered."""
        self._time, self._x = ctypes.c_double(time), self.padded(np.concatenate([q, v]))
        self._library.probe_restart(self._handle, tolerance, list(SolverChoice).index(solver))

    def forget(self, time: float, q: Floats, v: Floats) -> None:
        """Another state at a time [s], for a solver that goes on with its settings and counters and nothing else."""
        self._time, self._x = ctypes.c_double(time), self.padded(np.concatenate([q, v]))
        self._library.probe_forget(self._handle)

    def advance(self, end: float, waves: Mapping[str, Wave]) -> Run:
        """One communication step, to the time `end` [s]."""
        signals, counter = _signals(waves), np.zeros(len(table().solver))
        time, x = self._time, self._x
        status = self._library.probe_advance(self._handle, ctypes.byref(time), end, x, signals, counter)
        names = (name.removeprefix("solver.") for name in table().solver)
        own, half = self.cable.unpadded(x), self.cable.coordinates
        counters = dict(zip(names, counter.tolist(), strict=True))
        return Run(_STATUS[status], time.value, own[:half].copy(), own[half:].copy(), counters)

    def run(
        self,
        times: Floats,
        *,
        tolerance: float,
        waves: Mapping[str, Wave] | None = None,
        solver: SolverChoice = SolverChoice.EXPLICIT,
    ) -> list[Run]:
        """From the cable's start at times[0] to each later time in turn; ends early on failure."""
        self.start(times[0], self.cable.position, self.cable.velocity, tolerance=tolerance, solver=solver)
        runs: list[Run] = []
        for end in times[1:]:
            runs.append(self.advance(end, waves or {}))
            if runs[-1].status != "ok":
                break
        return runs

    def energy_parts(self) -> tuple[float, float]:
        """Work of the inputs, and what drag and dampers took, since the start [J]."""
        parts = np.empty(2)
        self._library.probe_energy(self._handle, parts)
        return parts[0], parts[1]

    def implicit_steps(
        self, step: float, steps: int, waves: Mapping[str, Wave], *, share: float = 1.0, still: bool = False
    ) -> tuple[Floats, Floats, float]:
        """Fixed implicit steps of size `step` [s] from the cable's start at t = 0, none of them refused.

        Returns (q, v) at the end, (q, v) at that share of the last step by dense output, and the last step's
        error by its own estimate, over 1 + |x|. With `still`, inputs seem to rest where their slopes are measured.
        """
        x = np.concatenate([self.cable.position, self.cable.velocity])
        between = np.empty_like(x)
        error = self._library.probe_implicit_steps(
            self._handle, 0.0, step, steps, still, share, x, _signals(waves), between
        )
        return x, between, error

    def _outputs(self, x: Floats, u: Floats, derivative: int | None) -> dict[str, float]:
        output = np.full(len(table().outputs), np.nan)
        self._library.probe_outputs(self._handle, self.padded(x), u, derivative, output)
        return self._named(output)

    def _named(self, output: Floats) -> dict[str, float]:
        """Those that such a cable has."""
        every = zip(table().outputs, output.tolist(), strict=True)
        return {name: value for name, value in every if name not in self.cable.absent_outputs}


def _signals(waves: Mapping[str, Wave]) -> Floats:
    """Constants, amplitudes, pulsations and phases, a row each, in the slots of the inputs."""
    signals = np.zeros((4, len(table().inputs)))
    for name, wave in waves.items():
        signals[: len(wave), table().inputs[name].slot] = wave
    return signals


def inputs_of(inputs: Mapping[str, float]) -> Floats:
    """u as the kernel wants it: one slot for every input that any scene may have [N]."""
    return np.array([inputs.get(name, 0.0) for name in table().inputs])
