"""Forward dynamics of the same chain in rigid-body libraries from PyPI; run by an interpreter that has them.

`PYTHON tests/benchmarks/peers.py N REPEATS SECONDS` prints one JSON line: per library its version, the seconds per
evaluation (with the positions set anew, so that nothing is remembered), the accelerations, to see that all solve the
same chain, heave [m/s^2] and absolute angles [rad/s^2], and a ladder of motions over SECONDS: its setting, CPU seconds
and where the load ends [m]. pinocchio and DART have no integrator with error control: scipy's DOP853 drives them.
Imports nothing of cablefmu but chain.py beside it.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from chain import Chain, chain

Result = dict[str, Any]


def relative(values: list[float]) -> list[float]:
    """Joint coordinates of absolute ones."""
    return [values[0], *(b - a for a, b in pairwise(values))]


def seconds(call: Callable[[], object], repeats: int) -> float:
    """Of one call, the best of seven rounds."""
    best = float("inf")
    for _ in range(7):
        begun = time.perf_counter()
        for _ in range(repeats):
            call()
        best = min(best, (time.perf_counter() - begun) / repeats)
    return best


def absolute(accelerations: list[float]) -> list[float]:
    """(heave, absolute angles) of (heave, joint angles)."""
    return [accelerations[0], *accumulate(accelerations[1:])]


def end_of_chain(c: Chain, q: Any) -> list[float]:
    """(x_c, y_c) of (heave, joint angles) [m]."""
    theta = np.cumsum(np.asarray(q)[1:])
    return [float(c.length * np.sin(theta).sum()), float(q[0] + c.length * np.cos(theta).sum())]


def by_dop853(c: Chain, q: Any, v: Any, seconds: float, acceleration: Callable[[Any, Any], Any]) -> list[Result]:
    """Motions at three tolerances."""
    from scipy.integrate import solve_ivp

    size, ladder = len(q), []
    for tolerance in (1e-4, 1e-6, 1e-8):
        begun = time.process_time()
        done = solve_ivp(
            lambda t, x: np.concatenate([x[size:], acceleration(x[:size], x[size:])]),
            (0.0, seconds), np.concatenate([q, v]), method="DOP853", rtol=tolerance, atol=tolerance,
        )  # fmt: skip
        spent = time.process_time() - begun
        ladder.append(
            {"setting": f"DOP853, {tolerance:g}", "seconds": spent, "end": end_of_chain(c, done.y[:size, -1])}
        )
    return ladder


def with_pinocchio(c: Chain, repeats: int, span: float) -> Result:
    """Articulated-body algorithm. With x right and y down, z points into the page and theta turns about -z."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([0.0, c.gravity, 0.0])
    joint = model.addJoint(0, pin.JointModelPY(), pin.SE3.Identity(), "heave")
    model.appendBodyToJoint(joint, pin.Inertia(c.floater, np.zeros(3), np.eye(3)), pin.SE3.Identity())
    place = pin.SE3.Identity()
    turn = pin.JointModelRevoluteUnaligned(np.array([0.0, 0.0, -1.0]))
    for i in range(c.n):
        joint = model.addJoint(joint, turn, place, f"joint{i}")
        body = pin.Inertia(c.mass, np.array([0.0, c.length / 2, 0.0]), c.inertia * np.eye(3))
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
        place = pin.SE3(np.eye(3), np.array([0.0, c.length, 0.0]))
    model.appendBodyToJoint(joint, pin.Inertia(c.load, np.zeros(3), np.zeros((3, 3))), place)
    data = model.createData()
    q, v = np.array([0.0, *relative(c.theta)]), np.array([0.0, *relative(c.omega)])
    tau = np.zeros(model.nv)
    found = pin.aba(model, data, q, v, tau).tolist()
    cost = seconds(lambda: pin.aba(model, data, q, v, tau), repeats)
    motions = by_dop853(c, q, v, span, lambda q, v: pin.aba(model, data, q, v, tau))
    return {"version": pin.__version__, "seconds": cost, "accelerations": absolute(found), "motions": motions}


def with_dart(c: Chain, repeats: int, span: float) -> Result:
    """Articulated-body algorithm of DART."""
    import dartpy as dart

    skeleton = dart.dynamics.Skeleton("cable")
    skeleton.setGravity([0.0, c.gravity, 0.0])
    heave = dart.dynamics.PrismaticJointProperties()
    heave.mAxis = [0.0, 1.0, 0.0]
    _, body = skeleton.createPrismaticJointAndBodyNodePair(None, heave)
    body.setInertia(dart.dynamics.Inertia(c.floater, [0, 0, 0], np.eye(3)))
    shift = 0.0
    for i in range(c.n):
        joint = dart.dynamics.RevoluteJointProperties()
        joint.mName = f"joint{i}"
        joint.mAxis = [0.0, 0.0, -1.0]
        joint.mT_ParentBodyToJoint.set_translation([0.0, shift, 0.0])
        shift = c.length
        _, body = skeleton.createRevoluteJointAndBodyNodePair(body, joint)
        mass, centre, inertia = c.mass, c.length / 2, c.inertia
        if i == c.n - 1:  # the load as part of the last link
            mass = c.mass + c.load
            centre = (c.mass * c.length / 2 + c.load * c.length) / mass
            inertia += c.mass * (centre - c.length / 2) ** 2 + c.load * (c.length - centre) ** 2
        body.setInertia(dart.dynamics.Inertia(mass, [0, centre, 0], inertia * np.eye(3)))
    q, v = np.array([0.0, *relative(c.theta)]), np.array([0.0, *relative(c.omega)])

    def evaluate() -> None:
        skeleton.setPositions(q)
        skeleton.setVelocities(v)
        skeleton.computeForwardDynamics()

    def acceleration(q: Any, v: Any) -> Any:
        skeleton.setPositions(q)
        skeleton.setVelocities(v)
        skeleton.computeForwardDynamics()
        return skeleton.getAccelerations()

    found, cost = acceleration(q, v).tolist(), seconds(evaluate, repeats)
    motions = by_dop853(c, q, v, span, acceleration)
    return {"version": dart.__version__, "seconds": cost, "accelerations": absolute(found), "motions": motions}


def with_mujoco(c: Chain, repeats: int, span: float) -> Result:
    """mj_forward with contacts off."""
    import mujoco

    def inertial(mass: float, centre: float, inertia: float) -> str:
        return f'<inertial pos="0 {centre!r} 0" mass="{mass!r}" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>'

    last = c.mass + c.load
    centre = (c.mass * c.length / 2 + c.load * c.length) / last
    turn = c.inertia + c.mass * (centre - c.length / 2) ** 2 + c.load * (c.length - centre) ** 2
    inner = ""
    for i in reversed(range(c.n)):
        own = inertial(last, centre, turn) if i == c.n - 1 else inertial(c.mass, c.length / 2, c.inertia)
        place = 0.0 if i == 0 else c.length
        inner = f'<body pos="0 {place!r} 0"><joint type="hinge" axis="0 0 -1"/>{own}{inner}</body>'
    text = f"""<mujoco><option gravity="0 {c.gravity!r} 0"><flag contact="disable"/></option>
    <worldbody><body><joint type="slide" axis="0 1 0"/>
    <inertial pos="0 0 0" mass="{c.floater!r}" diaginertia="1 1 1"/>{inner}</body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    q, v = [0.0, *relative(c.theta)], [0.0, *relative(c.omega)]
    data.qpos[:], data.qvel[:] = q, v
    mujoco.mj_forward(model, data)
    found = data.qacc.tolist()
    cost = seconds(lambda: mujoco.mj_forward(model, data), repeats)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    motions = []
    for step in (0.02, 0.01, 0.005, 0.0025):
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:], model.opt.timestep = q, v, step
        begun = time.process_time()
        mujoco.mj_step(model, data, round(span / step))
        spent = time.process_time() - begun
        motions.append({"setting": f"its RK4, {step} s", "seconds": spent, "end": end_of_chain(c, data.qpos)})
    return {"version": mujoco.__version__, "seconds": cost, "accelerations": absolute(found), "motions": motions}


def main() -> None:
    c, repeats, span = chain(int(sys.argv[1])), int(sys.argv[2]), float(sys.argv[3])
    libraries = {"DART": with_dart, "pinocchio": with_pinocchio, "MuJoCo": with_mujoco}
    print(json.dumps({name: measure(c, repeats, span) for name, measure in libraries.items()}))


if __name__ == "__main__":
    main()
