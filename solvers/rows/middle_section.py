"""The middle section of a row, from which the others start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.cascade.cascade import scaled
from meshonet.solvers.cascade.cascade_layout import FIRST, WEIGHTS, attached_cells, counts_of
from meshonet.solvers.cascade.passage import INLET, NEAR, OUTLET
from meshonet.solvers.cascade.passage_template import template
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.layers.layer_law import layer_arcs
from meshonet.solvers.layers.layer_settings import JOIN
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import multiplied, refine
from meshonet.solvers.refinement.size_metric import SizeMetric
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.whole_section import whole_section

UPPER, TRAILING, LOWER, LEADING = range(8, 12)
"""Numbers of the template's blocks around the blade."""
REMEDY = "use more {cells}, a larger {first_cell}, or profiles nearer to each other there"
COARSE = 300
"""Number of iterations of the first optimisation."""
TOLERANCE = 3e-4
"""Of the minimisations of sections. With three times as much, rounding changes Jacobians by 1 %."""
_TRIES, _NEAR = 4, 0.03  # largest number of choices of counts; sufficient relative accuracy of the total
_PART = 0.6  # of the least room before or behind the blade that is left to blocks


@dataclass(frozen=True)
class Shared:
    """Properties of the middle section that follow from those of all sections.

    Parameters
    ----------
    near : distances upstream and downstream of the blade, in pitches, at which straight rows begin.
    rows : number of rows of the layers.
    longest : largest lengths, in any section, of the rows to inlet and outlet, by the index of their loop.
    """

    near: tuple[float, float]
    rows: int
    longest: Mapping[int, float]

    @classmethod
    def of(cls, planes: Sequence[SectionPlane]) -> Shared:
        """Return the properties for the sections `planes`."""
        rooms = list(zip(*(plane.room for plane in planes), strict=True))
        before, behind = (min(NEAR, _PART * min(each)) for each in rooms)
        pitch = planes[0].cascade.pitch[1]
        most = (max(max(each) - part, 0.0) for each, part in zip(rooms, (before, behind), strict=True))
        longest = {number: pitch * length for number, length in zip((INLET, OUTLET), most, strict=True)}
        return cls((before, behind), max(plane.cascade.rows_of_layers for plane in planes), longest)


def coarse_section(plane: SectionPlane, *, early: bool = True) -> Layout:
    """Return the coarse blocks of a section; if `early`, corners of the blade are nodes from the start.

    Raises InputError: no room for inlet or outlet. Raises NoValidGridError: cells are folded.
    """
    return _sized(template(plane.cascade.passage, at_corners=early), FIRST, None)


def middle_section(plane: SectionPlane, cells: int, shared: Shared, coarse: Layout | None = None) -> Layout:
    """Return the middle section of a row with about `cells` cells, including its layers and rows.

    `coarse` is the `coarse_section`, if it is known. Raises NoValidGridError: cells are folded.
    """
    try:
        return _made(plane, cells, shared, coarse or coarse_section(plane))
    except NoValidGridError:
        return _made(plane, cells, shared, coarse_section(plane, early=False))


def _made(plane: SectionPlane, cells: int, shared: Shared, coarse: Layout) -> Layout:
    """Return the middle section from its coarse blocks."""
    cascade, rows, longest = plane.cascade, shared.rows, shared.longest
    chords = Chords.of(coarse)
    ends = [chords.chord[chords.sides[block, 0]] for block in (TRAILING, LEADING)]
    wanted = float(cells)
    for _ in range(_TRIES):  # more rows than those of this section, and counts that are rounded
        counts, times, metric = counts_of(cascade, chords, round(wanted), None)
        counts[ends] = counts[ends].max()
        every = counts * times
        total = chords.cells(every) + attached_cells(cascade, chords, every, metric, rows, longest)
        if abs(total - cells) < _NEAR * cells:
            break
        wanted *= cells / total
    scale = float((metric.along / cascade.metric.along).mean())
    metric = _joined(plane, scale, rows)
    fine = _sized(refine(coarse, counts, chords), COARSE, metric)
    if times > 1:
        fine = multiplied(fine, times)
    return whole_section(plane, fine, rows, metric.largest, longest)


def _sized(layout: Layout, iterations: int, metric: SizeMetric | None) -> Layout:
    """Return the blocks beyond the layers at the optimum, with cell sizes by `metric`, if any.

    Nodes at which the cut ends do not move.
    """
    mesh = layout.mesh
    optimum = optimise(
        mesh, iterations=iterations, held=(mesh.places.loop >= 0) & mesh.tied,
        targets=metric.gradual(mesh) if metric else None, tolerance=TOLERANCE, weights=WEIGHTS,
    )  # fmt: skip
    if not optimum.valid:
        raise NoValidGridError(f"cells of the section in the middle of the span stay folded; {REMEDY}")
    return replace(layout, mesh=optimum.mesh)


def folded_section(plane: SectionPlane, mesh: QuadMesh) -> NoValidGridError:
    """Return the error for a folded section, with the position of its worst cell."""
    worst = int(smallest_jacobians(mesh.nodes, mesh.quads).argmin())
    place = plane.place(mesh.nodes[mesh.quads[worst]].mean(axis=0))
    return NoValidGridError(f"cells stay folded in the {place}; {REMEDY}")


def _joined(plane: SectionPlane, scale: float, rows: int) -> SizeMetric:
    """Return the sizes of cells `scale` times as long, that continue `rows` of layers across the front."""
    cascade = plane.cascade
    sizes, thickness = cascade.metric, cascade.ring.thickness
    none = np.full(len(thickness), np.inf)
    first = cascade.layers.first * cascade.factors_at(cascade.ring.arcs)
    arcs = layer_arcs(thickness, first, none, rows)
    last = JOIN * (arcs[:, -1] - arcs[:, -2])
    return replace(scaled(sizes, scale), across=np.tile(last, len(sizes.across) // len(last)))
