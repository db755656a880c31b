"""Copies of periodic grids: bitwise joined, in their places, closed to a ring where they fill the turn."""

import numpy as np
import pytest

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolved
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import measure

PARTS = 7


def plane(count: int = 4) -> np.ndarray:
    """Nodes (count, 3, 2) of a bent duct above the x axis."""
    x, r = np.meshgrid(np.linspace(0.0, 2.0, count), [1.0, 1.4, 2.0], indexing="ij")
    return np.stack([x + 0.2 * r, r + 0.1 * x**2], axis=-1)


def passage(axis: AxisLine | None = None, degrees: float = 360.0 / PARTS) -> Grid:
    return revolved(Grid((Block(plane()),)), Revolution(degrees, 5, axis or AxisLine()))


def turned(nodes: np.ndarray, angle: float) -> np.ndarray:
    """Nodes rotated about the x axis, by complex numbers."""
    other = (nodes[..., 1] + 1j * nodes[..., 2]) * np.exp(1j * angle)
    return np.stack([nodes[..., 0], other.real, other.imag], axis=-1)


def strip(shift: tuple[float, float]) -> Grid:
    """A block whose north side is its south side shifted."""
    line = np.stack([np.linspace(0.0, 1.0, 6), 0.1 * np.sin(np.arange(6.0))], axis=-1)
    nodes = np.stack([line, line + 0.4 * np.array(shift), Motion(shift)(line)], axis=1)
    ends = (0, "south", ((0, 5),)), (0, "north", ((0, 5),))
    patches = (Patch("in", "west", 0, 2, kind="inlet"), Patch("out", "east", 0, 2, kind="outlet"))
    return Grid((Block(nodes),), patches, (Connection(*ends[0], *ends[1], (1,), Motion(shift)),))


@pytest.mark.parametrize("copies", [2, 5])
def test_copies_are_turned_by_periods_and_periodic_by_all_of_them(copies: int) -> None:
    one, many = passage(), copied(passage(), copies)
    (period,) = (each for each in one.connections if each.transform)
    first, second = (one.face(0, side) for side in (period.side, period.donor_side))
    angle = np.angle((second[0, 0, 1] + 1j * second[0, 0, 2]) / (first[0, 0, 1] + 1j * first[0, 0, 2]))
    for k, block in enumerate(many.blocks):
        assert block.nodes == pytest.approx(turned(one.nodes, k * angle), abs=1e-14)
    (outer,) = (each for each in many.connections if each.transform)
    own, donor = (many.face(*end[:2]) for end in outer.ends)
    assert np.array_equal(outer.transform(own), donor)  # type: ignore[misc]
    assert donor == pytest.approx(turned(own, copies * angle), abs=1e-14)


def test_a_whole_turn_is_a_ring_of_the_whole_volume_without_periodic_sides() -> None:
    ring = copied(passage(), PARTS)
    assert len(ring.connections) == PARTS
    assert all(each.transform is None for each in ring.connections)
    names = [{patch.name for patch in grid.outer_patches()} for grid in (ring, passage())]
    assert names[0] == names[1]
    whole = revolved(Grid((Block(plane()),)), Revolution(360.0, 4 * PARTS + 1))
    volumes = [np.linalg.det(_edges(block.nodes)).sum() for block in ring.blocks]
    assert sum(volumes) == pytest.approx(np.linalg.det(_edges(whole.nodes)).sum(), rel=1e-12)
    assert measure(ring).folded == 0


def _edges(nodes: np.ndarray) -> np.ndarray:
    """Edges (..., 3, 3) that leave the first corner of each cell."""
    start = nodes[:-1, :-1, :-1]
    ends = nodes[1:, :-1, :-1], nodes[:-1, 1:, :-1], nodes[:-1, :-1, 1:]
    return np.stack([end - start for end in ends], axis=-1)


def test_the_axis_may_be_any_line() -> None:
    axis = AxisLine(0.3, -2.0, 1.0, 0.4)
    many = copied(passage(axis), PARTS)
    mean = np.mean([block.nodes.reshape(-1, 3).mean(axis=0) for block in many.blocks], axis=0)
    along = np.array([1.0, 0.4, 0.0]) / np.hypot(1.0, 0.4)
    off = mean - np.array([0.3, -2.0, 0.0])
    assert np.linalg.norm(off - (off @ along) * along) == pytest.approx(0.0, abs=1e-13)


def test_translated_copies_are_a_row_of_them() -> None:
    many = copied(strip((0.1, 0.7)), 4)
    for k, block in enumerate(many.blocks):
        assert block.nodes == pytest.approx(strip((0.1, 0.7)).nodes + k * np.array([0.1, 0.7]), abs=1e-14)
    (outer,) = (each for each in many.connections if each.transform)
    assert outer.transform.shift == pytest.approx((0.4, 2.8), rel=1e-15)  # type: ignore[union-attr]
    assert [patch.name for patch in many.patches] == ["in", "out"] * 4


def test_one_copy_is_the_grid_itself() -> None:
    grid = passage()
    assert copied(grid, 1) is grid


@pytest.mark.parametrize(
    ("grid", "copies", "words"),
    [
        (passage(), PARTS + 1, "8 copies of 51.4286 degrees; use 1 to 7"),
        (passage(degrees=70.0), 6, "6 copies of 70 degrees; use 1 to 5"),
        (passage(), 0, "0 copies"),
        (strip((0.0, 1.0)), 20_000, "use 1 to 10000"),
        (Grid((Block(plane()),)), 2, "the grid is not periodic"),
    ],
)
def test_what_has_no_copies_is_refused(grid: Grid, copies: int, words: str) -> None:
    with pytest.raises(InputError, match=words):
        copied(grid, copies)


def cell() -> Grid:
    """Two blocks side by side, periodic along x and y, with uneven nodes."""
    x, y = np.meshgrid([0.0, 0.3, 1.1, 1.3], [0.0, 0.9, 1.0, 2.7], indexing="ij")
    left, right = np.stack([x[:3], y[:3]], axis=-1), np.stack([x[2:], y[2:]], axis=-1)
    up = Motion((0.0, 2.7))
    return Grid(
        (Block(left), Block(right)),
        (),
        (
            Connection(0, "east", ((0, 3),), 1, "west", ((0, 3),), (1,)),
            Connection(0, "west", ((0, 3),), 1, "east", ((0, 3),), (1,), Motion((1.3, 0.0))),
            Connection(0, "south", ((0, 2),), 0, "north", ((0, 2),), (1,), up),
            Connection(1, "north", ((0, 1),), 1, "south", ((0, 1),), (1,), up.inverse()),
        ),
    )


@pytest.mark.parametrize("counts", [(3, 2), (1, 4), (2, 1)])
def test_a_cell_with_two_periods_is_tiled_both_ways(counts: tuple[int, int]) -> None:
    grid = copied(cell(), counts)
    corners = {tuple(block.nodes[0, 0].round(9)) for block in grid.blocks}
    along, across = (range(count) for count in counts)
    places = {(round(1.3 * i + x, 9), round(2.7 * j, 9)) for i in along for j in across for x in (0, 1.1)}
    assert corners == places
    assert grid.box == pytest.approx(np.array([[0.0, 0.0], [1.3 * counts[0], 2.7 * counts[1]]]))
    shifts = set()
    for each in grid.connections:
        own, donor = (grid.face(*end[:2])[slice(end[2][0][0], end[2][0][1] + 1)] for end in each.ends)
        motion = each.transform or Motion()
        assert np.array_equal(motion(own), donor)
        shifts.add(motion.shift)
    outer = {tuple(sorted(abs(round(x, 9)) for x in shift)) for shift in shifts if shift}
    assert outer == {(0.0, round(1.3 * counts[0], 9)), (0.0, round(2.7 * counts[1], 9))}
    assert measure(grid).folded == 0


def test_numbers_of_copies_are_those_of_the_periods() -> None:
    shifts = r"shifts of \(1\.3, 0\) and \(0, 2\.7\); give a number for each, such as 3x2"
    with pytest.raises(InputError, match=shifts):
        copied(cell(), 2)
    with pytest.raises(InputError, match="2 numbers for a grid with one period; give one"):
        copied(strip((0.0, 1.0)), (2, 3))
    with pytest.raises(InputError, match="200x200 copies; use at most 10000 in all"):
        copied(cell(), (200, 200))
