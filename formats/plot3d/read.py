"""Reading Plot3D grids of any layout, which their length and their cells tell."""

from collections.abc import Iterator

from meshonet.formats.format import Options
from meshonet.formats.mesh.structured import FileBlock, grids_of_file
from meshonet.formats.plot3d import binary, is_text, text
from meshonet.formats.plot3d.layouts import best
from meshonet.formats.plot3d.nmf import Map, read_map
from meshonet.formats.source import Source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

_WRITTEN_ONLY = {"span-i", "span-j", "span-k"}
"""Options that say nothing of how a file is read."""


def read_grids(source: Source, *, options: Options = frozenset()) -> Iterator[Grid]:
    """Yield the grids of the blocks, right-handed: those that touch are one, others one each.

    `meshonet.formats.mesh.slices` says which files are grids in the plane; all surface patches of a file in
    space are one grid. Where blocks join, and what their sides are, stands in a neutral map file beside the
    file, or else is found by position; of a plane block alone the topology is recovered from its nodes. Where
    there is an iblank array, the provenance says how many nodes have which value. `options` say what is known
    of the layout.

    Raises InputError where none fits the file's length, or a block has no cells.
    """
    wanted = options - _WRITTEN_ONLY
    if is_text(source.head()):
        every = text.candidates(source.read_bytes(), wanted)
    else:
        every = binary.candidates(memoryview(source.buffer()), wanted)
    fitting = [candidate for candidate in every if wanted <= candidate.traits]
    if not fitting:
        fits = " or ".join(" ".join(sorted(candidate.traits)) for candidate in every[:3])
        problem = f"is not {' '.join(sorted(wanted))}: it fits {fits}"
        raise InputError(problem, "correct or leave out the options")
    reading = best(fitting)
    blocks = []
    for k in reading.blocks:
        place = f"block {k + 1}, read as {reading.numbers}"
        with in_place(place):
            blocks.append(FileBlock(reading.coordinates(k), "", place, reading.iblank(k)))
    beside = source.path.with_suffix(".nmf") if source.path else None
    known = Map([], [])
    if beside is not None and beside.is_file():
        known = read_map(beside, [reading.size(k) for k in reading.blocks])
    yield from grids_of_file(blocks, *known, source.stem)
