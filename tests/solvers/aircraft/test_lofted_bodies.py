"""Grids around bodies through cross-sections: oval, square, with a raised tail."""

from dataclasses import replace

import numpy as np
import pytest
from aircraft_shapes import aircraft, unclaimed_faces, wall

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.body_section import BodySection
from meshonet.geometry.aircraft.lofted_body import LoftedBody
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, measure_volumes
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.lofted_map import LoftedMap, map_around
from meshonet.solvers.aircraft.request import AircraftRequest

FIRST = 5e-3
SMALL = AircraftRequest(around=41, span=5, first_cell=FIRST, growth=1.6, far_field=4.0)


def oval(width: float = 1.4, height: float = 1.1, exponent: float = 2.5, raised: float = 0.4) -> LoftedBody:
    """A fuselage 10 long, its nose 2, its tail 4, whose end is `raised`."""
    inner = np.concatenate([2.0 - 2.0 * np.cos(np.linspace(0.2, 1.5, 7)), np.linspace(3.0, 9.9, 12)])
    ahead, behind = np.clip(1.0 - inner / 2.0, 0.0, 1.0), np.clip((inner - 6.0) / 4.0, 0.0, 1.0)
    part = np.sqrt((1.0 - ahead**2) * (1.0 - behind**2))
    sections = [
        BodySection(x, raised * up**2, width * size, height * size, exponent)
        for x, up, size in zip(inner.tolist(), behind.tolist(), part.tolist(), strict=True)
    ]
    return LoftedBody(sections=(BodySection(0.0), *sections, BodySection(10.0, y=raised)))


def jet(body: LoftedBody) -> Aircraft:
    return replace(aircraft(y=0.0), body=body)


@pytest.fixture(scope="module")
def grid() -> Grid:
    return aircraft_grid(jet(oval()), SMALL)[0]


def test_no_cell_is_folded_and_blocks_match(grid: Grid) -> None:
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks) == 0
    assert measure_volumes(grid)["scaled_jacobian"].min > 0.1
    assert unclaimed_faces(grid) == 0


def test_nodes_lie_on_the_surface_through_the_sections(grid: Grid) -> None:
    for nodes, _ in wall(grid, "fuselage"):
        assert np.abs(oval().outside(nodes.reshape(-1, 3))).max() < 1e-9


@pytest.mark.parametrize("name", ["fuselage", "wing", "tip"])
def test_first_cells_are_exact_on_every_wall(grid: Grid, name: str) -> None:
    for nodes, beside in wall(grid, name):
        assert np.linalg.norm(beside - nodes, axis=-1) == pytest.approx(FIRST * 2.0, rel=1e-9)


def test_lines_leave_the_body_at_right_angles(grid: Grid) -> None:
    """Also where the tail is raised and the body narrows, up to the junctions."""
    angles = []
    for nodes, beside in wall(grid, "fuselage"):
        face = np.cross(np.gradient(nodes, axis=0), np.gradient(nodes, axis=1))
        cosine = (face * (beside - nodes)).sum(-1) / np.linalg.norm(face, axis=-1) / (FIRST * 2.0)
        angles.append(np.degrees(np.arccos(np.clip(np.abs(cosine[1:-1, 1:-1]), 0.0, 1.0))).ravel())
    assert np.percentile(np.concatenate(angles), 75) < 4.0, "2.9 beside a body of revolution"
    assert np.percentile(np.concatenate(angles), 95) < 8.0, "10 there"


FIVE = LoftedBody(
    sections=(
        BodySection(0.0, y=-0.2), BodySection(0.2, 0.0, 1.0, 0.8), BodySection(1.0, 0.0, 1.8, 1.4, 2.5),
        BodySection(5.0, 0.0, 1.7, 1.6), BodySection(10.0, y=0.2),
    )
)  # fmt: skip
OTHERS = {"wide and square": oval(2.0, 1.0, 4.0), "five sections": FIVE}


@pytest.mark.parametrize("name", OTHERS)
def test_square_and_wide_bodies_and_few_sections_are_made(name: str) -> None:
    made, *_ = aircraft_grid(jet(OTHERS[name]), SMALL)
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in made.blocks) == 0
    assert measure_volumes(made)["scaled_jacobian"].min > 0.05


def test_circles_give_the_grid_of_a_body_of_revolution() -> None:
    """The same surface by both maps: points of one are those of the other, at the same places."""
    circles = oval(1.2, 1.2, 2.0, 0.0)
    draw = np.random.default_rng(0)
    places = np.stack([draw.uniform(0.5, 9.5, 99), draw.uniform(0.1, 3.0, 99), draw.uniform(0, 0.9, 99)], -1)
    plain = BodyMap(circles, 30.0)
    own = LoftedMap(circles, 30.0)
    assert own.points(places) == pytest.approx(plain.points(places), abs=1e-9)


def test_places_around_a_body_are_those_of_the_points_there() -> None:
    space = map_around(oval(1.6, 1.0, 3.0), 40.0)
    draw = np.random.default_rng(0)
    places = np.stack([draw.uniform(0.5, 9.5, 99), draw.uniform(0.1, 3.0, 99), draw.uniform(0, 0.9, 99)], -1)
    assert space.places(space.points(places)) == pytest.approx(places, abs=1e-8)
