"""`cablefmu view`: results become a page that moves, or a movie."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .reading import open_result
from .view import check_view, write_view

__all__ = ["view"]


def view(
    result: Annotated[
        Path, Parameter(help="What `cablefmu run SCENE --record nodes tensions` wrote, FILE.csv or FILE.nc.")
    ],
    other: Annotated[Path | None, Parameter(help="A second one, in the same picture.")] = None,
    /,
    *,
    output: Annotated[
        Path | None,
        Parameter(
            name=["--output", "-o"],
            help="FILE.html, a page for any browser, ./build/NAME.view.html by default; a movie: FILE.gif or FILE.mp4.",
        ),
    ] = None,
    speed: Annotated[float, Parameter(help="Of a movie: seconds of the run in one second.")] = 1.0,
) -> None:
    """Show the cable move: one HTML page to play, scrub and zoom, which needs no network; or a movie."""
    paths = [result] if other is None else [result, other]
    target = output or Path("build") / f"{'-'.join(path.stem for path in paths)}.view.html"
    check_view(target)
    results = {name: open_result(path) for name, path in zip(_names(paths), paths, strict=True)}
    write_view(results, target, speed=speed)
    print(f"{target}, {target.stat().st_size / 1e6:.2f} MB")


def _names(paths: list[Path]) -> list[str]:
    """Stems; where two are alike paths, numbered if they are the same."""
    stems, whole = [path.stem for path in paths], [str(path) for path in paths]
    for names in (stems, whole):
        if len(set(names)) == len(names):
            return names
    return [f"{name} ({k})" for k, name in enumerate(whole, start=1)]
