"""Atomic writing: an output file appears complete or not at all, even if the program is stopped."""

import contextlib
import errno
import functools
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError

PART_SUFFIX = ".meshonet-part"
"""Extension of unfinished files, by which a file left by a killed process is recognised and removed."""

_PART = re.compile(
    rf"\.(?P<final>.*)\.(?P<machine>[0-9a-f]*-\d*)-(?P<process>\d+)-[0-9a-f]{{8}}{re.escape(PART_SUFFIX)}"
)
"""Name of an unfinished file: the name of the finished file, the machine, and the process that writes it."""
_swept: set[Path] = set()
_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS}  # errors of a disk that is full or read-only


@contextlib.contextmanager
def whole_file(destination: str, *, make_folder: bool = False, beside: bool = False) -> Iterator[Path]:
    """Return a context with the path of a temporary file, which becomes `destination` if the block succeeds.

    The temporary file is in the folder of the destination and is renamed in one step. If the destination is
    ``-`` (standard output), a device or a pipe, the content is copied at the end. After any exception the
    temporary file is removed and the destination is unchanged. `make_folder` makes a missing folder. With
    `beside`, other files are written next to the destination, which therefore must not be a stream. Raises
    InputError if the destination is a folder, if its folder is missing or read-only, or if the disk is full.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     with whole_file(f"{folder}/a.txt") as path:
    ...         _ = path.write_text("whole")
    ...     os.listdir(folder)
    ['a.txt']
    """
    name = printable(destination)
    with _naming(name):
        place = Path(destination)
        stream = destination == "-" or (place.exists() and not place.is_file() and not place.is_dir())
        if stream and beside:
            raise InputError("is a stream, and a folder is to be written", "name a file", source=name)
        if stream:
            import tempfile

            part = Path(tempfile.gettempdir(), os.urandom(8).hex() + PART_SUFFIX)
        else:
            target = Path(os.path.realpath(destination))
            if make_folder and not target.is_dir():
                target.parent.mkdir(parents=True, exist_ok=True)
            check_place(place, name)
            _sweep(target.parent)
            part = _part_name(target)
    try:
        with _naming(name):
            # not by tempfile, so that the permissions are those of the umask as for any new file; within the
            # block, since a signal that comes while the system makes it is raised right behind this line
            os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600 if stream else 0o666))
        with _naming(name, _FULL):
            yield part
        with _naming(name):
            if stream:
                _copy_out(part, destination)
            else:
                part.replace(target)
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def whole_folder(target: Path) -> Iterator[Path]:
    """Return a context with an empty folder, which replaces `target` when the context ends.

    After any exception the new folder is removed and `target` is unchanged.
    """
    _sweep(target.parent)
    part = _part_name(target)
    try:
        part.mkdir()
        yield part
        if not target.is_dir():
            part.rename(target)
        elif not _swapped(part, target):
            old = _part_name(target)
            target.rename(old)
            part.rename(target)
            _remove(old)
    finally:
        _remove(part)


def _swapped(first: Path, second: Path) -> bool:
    """Exchange two paths in one step; return whether the system supports it."""
    import ctypes

    here, exchange = -100, 2  # AT_FDCWD, RENAME_EXCHANGE of linux/fs.h
    rename = getattr(ctypes.CDLL(None), "renameat2", None)
    return rename is not None and rename(here, os.fsencode(first), here, os.fsencode(second), exchange) == 0


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        import shutil

        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


@contextlib.contextmanager
def _naming(name: str, only: set[int] | None = None) -> Iterator[None]:
    """Return a context in which errors of the system (those in `only`) become errors of `name`."""
    try:
        yield
    except OSError as error:
        short = error.errno is None and "requested and" in str(error)  # numpy's word for a disc that is full
        if only is not None and error.errno not in only and not short:
            raise
        why = error.strerror or str(error)
        remedy = "free space or choose another place"
        raise InputError(f"cannot be written ({why})", remedy, source=name) from error


def final_name(part: Path) -> str:
    """Return the name that the file at the temporary path `part` will get; for another path, its name."""
    match = _PART.fullmatch(part.name)
    return match["final"] if match else part.name


def check_place(destination: Path, name: str) -> None:
    """Raise InputError, with `name`, if `destination` is a folder or its folder does not exist."""
    target = Path(os.path.realpath(destination))
    if target.is_dir():
        raise InputError("is a folder", "name a file in it", source=name)
    if not target.parent.is_dir():
        remedy = f"make it: mkdir -p {printable(str(destination.parent))}"
        raise InputError("its folder does not exist", remedy, source=name)


def _part_name(target: Path) -> Path:
    own = f"{_machine()}-{os.getpid()}-{os.urandom(4).hex()}"
    return target.with_name(f".{target.name[:150]}.{own}{PART_SUFFIX}")


@functools.cache
def _machine() -> str:
    """Return an identifier of boot and process namespace; process numbers are unique within it.

    Host names do not suffice: containers, and machines with a common disk, may share them. Empty except on
    Linux.
    """
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip().replace("-", "")
        return f"{boot}-{Path('/proc/self/ns/pid').stat().st_ino}"
    except OSError:
        return "-"


def _sweep(folder: Path) -> None:
    """Remove, once, the unfinished files in `folder` of killed processes of this machine."""
    if folder in _swept or _machine() == "-":
        return
    _swept.add(folder)
    with contextlib.suppress(OSError):  # a folder that may be written but not listed stays as it is
        for entry in folder.iterdir():
            match = _PART.fullmatch(entry.name)
            if match and match["machine"] == _machine() and not _alive(int(match["process"])):
                _remove(entry)


def _alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        pass
    return True


def _copy_out(part: Path, destination: str) -> None:
    import shutil

    with part.open("rb") as finished:
        if destination != "-":
            with Path(destination).open("wb") as stream:
                shutil.copyfileobj(finished, stream)
            return
        try:
            shutil.copyfileobj(finished, sys.stdout.buffer)
            sys.stdout.buffer.flush()
        except BrokenPipeError:
            # the reader (head, say) had enough; the interpreter's own flush at exit must not complain either
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
