"""The fuzzers, their scenes and the files they start from."""

from __future__ import annotations

import itertools
import re
import subprocess
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from fmpy import extract, read_model_description

from cablefmu.fmu.archive import build_fmu
from cablefmu.scene import Scene
from tests.fmu_helpers import SCENES, from_equilibrium
from tests.kernel.library import toolchain

__all__ = ["COVERAGE", "FUZZERS", "SANITIZED", "SAVED", "compile_fuzzers", "environment", "starts", "write_scenes"]

HERE = Path(__file__).parent
FUZZERS = ("calls", "resource")
SAVED = HERE / "corpus"
"""Sequences of calls that earlier runs kept; resource files of one version are of no use to the next."""
FIRST_FUNCTION, RUN_UP, CONTINUE, AS_NEW, ROLL_BACK, IN_STEP, TO_IMAGE, DAMAGE, STEP = 16, 3, 4, 5, 6, 7, 8, 9, 10
CLOSE, A_SMALL_NUMBER = 2, 35
"""Functions and deeds by their numbers in host.h and deeds.c."""
EXTREMES, MILLI, ENDLESS, A_TENTH, TEN, THOUSANDS = (13, 22, 30, 19), 6, 255, 3, 8, 11
"""Codes of 1e300, 1.7e6, 1e200 and nan, of 1e-3, 0.1, 10, 1e5 in arguments.c; of no time to return at in host3.c."""
ENTER = {2: ("fmi2SetupExperiment", "fmi2EnterInitializationMode"), 3: ("fmi3EnterInitializationMode",)}
WRITE = {2: "fmi2SetReal", 3: "fmi3SetFloat64"}
STATE = {2: ("fmi2GetFMUstate", "fmi2DeSerializeFMUstate", "fmi2SetFMUstate"),
         3: ("fmi3GetFMUState", "fmi3DeserializeFMUState", "fmi3SetFMUState")}  # fmt: skip
READ = {2: "fmi2GetReal", 3: "fmi3GetFloat64"}
_SHARED = ("scenes.c", "arguments.c", "host2.c", "host3.c", "deeds.c")

# Sanitized loops are not vectorised, which the kernel asks for: no news.
_CLANG = ["clang", "-g", "-O1", "-fno-omit-frame-pointer", "-ffp-contract=off"]
# A step that takes more attempts than this is given up, as others are after a million: time is for other calls.
_WORDS = ["-D_POSIX_C_SOURCE=200809L", "-DSOLVER_MOST_STEPS=150", "-Dfopen=fuzz_fopen"]
SANITIZED = ("-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all")
COVERAGE = ("-fsanitize=fuzzer", "-fprofile-instr-generate", "-fcoverage-mapping")


def compile_fuzzers(folder: Path, flags: Sequence[str] = SANITIZED, *, sources: Path | None = None) -> None:
    """All of `FUZZERS` as programs in `folder`; the FMU's C files from `sources`, a copy of fmu_src, if given."""
    recipe = toolchain()
    root = sources or recipe.HERE
    parts = {part: sorted((root / part).glob("*.c")) for part in ("kernel", "fmi")}
    words = ["-I", str(root), "-isystem", str(recipe.fmi_headers()), *recipe.STRICT, "-Wno-pass-failed", *_WORDS]

    def clang(place: Path, *arguments: str) -> None:
        command = [*_CLANG, *flags, *words, *arguments]
        result = subprocess.run(command, capture_output=True, text=True, cwd=place)
        assert result.returncode == 0, result.stderr

    objects: list[str] = []
    for part, files in {**parts, "host": [HERE / file for file in _SHARED]}.items():
        (folder / part).mkdir(parents=True)
        clang(folder / part, "-c", *map(str, files))
        objects += [f"{part}/{path.stem}.o" for path in files]
    for name in FUZZERS:
        clang(folder, str(HERE / f"fuzz_{name}.c"), *objects, "-o", name, "-lm")


def write_scenes(folder: Path) -> Path:
    """The resource files of small scenes of every kind as 0.bin, 1.bin, ...: two links are enough."""
    target = folder / "scenes"
    target.mkdir()
    scenes = [
        Scene.from_text(text.replace("links = 5", "links = 2"), name=kind)
        for kind, text in SCENES.items()
        if kind != "load-volume"
    ]
    equilibrium = from_equilibrium(scenes[1])
    every = [*((scene, False) for scene in [*scenes, equilibrium]), (scenes[1], True), (equilibrium, True)]
    every += [(scene, True) for scene in scenes[3:]]  # whatever hangs between two ends, surges or is moved
    for number, (scene, arrays) in enumerate(every):
        unpacked = folder / f"scene-{number}" / f"{scene.name}-3"
        path = build_fmu(scene, folder / f"scene-{number}.fmu", fmi=3, arrays=arrays)
        extract(str(path), unzipdir=str(unpacked))
        (target / f"{number}.bin").write_bytes((unpacked / "resources" / "cable.bin").read_bytes())
    return target


_INSTEAD = {"u_m1": "ay_1", "M_1": "g", "y_m1": "y_c"}
"""What a cable without a floater has at that place."""


def _seeds_of_resources(scenes: Path, folder: Path) -> Path:
    """Every scene's file, whole, cut, too long, and with each word of its header changed."""
    folder.mkdir()
    for path in sorted(scenes.glob("*.bin")):
        whole = path.read_bytes()
        (folder / path.stem).write_bytes(whole)
        (folder / f"{path.stem}-cut").write_bytes(whole[:-8])
        (folder / f"{path.stem}-long").write_bytes(whole + bytes(8))
    first = (scenes / "0.bin").read_bytes()
    for word in range(0, 72, 4):
        (folder / f"word-{word}").write_bytes(first[:word] + bytes([first[word] ^ 0x47]) + first[word + 1 :])
    (folder / "no-mass").write_bytes(first[: 64 + 8 * 64] + bytes(8) + first[72 + 8 * 64 :])
    return folder


def _functions(fmi: int) -> dict[str, int]:
    """Name -> number of the table's line."""
    text = (HERE / f"calls{fmi}.def").read_text()
    return {name: FIRST_FUNCTION + k for k, name in enumerate(re.findall(r"^CALL\((\w+),", text, re.MULTILINE))}


def _record(
    function: int, *, slot: int = 0, count: int = 0, flags: int = 0, references: Sequence[int] = (),
    values: Sequence[int] = (), spare: int = 0,
) -> bytes:  # fmt: skip
    """As `Record` in host.h."""
    three = [(*numbers, 0, 0, 0)[:3] for numbers in (references, values)]
    return bytes([function, slot, count, 0, flags, *three[0], *three[1], spare])


def _journeys(fmi: int, cosimulation: int, scene: int, reference: dict[str, int]) -> Iterator[list[bytes]]:
    """What a careful host does with each function of the table, and with several variables."""
    listens = 4 | 2 if fmi == 3 and cosimulation else 0
    opened = _record(fmi - 2, count=1, references=[reference["u_m1"]], values=[cosimulation, listens, scene])
    begin = [_record(RUN_UP), *([] if cosimulation else [_record(CONTINUE)])]
    for name in ("u_m1", "x_c", "theta[1]", "solver") if scene == 1 else ("x_c",):
        for value in (reference["theta[1]"], A_SMALL_NUMBER):
            for number in _functions(fmi).values():
                call = {"count": 1, "references": [reference[name]], "values": [value] * 3}
                yield [opened, _record(number, **call), *begin, _record(number, **call), _record(STEP)]
                if listens and name in ("u_m1", "x_c"):
                    for flags in (0, 16, 32 | 16, 64 | 32 | 16):
                        deed = _record(IN_STEP, **call, flags=flags, spare=number)
                        yield [opened, *begin, deed, _record(STEP)]
    readings = [_record(_functions(fmi)[READ[fmi]], count=1, references=[k]) for k in range(0, 60, 2)]
    yield [opened, *readings, *begin, *readings]
    calls = _functions(fmi)
    enter = [_record(calls[name], values=[0, 0, MILLI], flags=2) for name in ENTER[fmi]]  # stops after 1 ms
    for number in calls.values():
        call = _record(number, count=1, references=[reference["x_c"]], values=[reference["u_m1"]] * 3)
        yield [opened, *enter, call, _record(calls[f"fmi{fmi}ExitInitializationMode"]), _record(STEP)]
    get, load, put = (calls[name] for name in STATE[fmi])
    other = [opened[:1] + bytes([1]) + opened[2:], _record(load, slot=1), _record(put, slot=1), _record(STEP, slot=1)]
    yield [opened, *begin, _record(get), _record(TO_IMAGE), *other, _record(DAMAGE, values=[0, 99, 5]), *other[1:]]
    if fmi == 3 and "n" in reference:
        for count in (0, 1, 4, 5):  # to -1, 0, 3 and 4 links
            size = _record(calls["fmi3SetUInt64"], count=1, references=[reference["n"]], values=[count])
            enter, leave = (_record(calls[f"fmi3{way}ConfigurationMode"]) for way in ("Enter", "Exit"))
            read = _record(calls["fmi3GetUInt64"], count=1, references=[reference["n"]])
            yield [opened, enter, size, read, leave, *readings, *begin, *readings, _record(STEP), _record(AS_NEW)]
            for name, value in itertools.product(
                ("L", "rho_cable", "g", "M_1"), (0, *EXTREMES, MILLI, A_TENTH, TEN, THOUSANDS)
            ):
                if name in reference:
                    change = _record(calls["fmi3SetFloat64"], count=1, references=[reference[name]], values=[value])
                    yield [opened, change, enter, size, leave, *readings[:2], *begin, *readings[:6]]
            yield [opened, enter, size, leave, _record(get), *begin, _record(STEP), _record(put), _record(STEP)]
    if fmi == 2:
        name = "fmi2SetRealInputDerivatives"
        orders = [_record(calls[name], count=1, references=[reference["u_m1"]], values=[k]) for k in range(11)]
        yield [opened, *begin, *orders, _record(STEP)]
    if listens:
        yield [opened, *begin, _record(IN_STEP, flags=32 | 16, values=[ENDLESS]), _record(STEP)]
    for name, value in itertools.product(("u_m1", "M_1", "theta[1]", "omega[1]", "y_m1"), EXTREMES):
        extreme = _record(_functions(fmi)[WRITE[fmi]], count=1, references=[reference[name]], values=[value] * 3)
        yield [opened, extreme, *begin, extreme, *readings[::5], _record(STEP), _record(AS_NEW)]
    yield [opened, *begin, *(_record(deed) for deed in (ROLL_BACK, TO_IMAGE, STEP, DAMAGE, CLOSE))]


def _batches(journeys: Iterable[list[bytes]], size: int) -> Iterator[tuple[list[bytes], ...]]:
    rest = iter(journeys)
    while batch := tuple(itertools.islice(rest, size)):
        yield batch


def _seeds_of_calls(folder: Path, scenes: Path) -> Path:
    """Journeys on every scene, one behind the other in files of a sensible size."""
    folder.mkdir()
    for fmi, cosimulation, scene in itertools.product((2, 3), (0, 1), range(len(list(scenes.iterdir())))):
        (unpacked,) = (scenes.parent / f"scene-{scene}").glob("*-3/")
        description = read_model_description(str(unpacked), validate=False)
        reference = {variable.name: variable.valueReference for variable in description.modelVariables}
        reference |= {f"{name}[1]": reference[name] for name in ("theta", "omega") if name in reference}
        reference |= {name: reference[other] for name, other in _INSTEAD.items() if name not in reference}
        for number, journeys in enumerate(_batches(_journeys(fmi, cosimulation, scene, reference), 8)):
            (folder / f"{fmi}-{cosimulation}-{scene}-{number}").write_bytes(b"".join(itertools.chain(*journeys)))
    return folder


def starts(scenes: Path, folder: Path) -> dict[str, list[Path]]:
    """Fuzzer -> folders of files to begin with: made of the scenes and tables as they are now, and saved."""
    return {"calls": [_seeds_of_calls(folder / "seeds-calls", scenes), SAVED],
            "resource": [_seeds_of_resources(scenes, folder / "seeds-resource")]}  # fmt: skip


def environment(scenes: Path) -> dict[str, str]:
    """In which a fuzzer runs."""
    options = "detect_leaks=1:strict_string_checks=1:allocator_may_return_null=1:max_allocation_size_mb=512"
    return {"PATH": "/usr/bin:/bin", "FUZZ_SCENES": str(scenes), "ASAN_OPTIONS": options,
            "UBSAN_OPTIONS": "print_stacktrace=1"}  # fmt: skip
