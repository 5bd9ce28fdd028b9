"""A stiff cable in other people's implicit hosts, with and without our directional derivatives.

`python hosts_peer.py FMU STOP TOLERANCE` with an FMI 2 FMU, in an environment that has casadi, scikit-sundae and fmpy.
Prints JSON: host -> how its Jacobian is made -> steps, evaluations, failures, CPU seconds, where the terminal ends.
"""

from __future__ import annotations

import ctypes
import json
import sys
import tempfile
import time
import zipfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Model, FMU2Slave


class ModelExchange:
    """The FMU's right-hand side, and its Jacobian column by column, with as little Python as a Python host can have."""

    def __init__(self, folder: str, inputs: dict[str, float]) -> None:
        self.description = read_model_description(folder)
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        self.fmu = FMU2Model(
            guid=self.description.guid, unzipDirectory=folder, instanceName="a",
            modelIdentifier=self.description.modelExchange.modelIdentifier,
        )  # fmt: skip
        self.fmu.instantiate()
        self.fmu.setupExperiment(startTime=0.0)
        for name, value in inputs.items():
            self.fmu.setReal([self.reference[name]], [value])
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.fmu.newDiscreteStates()
        self.fmu.enterContinuousTimeMode()
        self.n = self.description.numberOfContinuousStates
        derivatives = [v for v in self.description.modelVariables if v.derivative is not None]
        self.unknowns = (ctypes.c_uint32 * self.n)(*(v.valueReference for v in derivatives))
        self.knowns = [(ctypes.c_uint32 * 1)(v.derivative.valueReference) for v in derivatives]
        self.one = (ctypes.c_double * 1)(1.0)
        self.evaluations = 0

    def start(self) -> Any:
        x = np.zeros(self.n)
        self.fmu.getContinuousStates(pointer(x), self.n)
        return x

    def set(self, x: Any) -> None:
        self.fmu.setContinuousStates(pointer(x), self.n)

    def derivatives(self, t: float, x: Any, out: Any) -> None:
        self.set(np.ascontiguousarray(x))
        values = np.empty(self.n)
        self.fmu.getDerivatives(pointer(values), self.n)
        out[:] = values
        self.evaluations += 1

    def jacobian(self, t: float, x: Any, slope: Any, out: Any) -> None:
        """Every column by fmi2GetDirectionalDerivative at one state."""
        self.set(np.ascontiguousarray(x))
        matrix = np.empty((self.n, self.n))
        component, ask = self.fmu.component, self.fmu.fmi2GetDirectionalDerivative
        for k, known in enumerate(self.knowns):
            ask(component, self.unknowns, self.n, known, 1, self.one, pointer(matrix[k]))
        out[:, :] = matrix.T

    def end(self, x: Any) -> list[float]:
        self.set(np.ascontiguousarray(x))
        return list(self.fmu.getReal([self.reference["x_c"], self.reference["y_c"]]))


def pointer(values: Any) -> Any:
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def cvode(folder: str, inputs: dict[str, float], stop: float, tolerance: float, *, exact: bool) -> dict[str, Any]:
    """scikit-sundae's CVODE, BDF, dense; its own differences or our columns."""
    from sksundae.cvode import CVODE

    model = ModelExchange(folder, inputs)
    jacobian = {"jacfn": model.jacobian} if exact else {}
    solver = CVODE(model.derivatives, rtol=tolerance, atol=tolerance, max_num_steps=500_000, **jacobian)
    begun = time.process_time()
    found = solver.solve(np.array([0.0, stop]), model.start())
    seconds = time.process_time() - begun
    end, jacobians = model.end(found.y[-1]), int(found.njev)
    newton = model.evaluations - (0 if exact else jacobians * model.n)
    return {"seconds": seconds, "newton": newton, "jacobians": jacobians, "x": end[0], "y": end[1]}


def without_flag(path: str) -> str:
    """The same FMU, which does not say that it has directional derivatives: what makes an importer difference."""
    copy = str(Path(tempfile.mkdtemp()) / "without.fmu")
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(copy, "w") as target:
        for entry in source.infolist():
            content = source.read(entry)
            if entry.filename == "modelDescription.xml":
                flag = b'providesDirectionalDerivative="%s"'
                content = content.replace(flag % b"true", flag % b"false")
            target.writestr(entry, content)
    return copy


def casadi_cvodes(path: str, inputs: dict[str, float], stop: float, tolerance: float, *, exact: bool) -> dict[str, Any]:
    """casadi's importer and its CVODES; the importer's differences or our directional derivatives."""
    import casadi

    model = casadi.DaeBuilder("cable", path if exact else without_flag(path))
    ode = model.create("ode", ["t", "x", "u"], ["ode"])
    x, u = casadi.MX.sym("x", ode.size1_in("x")), casadi.MX.sym("u", ode.size1_in("u"))
    t = casadi.MX.sym("t")
    problem = {"t": t, "x": x, "u": u, "ode": ode(t=t, x=x, u=u)["ode"]}
    options = {"abstol": tolerance, "reltol": tolerance, "max_num_steps": 500_000}
    integrate = casadi.integrator("run", "cvodes", problem, 0.0, stop, options)
    start = model.start(model.x())
    given = [inputs.get(name, 0.0) for name in model.u()]
    begun = time.process_time()
    found = integrate(x0=start, u=given)
    seconds = time.process_time() - begun
    stats = integrate.stats()
    state = np.array(found["xf"]).ravel()
    return {
        "seconds": seconds,
        "success": bool(np.all(np.isfinite(state))),
        "state": state.tolist(),
        "stats": {name: value for name, value in stats.items() if isinstance(value, int | float | bool)},
        "names": model.x(),
    }


def co_simulation(folder: str, inputs: dict[str, float], stop: float, tolerance: float) -> dict[str, Any]:
    """The FMU's own solver, one communication step."""
    description = read_model_description(folder)
    reference = {v.name: v.valueReference for v in description.modelVariables}
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, instanceName="b",
                    modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0, tolerance=tolerance)
    for name, value in inputs.items():
        fmu.setReal([reference[name]], [value])
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    begun = time.process_time()
    fmu.doStep(0.0, stop)
    seconds = time.process_time() - begun
    names = ("x_c", "y_c", "solver.steps", "solver.rejected", "solver.rhs", "solver.jacobians")
    x, y, steps, rejected, rhs, jacobians = fmu.getReal([reference[name] for name in names])
    return {"seconds": seconds, "x": x, "y": y, "steps": steps, "rejected": rejected, "evaluations": rhs,
            "jacobians": jacobians}  # fmt: skip


def main() -> None:
    path, stop, tolerance = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
    inputs = {"F_cx": 200.0}
    folder = extract(path, unzipdir=tempfile.mkdtemp())
    found: dict[str, Any] = {"versions": {name: version(name) for name in ("casadi", "scikit-sundae", "fmpy")}}
    found["reference"] = co_simulation(folder, inputs, stop, 1e-10)
    found["co-simulation"] = co_simulation(folder, inputs, stop, tolerance)
    for name, exact in (("differences", False), ("directional derivatives", True)):
        found[f"CVODE, {name}"] = cvode(folder, inputs, stop, tolerance, exact=exact)
        found[f"casadi, {name}"] = casadi_cvodes(path, inputs, stop, tolerance, exact=exact)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
