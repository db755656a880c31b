"""Samples of a dataset as inputs: how many ``FILE.h5#test`` names, and what names some of them."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.formats.hdf5.check import Checked, opened
from meshonet.formats.hdf5.index import shown_parts
from meshonet.formats.hdf5.read import kept_of, rows_of
from meshonet.formats.source import open_source
from meshonet.geometry.errors import in_source


@dataclass(frozen=True)
class Samples:
    """Samples of a dataset, of one split or of all: those of the numbers `rows`."""

    name: str
    split: str
    rows: range

    def __len__(self) -> int:
        return len(self.rows)

    def named(self, start: int, stop: int, step: int = 1) -> str:
        """Return the input that names every `step`-th of these samples from `start` to `stop`."""
        rows = self.rows[start:stop:step]
        split = f"{self.split}," if self.split else ""
        words = f"{rows[0]}" if len(rows) == 1 else f"{rows.start}:{rows.stop}"
        return f"{self.name}#{split}{words}" + (f":{rows.step}" if len(rows) > 1 and rows.step > 1 else "")


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
