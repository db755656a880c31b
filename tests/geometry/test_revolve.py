"""Planar grids turned about an axis: wedges, sectors and whole turns, by the volumes of Pappus."""

import math
from dataclasses import replace

import numpy as np
import pytest
from block_grids import o_ring

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.revolve import AXIS, FLOWS, AxisLine, Revolution, bent, revolved
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.volume.hex_mesh import hex_mesh_of


def box(low: float = 0.0, high: float = 1.0, n: int = 5) -> Grid:
    sides = np.linspace(0.0, 2.0, n), np.linspace(low, high, n)
    return Grid.from_nodes(np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1))


def volume(grid: Grid) -> float:
    """Sum of the cells, each as five tetrahedra, of both diagonals in the mean."""
    total = 0.0
    for block in grid.blocks:
        x = block.nodes
        at = {c: x[tuple(slice(k, n - 1 + k) for k, n in zip(c, x.shape, strict=False))]
              for c in np.ndindex(2, 2, 2)}  # fmt: skip
        for flip in (0, 1):
            sign = 1 - 2 * flip
            for a, b, c, d in (
                ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)), ((1, 1, 0), (0, 1, 0), (1, 0, 0), (1, 1, 1)),
                ((1, 0, 1), (0, 0, 1), (1, 1, 1), (1, 0, 0)), ((0, 1, 1), (1, 1, 1), (0, 0, 1), (0, 1, 0)),
                ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)),
            ):  # fmt: skip
                o = at[(a[0] ^ flip, *a[1:])]
                u, v, w = (at[(each[0] ^ flip, *each[1:])] - o for each in (b, c, d))
                total += 0.5 * sign * float((np.cross(u, v) * w).sum()) / 6.0
    return total


def prism(degrees: float, cells: int) -> float:
    """Return the part of a circle's area that the polygon of so many faces in a sector has."""
    step = math.radians(degrees) / cells
    return math.sin(step) / step


@pytest.mark.parametrize("degrees", [1.0, 5.0, 10.0])
def test_a_wedge_is_one_cell_on_both_sides_of_the_plane_with_wedge_patches(degrees):
    made = revolved(box(), Revolution(degrees))
    assert [block.counts for block in made.blocks] == [(5, 5, 2)]
    assert {(p.name, p.kind) for p in made.patches if p.side in ("bottom", "top")} == {
        ("wedge1", "wedge"), ("wedge2", "wedge"),
    }  # fmt: skip
    assert measure(made).folded == 0
    assert made.blocks[0].nodes[..., 2].min() == -made.blocks[0].nodes[..., 2].max()
    assert volume(made) == pytest.approx(math.radians(degrees) * prism(degrees, 1), rel=1e-12)


def test_nodes_on_the_axis_are_one_and_their_side_is_called_so():
    made = revolved(box(), Revolution(5.0))
    nodes = made.blocks[0].nodes
    assert np.array_equal(nodes[:, 0, 0], nodes[:, 0, 1])
    assert [p.name for p in made.patches if p.side == "south"] == [AXIS]
    assert len(hex_mesh_of(made).nodes) == 2 * 25 - 5


def test_a_sector_has_periodic_sides_that_match_bitwise():
    made = revolved(box(0.5, 1.0), Revolution(60.0, axis=AxisLine(0.3, -0.2, 1.0, 0.1)))
    (joined,) = [each for each in made.connections if each.transform]
    own, donor = joined.nodes(made.face)
    assert np.array_equal(own, donor)
    assert (joined.side, joined.donor_side) == ("bottom", "top")
    assert not [p for p in made.patches if p.side in ("bottom", "top")]
    assert made.blocks[0].counts[2] == 16


@pytest.mark.parametrize("degrees", [5.0, 72.0, 360.0])
def test_patches_of_the_plane_keep_their_names(degrees):
    names = {"west": "inlet", "east": "outlet", "north": "wall", "south": "inner"}
    named = tuple(Patch(name, side, 0, 4) for side, name in names.items())
    made = revolved(replace(box(0.5), patches=named), Revolution(degrees))
    ends = {"wedge1", "wedge2"} if degrees == 5.0 else set()
    assert {patch.name: patch.side for patch in made.patches if patch.name not in ends} == {
        name: side for side, name in names.items()
    }


def test_ends_of_a_sector_that_is_flown_through_are_patches():
    made = revolved(box(0.5, 1.0), Revolution(90.0), FLOWS)
    ends = {(p.name, p.kind, p.side) for p in made.patches if p.side in ("bottom", "top")}
    assert ends == {("inlet", "inlet", "bottom"), ("outlet", "outlet", "top")}
    assert not made.connections


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (0.5, 1.0), (-1.0, 0.0), (-1.0, -0.5)])
def test_a_whole_turn_is_joined_and_has_the_volume_of_pappus(low, high):
    made = revolved(box(low, high), Revolution(360.0))
    assert [(each.side, each.donor_side) for each in made.connections] == [("bottom", "top")]
    assert measure(made).folded == 0
    exact = 2.0 * math.pi * abs(high**2 - low**2)
    assert volume(made) == pytest.approx(exact * prism(360.0, 90), rel=1e-12)


def test_an_o_grid_can_be_turned_about_any_line_beside_it():
    flat = o_ring()
    made = revolved(flat, Revolution(360.0, planes=41, axis=AxisLine(0.0, -9.0, 1.0, 0.5)))
    assert measure(made).folded == 0
    assert len(made.connections) == len(flat.connections) + len(flat.blocks)


def test_the_height_of_a_volume_becomes_an_angle():
    flat = box(0.5, 1.0).blocks[0].nodes
    z = np.linspace(3.0, 5.0, 31)
    nodes = np.concatenate(
        [np.broadcast_to(flat[:, :, None], (5, 5, 31, 2)), np.broadcast_to(z[:, None], (5, 5, 31, 1))],
        axis=-1,
    )
    (made,) = bent([nodes], Revolution(90.0))
    radius = np.hypot(made[..., 1], made[..., 2])
    assert radius == pytest.approx(nodes[..., 1])
    assert np.degrees(np.arctan2(made[..., 2], made[..., 1])) == pytest.approx(45.0 * (nodes[..., 2] - 3.0))


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (lambda: Revolution(0.0), "0 degrees; use 0.001 to 360"),
        (lambda: Revolution(361.0), "361 degrees"),
        (lambda: Revolution(math.nan), "nan degrees"),
        (lambda: Revolution(90.0, planes=1), "1 planes"),
        (lambda: Revolution(360.0, planes=3), "3 planes of a whole turn"),
        (lambda: Revolution(5.0, axis=AxisLine(0, 0, 0, 0)), "a line without direction"),
        (lambda: revolved(box(-1.0, 1.0), Revolution(5.0)), "runs through the grid, from 1 to one side"),
        (lambda: revolved(revolved(box(), Revolution(5.0)), Revolution(5.0)), "is not in the plane"),
    ],
)
def test_turns_that_cannot_be_are_refused(make, problem):
    with pytest.raises(InputError) as refusal:
        make()
    assert problem in str(refusal.value)
