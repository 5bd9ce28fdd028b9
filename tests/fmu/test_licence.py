"""What an FMU says of its licences, against what it holds."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from cablefmu.fmu.archive import build_fmu
from cablefmu.fmu.twin import build_twin
from cablefmu.fmu.vessel import build_vessel
from tests.fmu.test_platforms import SYSTEM
from tests.fmu.test_vessel import SINES
from tests.fmu_helpers import small_scene
from tests.kernel.library import ROOT, toolchain

OURS = (ROOT / "LICENSE").read_text(encoding="utf-8")


def licence_in(path: Path) -> str:
    with zipfile.ZipFile(path) as archive:
        return archive.read("documentation/licenses/license.txt").decode()


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_has_ours_and_the_headers(fmi: int, tmp_path: Path) -> None:
    text = licence_in(build_fmu(small_scene("air"), tmp_path / "x.fmu", fmi=fmi))
    assert text.startswith(OURS)
    header = (toolchain().fmi_headers() / "fmi3Functions.h").read_text(encoding="utf-8")
    terms = header[header.index("Redistribution and use") : header.index("ADVISED OF THE POSSIBILITY")]
    assert " ".join(terms.split()) in " ".join(text.split())


def test_it_names_the_compiler_in_use_and_all_that_is_linked_to(tmp_path: Path) -> None:
    text = licence_in(build_fmu(small_scene("air"), tmp_path / "x.fmu"))
    assert toolchain().REQUIREMENTS[0].replace("lang==", " ") + " (MIT" in text
    libraries = {Path(name).name for names in SYSTEM.values() for name in names} - {"cable.dylib"}
    assert len(libraries) == 3 and all(name in text for name in libraries)


@pytest.mark.parametrize("kind", ["twin", "vessel"])
def test_a_slave_in_python_has_ours_and_that_of_the_library_in_it(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "x.fmu"
    text = licence_in(build_twin(small_scene("air"), path) if kind == "twin" else build_vessel(SINES, path))
    assert text.startswith(OURS) and "zig" not in text
    assert "MIT License" in text and "NTNU" in text and "Mozilla Public License 2.0" in text
