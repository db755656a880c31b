"""The middle section of a row, from which the others start."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.cascade.cascade import scaled
from meshonet.solvers.cascade.cascade_layout import CORNERS, FIRST, WEIGHTS, attached_cells, counts_of
from meshonet.solvers.cascade.passage import BLADE
from meshonet.solvers.cascade.templates import TEMPLATES, Template, around_blade, first_valid
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.layers.layer_law import layer_arcs
from meshonet.solvers.layers.layer_settings import JOIN
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import multiplied, refine
from meshonet.solvers.refinement.size_metric import SizeMetric
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.whole_section import whole_section

REMEDY = "use more {cells}, a larger {first_cell}, or profiles nearer to each other there"
COARSE = 300  # number of iterations of the first optimisation
TOLERANCE = 1e-3
_TRIES, _NEAR = 4, 0.03  # largest number of choices of counts; sufficient relative accuracy of the total


def coarse_section(
    plane: SectionPlane, template: Template | None = None, corners: str = CORNERS[0]
) -> Layout:  # fmt: skip
    """Return a coarse, optimised block layout of a section, beyond the outer edge of the blade's layers.

    `template` makes the first blocks; None: the first of the `TEMPLATES`. `corners` says when nodes are put
    at corners of the outer edge, see `CORNERS`. Raises InputError if there is no room for inlet or outlet,
    and NoValidGridError if cells are folded.
    """
    make = template or TEMPLATES[0]
    return _sized(make(plane.cascade.passage, at_corners=corners == CORNERS[0]), FIRST, None)


def middle_section(
    planes: Sequence[SectionPlane], cells: int, longest: Mapping[int, float], coarse: Layout | None = None
) -> Layout:
    """Return the layout of the middle one of the sections `planes`, with layers and about `cells` cells.

    Parameters
    ----------
    longest : for `INLET` and `OUTLET`, largest length of the straight grid lines there, over all sections.
    coarse : result of `coarse_section`; None: it is computed.

    Raises NoValidGridError if cells are folded.
    """
    plane = planes[len(planes) // 2]

    def made(template: Template, corners: str) -> Layout:
        begun = coarse if (template, corners) == (TEMPLATES[0], CORNERS[0]) else None
        return _made(planes, cells, longest, begun or coarse_section(plane, template, corners))

    return first_valid(made, CORNERS[:2])


def _made(planes: Sequence[SectionPlane], cells: int, longest: Mapping[int, float], coarse: Layout) -> Layout:
    plane = planes[len(planes) // 2]
    cascade = plane.cascade
    chords = Chords.of(coarse)
    rows = max(each.cascade.rows_of_layers for each in planes)
    _, trailing, _, leading = around_blade(coarse, coarse.mesh.places.loop == BLADE)
    ends = [chords.chord[chords.sides[block, 0]] for block in (trailing, leading)]
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
    fine = multiplied(_sized(refine(coarse, counts, chords), COARSE, metric), times)
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
