"""`cablefmu gallery`: the dissertation's figures on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .files import check_writable
from .gallery import chosen, show
from .gallery_page import error_text, write_gallery
from .plot import need_matplotlib

__all__ = ["gallery"]


def gallery(
    *figures: Annotated[str, Parameter(help="Numbers of figures, 6.1 to 6.17; all by default.")],
    output: Annotated[Path, Parameter(name=["--output", "-o"], help="Folder for index.html, all that there is.")]
    = Path("build") / "gallery",
) -> None:  # fmt: skip
    """Compute figures 6.1 to 6.17 of the dissertation anew, with what one sees, run time and error, on one page."""
    wanted = chosen(figures)
    need_matplotlib()
    check_writable(output / "index.html")
    shown = []
    for one in show(wanted):
        run_time = float(one.result.attrs["run_time"])
        print(f"{one.exhibit.number}  {one.exhibit.scene}: {run_time:.3g} s, error {error_text(one.error)}", flush=True)
        shown.append(one)
    print(write_gallery(shown, output))
