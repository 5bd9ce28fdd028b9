"""What was measured as Markdown: for the README, and for the page of the documentation."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

__all__ = ["sections", "tables"]

Results = dict[str, Any]
"""What build/benchmarks.json holds."""


def tables(results: Results) -> str:
    """All of it, a title above each table."""
    return "\n\n".join(f"## {title}\n\n{text}" for title, text in sections(results))


def sections(results: Results) -> Iterator[tuple[str, str]]:
    """Title and Markdown of each thing that was measured, in the order of interest."""
    if "peers" in results:
        yield "Forward dynamics of 120 links, the same chain", _peers(results["peers"])
        yield "The same chain in motion", _motions(results["peers"])
    yield "10 s of timing-120", _work_precision(results)
    yield "Table 6.6 of the dissertation", _table_6_6(results["table_6_6"])
    yield "A right-hand side, with water, joint springs and dampers", _per_link(results["per_link"])
    yield "Stiff cables, 10 s", _stiff(results)
    yield "The automatic choice", _automatic(results["automatic"])
    yield (
        "Beside the integration",
        _table(("what", "seconds"), ((row["what"], f"{row['seconds']:.2g}") for row in results["overhead"])),
    )


def _table(titles: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    head = f"| {' | '.join(titles)} |\n|{'---|' * len(titles)}"
    return "\n".join([head, *(f"| {' | '.join(map(str, row))} |" for row in rows)])


def _peers(peers: Results) -> str:
    own = peers["cablefmu"]["seconds"]
    return _table(
        ("", "version", "µs", "times ours"),
        (
            (name, peer["version"], f"{1e6 * peer['seconds']:.1f}", f"{peer['seconds'] / own:.1f}")
            for name, peer in sorted(peers.items(), key=lambda item: float(item[1]["seconds"]))
        ),
    )


def _motions(peers: Results) -> str:
    return _table(
        ("", "setting", "CPU [ms]", "error [m]"),
        (
            (name, motion["setting"], f"{1e3 * motion['seconds']:.1f}", f"{motion['error_m']:.0e}")
            for name, peer in peers.items()
            for motion in peer.get("motions", [])
        ),
    )


def _work_precision(results: Results) -> str:
    text = _table(
        ("", "tolerance", "CPU [ms]", "error of the terminal [m]"),
        (
            (row["solver"], f"{row['tolerance']:g}", f"{1e3 * row['seconds']:.1f}", f"{row['error_m']:.0e}")
            for row in results["work_precision"]
        ),
    )
    if "moordyn" not in results:
        return text
    line = results["moordyn"]
    cost = 1e3 * float(line["seconds"])
    return f"{text}\n\nMoorDyn {line['version']}, its own extensible line: {cost:.0f} ms in steps of {line['step']} s."


def _table_6_6(rows: Iterable[Results]) -> str:
    return _table(
        ("links", "tolerance", "ours [ms]", "error [m]", "right-hand sides", "dense NumPy [s]", "MATLAB, 2015 [s]"),
        (
            (
                row["links"], f"{row['tolerance']:g}", f"{1e3 * row['seconds']:.1f}", f"{row['error_m']:.0e}",
                f"{row['rhs']:.0f}", f"{row['dense_seconds']:.2g}", row["matlab_seconds"],
            )
            for row in rows
        ),
    )  # fmt: skip


def _per_link(rows: Iterable[Results]) -> str:
    return _table(
        ("links", "variant", "ns per link", "sines and elimination alone", "ratio"),
        (
            (
                row["links"], row["variant"], f"{row['ns_per_link']:.1f}", f"{row['core_ns_per_link']:.1f}",
                f"{row['ns_per_link'] / row['core_ns_per_link']:.2f}",
            )
            for row in rows
        ),
    )  # fmt: skip


def _stiff(results: Results) -> str:
    text = _table(
        ("case", "method", "tolerance", "CPU [ms]", "steps", "error [m]"),
        (
            (
                row["case"], row["method"], f"{row['tolerance']:g}", f"{1e3 * row['seconds']:.1f}",
                f"{row['steps']:.0f}", f"{row['error_m']:.0e}",
            )
            for row in results["stiff"]
        ),
    )  # fmt: skip
    growth = results["growth"]
    each = zip(growth["links"], growth["seconds_per_step"], strict=True)
    costs = ", ".join(f"{1e6 * seconds:.3g} µs at {n} links" for n, seconds in each)
    return f"{text}\n\nAn implicit step costs n^{growth['exponent']:.3f}: {costs}."


def _automatic(rows: Iterable[Results]) -> str:
    return _table(
        ("scene", "links", "explicit [ms]", "implicit [ms]", "automatic [ms]", "of the cheaper", "of the explicit"),
        (
            (
                row["scene"], row["links"],
                *(f"{1e3 * row[solver]:.1f}" for solver in ("explicit", "implicit", "automatic")),
                f"{row['of_cheaper']:.2f}", f"{row['of_explicit']:.2f}",
            )
            for row in rows
        ),
    )  # fmt: skip
