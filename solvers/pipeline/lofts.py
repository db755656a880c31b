"""Blades and ducts: planar grids of all sections with the same topology, and the volume between them."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, as_planar, norms
from meshonet.geometry.blocks.extrude import End, thickened
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import arctan2, cos, exp, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.growth import cells_for_growth
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.wall_facts import wall_facts
from meshonet.solvers.stacking.axis_heights import axis_heights
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.stacking.section_nodes import around, nose_notes, unit_nodes
from meshonet.solvers.sweeping import butterfly

_FADE = 4.0  # distance from a blade, in chords, at which its twist and scaling are reduced to one third
_CENTRE = np.array([0.5, 0.0])  # of the far field of a section of unit chord
_HIGHEST = 0.1  # largest height of first cells in a duct, in widths of the narrowest section
GROWTH = 1.2  # of layers where none is given, as of volumes that are marched


def blade_volume(stack: Stack, request: StackRequest) -> tuple[Grid, tuple[str, ...]]:
    """Return the volume around a blade, with patches ``hub`` and ``shroud`` at its end sections, and notes.

    Planar O grids around the sections are marched and joined. Far from the blade, all these grids are equal,
    so that the far field is a cylinder. Raises InputError if node counts are too small. Raises
    NoValidGridError if the grid of a section has folded cells.
    """
    plan = around(
        request.surface.around, gap=request.surface.base, edge=stack.te_spacing, nose=stack.le_spacing
    )
    height = request.height() * stack.chord
    rows = 1 + blade_rows(request)
    planes, notes = [], []
    for section in stack.sections:
        nodes, note = unit_nodes(section, plan)
        wall = nodes[::-1].copy()  # clockwise, as planar grids around bodies are
        edges = o_boundary(wall, rows, _CENTRE, request.far_field, chord=1.0, turned=False)
        march = GridRequest(method="hyperbolic", first_cell=height / section.chord)
        planes.append(make_grid(edges, march).grid)
        notes.append(note)
    nodes_of = np.stack([plane.nodes for plane in planes])
    away = norms(nodes_of - nodes_of[:, :, :1]).mean(axis=0)
    weight = exp(-((away / min(_FADE, request.far_field / 3.0)) ** 2))
    planes = [
        plane.with_nodes(each) for plane, each in zip(planes, _alike_far_away(nodes_of, weight), strict=True)
    ]
    ends: tuple[End, End] = (("hub", "wall"), ("shroud", "wall"))
    grid, along = _lofted(stack, planes, request.span, ends, weight.ravel())
    named = [replace(p, name="blade", kind="wall") if p.name == "wall" else p for p in grid.patches]
    changes = dict.fromkeys(note for note in notes if note)
    said = *stack.notes, *changes, *along, *nose_notes(stack.sections, plan)
    return replace(grid, patches=tuple(named)), said


def blade_rows(request: StackRequest) -> int:
    """Return the number of cells between a blade and its far field."""
    if request.layers:
        return request.layers - 1
    return cells_for_growth(request.height(), request.far_field, request.growth or GROWTH)


def _alike_far_away(grids: Floats, weight: Floats) -> Floats:
    """Return O grids (k, ni, nj, 2) moved to their mean in polar coordinates, but for a part of `weight`."""
    off = grids - _CENTRE
    radius = norms(off)
    angle = np.unwrap(arctan2(off[..., 1], off[..., 0]), axis=1)
    turn = (1.0 - weight) * (angle.mean(axis=0) - angle)
    scale = 1.0 + (1.0 - weight) * (radius.mean(axis=0) / radius - 1.0)
    c, s = scale * cos(turn), scale * sin(turn)
    x, y = off[..., 0], off[..., 1]
    nodes = _CENTRE + np.stack([c * x - s * y, s * x + c * y], axis=-1)
    nodes[:, -1] = nodes[:, 0]
    nodes[:, :, 0] = grids[:, :, 0]
    return nodes


def duct_volume(stack: Stack, request: StackRequest) -> tuple[Grid, tuple[str, ...]]:
    """Return the volume inside a duct, and notes; the end sections are called ``inlet`` and ``outlet``.

    It has one block if all sections have four sides, otherwise five. Raises InputError if a section is an
    airfoil, or if node counts are too small.
    """
    for k, section in enumerate(stack.sections):
        if isinstance(section.shape, Airfoil):
            problem = "an airfoil is no section of a duct"
            raise InputError(problem, "give a closed curve without a trailing edge", place=f"sections[{k}]")
    first = request.height(stack.chord) if request.at_walls else None
    if first is not None and first > _HIGHEST * (width := float(stack.chords.min())):
        problem = f"first cells are {first:g} high in a section that is {width:g} wide"
        raise InputError(problem, f"use at most {_HIGHEST:g} of it", parameter="first_cell")
    single = all(section.shape.topology == "quad" for section in stack.sections)  # type: ignore[union-attr]
    planes = _four_sided(stack, request, first) if single else _five_blocks(stack, request, first)
    grid, notes = _lofted(stack, planes, request.span, (("inlet", "inlet"), ("outlet", "outlet")))
    facts = wall_facts(grid) if request.at_walls else ()
    return grid, (*stack.notes, *notes, *facts)


def _four_sided(stack: Stack, request: StackRequest, first: float | None) -> list[Grid]:
    n = _side(request) + 1
    planes = []
    for section in stack.sections:
        origin, length = section.frame
        h = None if first is None else first / section.chord * length
        sides = GridRequest(
            Sampling(n, n), slide=False, spacing_south=h, spacing_north=h, spacing_west=h, spacing_east=h
        )
        plane = make_grid(section.shape, sides).grid
        patches = (replace(p, name="wall", kind="wall") for p in plane.outer_patches())
        unit = plane.with_nodes((plane.nodes - origin) / length)
        planes.append(replace(unit, patches=tuple(patches)))
    return planes


def _five_blocks(stack: Stack, request: StackRequest, first: float | None) -> list[Grid]:
    side = _side(request)
    sections = []
    for section in stack.sections:
        assert isinstance(section.shape, Outline)  # noqa: S101 - ducts have no others
        edges = section.shape.boundary(Sampling(side + 1, side + 1, topology="quad"))
        origin, length = section.frame
        loop = (edges.east, edges.north[::-1], edges.west[::-1], edges.south)
        arcs = [(arc - origin) / length for arc in loop]
        sections.append(butterfly.CrossSection(arcs, None if first is None else first / section.chord))
    rows = request.layers - 1 if request.layers else None
    plan = butterfly.planned(sections, request.growth or GROWTH, rows)
    return [butterfly.filled(section, plan) for section in sections]


def _side(request: StackRequest) -> int:
    """Return the number of cells along a quarter of a section."""
    if (request.surface.around - 1) % 4:
        remedy = "use a multiple of 4, and one more"
        raise InputError(
            f"{request.surface.around} nodes around the four sides of a duct", remedy, parameter="around"
        )
    return (request.surface.around - 1) // 4


def _lofted(
    stack: Stack, planes: list[Grid], span: int | None, ends: tuple[End, End], weight: Floats | None = None
) -> tuple[Grid, tuple[str, ...]]:
    """Return the volume between planar grids of unit chord and equal topology, and notes."""
    z, notes = axis_heights(stack.z, span, stack.panel_cells)
    nodes = []
    for k, block in enumerate(planes[0].blocks):
        ni, nj = block.counts
        unit = np.stack([plane.blocks[k].nodes.reshape(-1, 2) for plane in planes])
        made = stack.lofted(unit, z, weight).reshape(len(z), ni, nj, 3)
        nodes.append(as_planar(made.transpose(1, 2, 0, 3)))
    return replace(thickened(planes[0], nodes, ends), name=stack.name), notes
