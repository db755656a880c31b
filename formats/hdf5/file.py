"""HDF5 files being made on discs that may run full.

The HDF5 library cannot close a file that it failed to write to: it tries again when the program ends, and
crashes there. So a failure is kept from it, what it still writes is dropped, and the error is raised when it
is done.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import h5py


class _Disc:
    """The file that HDF5 writes to, as it wants Python's files to be.

    Parameters
    ----------
    path : file to make.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b", buffering=0)
        self.error: OSError | None = None

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the place."""
        return self._file.tell()

    def read(self, count: int = -1) -> bytes:
        """Read; h5py knows files by this and uses `readinto`."""
        return self._file.read(count) or b""

    def readinto(self, buffer: memoryview) -> int:
        """Read; what was never written is zero."""
        count = self._file.readinto(buffer) or 0
        buffer[count:] = bytes(len(buffer) - count)
        return len(buffer)

    def write(self, data: memoryview) -> int:
        """Write all of `data`, or nothing once that has failed."""
        left = memoryview(data)
        while self.error is None and len(left):
            try:
                left = left[self._file.write(left) :]
            except OSError as error:
                self.error = error
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        """Set the length."""
        if self.error is None:
            try:
                return self._file.truncate(size)
            except OSError as error:
                self.error = error
        return size or 0

    def flush(self) -> None:
        """Do nothing: nothing is held back."""

    def close(self) -> None:
        """Close the file and raise what went wrong."""
        try:
            self._file.close()
        except OSError as error:
            self.error = self.error or error
        if self.error is not None:
            raise self.error


@contextlib.contextmanager
def created(path: Path, **options: Any) -> Iterator[h5py.File]:
    """Give a new HDF5 file; `options` go to h5py.

    Raises OSError: the disc is full, or another failure to write.
    """
    import h5py

    disc = _Disc(path)
    try:
        with h5py.File(disc, "w", **options) as file:
            yield file
    finally:
        disc.close()
