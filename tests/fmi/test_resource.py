"""The FMU finds its numbers wherever it lies, and takes no other file for them."""

from __future__ import annotations

import ctypes
import hashlib
import random
import shutil
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from cablefmu.fmu.resource import token_of
from tests.conftest import Unpacked
from tests.fmu_helpers import Host, InstantiationRefusedError

both = pytest.mark.parametrize("fmi", [2, 3])

FOLDERS = ["plain", "with space", "Mühle Ångström 海", "100%", "%41%zz%", "a#b?c&d=e", "file:x"]


@both
@pytest.mark.parametrize("name", FOLDERS)
def test_any_folder_will_do(name: str, fmi: int, unpacked: Unpacked, tmp_path: Path) -> None:
    """FMPy passes a percent-encoded URI in FMI 2 and a bare path in FMI 3."""
    folder = Path(shutil.copytree(unpacked("load", fmi), tmp_path / name))
    with Host(folder) as moved, Host(unpacked("load", fmi)) as first:
        np.testing.assert_array_equal(moved.initialize().run(0.2), first.initialize().run(0.2))


@both
@pytest.mark.parametrize("form", ["{}", "{}/", "file:{}", "file://{}", "file://localhost{}", "file://{}/"])
def test_forms_of_the_location(form: str, fmi: int, unpacked: Unpacked) -> None:
    """Hosts write the resource location in many ways."""
    with Host(unpacked("load", fmi)) as host:
        location = form.format(unpacked("load", fmi) / "resources").encode()
        token = host.description.guid.encode()
        if fmi == 2:
            instance = host.fmu.fmi2Instantiate(
                b"x", 1, token, location, ctypes.byref(host.fmu.callbacks), False, False
            )
            assert instance
            host.fmu.fmi2FreeInstance(instance)
        else:
            instance = host.fmu.fmi3InstantiateModelExchange(
                b"x", token, location, False, False, None, host.fmu.logMessage
            )
            assert instance
            host.fmu.fmi3FreeInstance(instance)


def refusal(folder: Path, **more: str) -> str:
    """The one message with which Instantiate returns NULL."""
    with pytest.raises(InstantiationRefusedError) as refused:
        Host(folder, **more)  # type: ignore[arg-type]
    (message,) = refused.value.args[0]
    return str(message).replace("%%", "%")


@pytest.fixture
def spoilt(unpacked: Unpacked, tmp_path: Path, fmi: int) -> Path:
    return Path(shutil.copytree(unpacked("load", fmi), tmp_path / "fmu"))


@both
def test_a_missing_file_is_named(spoilt: Path, fmi: int) -> None:
    resource = spoilt / "resources" / "cable.bin"
    resource.unlink()
    assert refusal(spoilt) == f"resource file {resource}: cannot be opened"


@both
@pytest.mark.parametrize("content", [b"", b"CABLEFMU", b"\0" * 5000, b"MZ" * 300])
def test_a_foreign_file_is_named(content: bytes, spoilt: Path, fmi: int) -> None:
    resource = spoilt / "resources" / "cable.bin"
    resource.write_bytes(content)
    assert refusal(spoilt) == f"resource file {resource}: is not a cable of this version, or is damaged"


@both
def test_another_cables_file_is_refused(spoilt: Path, fmi: int, unpacked: Unpacked) -> None:
    other = unpacked("floater", fmi) / "resources" / "cable.bin"
    shutil.copy(other, spoilt / "resources")
    assert f"does not belong to cable.bin, whose token is {token_of(other.read_bytes())}" in refusal(spoilt)


@both
@pytest.mark.parametrize("token", ["{00000000-0000-0000-0000-000000000000}", "x" * 2000])
def test_a_wrong_token_is_refused(token: str, fmi: int, unpacked: Unpacked) -> None:
    message = refusal(unpacked("load", fmi), token=token)
    assert message.startswith(f"the guid or instantiation token {token[:400]}")


@both
@pytest.mark.parametrize("seed", range(40))
def test_damage_is_refused(seed: int, spoilt: Path, fmi: int) -> None:
    """Cut, lengthen or scribble: NULL and a message, whatever the bytes say; no crash."""
    dice = random.Random(seed)
    resource = spoilt / "resources" / "cable.bin"
    content = bytearray(resource.read_bytes())
    for _ in range(dice.randint(1, 4)):
        match dice.randrange(3):
            case 0:
                del content[dice.randrange(len(content)) :]
            case 1:
                content += dice.randbytes(dice.randint(1, 64))
            case _:
                at = dice.randrange(len(content) + 1)
                content[at : at + 8] = dice.randbytes(8)
        content += b"\0" * (not content)
    resource.write_bytes(content)
    assert "cable.bin" in refusal(spoilt)


HEADER = {"version": 8, "links": 12, "terminal": 16, "drag": 20, "parameters": 32, "inputs": 36, "outputs": 40,
          "solver": 48, "initial": 52, "shape": 56, "whole": 60}  # fmt: skip


@both
@pytest.mark.parametrize("value", [0, 6, 2**31, 2**32 - 1])
@pytest.mark.parametrize("entry", HEADER)
def test_the_header_is_checked_even_if_the_token_fits(entry: str, value: int, spoilt: Path, fmi: int) -> None:
    resource = spoilt / "resources" / "cable.bin"
    content = bytearray(resource.read_bytes())
    struct.pack_into("<I", content, HEADER[entry], value)
    if entry in ("terminal", "drag", "solver", "initial", "shape", "whole") and value == 0:
        content[HEADER[entry]] = 9  # 0 is a kind as well
    resource.write_bytes(content)
    assert "is not a cable of this version, or is damaged" in refusal(spoilt, token=token_of(bytes(content)))


@both
def test_scenes_that_seek_no_equilibrium_tell_nothing_of_it(
    fmi: int, unpacked_from_equilibrium: Unpacked, tmp_path: Path
) -> None:
    """Else the FMU would have an output that nobody works out."""
    folder = Path(shutil.copytree(unpacked_from_equilibrium("load", fmi), tmp_path / "fmu"))
    resource = folder / "resources" / "cable.bin"
    content = bytearray(resource.read_bytes())
    struct.pack_into("<I", content, HEADER["initial"], 0)
    resource.write_bytes(content)
    assert "holds impossible values" in refusal(folder, token=token_of(bytes(content)))


@both
@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0])
def test_impossible_lengths_are_refused_even_if_the_token_fits(value: float, spoilt: Path, fmi: int) -> None:
    resource = spoilt / "resources" / "cable.bin"
    content = bytearray(resource.read_bytes())
    at = content.index(struct.pack("<d", 4.0) * 5)  # five links of 4 m
    struct.pack_into("<d", content, at, value)
    resource.write_bytes(content)
    assert "holds impossible values" in refusal(spoilt, token=token_of(bytes(content)))


def with_whole(folder: Path, target: Path, place: int, value: float) -> tuple[Path, str]:
    """A copy of an FMU with arrays, one number of the whole cable replaced, and the token that fits."""
    copy = Path(shutil.copytree(folder, target))
    resource = copy / "resources" / "cable.bin"
    content = bytearray(resource.read_bytes())
    at = content.index(struct.pack("<3d", 20.0, 0.02, 7850.0))  # L, D, rho_cable
    struct.pack_into("<d", content, at + 8 * place, value)
    resource.write_bytes(content)
    return copy, token_of(bytes(content))


@pytest.mark.parametrize("place", range(5))
@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0])
def test_impossible_cables_are_refused_even_if_the_token_fits(
    place: int, value: float, unpacked_arrays: Callable[[str], Path], tmp_path: Path
) -> None:
    folder, token = with_whole(unpacked_arrays("load"), tmp_path / "fmu", place, value)
    if (place, value) == (4, -1.0):  # an angle
        with Host(folder, token=token) as host:
            assert host.get("theta_start") == [-1.0]
        return
    assert "holds impossible values" in refusal(folder, token=token)


@pytest.mark.parametrize("entry", HEADER)
@pytest.mark.parametrize("value", [0, 1, 6, 2**31, 2**32 - 1])
def test_the_header_of_arrays_is_checked(
    entry: str, value: int, unpacked_arrays: Callable[[str], Path], tmp_path: Path
) -> None:
    folder = Path(shutil.copytree(unpacked_arrays("load"), tmp_path / "fmu"))
    resource = folder / "resources" / "cable.bin"
    content = bytearray(resource.read_bytes())
    struct.pack_into("<I", content, HEADER[entry], value)
    resource.write_bytes(content)
    token = token_of(bytes(content))
    allowed = {"links": (1, 6), "shape": (1,), "terminal": (0, 1), "drag": (0, 1), "solver": (0, 1), "initial": (0, 1)}
    if value in allowed.get(entry, ()):
        with Host(folder, token=token) as host:
            assert host.messages == []
        return
    assert "is not a cable of this version, or is damaged" in refusal(folder, token=token)


def test_version_2_takes_no_arrays(unpacked: Unpacked, unpacked_arrays: Callable[[str], Path], tmp_path: Path) -> None:
    """There a value reference stands for one value, and a host has room for no more."""
    folder = Path(shutil.copytree(unpacked("load", 2), tmp_path / "fmu"))
    resource = shutil.copy(unpacked_arrays("load") / "resources" / "cable.bin", folder / "resources")
    says = refusal(folder, token=token_of(Path(resource).read_bytes()))
    assert says == "cable.bin is that of a cable with arrays, which FMI 2 does not have"


@pytest.mark.parametrize("seed", range(40))
def test_damage_to_arrays_is_refused(seed: int, unpacked_arrays: Callable[[str], Path], tmp_path: Path) -> None:
    test_damage_is_refused(seed, Path(shutil.copytree(unpacked_arrays("pin"), tmp_path / "fmu")), 3)


@pytest.mark.parametrize("seed", range(40))
def test_any_numbers_are_run_or_refused(seed: int, unpacked_arrays: Callable[[str], Path], tmp_path: Path) -> None:
    """Wild but possible cables, the token fitting: an answer of numbers or a message, in bounded time."""
    dice = random.Random(seed)
    kind = dice.choice(["load", "pin", "floater", "anchor-spring", "anchor-mass"])
    value = 10.0 ** dice.uniform(-300, 300)
    folder, token = with_whole(unpacked_arrays(kind), tmp_path / "fmu", dice.randrange(4), value)
    with Host(folder, token=token) as host:
        try:
            host.configure(dice.choice([1, 2, 50])).initialize()
        except FMICallException:
            assert host.messages
            return
        assert np.all(np.isfinite(host.get(*host.names("output"))))


@both
def test_the_token_is_the_files_hash(fmi: int, unpacked: Unpacked) -> None:
    """The binary's SHA-256 against Python's."""
    digest = hashlib.sha256((unpacked("load", fmi) / "resources" / "cable.bin").read_bytes()).hexdigest()
    with Host(unpacked("load", fmi)) as host:
        assert host.description.guid.strip("{}").replace("-", "") == digest[:32]


@both
def test_nothing_of_the_binary_depends_on_the_locale(fmi: int, unpacked: Unpacked) -> None:
    """It imports no function that reads or writes numbers by the locale; it does open files."""
    (library,) = unpacked("load", fmi).glob("binaries/*/*.so")
    names = set(library.read_bytes().split(b"\0"))
    by_locale = b"printf sprintf snprintf vsnprintf fprintf strtod strtof atof sscanf fscanf setlocale localeconv"
    assert b"fopen" in names
    assert names.isdisjoint(by_locale.split())
