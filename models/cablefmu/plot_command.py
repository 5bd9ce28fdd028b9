"""`cablefmu plot`: a picture of results that were kept; and what a run does for its own picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import xarray as xr
from cyclopts import Parameter

from .errors import OptionError
from .plot import Kind, check_picture, write_plot
from .reading import open_result

__all__ = ["as_asked", "plot"]


def plot(
    result: Annotated[Path, Parameter(help="Results of `cablefmu run` or `cablefmu couple`, FILE.csv or FILE.nc.")],
    /,
    *,
    kind: Annotated[
        Kind,
        Parameter(
            help="frames: the cable at regular times (--record nodes); series: numbers over time; tension: the pull "
            "along the cable over time (--record tensions); envelope: extremes along the cable (--record nodes "
            "tensions); spectrum: power spectral densities."
        ),
    ] = "frames",
    names: Annotated[
        list[str] | None,
        Parameter(
            consume_multiple=True,
            negative=(),
            help="For series and spectrum: variables such as x_c, theta or theta[3]; all outputs by default.",
        ),
    ] = None,
    interval: Annotated[
        float | None, Parameter(help="For frames: time between two shapes [s]; the scene's by default.")
    ] = None,
    output: Annotated[
        Path | None,
        Parameter(
            name=["--output", "-o"], help="Picture, FILE.png, .svg or .pdf; RESULT.KIND.png beside it by default."
        ),
    ] = None,
) -> None:
    """Draw a picture of results that were kept."""
    if names == []:
        raise OptionError("names: at least one name is expected behind it")
    picture = output or result.parent / f"{result.stem}.{kind}.png"
    check_picture(picture)
    asked = [name.strip() for text in names or [] for name in text.split(",")]
    write_plot(open_result(result), picture, kind, names=asked, interval=interval)
    print(picture)


_HOLDS = {"nodes": ("node_x", "node_y"), "tensions": ("tension",)}


def as_asked(result: xr.Dataset, record: list[str]) -> xr.Dataset:
    """Without what only a picture needed."""
    beyond = [name for group, held in _HOLDS.items() if group not in record for name in held if name in result]
    result = result.drop_vars(beyond)
    return result.drop_dims(set(result.dims) - {"time"}.union(*(v.dims for v in result.data_vars.values())))
