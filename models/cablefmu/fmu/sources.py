"""sources/: what an FMU's libraries are compiled from, for hosts and processors that none of them is for.

The files of the kernel and of one version's adapter stand there as they are. Whoever compiles them is asked for no
flags and no order: the two files to be compiled, which are written here, include the others. One is everything in one
translation unit, the other the kernel's right-hand side once more, for processors with AVX2. Several FMUs may go into
one program: functions of the API have the prefix that FMI asks for (both standards, "Header files and naming of
functions"), and so has every other name with external linkage. What is static is so in the whole unit, so that no two
files of fmu_src may have the same name for it. FMI's own headers are the importer's.
"""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from xml.etree import ElementTree as ET

__all__ = ["FOLDER", "compiled_files", "sources"]

FOLDER = "sources"

_AVX2 = "kernel/avx2.c"
_PREAMBLE, _NAMES = "fmi/unit.h", "names.h"

# As clang-format leaves them: a definition begins at the margin. VARIANT(name) stands for two [kernel/variant.h].
_FUNCTION = re.compile(r"^(?!static|typedef|return|else)[a-zA-Z_][\w \*]*?[ \*](?:VARIANT\((\w+)\)|(\w+))\(", re.M)
_OBJECT = re.compile(r"^const \w+ (\w+)(?:\[\w*\])? =", re.M)


def compiled_files(identifier: str) -> tuple[str, str]:
    """What of the folder is to be compiled; the FMU's name is in theirs, since archives of objects know no folders."""
    return f"{identifier}.c", f"{identifier}_avx2.c"


def sources(fmi: int, identifier: str) -> dict[str, bytes]:
    """Every file below sources/.

    Parameters
    ----------
    fmi
        2 or 3: the other version's adapter is left out.
    identifier
        The FMU's modelIdentifier.
    """
    held = {name: text for name, text in _package_sources().items() if not name.startswith(f"fmi/fmi{5 - fmi}")}
    units = [name for name in held if name.endswith(".c")]
    # The kernel comes first: one of the adapter's tables has names of a letter each.
    units.sort(key=lambda name: (not name.startswith("kernel/"), name))
    whole, twice = compiled_files(identifier)
    written = {
        _NAMES: _names(identifier, [held[name] for name in units]),
        whole: _unit(
            f"{identifier}: everything in one translation unit, but for {_AVX2}.",
            f"#ifndef FMI{fmi}_FUNCTION_PREFIX\n#define FMI{fmi}_FUNCTION_PREFIX {identifier}_\n#endif\n"
            f'#include "fmi{fmi}Functions.h"\n',
            [name for name in units if name != _AVX2],
        ),
        twice: _unit(f"{identifier}: the right-hand side for processors with AVX2.", "", [_AVX2]),
    }
    if fmi == 3:
        written["buildDescription.xml"] = _build_description(identifier)
    return {name: text.encode() for name, text in {**held, **written}.items()}


@cache
def _package_sources() -> dict[str, str]:
    """The C files that the package carries, by their path below fmu_src."""
    root = files("cablefmu") / "binaries" / FOLDER
    return {
        f"{folder}/{path.name}": path.read_text(encoding="utf-8")
        for folder in ("fmi", "kernel")
        for path in sorted((root / folder).iterdir(), key=lambda path: path.name)
    }


def _unit(title: str, prefix: str, includes: list[str]) -> str:
    lines = "".join(f'#include "{name}"\n' for name in includes)
    head = f"/* {title} Licence: documentation/licenses/license.txt */\n{prefix}"
    return f'{head}#include "{_NAMES}"\n#include "{_PREAMBLE}"\n\n{lines}'


def _names(identifier: str, texts: list[str]) -> str:
    """Another FMU in the same program has these names as well: each gets this one's prefix."""
    found: set[str] = set()
    for text in texts:
        found.update(_OBJECT.findall(text))
        for variant, name in _FUNCTION.findall(text):
            found.update([name] if name else [f"{variant}_portable", f"{variant}_avx2"])
    own = sorted(name for name in found if not re.match("fmi[23][A-Z]", name))
    lines = "".join(f"#define {name} {identifier}_{name}\n" for name in own)
    return f"/* What other cables in the same program have as well. */\n{lines}"


def _build_description(identifier: str) -> str:
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    file_set = ET.SubElement(configuration, "SourceFileSet", language="C11")
    for name in compiled_files(identifier):
        ET.SubElement(file_set, "SourceFile", name=name)
    ET.SubElement(
        file_set, "PreprocessorDefinition", name="FMI3_OVERRIDE_FUNCTION_PREFIX", value="1", optional="true",
        description=f"For libraries that are loaded: no prefix. Without it functions begin with {identifier}_",
    )  # fmt: skip
    ET.indent(root, "  ")
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"
