"""Writing files so that nothing is lost: a new file is complete before it takes the old one's place."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import OptionError

__all__ = ["check_writable", "is_path", "replacing"]


def is_path(name_or_path: str | Path) -> bool:
    """Whether that is the path of a TOML file, and not the name of something that ships."""
    asked = str(name_or_path)
    return isinstance(name_or_path, Path) or asked.endswith(".toml") or "/" in asked or "\\" in asked


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path beside `path` to write to; it takes `path`'s place when the block ends well.

    Raises
    ------
    OptionError
        If the folder does not exist and cannot be made or is not writable, if `path` is a folder itself, or
        if the disk is full.
    """
    temporary = None
    try:
        check_writable(path)
        handle, name = tempfile.mkstemp(prefix=".cablefmu-", dir=path.parent)
        os.close(handle)
        temporary = Path(name)
        yield temporary
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
        temporary.replace(path)
    except OSError as error:
        raise OptionError(f"{path}: cannot be written ({error.strerror or error})") from None
    finally:
        if temporary is not None:
            temporary.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """Find out before long work whether its result has a place; makes the folder if there is none.

    Raises
    ------
    OptionError
        If `path` is a folder, or its own folder cannot be made or written to.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            raise OptionError(f"{path}: is a folder, a file name is expected")
        with tempfile.NamedTemporaryFile(prefix=".cablefmu-", dir=path.parent):
            pass
    except OSError as error:
        raise OptionError(f"{path}: cannot be written ({error.strerror or error})") from None
