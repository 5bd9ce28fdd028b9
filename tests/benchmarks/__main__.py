"""`python -m tests.benchmarks [PYTHON]`: measure, write build/benchmarks.json, print the README's tables.

PYTHON is an interpreter that has the peers: `pip install mujoco pin dartpy moordyn scipy` in an environment of its own.
"""

from __future__ import annotations

import json
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

from tests.benchmarks import automatic, overhead, rhs, stiff, table_6_6, work_precision

LINKS = 120
REPEATS = 2_000
SPAN = 10.0
"""Of the peers' motions [s]."""


def machine() -> str:
    """Processor, as the system names it."""
    info = Path("/proc/cpuinfo")
    names = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if line.startswith("model name")]
    return names[0] if names else platform.processor()


def peers(python: str) -> dict[str, dict[str, object]]:
    """What the libraries need for the same chain, after a look that they solve the same chain."""
    script = Path(__file__).with_name("peers.py")
    done = subprocess.run(
        [python, str(script), str(LINKS), str(REPEATS), str(SPAN)], capture_output=True, text=True, check=True
    )
    found: dict[str, dict[str, object]] = json.loads(done.stdout)
    own = rhs.single(LINKS, SPAN)
    for name, peer in found.items():
        difference = np.max(np.abs(np.subtract(peer.pop("accelerations"), own["accelerations"])))  # type: ignore[call-overload]
        if not difference < 1e-6:
            raise SystemExit(f"{name} solves another chain: accelerations differ by {difference}")
    found["cablefmu"] = {"version": version("cablefmu"), "seconds": own["seconds"], "motions": own["motions"][:-1]}
    exact = own["motions"][-1]["end"]
    for peer in found.values():
        for motion in peer["motions"]:  # type: ignore[attr-defined]
            motion["error_m"] = float(np.max(np.abs(np.subtract(motion["end"], exact))))
    found["dense NumPy (cablefmu.reference)"] = {"version": np.__version__, "seconds": own["dense_seconds"]}
    return found


def moordyn(python: str) -> dict[str, float | str]:
    """Ten seconds of MoorDyn's own line of as many segments."""
    script = Path(__file__).with_name("moordyn_peer.py")
    done = subprocess.run([python, str(script), str(LINKS), "10"], capture_output=True, text=True, check=True)
    found: dict[str, float | str] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    results: dict[str, object] = {
        "machine": machine(),
        "versions": {name: version(name) for name in ("cablefmu", "fmpy", "numpy", "ziglang")},
        "per_link": rhs.per_link(),
        "table_6_6": table_6_6.rows(),
        "work_precision": work_precision.rows(),
        "overhead": overhead.rows(),
        "stiff": stiff.rows(),
        "growth": stiff.growth(),
        "automatic": automatic.rows(),
    }
    if len(sys.argv) > 1:
        results["peers"] = peers(sys.argv[1])
        results["moordyn"] = moordyn(sys.argv[1])
    Path("build").mkdir(exist_ok=True)
    Path("build/benchmarks.json").write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    print_tables(results)


def print_tables(results: dict[str, object]) -> None:
    """Markdown, for the README."""
    print(f"{results['machine']}; {results['versions']}\n")
    print("| links | variant | ns per link | sines and elimination alone | ratio |\n|---|---|---|---|---|")
    for row in results["per_link"]:  # type: ignore[attr-defined]
        cost, core = row["ns_per_link"], row["core_ns_per_link"]
        print(f"| {row['links']} | {row['variant']} | {cost:.1f} | {core:.1f} | {cost / core:.2f} |")
    titles = ("links", "tolerance", "ours [ms]", "error [m]", "right-hand sides", "dense NumPy [s]", "MATLAB [s]")
    print(f"\n| {' | '.join(titles)} |\n|{'---|' * len(titles)}")
    for row in results["table_6_6"]:  # type: ignore[attr-defined]
        print(
            f"| {row['links']} | {row['tolerance']:g} | {1e3 * row['seconds']:.1f} | {row['error_m']:.0e} | "
            f"{row['rhs']:.0f} | {row['dense_seconds']:.2g} | {row['matlab_seconds']} |"
        )
    print("\n| 10 s of timing-120 | tolerance | CPU [ms] | error [m] |\n|---|---|---|---|")
    for row in results["work_precision"]:  # type: ignore[attr-defined]
        print(f"| {row['solver']} | {row['tolerance']:g} | {1e3 * row['seconds']:.1f} | {row['error_m']:.0e} |")
    print("\n| stiff cables, 10 s | method | tolerance | CPU [ms] | steps | error [m] |\n|---|---|---|---|---|---|")
    for row in results["stiff"]:  # type: ignore[attr-defined]
        print(
            f"| {row['case']} | {row['method']} | {row['tolerance']:g} | {1e3 * row['seconds']:.1f} | "
            f"{row['steps']:.0f} | {row['error_m']:.0e} |"
        )
    growth: dict[str, float] = results["growth"]  # type: ignore[assignment]
    print(f"\nAn implicit step costs n^{growth['exponent']:.3f}: {growth['seconds_per_step']} s")
    print("\n| scene | links | explicit [ms] | implicit [ms] | automatic [ms] | of the cheaper | of the explicit |")
    print("|" + "---|" * 7)
    for row in results["automatic"]:  # type: ignore[attr-defined]
        costs = " | ".join(f"{1e3 * row[solver]:.1f}" for solver in ("explicit", "implicit", "automatic"))
        print(f"| {row['scene']} | {row['links']} | {costs} | {row['of_cheaper']:.2f} | {row['of_explicit']:.2f} |")
    print("\n| overhead | seconds |\n|---|---|")
    for row in results["overhead"]:  # type: ignore[attr-defined]
        print(f"| {row['what']} | {row['seconds']:.2g} |")
    if "peers" not in results:
        return
    peer_line: dict[str, float | str] = results["moordyn"]  # type: ignore[assignment]
    cost = 1e3 * float(peer_line["seconds"])
    print(f"\nMoorDyn {peer_line['version']}, its own line: {cost:.0f} ms at {peer_line['step']} s")
    found: dict[str, dict[str, float]] = results["peers"]  # type: ignore[assignment]
    own = found["cablefmu"]["seconds"]
    print("\n| forward dynamics of 120 links | version | us | times ours |\n|---|---|---|---|")
    for name, peer in sorted(found.items(), key=lambda item: item[1]["seconds"]):
        print(f"| {name} | {peer['version']} | {1e6 * peer['seconds']:.1f} | {peer['seconds'] / own:.1f} |")
    print(f"\n| {SPAN:g} s of the same chain | setting | CPU [ms] | error [m] |\n|---|---|---|---|")
    for name, peer in found.items():
        for motion in peer.get("motions", []):  # type: ignore[attr-defined]
            print(f"| {name} | {motion['setting']} | {1e3 * motion['seconds']:.1f} | {motion['error_m']:.0e} |")


if __name__ == "__main__":
    main()
