"""Formulas of a scene's page as numbers: just enough TeX to see whether both sides of an equation are equal."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np

__all__ = ["Lookup", "sides"]

Lookup = Callable[[str, int, str, int], Any]
"""(letter or name, dots above it, text of its index, number of the link) -> value."""

_TOKEN = re.compile(r"\\[A-Za-z]+|\d+|\S")


def sides(formula: str, lookup: Lookup, link: int, links: int) -> list[Any]:
    """What stands on each side of the equals sign, for one link.

    Vectors are arrays of two; a blank is a product, ``\\cdot`` between vectors their inner product.
    """
    return [_Reader(_TOKEN.findall(side), lookup, links).whole(link) for side in formula.split("=")]


class _Reader:
    """Recursive descent; every method leaves `place` behind what it has read."""

    def __init__(self, tokens: list[str], lookup: Lookup, links: int) -> None:
        self.tokens, self.lookup, self.links, self.place = tokens, lookup, links, 0
        self.in_bars = False

    @property
    def next(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self, expected: str = "") -> str:
        token = self.next
        assert token and token == (expected or token), f"{expected} in {self.tokens} at {self.place}"
        self.place += 1
        return token

    def whole(self, link: int) -> Any:
        value = self.sum(link)
        assert self.next == "", f"{self.tokens} from {self.place}"
        return value

    def sum(self, link: int) -> Any:
        total: Any = 0.0
        sign = 1.0
        if self.next in ("+", "-"):
            sign = -1.0 if self.take() == "-" else 1.0
        while True:
            total = total + sign * self.product(link)
            if self.next not in ("+", "-"):
                return total
            sign = -1.0 if self.take() == "-" else 1.0

    def product(self, link: int) -> Any:
        value = self.power(link)
        while self.next not in ("", "+", "-", ")", "}", ",") and not (self.next == "|" and self.in_bars):
            if self.next == "\\cdot":
                self.take()
                other = self.power(link)
                value = value @ other if np.ndim(value) and np.ndim(other) else value * other
            elif self.next == "/":
                self.take()
                value = value / self.power(link)
            else:
                value = value * self.power(link)
        return value

    def power(self, link: int) -> Any:
        value = self.factor(link)
        if self.next == "^":
            self.take()
            value = value ** int(self.take())
        return value

    def factor(self, link: int) -> Any:
        token = self.next
        if token.isdigit():
            return float(self.take())
        if token == "(":
            return self.brackets(link)
        if token == "|":
            self.take()
            self.in_bars = True
            value = self.sum(link)
            self.take("|")
            self.in_bars = False
            return np.sqrt(np.sum(np.square(value)))
        if token == "\\frac":
            self.take()
            return self.group(link) / self.group(link)
        if token in ("\\sin", "\\cos"):
            return (np.sin if self.take() == "\\sin" else np.cos)(self.factor(link))
        if token in ("\\sum", "\\max"):
            return self.over_links(np.sum if self.take() == "\\sum" else np.max)
        return self.symbol(link)

    def group(self, link: int) -> Any:
        self.take("{")
        value = self.sum(link)
        self.take("}")
        return value

    def brackets(self, link: int) -> Any:
        self.take("(")
        parts = [self.sum(link)]
        while self.next == ",":
            self.take()
            parts.append(self.sum(link))
        self.take(")")
        return parts[0] if len(parts) == 1 else np.array(parts)

    def over_links(self, gather: Callable[[Any], Any]) -> Any:
        self.take("_")
        self.take("i")
        start, values = self.place, []
        for link in range(1, self.links + 1):
            self.place = start
            values.append(self.product(link))
        return gather(values)

    def symbol(self, link: int) -> Any:
        dots, name = self.named()
        index = ""
        if self.next == "_":
            self.take()
            index = self.named()[1] if self.next == "\\name" else self.text()
        return self.lookup(name, dots, index, link)

    def named(self) -> tuple[int, str]:
        """Dots above, and the letter or the name."""
        token = self.take()
        if token in ("\\dot", "\\ddot"):
            self.take("{")
            _, name = self.named()
            self.take("}")
            return len(token) - 3, name
        return 0, self.text() if token in ("\\vec", "\\name") else token

    def text(self) -> str:
        """A group as it stands, or one token."""
        if self.next != "{":
            return self.take()
        self.take()
        start = self.place
        while self.next != "}":
            self.take()
        self.take()
        return "".join(self.tokens[start : self.place - 1])
