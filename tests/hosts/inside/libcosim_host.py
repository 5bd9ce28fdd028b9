"""libcosim's fixed-step algorithm; forces through its override manipulator."""

from __future__ import annotations

from typing import Any

from exchange import Request, answer, held, steps
from libcosimpy._internal import get_last_error_message
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

NANOSECONDS = 1e9


def run(request: Request) -> dict[str, Any]:
    execution = CosimExecution.from_step_size(step_size=round(request["step"] * NANOSECONDS))
    slave = CosimLocalSlave(fmu_path=request["fmu"], instance_name="cable")
    if not slave.ptr():  # added all the same it would end the process
        raise RuntimeError(get_last_error_message())
    index = execution.add_local_slave(local_slave=slave)
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    execution.add_observer(observer=observer)
    execution.add_manipulator(manipulator=manipulator)
    reference = {variable.name.decode(): variable.reference for variable in execution.slave_variables(index)}
    for step in range(steps(request)):
        forces = held(request, step)
        if forces:
            manipulator.slave_real_values(index, [reference[name] for name in forces], list(forces.values()))
        if not execution.step():
            raise RuntimeError(get_last_error_message())
    values = observer.last_real_values(index, [reference[name] for name in request["outputs"]])
    time = execution.status().current_time / NANOSECONDS
    return {"time": time, "end": dict(zip(request["outputs"], values, strict=True))}


if __name__ == "__main__":
    answer("libcosimpy", run)
