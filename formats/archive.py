"""Members of zip archives, read one by one; nothing is unpacked to disk.

https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from zipfile import ZipFile

LARGEST_MEMBER = 1 << 28  # largest uncompressed size of a member, in bytes
_IN_ARCHIVE = re.compile(r"\.zip/", re.IGNORECASE)
"""Pattern that finds the end of the archive's name in a path, where the name of a member begins."""


def member_names(path: str) -> Iterator[str]:
    """Return the sorted names of the files in a zip archive. Raises InputError if it is unreadable."""
    return iter(sorted(name for name in _archive(path).NameToInfo if not name.endswith("/")))


def split_member(text: str) -> tuple[str, str] | None:
    """Return archive and file of a path such as ``a.zip/b/c.dat``; None if no archive is in the path."""
    for match in _IN_ARCHIVE.finditer(text):
        if Path(text[: match.end() - 1]).is_file():
            return text[: match.end() - 1], text[match.end() :]
    return None


def read_member(path: str, name: str) -> bytes:
    """Return the uncompressed bytes of the file `name` in a zip archive.

    Raises InputError if it is missing, encrypted, damaged, too large or packed by an unknown method.
    """
    archive = _archive(path)
    info = archive.NameToInfo.get(name)
    if info is None:
        raise InputError("no such file in the archive", "list it: unzip -l")
    if info.file_size > LARGEST_MEMBER:
        problem = f"claims {info.file_size} bytes, more than {LARGEST_MEMBER}"
        raise InputError(problem, "unpack it")
    try:
        return archive.read(info)
    except (RuntimeError, NotImplementedError) as error:  # encrypted; packed in a way that is not known
        raise InputError(f"cannot be unpacked ({error})", "unpack it") from error
    except Exception as error:  # whatever zipfile and its decompressors make of damaged bytes
        problem = f"is damaged ({error or type(error).__name__})"
        raise InputError(problem, "make the archive again") from error


def _archive(path: str) -> ZipFile:
    state = Path(path).stat()
    return _opened(path, (state.st_ino, state.st_mtime_ns, state.st_size))


@lru_cache(maxsize=2)  # the table of members is read once for all of them
def _opened(path: str, state: tuple[int, int, int]) -> ZipFile:  # noqa: ARG001  (so that a changed one is read)
    from zipfile import BadZipFile, ZipFile

    try:
        return ZipFile(path)
    except OSError as error:
        problem = f"cannot be read ({error.strerror or error})"
        raise InputError(problem, "check its permissions") from error
    except (BadZipFile, NotImplementedError, ValueError, UnicodeError) as error:
        raise InputError(f"is no zip archive ({error})", "make it again") from error
