"""Volumes swept along paths: sizes by formula, frames, patches, bends that are too tight."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.curves.path import Bend, PiecedPath, SplinePath
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import measure
from meshonet.solvers.sweeping.disc import Disc, butterfly
from meshonet.solvers.sweeping.sweep import Sweep, reach_of, self_crossing, sweep


def quarter(radius: float) -> PiecedPath:
    arc = Bend(0.5 * np.pi * radius, radius, (0.0, 1.0, 0.0))
    return PiecedPath((Bend(1.0), arc, Bend(1.0)), np.zeros(3), np.array([1.0, 0.0, 0.0]))


def ring(radius: float, n: int = 33) -> SplinePath:
    angle = np.linspace(0.0, 2.0 * np.pi, n)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    points[-1] = points[0]
    return SplinePath(points)


def volume(grid: Grid) -> float:
    """Sum of the cells, each as six tetrahedra."""
    total = 0.0
    for block in grid.blocks:
        x = block.nodes
        corner = {(a, b, c): x[a : len(x) - 1 + a, b : x.shape[1] - 1 + b, c : x.shape[2] - 1 + c]
                  for a in (0, 1) for b in (0, 1) for c in (0, 1)}  # fmt: skip
        ways = [((1, 0, 0), (1, 1, 0)), ((1, 1, 0), (0, 1, 0)), ((0, 1, 0), (0, 1, 1)),
                ((0, 1, 1), (0, 0, 1)), ((0, 0, 1), (1, 0, 1)), ((1, 0, 1), (1, 0, 0))]  # fmt: skip
        o, far = corner[0, 0, 0], corner[1, 1, 1]
        for a, b in ways:
            total += float((np.cross(corner[a] - o, corner[b] - o) * (far - o)).sum()) / 6.0
    return total


def test_a_bent_pipe_has_the_volume_of_pappus():
    disc = butterfly(Disc(0.5))
    area = np.pi * 0.25
    path = quarter(1.5)
    made = sweep(disc, path, Sweep(planes=161))
    assert volume(made) == pytest.approx(area * path.length, rel=5e-3)


def test_every_plane_stands_across_the_path_and_is_the_section():
    disc = butterfly(Disc(0.5, around=32))
    path = quarter(1.5)
    made = sweep(disc, path, Sweep(planes=31))
    places = path.at(np.linspace(0.0, path.length, 31))
    for flat, block in zip(disc.blocks, made.blocks, strict=True):
        away = block.nodes - places.points
        assert np.abs((away * places.tangents).sum(-1)).max() < 1e-12
        assert np.linalg.norm(away, axis=-1) == pytest.approx(
            np.broadcast_to(np.linalg.norm(flat.nodes, axis=-1)[..., None], block.counts)
        )


def test_blocks_and_connections_stay_and_ends_are_inlet_and_outlet():
    disc = butterfly(Disc(0.5, around=32))
    made = sweep(disc, quarter(1.5))
    assert len(made.blocks) == 5
    assert len(made.connections) == len(disc.connections)
    kinds = {(patch.name, patch.kind, patch.side) for patch in made.patches}
    assert kinds == {("wall", "wall", "south"), ("inlet", "inlet", "bottom"), ("outlet", "outlet", "top")}
    assert measure(made).folded == 0


def test_a_closed_path_is_connected_to_itself_and_has_no_ends():
    made = sweep(butterfly(Disc(0.5, around=32)), ring(2.0), Sweep(planes=65))
    assert {patch.name for patch in made.patches} == {"wall"}
    tops = [each for each in made.connections if each.donor_side == "top"]
    assert [each.block for each in tops] == [0, 1, 2, 3, 4]
    assert volume(made) == pytest.approx(np.pi * 0.25 * 4.0 * np.pi, rel=2e-2)


def test_a_section_can_be_twisted_and_scaled():
    square = Grid.from_nodes(np.stack(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], indexing="ij"), axis=-1))
    straight = PiecedPath((Bend(4.0),), np.zeros(3), np.array([0.0, 0.0, 1.0]))
    made = sweep(square, straight, Sweep(planes=3, twist=90.0, scale=3.0)).blocks[0].nodes
    assert made[1, 1, 0] == pytest.approx([1.0, 1.0, 0.0])
    assert made[1, 1, 1] == pytest.approx([0.0, 2.0 * np.sqrt(2.0), 2.0], abs=1e-12)
    assert made[1, 1, 2] == pytest.approx([-3.0, 3.0, 4.0])


@pytest.mark.parametrize("radius", [0.45, 0.5])
def test_a_bend_tighter_than_the_section_is_refused_with_its_place(radius):
    with pytest.raises(InputError) as refusal:
        sweep(butterfly(Disc(0.5)), quarter(radius))
    message = str(refusal.value)
    assert f"the path bends with a radius of {radius:g} at (1." in message
    assert "the section reaches 0.5 to the inside" in message


def test_a_bend_a_little_wider_than_the_section_is_valid():
    assert measure(sweep(butterfly(Disc(0.5)), quarter(0.52))).folded == 0


def test_a_section_beside_the_path_is_judged_by_its_inner_side():
    plane = np.stack(np.meshgrid([1.0, 2.0], [0.0, 1.0], indexing="ij"), axis=-1)
    inside, outside = Grid.from_nodes(plane), Grid.from_nodes(plane - [3.0, 0.0])
    with pytest.raises(InputError, match="reaches 2 to the inside"):
        sweep(inside, quarter(1.5))
    assert measure(sweep(outside, quarter(1.5))).folded == 0


def test_a_path_that_comes_back_to_itself_is_seen():
    disc = butterfly(Disc(0.5))
    assert self_crossing(quarter(1.5), reach_of(disc)) is None
    most = Bend(1.75 * np.pi * 0.6, 0.6, (0.0, 1.0, 0.0))
    place = self_crossing(PiecedPath((most,), np.zeros(3), np.array([1.0, 0.0, 0.0])), 0.5)
    assert place is not None
    assert np.linalg.norm(place) < 0.6  # near its start


def test_periodic_sections_and_open_turns_of_closed_paths_are_refused():
    with pytest.raises(InputError, match="does not come back to itself"):
        sweep(butterfly(Disc(0.5, around=32)), ring(2.0), Sweep(twist=90.0))


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({"radius": -1.0}, "a circle of radius -1"),
        ({"radius": 1.0, "cells": 5}, "5 cells"),
        ({"radius": 1.0, "first_cell": 0.3}, "0.3 in a circle of radius 1"),
        ({"radius": 1.0, "growth": 0.9}, "0.9"),
    ],
)
def test_discs_that_cannot_be_are_refused(values, problem):
    with pytest.raises(InputError) as refusal:
        Disc(**values)
    assert problem in str(refusal.value)
