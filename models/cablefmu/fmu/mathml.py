"""Formulas as MathML, which browsers draw without scripts, from a few words of TeX.

Letters, digits, operators, ``_`` and ``^``, braces, and the commands of `_COMMANDS` and `_SIGNS`. Braces group;
blanks mean nothing.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from html import escape

__all__ = ["mathml"]

_TOKEN = re.compile(r"\\[A-Za-z]+|\d+(?:\.\d+)?|\S")
_SIGNS = {"\\cdot": "·", "\\sum": "∑", "\\dots": "…", "\\pi": "π"}
_FUNCTIONS = ("\\sin", "\\cos", "\\max")


def mathml(tex: str, *, block: bool = False) -> str:
    """The <math> element of a formula.

    Parameters
    ----------
    tex
        The formula, for example ``\\frac{1}{2} k_{m1} y_{m1}^2``.
    block
        Whether it stands on a line of its own.

    Raises
    ------
    ValueError
        If a command is unknown or a brace has no partner.
    """
    tokens = _Tokens(_TOKEN.findall(tex))
    content = "".join(_row(tokens))
    if tokens.next is not None:
        raise ValueError(f"{tex!r}: a brace too many")
    return f"<math{' display=' + chr(34) + 'block' + chr(34) if block else ''}>{content}</math>"


class _Tokens:
    """What is left to read."""

    def __init__(self, tokens: list[str]) -> None:
        self._tokens = tokens
        self._place = 0

    @property
    def next(self) -> str | None:
        return self._tokens[self._place] if self._place < len(self._tokens) else None

    def take(self) -> str:
        if self.next is None:
            raise ValueError("a formula ends too early")
        self._place += 1
        return self._tokens[self._place - 1]


def _row(tokens: _Tokens) -> Iterator[str]:
    """Items up to a closing brace or the end."""
    while tokens.next not in (None, "}"):
        yield _item(tokens)


def _item(tokens: _Tokens) -> str:
    """One atom with what stands below and above it."""
    is_sum, is_function = tokens.next == "\\sum", tokens.next in _FUNCTIONS
    base = _atom(tokens)
    scripts: dict[str, str] = {}
    while tokens.next in ("_", "^"):
        place = tokens.take()
        scripts[place] = _atom(tokens)
    gap = '<mspace width="0.17em"></mspace>' if is_function else ""
    if not scripts:
        return base + gap
    below, above = ("under", "over") if is_sum else ("sub", "sup")
    name = "m" + (below if "_" in scripts else "") + (above if "^" in scripts else "")
    return f"<{name}>{base}{scripts.get('_', '')}{scripts.get('^', '')}</{name}>{gap}"


def _atom(tokens: _Tokens) -> str:
    token = tokens.take()
    if token == "{":
        content = "".join(_row(tokens))
        if tokens.next != "}":
            raise ValueError("a brace is not closed")
        tokens.take()
        return f"<mrow>{content}</mrow>"
    if token in _COMMANDS:
        return _COMMANDS[token](tokens)
    if token in _FUNCTIONS:
        return f"<mi>{token[1:]}</mi>"
    if token in _SIGNS:
        return f"<mo>{_SIGNS[token]}</mo>"
    if token.startswith("\\"):
        raise ValueError(f"{token}: an unknown command")
    if token[0].isdigit():
        return f"<mn>{token}</mn>"
    if token.isalpha():
        return f"<mi>{token}</mi>"
    if token == "|":  # a bracket, whichever side
        return '<mo stretchy="false" lspace="0" rspace="0">|</mo>'
    upright = ' stretchy="false"' if token in "()[]" else ""
    return f"<mo{upright}>{escape('−' if token == '-' else token)}</mo>"


def _word(tokens: _Tokens) -> str:
    """The letters of a group as they stand: names of variables have more than one."""
    if tokens.take() != "{":
        raise ValueError("a name in braces is expected")
    letters = []
    while tokens.next != "}":
        letters.append(tokens.take())
    tokens.take()
    return escape("".join(letters))


def _fraction(tokens: _Tokens) -> str:
    return f"<mfrac>{_atom(tokens)}{_atom(tokens)}</mfrac>"


def _above(sign: str) -> Callable[[_Tokens], str]:
    # Not as an accent: with a font that has no table for formulas, browsers put those into the letter.
    return lambda tokens: f'<mover>{_atom(tokens)}<mo stretchy="false">{sign}</mo></mover>'


_COMMANDS: dict[str, Callable[[_Tokens], str]] = {
    "\\frac": _fraction,
    "\\dot": _above("."),
    "\\ddot": _above(".."),
    "\\vec": lambda tokens: f'<mi class="vector">{_word(tokens)}</mi>',
    "\\name": lambda tokens: f"<mi>{_word(tokens)}</mi>",
}
