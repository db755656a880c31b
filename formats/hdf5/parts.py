"""Datasets in parts: files ``out/part-00000.h5`` ..., and their index ``out.h5`` (docs/reference/hdf5.md).

https://docs.hdfgroup.org/archive/support/HDF5/docNewFeatures/NewFeaturesVirtualDatasetDocs.html
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple, NoReturn

from meshonet.formats.hdf5.index import Failed as Failed
from meshonet.formats.hdf5.index import PartFacts, part_facts, write_index
from meshonet.formats.hdf5.write import Kind, writing
from meshonet.formats.output import whole_file
from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid

_NAME = re.compile(r"part-(\d{5,12})\.h5")  # name of a part's file
State = Literal["missing", "complete", "extended"]


class Input(NamedTuple):
    """The name of an input as the user gave it, and a digest of its content."""

    text: str
    digest: str


class OtherPartsError(InputError):
    """Error: the existing parts do not belong to the dataset that is being made."""


@dataclass(frozen=True)
class PartFiles:
    """The files of a dataset in parts: one file for each part, and an index.

    Parameters
    ----------
    index : path of the index.
    request : digest (`digest_of`) of the settings, which are the same for all parts.
    part_size : number of inputs of each part; the last part may have fewer.
    """

    index: Path
    request: str = ""
    part_size: int = 0

    @property
    def folder(self) -> Path:
        """The folder of the parts, such as ``out`` for the index file ``out.h5``."""
        return self.index.with_suffix("")

    def path(self, number: int) -> Path:
        """Return the path of a part; parts are counted from 0."""
        return self.folder / f"part-{number:05d}.h5"

    def numbers(self) -> list[int]:
        """Return the numbers of the existing parts, in ascending order."""
        if not self.folder.is_dir():
            return []
        names = (_NAME.fullmatch(entry.name) for entry in self.folder.iterdir())
        return sorted(int(match[1]) for match in names if match)

    def check(self, *, skip_existing: bool) -> None:
        """Raise OtherPartsError if `skip_existing` is set and parts were made with other settings."""
        for number in self.numbers()[:1] if skip_existing else ():
            self.facts(number)

    def refuse(self, number: int) -> NoReturn:
        """Raise OtherPartsError because this part already exists."""
        remedy = f"continue with {{skip_existing}}, or remove the parts: rm -r {printable(str(self.folder))}"
        raise OtherPartsError("is there already", remedy, source=printable(str(self.path(number))))

    def facts(self, number: int) -> PartFacts:
        """Return the description of a part. Raises InputError if unreadable or made with other settings."""
        facts = part_facts(self.path(number))
        if facts.request != self.request:
            self._refuse(facts.path, "was made with other options or another size of parts")
        return facts

    def size_there(self) -> int:
        """Return the `part_size` of the existing parts; 0 if there are none."""
        for number in self.numbers()[:1]:
            return part_facts(self.path(number)).part_size
        return 0

    def state(self, number: int, inputs: Sequence[Input]) -> State:
        """Return whether a part of a dataset is ``missing``, is ``complete``, or has to be ``extended``.

        A part has to be extended if there are more `inputs` now, or if a failed input has changed or may
        succeed now. Raises OtherPartsError if the part was made of other inputs or settings, InputError if it
        cannot be read.
        """
        if not self.path(number).exists():
            return "missing"
        facts = self.facts(number)
        if len(facts.inputs) > len(inputs):
            self._refuse(
                facts.path, f"was made of {len(facts.inputs)} inputs, of which {len(inputs)} are left"
            )
        changed = [new for new, digest in zip(inputs, facts.inputs, strict=False) if new.digest != digest]
        mended = {row.text for row in facts.failed}
        for new in changed:
            if new.text not in mended:
                self._refuse(facts.path, f"was not made of {printable(new.text)} as it is now, at this place")
        again = any(row.again for row in facts.failed)
        return "extended" if changed or again or len(inputs) > len(facts.inputs) else "complete"

    def write(
        self, number: int, kind: str, samples: Iterable[Boundary | Grid], inputs: Sequence[Input],
        failed: list[Failed],
    ) -> int:  # fmt: skip
        """Write the part `number` atomically and return its number of samples.

        `failed` lists the failed samples; it may grow while `samples` are read. Raises InputError if the
        samples have different sizes, or if the file cannot be written.
        """
        count = 0
        name: Kind = "meshonet-grid" if kind == "grids" else "meshonet-boundary"
        with whole_file(str(self.path(number)), make_folder=True) as part, writing(part, name) as writer:
            for sample in samples:
                writer.append(sample)
                count += 1
            digests = [each.digest for each in inputs]
            facts = {"request": self.request, "part_size": str(self.part_size)}
            writer.note(facts, digests, list(map(json.dumps, failed)))
        return count

    def build(self) -> int:
        """Write the index of the existing parts and return its number of samples.

        Several processes may do so at the same time. Raises InputError if the parts do not fit together.
        """
        numbers, count = None, 0
        while numbers != (numbers := self.numbers()):
            parts = [part_facts(self.path(number)) for number in numbers]
            count = sum(facts.count for facts in parts)
            if count:
                with whole_file(str(self.index)) as file:
                    write_index(file, self.index, parts)
        return count

    def _refuse(self, path: Path, problem: str) -> NoReturn:
        folder = printable(str(self.folder))
        remedy = f"write to another name, or remove the old parts: rm -r {folder}"
        raise OtherPartsError(problem, remedy, source=printable(str(path)))


def digest_of(*texts: str) -> str:
    """Return the digest of all `texts` together, in hexadecimal digits."""
    return hashlib.sha256("\0".join(texts).encode("utf-8", "surrogateescape")).hexdigest()[:32]
