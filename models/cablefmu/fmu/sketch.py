"""A scene's start shape as a picture: inline SVG, coloured by the page's style sheet."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np

from ..cable import Cable, Floats, Terminal, Top

__all__ = ["sketch"]

_WIDTH, _HEIGHT = 340.0, 340.0
"""Room for the cable [px], within the margins."""
_MARGIN_X, _TOP, _BOTTOM = 66.0, 60.0, 74.0
_LEAST_APART = 0.5
"""Joints nearer than this [px] are one point of the line, so that 10,000 links make no long file."""
_MOST_JOINTS = 40
"""Cables of more links are drawn without their joints."""


def sketch(cable: Cable) -> str:
    """The <svg> element: floater, cable, end, axes and a scale.

    Parameters
    ----------
    cable
        The scene's numbers; drawn is `cable.position`.
    """
    joints = _joints(cable)
    lowest, highest = np.minimum(joints.min(axis=0), 0.0), np.maximum(joints.max(axis=0), 0.0)
    span = np.maximum(highest - lowest, 1e-9 * float(np.sum(cable.links.length)))
    scale = float(min(_WIDTH / span[0], _HEIGHT / span[1]))
    width = max(float(span[0]) * scale, 260.0) + 2.0 * _MARGIN_X
    height = float(span[1]) * scale + _TOP + _BOTTOM
    # The cable in the middle of what it needs.
    origin = np.array([(width - (lowest[0] + highest[0]) * scale) / 2.0, _TOP - lowest[1] * scale])
    pixels = origin + joints * scale
    top = "vessel 1" if cable.top is Top.MOTION else "floater 1"
    words = f"Start shape of the cable: {cable.n} links from {top} to {_NAMES[cable.terminal]}"
    parts = [
        f'<svg class="sketch" viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{escape(words)}">',
        *_level(cable, width, float(origin[1])),
        *_axes(origin),
        *_line(cable, pixels),
        *_floater(pixels[0], top),
        *_ends(cable, joints[-1], pixels[-1], width),
        *_scale_bar(scale, width, height),
        "</svg>",
    ]
    return "\n".join(parts)


_NAMES = {
    Terminal.LOAD: "the load",
    Terminal.ANCHOR_MASS: "the anchor",
    Terminal.ANCHOR_SPRING: "the anchor",
    Terminal.FLOATER: "floater 2",
    Terminal.PIN: "the pin",
    Terminal.MOTION: "vessel 2",
}


def _joints(cable: Cable) -> Floats:
    """P_0 ... P_n at the start [m], shape (n + 1, 2)."""
    angles = cable.angles_in(cable.position)
    along = cable.links.length[:, None] * np.column_stack([np.sin(angles), np.cos(angles)])
    top = np.array([cable.start_of_top])
    return np.concatenate([top, top + np.cumsum(along, axis=0)])


def _level(cable: Cable, width: float, y: float) -> Iterator[str]:
    """Where the top rests: y = 0."""
    yield f'<path class="{"water" if cable.in_water else "level"}" d="M0 {y:.1f}H{width:.0f}"/>'
    yield f'<text class="small" x="2" y="{y - 6:.1f}">y = 0</text>'


def _axes(origin: Floats) -> Iterator[str]:
    x, y = origin
    yield f'<path class="axis" d="M{x:.1f} {y:.1f}h52m-7 -4l7 4l-7 4M{x:.1f} {y:.1f}v52m-4 -7l4 7l4 -7"/>'
    yield f'<text class="small" x="{x + 56:.1f}" y="{y + 14:.1f}">x</text>'
    yield f'<text class="small" x="{x - 14:.1f}" y="{y + 54:.1f}">y</text>'


def _line(cable: Cable, pixels: Floats) -> Iterator[str]:
    kept = [pixels[0]]
    for point in pixels[1:-1]:
        if np.max(np.abs(point - kept[-1])) >= _LEAST_APART:
            kept.append(point)
    kept.append(pixels[-1])
    yield f'<polyline class="cable" points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in kept)}"/>'
    if cable.n <= _MOST_JOINTS:
        yield from (f'<circle class="joint" cx="{x:.1f}" cy="{y:.1f}" r="2"/>' for x, y in pixels[1:-1])


def _floater(place: Floats, name: str) -> Iterator[str]:
    x, y = place
    yield f'<rect class="body" x="{x - 22:.1f}" y="{y - 15:.1f}" width="44" height="19" rx="6"/>'
    yield f'<text x="{x:.1f}" y="{y - 22:.1f}" text-anchor="middle">{name}</text>'


def _ends(cable: Cable, metres: Floats, place: Floats, width: float) -> Iterator[str]:
    x, y = place
    # What is zero but for rounding is zero.
    across, down = np.where(np.abs(metres) < 1e-9 * np.sum(cable.links.length), 0.0, metres)
    position = f"({across:.4g}, {down:.4g}) m".replace("-", "−")
    if cable.terminal in (Terminal.FLOATER, Terminal.MOTION):
        yield from _floater(place, _NAMES[cable.terminal])
        yield _label(position, x, y - 40.0, width)
        return
    if cable.terminal is Terminal.LOAD:
        yield f'<circle class="body" cx="{x:.1f}" cy="{y:.1f}" r="8"/>'
    else:
        yield from _ground(cable.terminal, x, y)
    yield _label(f"{_NAMES[cable.terminal].removeprefix('the ')} {position}", x, y + 38.0, width)


def _label(text: str, x: float, y: float, width: float) -> str:
    """Below or above its place, but inside the picture."""
    half = 3.9 * len(text)
    return f'<text x="{min(max(x, half), width - half):.1f}" y="{y:.1f}" text-anchor="middle">{text}</text>'


def _ground(terminal: Terminal, x: float, y: float) -> Iterator[str]:
    """A support with hatching below the end; springs or a block or a pin on it."""
    if terminal is Terminal.PIN:
        yield f'<path class="body" d="M{x:.1f} {y:.1f}l-9 14h18z"/>'
        yield f'<circle class="joint" cx="{x:.1f}" cy="{y:.1f}" r="3"/>'
    elif terminal is Terminal.ANCHOR_MASS:
        yield f'<rect class="body" x="{x - 12:.1f}" y="{y:.1f}" width="24" height="14"/>'
    else:
        yield f'<circle class="body" cx="{x:.1f}" cy="{y:.1f}" r="5"/>'
        yield f'<path class="axis" d="M{x:.1f} {y + 5:.1f}l-4 2l8 2l-8 2l4 2v1"/>'
        yield f'<path class="axis" d="M{x + 5:.1f} {y:.1f}h2l2 -4l2 8l2 -8l2 8l2 -4h2m0 -7v14"/>'
    hatching = "".join(f"M{x + k:.1f} {y + 14:.1f}l-5 6" for k in range(-14, 19, 8))
    yield f'<path class="axis" d="M{x - 18:.1f} {y + 14:.1f}h36{hatching}"/>'


def _scale_bar(scale: float, width: float, height: float) -> Iterator[str]:
    """A round length of some 90 px."""
    wanted = 90.0 / scale
    power = 10.0 ** np.floor(np.log10(wanted))
    length = max(step * power for step in (1.0, 2.0, 5.0) if step * power <= wanted)
    left, y = 8.0, height - 12.0
    yield f'<path class="axis" d="M{left:.1f} {y - 4:.1f}v8m0 -4h{length * scale:.1f}m0 -4v8"/>'
    yield f'<text class="small" x="{left + length * scale + 6:.1f}" y="{y + 4:.1f}">{length:g} m</text>'
