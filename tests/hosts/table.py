"""The tables of docs/hosts.md and of the README, made of what hosts did."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, replace

from tests.hosts.catalogue import HOSTS, SCENES, Way
from tests.hosts.runs import Outcome

__all__ = ["FAILS", "Row", "page", "readme", "row_of", "rows_in", "short"]

FAILS = "FAILS: "
_HEAD = ("host", "version", "FMI", "interface")
_MARK, _END = "<!-- hosts: python -m tests.hosts --readme README.md -->", "<!-- hosts end -->"

_PAGE = f"""# Other people's hosts

The same FMU files, one for each version of FMI and scene, in importers that others wrote, each in a virtual
environment of its own with the versions of `tests/hosts/inside`. Every cell below was run by
`python -m tests.hosts --markdown docs/hosts.md`; `pytest -m hosts` runs them again, compares every end with the
dense model under DOP853, and says when a row here is no longer what the host does.

Three scenes whose load ends 14 to 60 m from where it starts: {SCENES[0]} has no force, {SCENES[1]} two constant
ones, which hosts find as `start` values, {SCENES[2]} one of 25 kN that varies, which hosts feed. The numbers are
how far terminal and floater end from the dense model [m]; of a Jacobian, from its complex step, over its largest
entry. How far they may, and why, is in `tests/hosts/catalogue.py`: Co-Simulation 1e-5 m, by the FMU's solver at its
default tolerance; hosts' adaptive solvers at 1e-8 likewise; Euler's method with 1 ms 1e-2 m, being of first order.
Hosts that hold a force over a communication step hold that of its middle, for 2 ms.

%s

What is the hosts' own:

* FMPy's CVode reads forces anew at output times only (its right-hand side does not; its root function
  does, which is not called where there are no event indicators); every 10 ms here. Euler's step is the output
  interval, a smaller `step_size` is without effect ([FMPy 111](https://github.com/CATIA-Systems/FMPy/issues/111)).
  `set_input_derivatives=True` ends in a ValueError, "Can only assign sequence of same size". No thread was found of
  the first and the last.
* libcosim takes FMI 1 and 2 ([libcosim 741](https://github.com/open-simulation-platform/libcosim/issues/741));
  `libcosimpy` then hands out a null pointer, and a host that adds it as a slave crashes.
* `ecospy` asks for libtbb and does not bring it ([Ecos 30](https://github.com/Ecos-platform/ecos/issues/30)):
  PyPI's `tbb` has it. It reads zeros where an instance could not be made.
* PathSim's block of Co-Simulation steps at time 0 as well: at time t its outputs are those of t and one step.
  Inputs that are not connected it sets to 0, so `start` values must be fed.
* casadi in FMI 3 asks for the attribute `dependencies`, which need not be there where an unknown depends on
  everything ([casadi 3942](https://github.com/casadi/casadi/issues/3942), closed, is of an attribute that is empty
  or missing). It takes the same cable's FMI 2 file.
* fmu-manipulation-toolbox: its container embeds Co-Simulation; Model Exchange is [its issue
  69](https://github.com/grouperenault/fmu_manipulation_toolbox/issues/69).
"""


@dataclass(frozen=True)
class Row:
    """One way of one host, as text."""

    host: str
    version: str
    fmi: str
    interface: str
    ends: tuple[str, ...]
    """One a scene."""
    result: str


def row_of(way: Way, outcomes: Sequence[Outcome]) -> Row:
    """What a host did, and whether that is what it should."""
    ends = tuple("–" if outcome.error is None else _number(outcome.error) for outcome in outcomes)
    return Row(HOSTS[way.host], outcomes[0].version, str(way.fmi), way.interface, ends, _result(way, outcomes))


def _result(way: Way, outcomes: Sequence[Outcome]) -> str:
    if way.refusal and all(way.refusal in outcome.said for outcome in outcomes):
        return f"refused: {way.because}"
    for outcome in outcomes:
        if outcome.said or way.refusal:
            return f"{FAILS}{outcome.scene}: {outcome.said or 'no longer refused'}"
        if outcome.error is not None and not outcome.error <= outcome.allowed:
            return f"{FAILS}{outcome.scene}: {_number(outcome.error)} instead of {_number(outcome.allowed)}"
    if all(outcome.error is None for outcome in outcomes):
        return "no complaint"
    constant, varying = map(_number, way.allowed)
    if way.ask.get("compare") == "jacobian":
        return f"equal to {constant} of its largest entry"
    return f"within {constant} m" + (f", {varying} m where a force varies: {way.because}" if way.because else "")


def _number(value: float) -> str:
    return re.sub(r"e-0(\d)", r"e-\1", f"{value:.0e}")


def _markdown(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    lines = [list(head)]
    lines += [["---"] * len(lines[0]), *map(list, rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def page(rows: Iterable[Row]) -> str:
    """docs/hosts.md."""
    head = (*_HEAD, *SCENES, "result")
    return _PAGE % _markdown(head, ((*astuple(row)[:4], *row.ends, row.result) for row in rows))


def rows_in(text: str) -> list[Row]:
    """The rows of a page that `page` made."""
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in text.splitlines() if line[:1] == "|"]
    return [Row(*line[:4], tuple(line[4:-1]), line[-1]) for line in cells[2:]]


def short(rows: Iterable[Row]) -> str:
    """The README's table: versions of FMI with the same result share a line."""
    found: list[Row] = []
    for row in rows:
        twin = next((k for k, seen in enumerate(found) if replace(seen, fmi=row.fmi, ends=row.ends) == row), None)
        if twin is None:
            found.append(row)
        else:
            found[twin] = replace(found[twin], fmi=f"{found[twin].fmi}, {row.fmi}")
    return _markdown((*_HEAD, "result"), ((*astuple(row)[:4], row.result) for row in found))


def readme(text: str, rows: Iterable[Row]) -> str:
    """A README whose table between the two marks is made anew.

    Raises
    ------
    ValueError
        If the marks are not there.
    """
    before, mark, rest = text.partition(_MARK)
    _, end, after = rest.partition(_END)
    if not mark or not end:
        raise ValueError(f"the README has no table between {_MARK} and {_END}")
    return f"{before}{mark}\n{short(rows)}\n{end}{after}"
