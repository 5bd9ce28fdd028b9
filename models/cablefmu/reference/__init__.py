"""The dissertation's generic algorithms 5.1 to 5.10 as dense matrices: what the FMU is checked against.

Written to be read beside the print, with its equation numbers and its errata; it shares no code with
the FMU's kernel, which never forms a matrix.

- `chain` the cable's numbers under the equations' names; `kinematics` where it is and how it moves
- `matrices` I, C, K [5.1, 5.2]; `vectors` F, G [5.3-5.7], D; `drag`, `terminal` what makes up T [5.8-5.10]
- `model` the equation of motion; `heavy_end` the same for ends of 8e8 kg and for those that are held: by a `pin`, by a
  given motion
- `outputs` tensions, energy and powers; `oracle` trajectories by scipy
- `long_double` the same with three more digits
- `extended` accelerations and outputs in any precision (to be imported by itself: it needs mpmath)
"""

from cablefmu.reference.model import Reference
from cablefmu.reference.oracle import Inputs, Trajectory, integrate

__all__ = ["Inputs", "Reference", "Trajectory", "integrate"]
