"""A report as tables of texts, for the terminal, the page and Markdown alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .report import Report
from .report_ladder import Row, held_step, order
from .report_refinement import SHARES

__all__ = ["Sheet", "links_enough", "overview", "setting", "sheets"]


@dataclass(frozen=True, slots=True)
class Sheet:
    """One table."""

    title: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    note: str = ""


def sheets(report: Report) -> list[Sheet]:
    """What a report says: first the conclusions, then every measurement."""
    found = [_conclusions(report), _ladder(report), _communication(report), _links(report)]
    if report.at_best_step:
        found.insert(3, _at_best_step(report))
    return found


# --- conclusions ---


def _conclusions(report: Report) -> Sheet:
    horizon, difference = report.reference.horizon, report.reference.difference
    rows = [
        ("reference", f"own FMU at tolerance {report.reference.tolerance:g}, against {report.reference.checked_by}"),
        (
            "it is good to",
            f"position {difference.position:.2g} m, pull at the top {difference.tension:.2g} N, "
            f"energy {difference.energy:.2g} J",
        ),
        ("horizon", _horizon(report)),
        ("default setting", _judged(report, report.default)),
        (f"recommended for {report.accuracy:g} m", _judged(report, report.recommended)),
    ]
    if any(row.inputs == "held" for row in report.communication):
        rows.append(("in a host that holds inputs", _held(report)))
    rows += [
        ("links enough, position", links_enough(report.refinement.enough_position) or report.refinement.note),
        ("links enough, largest tension", links_enough(report.refinement.enough_tension) or report.refinement.note),
    ]
    note = "Chaotic: all errors are the largest up to the horizon, and no later." if horizon.is_chaotic else ""
    return Sheet("What it says", ("", ""), rows, note)


def _horizon(report: Report) -> str:
    horizon, stop = report.reference.horizon, report.scene.stop_time
    if horizon.is_chaotic:
        return f"{horizon.time:g} s of {stop:g} s: there starts 1e-9 rad apart part by more than {report.accuracy:g} m"
    return f"none within {stop:g} s: two starts 1e-9 rad apart stay within {max(horizon.growth):.1g} m"


def setting(row: Row | None) -> str:
    """Solver, tolerance and communication step."""
    if row is None:
        return "none of those tried"
    return f"{row.solver}, {row.tolerance:g}, step {row.step:g} s"


def _judged(report: Report, row: Row | None) -> str:
    if row is None or row.error is None:
        return setting(row) if row is None else f"{setting(row)}: {row.note}"
    return f"{setting(row)}: {row.error.position:.2g} m off, {1e3 * row.cpu_time:.3g} ms"


def _held(report: Report) -> str:
    needed = held_step(report.communication, report.accuracy)
    if report.longest_held is not None or needed is None:
        return _judged(report, report.longest_held)
    return f"no step that was tried; about {needed:.1g} s, as the error is of first order in the step"


def links_enough(enough: dict[float, int | None]) -> str:
    """For 1 %, 0.1 % and 0.01 %; empty if it is not known."""
    return ", ".join(f"{100.0 * share:g} %: {_links_text(enough[share])}" for share in enough)


def _links_text(links: int | None) -> str:
    return "more than tried" if links is None else str(links)


# --- measurements ---


_RESULTS = ("position [m]", "pull [N]", "pull rel.", "energy [J]", "CPU [ms]", "RHS")
"""Of the pull at the top, and right-hand sides."""


def _ladder(report: Report) -> Sheet:
    note = "Errors: the largest over the output times; the pull is that at the top. CPU time without building the FMU."
    if any(not row.is_own for row in report.ladder):
        note += (
            " CVode (FMPy's, on the Model Exchange FMU) and scipy's DOP853, Radau and LSODA (on the kernel) evaluate "
            "through Python call-backs: RHS, the number of right-hand sides, is the fairer comparison with them. "
            "scipy's values between its steps come of its dense output."
        )
    note += _reasons(report.ladder)
    return Sheet("Error against price", ("solver", "tol.", *_RESULTS), _by_tolerance(report.ladder), note)


def _at_best_step(report: Report) -> Sheet:
    rows = report.at_best_step
    title = f"The own solvers at a communication step of {rows[0].step:g} s"
    return Sheet(title, ("solver", "tol.", *_RESULTS), _by_tolerance(rows), _reasons(rows).strip())


def _by_tolerance(rows: Sequence[Row]) -> list[tuple[str, ...]]:
    return [(row.solver, f"{row.tolerance:g}", *_results(row)) for row in rows]


def _results(row: Row) -> tuple[str, ...]:
    if row.error is None:
        return ("too slow" if row.note.startswith("too slow") else "failed", "", "", "", "", "")
    e = row.error
    errors = (f"{value:.2g}" for value in (e.position, e.tension, e.tension_relative, e.energy))
    return (*errors, f"{1e3 * row.cpu_time:.3g}", f"{row.rhs:,}")


def _reasons(rows: Sequence[Row]) -> str:
    """Why runs did not end, each reason once."""
    return "".join(f" {note}." for note in dict.fromkeys(row.note for row in rows if row.note))


def _communication(report: Report) -> Sheet:
    head = ("inputs", "step [s]", *_RESULTS)
    rows = [(row.inputs, f"{row.step:g}", *_results(row)) for row in report.communication]
    held = [row for row in report.communication if row.inputs == "held" and row.error is not None]
    found = order([row.step for row in held], [row.error.position if row.error else 0.0 for row in held])
    note = "exact: the FMU is given the derivatives of its inputs; held: constant over each step, as a plain host does."
    if found is not None:
        note += f" Observed order of held inputs in the step: {found:.2f}."
    return Sheet("Communication step (automatic, 1e-6)", head, rows, note)


def _links(report: Report) -> Sheet:
    found = report.refinement
    rows = [
        (str(s.links), f"{100.0 * s.position:.2g} %", f"{100.0 * s.tension:.2g} %", f"{1e3 * s.cpu_time:.3g}")
        for s in found.steps
    ]
    note = found.note
    if found.steps:
        note = (
            f"The same continuous cable in more and more links. Limit: {found.reference}; the finest cable is off by "
            f"{100.0 * found.finest[0]:.1g} % and {100.0 * found.finest[1]:.1g} %. "
            f"Observed orders: {_order(found.position_order)}, {_order(found.tension_order)}. {found.note}"
        )
    return Sheet("Number of links", ("links", "position / length", "largest tension", "CPU [ms]"), rows, note.strip())


def _order(found: float | None) -> str:
    return "none" if found is None else f"{found:.2f}"


# --- all scenes ---


def overview(reports: Sequence[Report]) -> Sheet:
    """One row per scene."""
    shares = " / ".join(f"{100.0 * share:g}" for share in SHARES)
    head = (
        "scene", "links", "reference good to [m]", "horizon [s]", "default: error [m]", "CPU [ms]", "recommended",
        "error [m]", "CPU [ms]", "held inputs: step [s]", f"links for {shares} %: position", "largest tension",
    )  # fmt: skip
    return Sheet("All scenes", head, [_overview_row(report) for report in reports])


def _overview_row(report: Report) -> tuple[str, ...]:
    reference, best, found = report.reference, report.recommended, report.refinement
    good_to = f"{reference.difference.position:.1g}"
    return (
        report.scene.name,
        str(report.scene.cable.n),
        good_to if reference.is_independent else f"{good_to} (own solver only)",
        f"{reference.horizon.time:g}" + (" (chaotic)" if reference.horizon.is_chaotic else ""),
        *_brief(report.default),
        setting(best),
        *(_brief(best) if best is not None else ("", "")),
        _held_brief(report),
        _enough_text(found.enough_position),
        _enough_text(found.enough_tension),
    )


def _brief(row: Row) -> tuple[str, str]:
    return (row.note, "") if row.error is None else (f"{row.error.position:.1g}", f"{1e3 * row.cpu_time:.3g}")


def _held_brief(report: Report) -> str:
    if not any(row.inputs == "held" for row in report.communication):
        return "any"
    found, needed = report.longest_held, held_step(report.communication, report.accuracy)
    if found is not None:
        return f"{found.step:g}"
    return f"about {needed:.1g}" if needed is not None else "not known"


def _enough_text(enough: dict[float, int | None]) -> str:
    return " / ".join("more" if links is None else str(links) for links in enough.values()) or "not known"
