"""The index of a dataset in parts: an HDF5 file of virtual datasets over all parts, written and read."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from meshonet.formats.format import size_remedy
from meshonet.formats.hdf5.check import Checked, check_heaps, opened, own
from meshonet.formats.hdf5.file import created
from meshonet.formats.source import Source, printable
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    import h5py


OF_PARTS = ("request", "part_size", "size", "common")  # attributes of parts that the index does not have
_AGAIN = "repeat the command that made it, with {skip_existing}"  # remedy for parts that do not fit the index


class Failed(NamedTuple):
    """A sample that could not be made: input, name, error, and whether it may succeed if tried again."""

    text: str
    member: str
    error: str
    again: bool


@dataclass
class PartFacts:
    """Description of a part of a dataset: one of the HDF5 files that together form it.

    `size` states node counts and topology in words; all parts have the same. `columns` has length, row shape
    and type of each array in the file. `common` has digests of the provenance entries that all grids share.
    """

    path: Path
    request: str = ""
    size: str = ""
    part_size: int = 0
    count: int = 0
    inputs: list[str] = field(default_factory=list)
    failed: list[Failed] = field(default_factory=list)
    columns: dict[str, tuple[int, tuple[int, ...], Any]] = field(default_factory=dict)
    parameter_names: Any = None
    common: dict[str, str] = field(default_factory=dict)


def part_facts(path: Path) -> PartFacts:
    """Return the description of a dataset's part from its file. Raises InputError if it cannot be read."""
    facts = PartFacts(path)
    source = Source(printable(str(path)), path=path)
    with opened(source, texts=False) as file:
        facts.request, facts.size = _fixed(file, "request"), _fixed(file, "size")
        common = json.loads(_fixed(file, "common") or "{}")
        facts.common = common if isinstance(common, dict) else {}
        digits = _fixed(file, "part_size")
        facts.part_size = int(digits) if digits.isascii() and digits.isdigit() and len(digits) < 10 else 0
        for name, data in _datasets(file):
            facts.columns[name] = len(data), data.shape[1:], data.dtype
        if facts.columns.pop("inputs", None):
            facts.inputs = [digest.decode("ascii") for digest in file["inputs"][()]]
        if "failed" in facts.columns:
            check_heaps(source)
            facts.failed = [Failed(*json.loads(text)) for text in file["failed"].asstr()[()]]
        facts.count = facts.columns.get("south", facts.columns.get("blocks/0", (0,)))[0]
        if "parameters" in facts.columns:
            facts.parameter_names = file["parameters"].attrs.get("names")
    return facts


def _fixed(file: h5py.File, name: str) -> str:
    """Return an attribute that is a text of fixed length, an empty text for any other attribute."""
    kind = file.attrs.get_id(name).dtype.kind if name in file.attrs else ""
    return bytes(file.attrs[name]).decode("utf-8", "replace") if kind == "S" else ""


def _datasets(file: h5py.File) -> Iterator[tuple[str, h5py.Dataset]]:
    import h5py

    for name, data in file.items():
        if isinstance(data, h5py.Group):
            yield from ((f"{name}/{key}", each) for key, each in data.items())
        else:
            yield name, data


@dataclass(frozen=True)
class Part:
    """A part of a dataset: samples `start` to `stop` - 1 of the index."""

    source: Source
    start: int
    stop: int

    def check(self, data: Checked) -> None:
        """Raise InputError if the part contains fewer samples than the index says."""
        shown = self.stop - self.start
        if data.count < shown:
            raise InputError(f"holds {data.count} samples, where the index shows {shown}", _AGAIN)


def shown_parts(file: h5py.File, source: Source) -> list[Part] | None:
    """Return the parts of a dataset in order, or None if the open `file` is no index of parts.

    Raises InputError: a part that is missing or not in a folder beside the index; samples that no part has.
    """
    import h5py

    main = own(file, "south") or own(file, "blocks/0")
    if not isinstance(main, h5py.Dataset) or not main.is_virtual:
        return None
    if source.path is None:
        problem = "shows parts in other files, which cannot be reached from here"
        raise InputError(problem, "name the file, and have its parts beside it")
    parts = list(_parts(main.id.get_create_plist(), source.path, source.split))
    missing = [part.source for part in parts if part.source.path and not part.source.path.is_file()]
    if missing:
        verb = "are" if len(missing) > 2 else "is"
        more = f", as {verb} {len(missing) - 1} more of {len(parts)}" if len(missing) > 1 else ""
        raise InputError(f"its part {missing[0].name} is missing{more}", f"put it back, or {_AGAIN}")
    return parts


def _parts(mappings: Any, index: Path, split: str) -> Iterator[Part]:
    """Yield the parts that the mappings of a virtual dataset show."""
    from h5py import h5s

    start = 0
    for k in range(mappings.get_virtual_count()):
        low, high = mappings.get_virtual_vspace(k).get_select_bounds()
        of_part = mappings.get_virtual_srcspace(k)
        first = () if of_part.get_select_type() == h5s.SEL_ALL else of_part.get_select_bounds()[0]
        name = Path(mappings.get_virtual_filename(k).replace("%%", "%"))
        path = index.parent / name
        if name.is_absolute() or ".." in name.parts or len(name.parts) != 2:
            problem = f"shows {printable(str(name))}, which is not in a folder beside it"
            raise InputError(problem, "keep parts as out/part-00000.h5 beside out.h5")
        if low[0] != start or any(low[1:]) or any(first):
            raise InputError("shows rows that are not one after the other", _AGAIN)
        start = int(high[0]) + 1
        yield Part(Source(printable(str(path)), path=path, split=split), int(low[0]), start)


def write_index(file: Path, index: Path, parts: Sequence[PartFacts]) -> None:
    """Write to `file` the index of all `parts`; the caller then moves this file to the path `index`.

    Raises InputError: parts that were made with different options, or differ in node counts or topology.
    """
    filled = [facts for facts in parts if facts.count]
    first = filled[0]
    for facts in filled[1:]:
        _check_same(facts, first)
    columns = {name: column for facts in reversed(parts) for name, column in facts.columns.items()}
    with opened(Source(printable(str(first.path)), path=first.path)) as model:
        attributes = dict(model.attrs)
    shared = set.intersection(*(set(facts.common.items()) for facts in filled))
    left = {*OF_PARTS, *first.common}.difference(name for name, _ in shared)
    with created(file) as made:
        made.attrs.update({name: value for name, value in attributes.items() if name not in left})
        for name, (_, row, kind) in sorted(columns.items()):
            _add_column(made, name, row, kind, parts, index.parent)
        if first.parameter_names is not None:
            made["parameters"].attrs["names"] = first.parameter_names


def _check_same(facts: PartFacts, first: PartFacts) -> None:
    problem, remedy = "", "remove it and make it again"
    if facts.request != first.request:
        problem = "was made with other options"
    elif facts.size != first.size:
        problem = f"holds {facts.size}, and {first.path.name} {first.size}"
        remedy = f"one dataset has one size and topology: {size_remedy(facts.size, first.size)}"
    if problem:
        raise InputError(problem, remedy, source=printable(str(facts.path)))


def _add_column(
    made: h5py.File, name: str, row: tuple[int, ...], kind: Any, parts: Sequence[PartFacts], folder: Path
) -> None:
    """Add the virtual dataset `name` over all `parts`; parts without it have empty or NaN rows."""
    import h5py

    ends = [facts.columns.get(name, (0,))[0] if name == "failed" else facts.count for facts in parts]
    layout = h5py.VirtualLayout((sum(ends), *row), kind)
    start = 0
    for facts, rows in zip(parts, ends, strict=True):
        length = min(facts.columns.get(name, (0,))[0], rows)
        if length:
            path = str(facts.path.relative_to(folder)).replace("%", "%%")  # which HDF5 takes for a pattern
            layout[start : start + length] = h5py.VirtualSource(path, name, (length, *row), kind)
        start += rows
    made.create_virtual_dataset(
        name, layout, fillvalue=None if h5py.check_string_dtype(kind) else float("nan")
    )
