"""The room in front of walls is what is ahead of them, never the place itself."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import IN_FRONT, gaps_in_front, wall_gaps
from meshonet.geometry.domain.loop import Loop


def tube(x, y, radius=0.2, points=96):
    t = -2 * np.pi * np.arange(points) / points
    return Loop(
        Curve(np.c_[x + radius * np.cos(t), y + radius * np.sin(t)], closed=True, corners=()), (), ("tube",)
    )


BOX = Loop.of_polygon(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]), (0, 1, 2, 3), ("box",))


@pytest.mark.parametrize("turn", np.radians([0.0, 1.0, 17.0, 30.0, 45.0, 61.0]))
def test_tubes_have_the_gap_to_their_neighbours_in_any_direction(turn):
    apart = 0.7 * np.array([np.cos(turn), np.sin(turn)])
    tubes = [tube(*(np.array([2.0, 1.0]) + side * apart)) for side in (-0.5, 0.5)]
    domain = Domain((BOX, *tubes))
    for loop in tubes:
        arcs = np.linspace(0.0, loop.length, 400, endpoint=False)
        gaps = wall_gaps(domain, loop, arcs)
        assert gaps.min() == pytest.approx(0.7 - 2 * 0.2, rel=2e-3)


@pytest.mark.slow
def test_places_that_samples_of_the_walls_hit_are_no_gap():
    bank = [tube(1.0 + k, y, 0.25, 160) for k in range(3) for y in (0.5, 1.5)]
    domain = Domain((BOX, *bank))
    for loop in bank:
        for count in (32, 64, 96, 128, 400, 2000):
            arcs = np.linspace(0.0, loop.length, count, endpoint=False)
            assert wall_gaps(domain, loop, arcs).min() > 0.2


def test_distances_are_those_of_all_points_one_by_one():
    draw = np.random.default_rng(3)
    for n in (1, 63, 64, 500):
        walls, points = draw.normal(size=(n, 2)).round(1), draw.normal(size=(90, 2)).round(1)
        turn = draw.uniform(0.0, 2.0 * np.pi, 90)
        along = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        off = walls - points[:, None]
        distance = np.hypot(*np.moveaxis(off, -1, 0))
        height = off[..., 1] * along[:, :1] - off[..., 0] * along[:, 1:]
        same = 1e-9 * np.ptp(walls, axis=0).max()
        ahead = (height > (1.0 + 1e-9) * IN_FRONT * distance) & (distance > same)
        expected = np.where(ahead, distance, np.inf).min(axis=1)
        np.testing.assert_array_equal(gaps_in_front(walls, points, along), expected)


@pytest.mark.parametrize("sides", [8, 9, 10])
def test_layers_turn_at_wide_corners_without_a_gap(sides):
    turn = 2.0 * np.pi * np.arange(sides) / sides
    loop = Loop.of_polygon(np.stack([np.cos(turn), np.sin(turn)], axis=1))
    gaps = wall_gaps(Domain((loop,)), loop, np.linspace(0.0, loop.length, 200, endpoint=False))
    assert gaps.min() > 0.9


@pytest.mark.parametrize(("bend", "cells"), [(1.0, 1), (2.6, 2)])
def test_the_wall_across_a_lens_is_in_front_whatever_its_corners(bend, cells):
    turn = np.linspace(-0.25, 0.25, 41) * np.pi
    low = np.stack([np.sin(turn), bend * (0.5**0.5 - np.cos(turn))], axis=1)
    loop = Loop.of_polygon(np.concatenate([low, -low[1:-1]]))
    assert loop.corner_cells.tolist() == [cells, cells]
    gap = wall_gaps(Domain((loop,)), loop, np.array([0.25 * loop.length]))[0]
    assert 0.6 * np.ptp(loop.curve.points[:, 1]) < gap <= 1.001 * np.ptp(loop.curve.points[:, 1])
