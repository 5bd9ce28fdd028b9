"""What FMUs can do and what they ask of their hosts, read from the files, for docs/capabilities.md and the README.

    python -m tests.benchmarks.capabilities cablefmu=x.fmu,x-fmi3.fmu other=y.fmu    prints both tables
    python -m tests.benchmarks.capabilities                                          renews our column in both

A column is a label and files of one maker, of one FMI version each; a file is an archive, or a modelDescription.xml
where there is nothing else. Nothing is loaded or run. What the standard lets out counts as its default.
"""

from __future__ import annotations

import re
import struct
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree as ET

from cablefmu.fmu.archive import build_fmu

__all__ = ["PAGES", "column", "markdown", "needed_libraries", "our_column", "updated", "written_column"]

_INTERFACES = {"ModelExchange": "ME", "CoSimulation": "CS", "ScheduledExecution": "SE"}
_UNKNOWN = "not known"
"""Of an archive's content where only its description was at hand."""


@dataclass(frozen=True)
class Fmu:
    """One file, read."""

    version: int
    description: ET.Element
    archive: dict[str, bytes] | None

    @classmethod
    def read(cls, path: Path) -> Fmu:
        archive = None
        if path.suffix == ".fmu":
            with zipfile.ZipFile(path) as file:
                archive = {name: file.read(name) for name in file.namelist()}
        root = ET.fromstring(archive["modelDescription.xml"] if archive else path.read_bytes())
        return cls(int(root.attrib["fmiVersion"].split(".")[0]), root, archive)

    @property
    def interfaces(self) -> list[ET.Element]:
        return [element for element in self.description if element.tag in _INTERFACES]

    def each(self, attribute: str, default: str, only: str = "") -> str:
        """One attribute of all interfaces (or of one): "yes", "no", a number, or by interface where they differ."""
        values = {
            _INTERFACES[element.tag]: _plain(element.get(attribute, default))
            for element in self.interfaces
            if element.tag == (only or element.tag)
        }
        if len(set(values.values())) == 1:
            return next(iter(values.values()))
        return ", ".join(f"{value} ({interface})" for interface, value in values.items()) or "–"

    def has(self, *names: str) -> str:
        """Whether the archive holds one of these members."""
        if self.archive is None:
            return _UNKNOWN
        return _plain(str(any(name in self.archive for name in names)).lower())


def _plain(value: str) -> str:
    return {"true": "yes", "false": "no"}.get(value, value)


Fact = Callable[[Fmu], str | None]
"""What a cell says of one FMU; None where its version of FMI knows nothing of the kind."""


def _flag(two: str | None, three: str | None, *, only: str = "", default: str = "false") -> Fact:
    """An attribute by its names in FMI 2 and FMI 3."""

    def fact(fmu: Fmu) -> str | None:
        name = two if fmu.version == 2 else three
        return None if name is None else fmu.each(name, default, only)

    return fact


def _libraries(fmu: Fmu) -> str:
    if fmu.archive is None:
        return _UNKNOWN
    names = {
        library for name, content in fmu.archive.items() if _is_linux(name) for library in needed_libraries(content)
    }
    return ", ".join(sorted(library.partition(".so")[0] for library in names)) or "none"


def _is_linux(name: str) -> bool:
    return name.startswith(("binaries/linux64/", "binaries/x86_64-linux/")) and name.endswith(".so")


def _python(fmu: Fmu) -> str:
    if fmu.archive is None:
        return _UNKNOWN
    return _plain(str(any(name.startswith("resources/") and name.endswith(".py") for name in fmu.archive)).lower())


def _platforms(fmu: Fmu) -> str:
    if fmu.archive is None:
        return _UNKNOWN
    named = {"linux64": "x86_64-linux", "win64": "x86_64-windows", "win32": "x86-windows", "linux32": "x86-linux"}
    folders = {name.split("/")[1] for name in fmu.archive if name.startswith("binaries/") and name.count("/") == 2}
    found = {named.get(folder, folder) for folder in folders if folder}
    return ", ".join(sorted(found)) or "none"


_CS = "CoSimulation"
ROWS: dict[str, Fact] = {
    "FMI": lambda fmu: f"{fmu.version}.0",
    "interfaces": lambda fmu: " + ".join(_INTERFACES[element.tag] for element in fmu.interfaces),
    "state: get and set": _flag("canGetAndSetFMUstate", "canGetAndSetFMUState"),
    "state: serialise": _flag("canSerializeFMUstate", "canSerializeFMUState"),
    "directional derivatives": _flag("providesDirectionalDerivative", "providesDirectionalDerivatives"),
    "adjoint derivatives": _flag(None, "providesAdjointDerivatives"),
    "communication step may vary": _flag(*2 * ("canHandleVariableCommunicationStepSize",), only=_CS),
    "input derivatives": _flag("canInterpolateInputs", None, only=_CS),
    "output derivatives, order": _flag(*2 * ("maxOutputDerivativeOrder",), only=_CS, default="0"),
    "intermediate update": _flag(None, "providesIntermediateUpdate", only=_CS),
    "early return of its own": _flag(None, "mightReturnEarlyFromDoStep", only=_CS),
    "early return on request": _flag(None, "canReturnEarlyAfterIntermediateUpdate", only=_CS),
    "event mode": _flag(None, "hasEventMode", only=_CS),
    "one instance per process only": _flag(*2 * ("canBeInstantiatedOnlyOncePerProcess",)),
    "needs a tool on the host": _flag(*2 * ("needsExecutionTool",)),
    "Python code inside": _python,
    "libraries it asks for (Linux)": _libraries,
    "binaries for": _platforms,
    "terminals": lambda fmu: fmu.has("terminalsAndIcons/terminalsAndIcons.xml"),
    "icon": lambda fmu: fmu.has("terminalsAndIcons/icon.png", "model.png"),
    "documentation page": lambda fmu: fmu.has("documentation/index.html", "documentation/_main.html"),
}
"""Every row of the table."""

SHORT = (
    "FMI", "interfaces", "state: get and set", "state: serialise", "directional derivatives", "adjoint derivatives",
    "input derivatives", "output derivatives, order", "intermediate update", "early return on request",
    "one instance per process only", "needs a tool on the host", "libraries it asks for (Linux)", "documentation page",
)  # fmt: skip
"""The rows of the README."""


def column(paths: Sequence[Path]) -> dict[str, str]:
    """Every row's cell for the files of one maker.

    Parameters
    ----------
    paths
        Files of different FMI versions; where these differ a cell says which has what.
    """
    fmus = sorted((Fmu.read(path) for path in paths), key=lambda fmu: fmu.version)
    return {name: _joined([(fmu.version, fact(fmu)) for fmu in fmus], name) for name, fact in ROWS.items()}


def _joined(cells: list[tuple[int, str | None]], name: str) -> str:
    known = {version: cell for version, cell in cells if cell is not None}
    if name == "FMI":
        return ", ".join(known.values())
    if len(set(known.values())) <= 1:
        return next(iter(known.values()), "–")
    return ", ".join(f"{cell} (FMI {version})" for version, cell in known.items())


def markdown(columns: dict[str, dict[str, str]], rows: Sequence[str] = tuple(ROWS)) -> str:
    """The table, a line per row."""
    lines = [["", *columns], ["---"] * (len(columns) + 1)]
    lines += [[name, *(cells[name] for cells in columns.values())] for name in rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def needed_libraries(elf: bytes) -> list[str]:
    """DT_NEEDED of a 64-bit little-endian ELF library, in their order."""
    if elf[:6] != b"\x7fELF\x02\x01":
        raise ValueError("a 64-bit little-endian ELF file is expected")
    headers = list(_program_headers(elf))
    entries = [
        struct.unpack_from("<qQ", elf, offset + k)
        for kind, offset, _, size in headers
        if kind == 2  # PT_DYNAMIC
        for k in range(0, size, 16)
    ]
    (strings,) = (value for tag, value in entries if tag == 5)  # DT_STRTAB, an address
    # PT_LOAD tells where an address stands in the file.
    (base,) = (strings - at + offset for kind, offset, at, size in headers if kind == 1 and at <= strings < at + size)
    return [elf[base + value : elf.index(0, base + value)].decode() for tag, value in entries if tag == 1]  # DT_NEEDED


def _program_headers(elf: bytes) -> Iterator[tuple[int, int, int, int]]:
    """Kind, offset in the file, address and size of each segment."""
    (start,) = struct.unpack_from("<Q", elf, 32)
    size, count = struct.unpack_from("<HH", elf, 54)
    for k in range(count):
        kind, _, offset, address, _, length = struct.unpack_from("<IIQQQQ", elf, start + k * size)
        yield kind, offset, address, length


OURS = "cablefmu"
ROOT = Path(__file__).parents[2]
PAGES = {ROOT / "docs" / "capabilities.md": tuple(ROWS), ROOT / "README.md": SHORT}
"""Where a table stands, and with which rows."""


def our_column() -> dict[str, str]:
    """Of a scene's FMUs as they are built now."""
    with tempfile.TemporaryDirectory() as folder:
        return column([build_fmu("free-60-water", Path(folder) / f"{fmi}.fmu", fmi=fmi) for fmi in (2, 3)])


def written_column(text: str) -> dict[str, str]:
    """Our column as a page has it, by rows.

    Raises
    ------
    ValueError
        If the page has no such table, or several.
    """
    (table,) = _TABLE.findall(text)
    rows = [line.split("|") for line in table.splitlines()[2:]]
    return {row[1].strip(): row[2].strip() for row in rows}


_TABLE = re.compile(rf"^\|  ?\| {OURS} \|.*\n(?:\|.*\n)+", re.MULTILINE)


def updated(text: str, cells: dict[str, str]) -> str:
    """The page with our column anew; what else is in its table stays."""

    def line(found: re.Match[str]) -> str:
        return f"| {found[1]} | {cells[found[1]]} |" if found[1] in cells else found[0]

    return _TABLE.sub(lambda table: re.sub(r"^\| (.*?) \| .*? \|", line, table[0], flags=re.MULTILINE), text)


def main(arguments: Sequence[str]) -> None:
    if not arguments:
        cells = our_column()
        for page in PAGES:
            page.write_text(updated(page.read_text("utf-8"), cells), encoding="utf-8")
        return
    columns = {}
    for argument in arguments:
        label, _, files = argument.partition("=")
        columns[label] = column([Path(file) for file in files.split(",")])
    for rows in PAGES.values():
        print(markdown(columns, rows))


if __name__ == "__main__":
    main(sys.argv[1:])
