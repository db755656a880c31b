"""What is said of the cells at walls with layers is what a grid has there."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from block_grids import o_ring

import meshonet
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.layers.marched import AT_SHARP_EDGE, BLUNT
from meshonet.solvers.blocking.make import make_blocks
from meshonet.solvers.blocking.request import BlockRequest
from meshonet.solvers.blocking.wall_note import wall_note

RING = o_ring(n=9, m=12, growth=1.3)
FIRST = 2.0 / (1.3 ** np.arange(11)).sum()
SQUARE = Domain.of_polygons([np.array([[-4.0, -4], [4, -4], [4, 4], [-4, 4]])])


def test_heights_and_growth_are_those_of_the_grid() -> None:
    note = wall_note(RING, SQUARE, ("wall",), FIRST)
    assert (
        note == f"the first-cell height is {FIRST:.6g} at every node of wall; the mean growth ratio is 1.300"
    )


def test_heights_that_are_not_as_asked_are_told() -> None:
    nodes = RING.blocks[0].nodes.copy()
    nodes[3, 1] = nodes[3, 0] + 0.5 * (nodes[3, 1] - nodes[3, 0])
    grid = replace(RING, blocks=(Block(nodes), *RING.blocks[1:]))
    note = wall_note(grid, SQUARE, ("wall",), FIRST)
    assert note == f"first cells are {0.5 * FIRST:.3g} to {FIRST:.3g} instead of {FIRST:.6g}"


@pytest.mark.parametrize(("walls", "where"), [((), "wall node"), (("body",), "node of body")])
def test_a_body_in_a_square_is_told_with_its_first_cell(walls: tuple[str, ...], where: str) -> None:
    turn = -2 * np.pi * np.arange(80) / 80
    body = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    shape = DomainShape(Domain.of_polygons([SQUARE.loops[0].curve.points, body]))
    grown = {}
    for growth in (1.1, 1.3):
        request = BlockRequest(cells=1500, first_cell=1e-2, growth=growth, walls=walls)
        (note,) = (n for n in make_blocks(shape, request).notes if n.startswith("the first-cell height"))
        height = rf"the first-cell height is 0[.]01 at every {where}"
        match = re.fullmatch(rf"{height}; the mean growth ratio is (\S+)", note)
        assert match, note
        grown[growth] = float(match[1])
    assert 1.0 < grown[1.1] < grown[1.3] < 1.3


def test_named_sides_around_a_hole_without_layers_are_named() -> None:
    turn = -2 * np.pi * np.arange(80) / 80
    body = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    names = [("floor", "outlet", "ceiling", "inlet"), ("cylinder",)]
    domain = Domain.of_polygons([SQUARE.loops[0].curve.points, body], names=names)
    request = BlockRequest(cells=1500, first_cell=1e-2)
    note = "no layers at floor, ceiling: name all walls in {walls} to have them there"
    assert note in make_blocks(DomainShape(domain), request).notes
    periodic = replace(request, periodic=(("floor", "ceiling"),))
    for other in (replace(request, walls=("cylinder",)), periodic):
        assert not [n for n in make_blocks(DomainShape(domain), other).notes if n.startswith("no layers")]


def test_nothing_is_said_of_walls_without_layers() -> None:
    notes = make_blocks(DomainShape(SQUARE), BlockRequest(cells=50)).notes
    assert not [note for note in notes if "first cell" in note or "first-cell" in note]


def test_a_sharp_edge_around_which_lines_turn_is_named_with_what_avoids_it(tmp_path: Path) -> None:
    front, rear = str(tmp_path / "front.dat"), str(tmp_path / "rear.dat")
    shapes = [front, rear]  # the line behind the first edge meets the second nose
    for file, x in ((front, 0.0), (rear, 1.1)):
        points = naca("0012-sharp").curve.points + np.array([x, 0.0])
        np.savetxt(file, np.concatenate([points, points[:1]]), header=file, comments="")
    made = {"assemble": True, "first_cell": 1e-4, "far_field": 5.0, "cells": 4000}
    grid = meshonet.infer(shapes, **made)
    (note,) = (note for note in grid.notes if "sharp edge" in note)
    edge = re.match(r"cells at the sharp edge of front, \((\S+), (\S+)\), have angles of (\S+) degrees", note)
    assert edge is not None, note
    x, y, angle = map(float, edge.groups())
    assert (x, y) == pytest.approx((1.0, 0.0), abs=1e-9)
    assert angle == pytest.approx(grid.quality().metrics["max_angle"].max, abs=0.051)
    assert note.endswith(f": {BLUNT} makes it blunt".format(base="base"))
    assert BLUNT in AT_SHARP_EDGE  # the remedy of messages too
    opened = meshonet.infer(shapes, **made, base=float(BLUNT.split()[-1]))
    assert not [note for note in opened.notes if "sharp edge" in note]
    assert opened.quality().metrics["max_angle"].max < 160.0
