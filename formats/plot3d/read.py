"""Reads Plot3D grids in any layout, which is recognised by the file's length and its cells."""

from collections.abc import Iterator

from meshonet.formats.format import Options
from meshonet.formats.mesh.structured import FileBlock, grids_of_file
from meshonet.formats.plot3d import binary, is_text, text
from meshonet.formats.plot3d.layouts import best
from meshonet.formats.plot3d.nmf import Map, read_map
from meshonet.formats.source import Source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

_WRITTEN_ONLY = {"span-i", "span-j", "span-k"}  # options that only apply to writing


def read_grids(source: Source, *, options: Options = frozenset()) -> Iterator[Grid]:
    """Yield the grids of a Plot3D file, in the layout that suits its content and `options`.

    Connections and boundary conditions come from a neutral map file next to it, or else from node positions.
    Provenance has the counts of iblank values. Raises InputError: no layout fits; a block without cells.
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
