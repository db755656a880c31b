"""HDF5 files on disks that may run full: the library crashes if it cannot write while it closes a file.

Errors are therefore hidden from it, and raised after the file is closed.
"""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import h5py


class _Disc(io.FileIO):
    """The file that HDF5 writes to."""

    error: OSError | None = None

    def readinto(self, buffer: Any) -> int:
        """Read into `buffer`; bytes that were never written are zero."""
        count = super().readinto(buffer) or 0
        buffer[count:] = bytes(len(buffer) - count)
        return len(buffer)

    def write(self, data: Any) -> int:
        """Write all of `data`, or nothing once that has failed."""
        left = memoryview(data)
        while self.error is None and len(left):
            try:
                left = left[super().write(left) :]
            except OSError as error:
                self.error = error
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        """Set the length."""
        if self.error is None:
            try:
                return super().truncate(size)
            except OSError as error:
                self.error = error
        return size or 0


@contextlib.contextmanager
def created(path: Path, *, in_memory: bool = False, **options: Any) -> Iterator[h5py.File]:
    """Return a context with a new HDF5 file; `options` are h5py's. Raises OSError: it cannot be written.

    With `in_memory` the whole file is written at the end, which is faster if it has many objects.
    """
    import h5py

    if in_memory:
        with h5py.File(path.name, "w", driver="core", backing_store=False, **options) as file:
            yield file
            file.flush()
            image = file.id.get_file_image()
        path.write_bytes(image)
        return
    with _Disc(path, "w+") as disc:
        try:
            with h5py.File(disc, "w", **options) as file:
                yield file
        finally:
            if disc.error is not None:
                raise disc.error
