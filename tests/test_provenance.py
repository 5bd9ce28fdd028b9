"""What --version says of the libraries, against the build's own record."""

from __future__ import annotations

import shutil
from importlib.resources import files
from pathlib import Path

import pytest

from cablefmu import __version__, provenance
from cablefmu.fmu.platforms import PLATFORMS
from tests.kernel.library import toolchain

SHIPPED = Path(str(files("cablefmu")))


def told() -> dict[str, list[str]]:
    """First word of each row below the heading -> the others."""
    first, _, *rows = provenance.version_text().splitlines()
    assert first == f"cablefmu {__version__}"
    return {row.split()[0]: row.split()[1:] for row in rows}


def test_every_library_is_told_as_the_build_recorded_it() -> None:
    lines = (SHIPPED / "binaries" / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    short = {path.partition(".")[0]: digest[:12] for digest, path in (line.split("  ") for line in lines)}
    sources = toolchain().source_hash()[:12]
    expected = {name: [sources, short[f"{name}/cable"], short[f"{name}/kernel"]] for name in PLATFORMS}
    assert told() == expected | {"universal-darwin": ["-", short["universal-darwin/cable"], "-"]}


def test_the_files_are_asked_not_the_record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = told()
    shutil.copytree(SHIPPED / "binaries", tmp_path / "binaries")
    monkeypatch.setattr(provenance, "files", lambda _: tmp_path)
    (tmp_path / "binaries" / "x86_64-linux" / "cable.so").write_bytes(b"")
    (tmp_path / "binaries" / "aarch64-linux" / "kernel.so").unlink()
    shutil.rmtree(tmp_path / "binaries" / "x86_64-windows")
    after = told()
    assert after["x86_64-linux"] == [before["x86_64-linux"][0], "e3b0c44298fc", before["x86_64-linux"][2]]
    assert after["aarch64-linux"] == [*before["aarch64-linux"][:2], "-"]
    assert after["x86_64-windows"] == ["-", "-", "-"]
    assert after["x86_64-darwin"] == before["x86_64-darwin"]


def test_it_fits_a_terminal_of_80_columns() -> None:
    assert max(map(len, provenance.version_text().splitlines())) < 80
