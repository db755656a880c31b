"""Samples of a dataset as inputs: how many ``FILE.h5#test`` names, and what names some of them."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

from meshonet.formats.hdf5.check import Checked, opened
from meshonet.formats.hdf5.index import shown_parts
from meshonet.formats.hdf5.read import kept_of, rows_of, samples_read
from meshonet.formats.hdf5.write import TEXTS
from meshonet.formats.source import open_source
from meshonet.geometry.arrays import SIDES
from meshonet.geometry.errors import InputError, in_source


@dataclass(frozen=True)
class Samples:
    """Samples of a dataset, of one split or of all: those of the numbers `rows`."""

    name: str
    split: str
    rows: range

    def __len__(self) -> int:
        return len(self.rows)

    def digests(self) -> Iterator[str]:
        """Yield a digest of what is stored of each of these samples."""
        for digest in samples_read(open_source(self.named(0, len(self.rows))), _digest):
            try:
                yield digest()
            except InputError as error:
                yield str(error)

    def named(self, start: int, stop: int, step: int = 1) -> str:
        """Return the input that names every `step`-th of these samples from `start` to `stop`."""
        rows = self.rows[start:stop:step]
        split = f"{self.split}," if self.split else ""
        words = f"{rows[0]}" if len(rows) == 1 else f"{rows.start}:{rows.stop}"
        return f"{self.name}#{split}{words}" + (f":{rows.step}" if len(rows) > 1 and rows.step > 1 else "")


def _digest(data: Checked, k: int) -> str:
    names = [f"blocks/{m}" for m in range(data.blocks)] or [
        name for name in (*SIDES, "nodes") if name in data
    ]
    digest = hashlib.sha256("\0".join(data.text(name, k) for name in TEXTS).encode())
    for name in names:
        digest.update(data.nodes(name, k).tobytes())
    return digest.hexdigest()


def samples_of(text: str) -> Samples:
    """Return the samples that an input names; InputError where it is no dataset, or has none of them."""
    source = open_source(text)
    with in_source(source.name), opened(source) as file:
        parts = shown_parts(file, source)
        kept = Checked(file, source).kept(source.split) if parts is None else kept_of(parts, source.split)
        count = len(rows_of(kept, source))
    name = text.rpartition("#")[0] if source.split or source.rows else text
    rows = range(len(kept))[source.rows] if source.rows else range(count)
    return Samples(name, source.split, rows)
