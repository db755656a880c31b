"""Reading HDF5 datasets: boundaries, grids, their parameters, and samples selected in an input's name."""

import hashlib
import json
from bisect import bisect_left
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from operator import call
from typing import Any, NoReturn, TypeVar

from meshonet.formats.hdf5.check import Checked, checked, opened
from meshonet.formats.hdf5.index import Part, shown_parts
from meshonet.formats.hdf5.write import TEXTS
from meshonet.formats.mesh.recover_topology import boundary_of, usable
from meshonet.formats.source import Source, open_source
from meshonet.geometry.arrays import SIDES, Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid, Origin
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.shapes.shape import Shape

T = TypeVar("T")


def read_shapes(source: Source) -> Iterator[Shape]:
    """Return an iterator over the boundaries in a file, or over the outer edges of the grids in it.

    An invalid sample raises InputError; the iterator then continues with the next sample.
    """
    return map(call, samples_read(source, _boundary))


def read_grids(source: Source) -> Iterator[Grid]:
    """Return an iterator over the grids. After an InputError for an invalid grid, `next` gives the others."""
    return map(call, samples_read(source, _grid))


def samples_read(source: Source, read: Callable[[Checked, int], T]) -> Iterator[Callable[[], T]]:
    """Yield for each sample a function that reads it, so that an invalid sample does not end the loop."""
    with opened(source) as file:
        parts = shown_parts(file, source)
        if parts is None:
            data = Checked(file, source)
            _check_holds(data, read)
            yield from (partial(read, data, k) for k in rows_of(data.kept(source.split), source))
            return
    kept = rows_of(kept_of(parts, source.split), source)
    for part in parts:
        own = kept[bisect_left(kept, part.start) : bisect_left(kept, part.stop)]
        if own:
            yield from _samples_of_part(part, own, read)


def _samples_of_part(
    part: Part, kept: Sequence[int], read: Callable[[Checked, int], T]
) -> Iterator[Callable[[], T]]:
    """Yield functions as `samples_read` does; a part that cannot be read gives one."""
    try:
        with in_source(part.source.name), checked(part.source) as data:
            part.check(data)
            _check_holds(data, read)
            named = in_source(part.source.name)(read)
            yield from (partial(named, data, k - part.start) for k in kept)
    except InputError as error:
        yield partial(_raise, error)


def _raise(error: Exception) -> NoReturn:
    raise error


def kept_of(parts: Sequence[Part], split: str) -> Sequence[int]:
    """Return the indices, counted through all parts, of the samples of `split`; all if `split` is ""."""
    if not split:
        return range(parts[-1].stop)
    kept: list[int] = []
    for part in parts:
        with in_source(part.source.name), checked(part.source) as data:
            part.check(data)
            kept += (part.start + k for k in data.kept(split) if k < part.stop - part.start)
    return kept


def rows_of(kept: Sequence[int], source: Source) -> Sequence[int]:
    """Return the sample indices in `kept` that `source.rows` selects. Raises InputError if there are none."""
    if not kept:
        remedy = "mark samples where they are made, by {family} and {split}"
        raise InputError(f"no sample is marked {source.split!r}", remedy)
    taken = kept[source.rows] if source.rows else kept
    if not taken:
        raise InputError(f"has {len(kept)} samples", "number them from 0")
    return taken


def _check_holds(data: Checked, read: Callable[[Checked, int], T]) -> None:
    if read is _grid and "nodes" not in data and not data.blocks:
        remedy = "make grids of them first: meshonet solve-pde IN -o OUT.h5"
        raise InputError("holds boundaries, not grids", remedy)


def _boundary(data: Checked, k: int) -> Shape:
    if data.blocks:
        return boundary_of(_grid(data, k))
    with data.place(k):
        edges: dict[str, Any] = {side: data.sample(side, k) for side in SIDES}
        patches, name, origin = _patches(data, k), data.text("names", k), _origin(data, k)
        return Boundary(**edges, topology=data.topology, patches=patches, name=name, origin=origin)


def _grid(data: Checked, k: int) -> Grid:
    with data.place(k):
        facts = json.loads(data.text("provenance", k) or "{}")
        if not isinstance(facts, dict):
            raise InputError("provenance is not a JSON object", "remove the dataset 'provenance'")
        named = _patches(data, k), data.text("names", k), facts, _origin(data, k)
        if data.blocks:
            blocks = (usable(data.nodes(f"blocks/{m}", k)) for m in range(data.blocks))
            return Grid(tuple(map(Block, blocks)), named[0], data.connections, *named[1:])
        return Grid.from_nodes(usable(data.sample("nodes", k)), data.topology, *named)


def _origin(data: Checked, k: int) -> Origin:
    split, title = data.text("split", k), data.text("titles", k)
    if "parameters" not in data:
        return Origin((), split, title)
    row = data.sample("parameters", k)
    names = data.parameter_names() or tuple(f"parameter {m}" for m in range(len(row)))
    pairs = tuple((name, float(value)) for name, value in zip(names, row, strict=False))
    return Origin(pairs, split, title)


def _patches(data: Checked, k: int) -> tuple[Patch, ...]:
    try:
        return tuple(_patch(*row) for row in json.loads(data.text("parts", k) or "[]"))
    except (ValueError, TypeError, RecursionError):
        problem = "its parts are not a JSON list of [name, side, start, stop]"
        raise InputError(problem, "remove the dataset 'parts'") from None


def _patch(name: str, side: Side, start: int, stop: int, block: int = 0, *more: Any) -> Patch:
    across, kind = more or (None, "other")
    second = (int(across[0]), int(across[1])) if across else None
    return Patch(str(name), side, int(start), int(stop), second, int(block), kind)


@dataclass(frozen=True)
class DatasetSamples:
    """Samples of a dataset; `rows` are their indices among the samples of `split`, or among all samples."""

    name: str
    split: str
    rows: range

    def __len__(self) -> int:
        return len(self.rows)

    def digests(self) -> Iterator[str]:
        """Yield a digest of the data of each sample; for an invalid sample, the text of the error."""
        for digest in samples_read(open_source(self.named(0, len(self.rows))), _digest):
            try:
                yield digest()
            except InputError as error:
                yield str(error)

    def named(self, start: int, stop: int, step: int = 1) -> str:
        """Return one text, such as ``FILE#0:9:2``, for samples `start` to `stop` - 1 in steps of `step`."""
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


def samples_of(text: str) -> DatasetSamples:
    """Return the samples that an input such as ``FILE#0:9`` selects. Raises InputError: no such samples."""
    source = open_source(text)
    with in_source(source.name), opened(source) as file:
        parts = shown_parts(file, source)
        kept = Checked(file, source).kept(source.split) if parts is None else kept_of(parts, source.split)
        count = len(rows_of(kept, source))
    name = text.rpartition("#")[0] if source.split or source.rows else text
    rows = range(len(kept))[source.rows] if source.rows else range(count)
    return DatasetSamples(name, source.split, rows)
