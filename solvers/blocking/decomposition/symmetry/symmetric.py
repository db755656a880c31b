"""Symmetric blocks of symmetric domains, used if they are about as good as asymmetric blocks.

If the quads are symmetric, each node moves to the mean of itself and its images. If only the blocks are
symmetric, the counts of cells are made equal first. Otherwise the blocks of a part are mirrored or rotated.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Bools, distinct
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.ties import less
from meshonet.kernels._native import joined_classes
from meshonet.solvers.blocking.decomposition.collapse.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.decomposition.collapse.collapse import is_conforming
from meshonet.solvers.blocking.decomposition.quads.padding import wrong_count
from meshonet.solvers.blocking.decomposition.symmetry.images import Images, agree, images_of, made_symmetric
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror, mirrors_of
from meshonet.solvers.blocking.decomposition.symmetry.parts import DomainPart, part_of, sector_of, with_copies
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import refine

WORTH = 2.0  # largest increase of the score without prices (degrees) that symmetric blocks may have
AT_CENTRE = 6  # largest number of quads around the centre of mirrors, or the number of mirrors if larger
EVEN = 4  # number of cells along the sides of all blocks in the search for images
FindPart = Callable[[DomainPart], QuadMesh]  # returns the mesh of a part of a domain
Optimised = Callable[[QuadMesh], QuadMesh]
Way = Callable[[], QuadMesh]  # returns a mesh that may be symmetric
Score = Callable[[BaseComplex, bool], float]
"""Returns the score of blocks, with or without the price of their number; lower is better."""


def symmetric_blocks(
    blocks: BaseComplex, find: FindPart, optimised: Optimised, score: Score,
    unsized: Callable[[], QuadMesh] | None = None, worth: float = WORTH,
) -> BaseComplex:  # fmt: skip
    """Return symmetric blocks of the domain of `blocks`, or `blocks` if symmetric blocks are clearly worse.

    A lower `score` is better; that of symmetric blocks may be higher by `worth`. If `blocks` are symmetric,
    they are kept, unless mirroring a part of the domain gives better blocks, and not more of them. `find`
    returns the mesh of such a part. `unsized` returns a mesh without prescribed cell lengths, tried last.
    """
    mesh, every = blocks.mesh, mirrors_of(blocks.mesh.domain)
    pair = every[:1] if len(every) % 2 else every[:: max(len(every) // 2, 1)]
    most = score(blocks, False) + worth

    def best(ways: Sequence[Way], mirrors: Sequence[Mirror], enough: int = 0) -> BaseComplex | None:
        """Return the best blocks that the `ways` give; None if none are about as good as the given blocks.

        If one of the first `enough` ways succeeds, later ways are not tried; `enough` = 0 tries all.
        """
        least = None
        for number, way in enumerate(ways):
            if least is not None and 0 < enough <= number:
                break
            trial = _trial(way, mirrors, optimised)
            if trial is None or not less(score(trial, False), most):
                continue
            fewer = least is None or not enough or len(trial.blocks) <= len(least.blocks)
            if fewer and (least is None or less(score(trial, True), score(least, True))):
                least = trial
        return least

    def in_sectors(mirrors: Sequence[Mirror]) -> list[Way]:
        return [partial(_of_sector, mesh.domain, mirrors, k, find, optimised, score) for k in (0, 1)]

    alike = unsized is None
    if len(every) == 3 or len(every) > 4:
        symmetric = best([lambda: mesh, *in_sectors(every)], every)
        if symmetric:
            return symmetric
    irregular = wrong_count(mesh).any() or (mesh.irregular & ~mesh.wall_nodes).any()
    for group in [pair, pair[:1], pair[1:]][: (0, 1, 3)[len(pair)]]:
        ways: list[Way] = [
            lambda: mesh,
            partial(_of_part, mesh.domain, group, find),
            partial(_recounted, blocks, group, optimised, alike),
            *([unsized] if unsized else []),
        ]
        symmetric = best(ways, group, 2 if irregular else 1)
        four = every[:: max(len(every) // 4, 1)]
        if symmetric and group is pair and len(four) == 4 > len(images_of(symmetric.mesh, four)):
            again = best([partial(_recounted, symmetric, four, optimised, alike)], four)
            return again or best(in_sectors(four), four) or symmetric
        if symmetric:
            return symmetric
    return blocks


def _of_sector(
    domain: Domain, mirrors: Sequence[Mirror], start: int, find: FindPart, optimised: Optimised, score: Score
) -> QuadMesh:  # fmt: skip
    """Return the mesh of the sector that starts at a mirror, and its rotated copies."""
    part = sector_of(domain, mirrors, start)
    blocks = base_complex(find(part))
    return with_copies(symmetric_blocks(blocks, find, optimised, score, worth=np.inf).mesh, part)


def _trial(way: Way, mirrors: Sequence[Mirror], optimised: Optimised) -> BaseComplex | None:
    """Return the blocks of a mesh whose optimised nodes are symmetric; None if that is impossible."""
    try:
        mesh, images = _symmetric(optimised(_symmetric(way(), mirrors)[0]), mirrors)
        at_centre = max(len(mirrors), AT_CENTRE) if len(mirrors) > 2 else 0
        if not is_conforming(mesh, at_centre) or smallest_jacobian(mesh.nodes, mesh.quads) <= 0.0:
            return None
        return cut_on_mirrors(mesh, images)
    except (SolverError, InputError):
        return None


def _symmetric(mesh: QuadMesh, mirrors: Sequence[Mirror]) -> tuple[QuadMesh, Images]:
    """Return the mesh with nodes symmetric about the mirrors, and the mirror images of the nodes.

    With two mirrors, nodes are made symmetric about all mirrors of the domain if the quads are symmetric
    about them. Raises SolverError: the quads are not symmetric.
    """
    images = images_of(mesh, mirrors)
    if len(images) < len(mirrors) or not agree(images):
        raise SolverError("quads that are not symmetric")
    if len(mirrors) == 2:
        every = images_of(mesh)
        images = every if agree(every) else images
    return made_symmetric(mesh, images), images


def cut_on_mirrors(mesh: QuadMesh, images: Images, more: Bools | None = None) -> BaseComplex:
    """Return the blocks of a mesh, cut so that the mirror image of a block side is again a block side.

    `more` (e,) marks edges at which blocks end too. Raises SolverError if a block is a closed ring that
    cannot be cut, because no grid line is on a mirror.
    """
    blocks = base_complex(mesh, more)
    ring = bool(images) and any(len(distinct(block[[0, 0, -1], [0, -1, 0]])) < 3 for block in blocks.blocks)
    lines = np.zeros(len(mesh.edges), dtype=bool)
    for _, to in images:
        own = to == np.arange(len(to))
        line = own[mesh.edges].all(axis=1)
        label, count = joined_classes(np.ascontiguousarray(mesh.edges[line]), len(to))
        cut = np.zeros(count, dtype=bool)
        cut[label[own & (mesh.places.cells == 2)]] = True
        if ring and not lines.any() and line.any():
            cut[label[mesh.edges[line][0, 0]]] = True
        lines |= line & cut[label[mesh.edges[:, 0]]]
    if ring and not lines.any():
        raise SolverError("a ring without a line on a mirror")
    return base_complex(mesh, lines if more is None else lines | more) if lines.any() else blocks


def _recounted(blocks: BaseComplex, mirrors: Sequence[Mirror], optimised: Optimised, alike: bool) -> QuadMesh:
    """Return the mesh of the same blocks with equal counts for images: those of equal edges if `alike`."""
    before = Chords.of(blocks.layout)
    even = refine(blocks.layout, np.full(before.count, max(EVEN, int(before.least.max()))), before)
    mesh, images = _symmetric(optimised(even.mesh), mirrors)
    chords = Chords.of(replace(even, mesh=mesh), [to for _, to in images])
    counts = chords.counts_for_cells(len(blocks.mesh.quads))
    if not alike:
        wanted = np.bincount(chords.chord, before.counts[before.chord]) / np.bincount(chords.chord)
        counts = chords.rounded(wanted, chords.least)
    return refine(chords.layout, counts, chords).mesh


def _of_part(domain: Domain, mirrors: Sequence[Mirror], find: FindPart) -> QuadMesh:
    """Return the mesh of a half and its image, or of a quarter and its images."""
    part = part_of(domain, mirrors)
    return with_copies(find(part), part)
