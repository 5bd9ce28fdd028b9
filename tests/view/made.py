"""Results made by formula, of any size, with all that a page shows of one."""

from __future__ import annotations

import numpy as np
import xarray as xr

from cablefmu.cable import Floats
from cablefmu.view import Motion, motion_of

__all__ = ["made_motion", "made_result"]

_SCENE = """
[top]
kind = "{top}"
[terminal]
kind = "{end}"
"""


def made_result(
    links: int = 5, times: int = 21, *, step: float = 0.1, length: float = 20.0, lag: float = 0.0, top: str = "floater",
    end: str = "load", water: bool = True, tensions: bool = True, **attributes: str,
) -> xr.Dataset:  # fmt: skip
    """A cable that sways under a floater that heaves; `lag` [rad] tells one such run from another."""
    time = step * np.arange(times)
    numbers = np.arange(1, links + 1)
    theta = 0.8 * np.cos(1.3 * time + lag)[:, None] * np.linspace(1.0, 1.6, links)
    heave = 0.7 * np.sin(2.1 * time + lag)
    x = _nodes(np.zeros(times), np.sin(theta) * length / links)
    y = _nodes(heave, np.cos(theta) * length / links)
    pull = 900.0 * (1.0 + np.linspace(1.0, 0.2, links)) + 500.0 * np.sin(2.1 * time)[:, None]
    result = xr.Dataset(
        {
            "y_m1": ("time", heave, {"units": "m", "long_name": "Floater 1: displacement, down"}),
            "x_c": ("time", x[:, -1], {"units": "m", "long_name": "Terminal: x, to the right"}),
            "y_c": ("time", y[:, -1], {"units": "m", "long_name": "Terminal: y, down"}),
            "tension_max": ("time", pull.max(axis=1), {"units": "N", "long_name": "Largest pull"}),
            "node_x": (("time", "node"), x, {"units": "m"}),
            "node_y": (("time", "node"), y, {"units": "m"}),
            **({"tension": (("time", "link"), pull, {"units": "N"})} if tensions else {}),
        },
        coords={"time": ("time", time, {"units": "s"}), "link": numbers, "node": np.arange(links + 1)},
    )
    scene = _SCENE.format(top=top, end=end) + ("[water]\n" if water else "")
    result.attrs = {"title": "made", "summary": "Made by formula", "scene": scene, "source": "cablefmu 0", **attributes}
    return result


def _nodes(first: Floats, links: Floats) -> Floats:
    return first[:, None] + np.hstack([np.zeros((len(first), 1)), np.cumsum(links, axis=1)])


def made_motion(name: str = "made", **settings: object) -> Motion:
    """The same, ready to be drawn; settings as of `made_result`."""
    return motion_of(made_result(**settings), name)  # type: ignore[arg-type]
