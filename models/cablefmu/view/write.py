"""Results into a file that shows them move; its name says whether it is a page or a movie."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from ..errors import OptionError
from .motion import motion_of
from .movie import MOVIES, check_movie, write_movie
from .page import check_page, write_page

__all__ = ["SUFFIXES", "check_view", "write_view"]

SUFFIXES = (".html", *MOVIES)


def check_view(path: Path) -> None:
    """Find out before long work whether such a file can be made.

    Raises
    ------
    OptionError
        If its name ends otherwise, what makes it is not installed, or the folder is not writable.
    """
    if path.suffix not in SUFFIXES:
        raise OptionError(
            f"output = {path}: a name that ends with {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]} is expected"
        )
    (check_movie if path.suffix in MOVIES else check_page)(path)


def write_view(results: Mapping[str, xr.Dataset], path: str | Path, *, speed: float = 1.0) -> Path:
    """Write a page or a movie of one result, or of two in one picture.

    Parameters
    ----------
    results
        By the names that they are shown under; from `simulate(..., record=["nodes", "tensions"])` or `open_result`.
    path
        FILE.html, FILE.gif or FILE.mp4.
    speed
        Of a movie: seconds of the run in one second.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OptionError
        If a result does not say where its nodes are, there are more than two, or the file cannot be made.
    """
    path = Path(path)
    check_view(path)
    motions = [motion_of(result, name) for name, result in results.items()]
    if path.suffix in MOVIES:
        write_movie(motions, path, speed)
    else:
        write_page(motions, path)
    return path
