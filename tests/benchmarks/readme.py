"""The README's figures of what it costs: `python -m tests.benchmarks.readme` renews them from docs/benchmarks.json."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

__all__ = ["renewed"]

ROOT = Path(__file__).parents[2]
_MARK, _END = "<!-- costs: python -m tests.benchmarks.readme -->", "<!-- costs end -->"
_NAMES = {
    "cablefmu": "cablefmu, own solver",
    "DART": "DART, articulated bodies; motion by scipy's DOP853",
    "pinocchio": "pinocchio, articulated bodies; motion by scipy's DOP853",
    "MuJoCo": "MuJoCo, mj_forward; motion by its RK4",
}
_SHOWN = ("1e-06", "1e-08", "0.02 s", "0.01 s")
"""Ends of the settings whose motions are shown: tolerances, steps."""


def renewed(text: str, results: dict[str, Any]) -> str:
    """A README whose figures between the two marks are made anew.

    Parameters
    ----------
    text
        The README.
    results
        What docs/benchmarks.json holds, with the peers.

    Raises
    ------
    ValueError
        If the marks are not there.
    """
    before, mark, rest = text.partition(_MARK)
    _, end, after = rest.partition(_END)
    if not mark or not end:
        raise ValueError(f"the README has no figures between {_MARK} and {_END}")
    parts = [_peers(results["peers"]), _per_link(results), _table_6_6(results["table_6_6"])]
    return "\n\n".join([f"{before}{mark}\n{_where(results)}", *parts]) + f"\n{end}{after}"


def _where(results: dict[str, Any]) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in results["versions"].items())
    return f"One run on {results['machine']}, {versions}."


def _number(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def _peers(peers: dict[str, Any]) -> str:
    own = peers["cablefmu"]["seconds"]
    lines = [
        "| forward dynamics of 120 links, the same chain | version | µs | times ours "
        "| 10 s of it: CPU [ms] (error [m]) |\n|---|---|---|---|---|"
    ]
    for name, peer in sorted(peers.items(), key=lambda item: float(item[1]["seconds"])):
        shown = [m for m in peer.get("motions", []) if m["setting"].endswith(_SHOWN)]
        motions = ", ".join(f"{1e3 * m['seconds']:.1f} ({_number(m['error_m'])})" for m in shown)
        cost = f"{1e6 * peer['seconds']:.1f} | {peer['seconds'] / own:.1f}"
        lines.append(f"| {_NAMES.get(name, name)} | {peer['version']} | {cost} | {motions} |")
    return "\n".join(lines)


def _per_link(results: dict[str, Any]) -> str:
    of = {(row["links"], row["variant"]): row for row in results["per_link"]}
    fast, plain = (
        [f"{of[links, variant]['ns_per_link']:.1f}" for links in (120, 1000, 10000)] for variant in ("AVX2", "portable")
    )
    row = of[120, "AVX2"]
    ratio = row["ns_per_link"] / row["core_ns_per_link"]
    return (
        f"With water, joint springs and dampers a right-hand side takes {fast[0]} ns per link at 120 links,\n"
        f"{fast[1]} at 1,000 and {fast[2]} at 10,000 ({', '.join(plain[:2])} and {plain[2]} without AVX2).\n"
        f"At 120 links that is {ratio:.2f} times what its sines and its elimination take alone."
    )


def _table_6_6(rows: Iterable[dict[str, Any]]) -> str:
    of = {(row["links"], row["tolerance"]): row for row in rows}
    links = sorted({n for n, _ in of})

    def line(title: str, cells: Iterable[str]) -> str:
        return f"| {title} | {' | '.join(cells)} |"

    head = "Table 6.6: 10 s by `simulate` with 100 communication steps"
    lines = [line(head, [*map(str, links[:-1]), f"{links[-1]} links"]), f"|{'---|' * (len(links) + 1)}"]
    for tolerance in (1e-4, 1e-6):
        name = _number(tolerance)
        lines.append(line(f"cablefmu at {name} [ms]", (f"{1e3 * of[n, tolerance]['seconds']:.1f}" for n in links)))
        lines.append(line("... error of the terminal [m]", (_number(of[n, tolerance]["error_m"]) for n in links)))
    dense = (f"{of[n, 1e-6]['dense_seconds']:.2g}" for n in links)
    lines.append(line("dense NumPy under DOP853 at 1e-6 [s]", dense))
    lines.append(line("MATLAB, as printed in 2015 [s]", (str(of[n, 1e-6]["matlab_seconds"]) for n in links)))
    return "\n".join(lines)


def main() -> None:
    results = json.loads((ROOT / "docs" / "benchmarks.json").read_text("utf-8"))
    path = ROOT / "README.md"
    path.write_text(renewed(path.read_text("utf-8"), results), "utf-8")


if __name__ == "__main__":
    main()
