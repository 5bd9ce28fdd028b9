"""The system compiler's sanitizers and valgrind watch every call of the host, and find what is planted for them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import cablefmu
from cablefmu.fmu.platforms import this_platform
from tests.kernel.library import probe_sources, toolchain
from tests.robustness.building import GCC, compile_with_gcc, copy_of_sources, run

pytestmark = pytest.mark.system

ROOT = Path(__file__).parents[2]

MEMORY = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
THREADS = ("-fsanitize=thread",)
OPTIONS = {
    "ASAN_OPTIONS": "detect_leaks=1:detect_stack_use_after_return=1:strict_string_checks=1",
    "TSAN_OPTIONS": "halt_on_error=1",
}
VALGRIND = ("valgrind", "-q", "--error-exitcode=9", "--leak-check=full", "--show-leak-kinds=all",
            "--errors-for-leak-kinds=all")  # fmt: skip

OUT_OF_BOUNDS = {"fmi/access.c": ("if (reference < instance->resource.variables)",
                                  "if (reference <= instance->resource.variables)")}  # fmt: skip
"""The host asks for the reference behind the last: eight bytes behind the end of a block."""
OUT_OF_ARRAY = {"fmi/access.c": ("if (order < 1 || order > INPUT_ORDERS)", "if (order > INPUT_ORDERS)")}
"""The host gives a derivative of order 0: an index of -1, inside the block, so a case for UBSan alone."""
LEAK = {"fmi/instance.c": ("    free(instance->block);\n    free(instance);\n", "    free(instance);\n")}
RACE = {"fmi/instance.c": ("    Text why;\n    text_start(&why);\n    Instance", "    static Text why;\n"
                           "    text_start(&why);\n    Instance")}  # fmt: skip
"""Two threads that instantiate write one buffer."""


def without_random_addresses() -> tuple[str, ...]:
    """The race detector of this compiler's age has a fixed map of memory, which 32 random bits do not fit into."""
    bits = int(Path("/proc/sys/vm/mmap_rnd_bits").read_text())
    return ("setarch", "-R") if bits > 28 else ()


@pytest.fixture(scope="module")
def memory_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_with_gcc(tmp_path_factory.mktemp("memory") / "host", *MEMORY)


@pytest.fixture(scope="module")
def threads_host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_with_gcc(tmp_path_factory.mktemp("threads") / "host", *THREADS)


@pytest.fixture(scope="module")
def shipped_tour(shipped_host: Path, words: list[str]) -> str:
    return run(shipped_host, "tour", words).stdout


@pytest.mark.parametrize(("task", "number"), [("tour", 0), ("scarce", 0), ("interleaved", 100), ("threads", 8)])
def test_no_error_of_memory_and_nothing_undefined(
    task: str, number: int, memory_host: Path, words: list[str], shipped_tour: str
) -> None:
    result = run(memory_host, task, words, number=number, environment=OPTIONS)
    assert (result.returncode, result.stderr) == (0, "")
    assert task != "tour" or result.stdout == shipped_tour, "another compiler, the same bits"


@pytest.mark.parametrize(("defect", "says"), [
    (OUT_OF_BOUNDS, "AddressSanitizer: heap-buffer-overflow"),
    (OUT_OF_ARRAY, "runtime error: index -1 out of bounds"),
    (LEAK, "LeakSanitizer: detected memory leaks"),
])  # fmt: skip
def test_errors_of_memory_would_be_found(
    defect: dict[str, tuple[str, str]], says: str, tmp_path: Path, words: list[str]
) -> None:
    host = compile_with_gcc(tmp_path / "host", *MEMORY, sources=copy_of_sources(tmp_path, defect))
    result = run(host, "tour", words, environment=OPTIONS)
    assert result.returncode != 0
    assert says in result.stderr


def test_eight_threads_do_not_race(threads_host: Path, words: list[str]) -> None:
    wrapper = without_random_addresses()
    result = run(threads_host, "threads", words, number=8, environment=OPTIONS, wrapper=wrapper)
    assert (result.returncode, result.stderr) == (0, "")


def test_a_race_would_be_found(tmp_path: Path, words: list[str]) -> None:
    host = compile_with_gcc(tmp_path / "host", *THREADS, sources=copy_of_sources(tmp_path, RACE))
    wrapper = without_random_addresses()
    result = run(host, "threads", words, number=8, environment=OPTIONS, wrapper=wrapper)
    assert result.returncode != 0
    assert "ThreadSanitizer: data race" in result.stderr


@pytest.mark.parametrize("task", ["tour", "scarce"])
def test_valgrind_is_clean(task: str, plain_gcc_host: Path, words: list[str], shipped_tour: str) -> None:
    result = run(plain_gcc_host, task, words, wrapper=VALGRIND)
    assert (result.returncode, result.stderr) == (0, "")
    assert task != "tour" or result.stdout == shipped_tour, "another compiler, the same bits"


@pytest.mark.parametrize(("defect", "says"), [(OUT_OF_BOUNDS, "Invalid read of size"), (LEAK, "are definitely lost")])
def test_valgrind_would_find_it(
    defect: dict[str, tuple[str, str]], says: str, tmp_path: Path, words: list[str]
) -> None:
    host = compile_with_gcc(tmp_path / "host", sources=copy_of_sources(tmp_path, defect))
    result = run(host, "tour", words, wrapper=VALGRIND)
    assert result.returncode != 0
    assert says in result.stderr


@pytest.fixture(scope="module")
def under_sanitizers() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Python on these arguments with the sanitizer's library in front; its own leaks are not looked for."""
    asked = subprocess.run(["gcc", "-print-file-name=libasan.so"], capture_output=True, text=True, check=True)
    more = {"LD_PRELOAD": asked.stdout.strip(), "ASAN_OPTIONS": "detect_leaks=0"}

    def start(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *arguments], cwd=ROOT, env={**os.environ, **more, **environment}, timeout=600,
            capture_output=True, text=True,
        )  # fmt: skip

    return start


def compile_sanitized(output: Path, sources: list[Path], *flags: str) -> Path:
    recipe = toolchain()
    command = [*GCC, *MEMORY, "-shared", "-fPIC", *flags, *recipe.STRICT, "-isystem", str(recipe.fmi_headers())]
    subprocess.run([*command, *map(str, sources), "-o", str(output), "-lm"], check=True)
    return output


def test_the_kernels_paces(tmp_path: Path, under_sanitizers: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    """Random cables of every kind through every function, as where the kernel is alone."""
    library = compile_sanitized(tmp_path / "kernel.so", probe_sources())
    result = under_sanitizers("-m", "tests.kernel.exercise", str(library))
    assert (result.returncode, result.stdout) == (0, "done\n"), result.stderr


@pytest.fixture(scope="module")
def sanitized_package(tmp_path_factory: pytest.TempPathFactory) -> Callable[[list[Path]], Path]:
    """sanitized_package(sources): folder of a copy of the package whose FMUs carry a library with sanitizers."""

    def build(sources: list[Path]) -> Path:
        folder = tmp_path_factory.mktemp("package")
        package = shutil.copytree(Path(cablefmu.__file__).parent, folder / "cablefmu")
        library = package / "binaries" / this_platform() / "cable.so"
        compile_sanitized(library, sources, "-fvisibility=hidden")
        return folder

    return build


FMU_TESTS = (
    "-m", "pytest", "-q", "-p", "no:cacheprovider", "--capture=no", "tests/fmi",
    # It leaves no address space, and the sanitizer has none then either; memory runs out in test_memory.py as well.
    "--deselect", "tests/fmi/test_structure.py::test_without_memory_the_cable_keeps_its_links",
)  # fmt: skip


def test_the_fmus_own_tests(
    sanitized_package: Callable[[list[Path]], Path],
    under_sanitizers: Callable[..., subprocess.CompletedProcess[str]],
) -> None:
    """All of tests/fmi: damaged files, wrong values, wrong orders."""
    recipe = toolchain()
    folder = sanitized_package([*recipe.kernel_sources(), *recipe.fmi_sources()])
    result = under_sanitizers(*FMU_TESTS, PYTHONPATH=str(folder))
    assert result.returncode == 0, result.stdout[-3000:] + result.stderr[-3000:]


def test_the_fmus_own_tests_would_find_it(
    sanitized_package: Callable[[list[Path]], Path],
    under_sanitizers: Callable[..., subprocess.CompletedProcess[str]],
    tmp_path: Path,
) -> None:
    """That the sanitized library is the one that they load."""
    folder = sanitized_package(copy_of_sources(tmp_path, OUT_OF_BOUNDS))
    result = under_sanitizers(*FMU_TESTS, PYTHONPATH=str(folder))
    assert result.returncode != 0
    assert "AddressSanitizer: heap-buffer-overflow" in result.stderr
