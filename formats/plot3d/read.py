"""Reading Plot3D grids of any kind, told apart without being told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NoReturn

from meshonet.formats.mesh.recover_topology import recovered
from meshonet.formats.plot3d import binary, text
from meshonet.formats.plot3d.layouts import Candidate, best
from meshonet.formats.plot3d.sniff import is_text
from meshonet.formats.plot3d.variant import ANY, Variant
from meshonet.formats.source import HEAD_BYTES, Source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def read_grids(source: Source, variant: Variant = ANY) -> Iterator[Grid]:
    """Yield the grid of every block, right-handed, its topology recovered from its nodes.

    Where there is an iblank array, the provenance says how many nodes have which value.

    Parameters
    ----------
    variant : what is known of the layout; the rest is found out.

    Raises
    ------
    InputError
        no layout fits the file's length, or none that is as told; a block is three-dimensional.
    """
    data = source.read_bytes()
    every = text.candidates(data) if is_text(data[:HEAD_BYTES]) else binary.candidates(data)
    asked = variant.for_reading()
    found = best([candidate for candidate in every if asked <= candidate.traits] or _misfit(every, asked))
    blocks = len(found.layout.dims)
    for block in range(blocks):
        name = source.stem if blocks == 1 else f"{source.stem}-{block + 1}"
        try:
            grid = recovered(found.plane(block), name)
            flags = found.iblank(block)
            yield replace(grid, provenance={"iblank": flags}) if flags else grid
        except InputError as error:
            error.place = error.place or f"block {block + 1}, read as {found.told}"
            raise


def _misfit(every: list[Candidate], asked: frozenset[str]) -> NoReturn:
    fitting = " or ".join(" ".join(sorted(candidate.traits)) for candidate in every[:3])
    raise InputError(
        f"is not {' '.join(sorted(asked))}: it fits {fitting}",
        "correct or leave out the words of the variant",
    )
