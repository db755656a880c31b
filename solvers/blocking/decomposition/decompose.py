"""Decomposes any planar domain into four-sided blocks.

::

    domain -> triangulation -> cross field -> seamless map -> quad mesh -> ring of quads along smooth loops
           -> blocks -> chords collapsed while the score falls -> layout
"""

from collections.abc import Sequence
from functools import reduce

import numpy as np

from meshonet.geometry.domain.check import describe
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.lattice import corner_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.collapse.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.decomposition.collapse.collapse import simplify
from meshonet.solvers.blocking.decomposition.collapse.score import PRICE, score
from meshonet.solvers.blocking.decomposition.field.seamless_map import seamless_map
from meshonet.solvers.blocking.decomposition.quads.inner_rows import corner_row
from meshonet.solvers.blocking.decomposition.quads.padding import (
    Span,
    loops_to_pad,
    pad,
    pad_span,
    spans_to_pad,
)
from meshonet.solvers.blocking.decomposition.quads.quad_mesh import quad_mesh
from meshonet.solvers.blocking.decomposition.side_counts import check_sides, lacking_side
from meshonet.solvers.blocking.decomposition.symmetry.parts import DomainPart, spans_between
from meshonet.solvers.blocking.decomposition.symmetry.symmetric import symmetric_blocks
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.refinement.size_metric import SizeMetric
from meshonet.solvers.stages import Timings, stage

ATTEMPTS = 5  # number of triangulations that are tried, each finer; of 201 domains, two needed a second one
HELD_ITERATIONS, FIRST_ITERATIONS, BEFORE_PADDING = 10, 60, 25
"""Iterations: to untangle, with fixed wall nodes; with free ones; with free ones before rows are inserted."""
CELLS = 900  # number of cells of the quad mesh from which blocks are derived
MOST = 9_000  # largest number of blocks before the collapse; more would take too long
COUNT = 1500  # approximate number of points of the triangulation
FEWER = 1  # number of attempts with a reduced number of singularities; later attempts use the smoothest field
NEAR_CORNER = 3  # nodes of a periodic side for each quad that a row around its end is away from the corner
PADDED = 3  # number of attempts in which stretches without singularities are required


def decompose(
    domain: Domain,
    *,
    cells: int = CELLS,
    count: int = COUNT,
    price: float = PRICE,
    timings: Timings | None = None,
    sizes: SizeMetric | None = None,
    symmetric: bool = True,
) -> Layout:
    """Return a layout of the blocks of a domain, with an optimised quad mesh.

    Parameters
    ----------
    cells : number of cells of the quad mesh from which blocks are derived.
    count : approximate number of points of the triangulation.
    price : degrees by which the mean deviation of angles from 90 degrees may grow for each block removed.
    timings : filled with the times of the stages.
    sizes : target lengths of the edges of the quad mesh, used instead of `cells`.
    symmetric : whether a symmetric domain gets symmetric blocks; no effect if it has periodic sides.

    Raises SolverError if no attempt gives a valid layout, or if the domain has too many corners.
    """
    timings = {} if timings is None else timings
    blocks = _found(domain, cells, count, price, timings, sizes, ())
    if not symmetric or domain.periodic:
        return blocks.layout

    def of_part(part: DomainPart) -> QuadMesh:
        parts, rows = len(part.copies), spans_between(part.domain.loops[0])
        shares = cells // parts, count // parts
        return _found(part.domain, *shares, parts * price, timings, sizes, rows).mesh

    def optimised(mesh: QuadMesh) -> QuadMesh:
        with stage("first optimum", timings):
            return _optimised(mesh, FIRST_ITERATIONS, sizes)

    def scored(blocks: BaseComplex, priced: bool) -> float:
        return score(blocks, price if priced else 0.0, sizes.edges(blocks.mesh) if sizes else None)

    def unsized() -> QuadMesh:
        return decompose(domain, cells=cells, count=count, price=price, timings=timings).mesh

    return symmetric_blocks(blocks, of_part, optimised, scored, unsized if sizes else None).layout


def _found(
    domain: Domain, cells: int, count: int, price: float, timings: Timings, sizes: SizeMetric | None,
    spans: Sequence[Span],
) -> BaseComplex:  # fmt: skip
    """Return the blocks of a domain by the first attempt that succeeds."""
    problem: SolverError | None = None
    for attempt in range(ATTEMPTS):
        finer_count, finer_cells = int(count * (1.0 + 0.3 * attempt)), int(cells * (1.0 + 0.5 * attempt))
        try:
            with stage("map", timings):
                seamless = seamless_map(domain, finer_count, seed=attempt, fewer=attempt < FEWER)
            with stage("quad mesh", timings):
                mesh = quad_mesh(seamless, finer_cells, sizes)
            if len(mesh.quads) > MOST and len(base_complex(mesh).blocks) > MOST:
                break
            blocks = _blocks(mesh, price, timings, sizes, spans if attempt < PADDED else ())
            check_sides(blocks.layout)
            return blocks
        except SolverError as error:
            problem = error
    else:
        raise SolverError(f"no blocks found in {ATTEMPTS} attempts: {problem}") from problem
    raise SolverError(_too_many(domain))


def _too_many(domain: Domain) -> str:
    """Return a message for a domain with too many blocks, which names the loop with most corners."""
    number = int(np.argmax([len(loop.corners) for loop in domain.loops]))
    loop = domain.loops[number]
    at = loop.curve.points[loop.corners[0] if loop.corners else 0]
    return (
        f"the domain takes more than {MOST} blocks: "
        f"{describe(domain, number)} has {len(loop.corners)} corners, the first at "
        f"({at[0]:.6g}, {at[1]:.6g}); smooth it, or name its corners"
    )


def _blocks(
    mesh: QuadMesh, price: float, timings: Timings, sizes: SizeMetric | None, spans: Sequence[Span]
) -> BaseComplex:
    """Return the blocks of a quad mesh after optimising its nodes."""
    loops, spans = loops_to_pad(mesh), spans_to_pad(mesh, spans)
    with stage("first optimum", timings):
        mesh = _optimised(mesh, BEFORE_PADDING if loops or spans else FIRST_ITERATIONS, sizes)
        if loops or spans:
            mesh = reduce(pad_span, spans, pad(mesh, loops))
            mesh = _optimised(mesh, FIRST_ITERATIONS, sizes)
        rounded = _with_corner_rows(mesh)
        if rounded is not mesh:
            mesh = _optimised(rounded, FIRST_ITERATIONS, sizes)
    with stage("collapse", timings):
        return simplify(mesh, price=price, sizes=sizes)


def _with_corner_rows(mesh: QuadMesh) -> QuadMesh:
    """Return the mesh with rows around both ends of a periodic side that could not have enough cells."""
    side = lacking_side(base_complex(mesh).layout)
    if side is None or (mesh.places.cells[side[[0, -1]]] != 1).any():
        return mesh
    made = mesh
    for corner in side[[0, -1]].tolist():
        row = corner_row(made, corner, max(len(side) // NEAR_CORNER, 1))
        if row is None:
            return mesh
        made = row
    return made


def _optimised(mesh: QuadMesh, iterations: int, sizes: SizeMetric | None) -> QuadMesh:
    """Return the mesh with its nodes optimised, first with fixed wall nodes.

    Otherwise the nodes of a folded mesh would slide along smooth walls into a small part of them.
    """
    wall, targets = mesh.places.loop >= 0, sizes.edges(mesh) if sizes else None
    held = optimise(mesh, iterations=HELD_ITERATIONS, held=wall, targets=targets)
    optimum = optimise(held.mesh if held.valid else mesh, iterations=iterations, targets=targets)
    if not optimum.valid or not np.isfinite(optimum.value):
        raise SolverError(f"the quad mesh stays folded {most_folded(optimum.mesh)}")
    return optimum.mesh


def most_folded(mesh: QuadMesh) -> str:
    """Return the position of the most folded corner of a mesh, as text; a corner with NaN comes first."""
    jacobian = np.nan_to_num(corner_jacobians(mesh.nodes[mesh.quads]), nan=-np.inf)
    x, y = mesh.nodes[mesh.quads.ravel()[int(np.argmin(jacobian))]]
    return f"at ({x:.6g}, {y:.6g})"
