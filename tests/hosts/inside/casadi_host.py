"""casadi's importer: its CVODES on the FMU, and the Jacobian that it makes of the FMU's directional derivatives."""

from __future__ import annotations

from typing import Any

import casadi
import numpy as np
from exchange import Request, answer


def forces(request: Request, names: list[str], start: list[float], time: Any) -> Any:
    """The inputs as an expression of time: a spline through each table, else the start value."""

    def one(name: str, value: float) -> Any:
        table = request["forces"].get(name)
        return casadi.interpolant(name, "bspline", [table["times"]], table["values"])(time) if table else value

    return casadi.vertcat(*(one(name, value) for name, value in zip(names, start, strict=True)))


def run(request: Request) -> dict[str, Any]:
    model = casadi.DaeBuilder("cable", request["fmu"])
    function = model.create("f", ["t", "x", "u"], ["ode", "y"])
    time, x = casadi.MX.sym("t"), casadi.MX.sym("x", model.nx())
    u = forces(request, model.u(), model.start(model.u()), time)
    problem = {"t": time, "x": x, "ode": function(t=time, x=x, u=u)["ode"]}
    error = {"abstol": request["tolerance"], "reltol": request["tolerance"], "max_num_steps": 500_000}
    integrate = casadi.integrator("run", "cvodes", problem, 0.0, request["stop"], error)
    state = integrate(x0=model.start(model.x()))["xf"]
    inputs = casadi.Function("u", [time], [u])(request["stop"])
    outputs = np.array(function(t=request["stop"], x=state, u=inputs)["y"]).ravel()
    values = dict(zip(model.y(), outputs.tolist(), strict=True))
    said = {"time": request["stop"], "end": {name: values[name] for name in request["outputs"]}}
    if request.get("compare") == "jacobian":
        matrix = model.create("J", ["t", "x", "u"], ["jac_ode_x"])(t=request["stop"], x=state, u=inputs)["jac_ode_x"]
        said |= {"states": model.x(), "state": np.array(state).ravel().tolist()}
        said |= {"inputs": dict(zip(model.u(), np.array(inputs).ravel().tolist(), strict=True))}
        said |= {"jacobian": np.array(casadi.DM(matrix).full()).tolist()}
    return said


if __name__ == "__main__":
    answer("casadi", run)
