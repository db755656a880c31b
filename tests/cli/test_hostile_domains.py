"""Domains that are wrong, degenerate or hardly possible: one clear line, or a valid grid; in good time."""

import json
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, Outcome

from meshonet.formats.registry import read_grids

Loops = Sequence[np.ndarray]
LONGEST = 30.0
"""Seconds of the processor for any domain."""


def polygon(*coordinates: float) -> np.ndarray:
    """The polygon through x, y, x, y ..."""
    return np.array(coordinates, dtype=float).reshape(-1, 2)


def box(left: float, right: float, bottom: float, top: float) -> np.ndarray:
    """A rectangle."""
    return polygon(left, bottom, right, bottom, right, top, left, top)


def circle(x: float, y: float, radius: float, points: int = 96) -> np.ndarray:
    """Points on a circle."""
    turn = 2.0 * np.pi * np.arange(points) / points
    return np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)


def comb(teeth: int, height: float) -> Loops:
    """A comb whose teeth are half as wide as its pitch."""
    tooth = np.array([(0.75, 0.0), (0.75, height), (0.25, height), (0.25, 0.0)])
    rows = [tooth + np.array([k, 0.0]) for k in range(teeth - 1, -1, -1)]
    return [np.concatenate([[(0.0, -1.0), (teeth, -1.0)], *rows])]


def maze(rows: int) -> Loops:
    """A corridor of width 1 to and fro, rows of it 2 apart, with a dead end in its middle."""
    way = [(8.0 * side, 2.0 * row) for row in range(rows) for side in ((0, 1) if row % 2 == 0 else (1, 0))]
    step = np.diff(np.array(way), axis=0)
    left = 0.5 * np.stack([-step[:, 1], step[:, 0]], axis=1) / np.abs(step).sum(axis=1)[:, None]
    bend = np.concatenate([left[:1], left[:-1] + left[1:], left[-1:]])
    dead_end = np.array([(4.5, -0.5), (4.5, -3.0), (3.5, -3.0), (3.5, -0.5)])[::-1]
    right = np.array(way) - bend
    return [np.concatenate([right[:1], dead_end, right[1:], (np.array(way) + bend)[::-1]])]


def spiral(rounds: int) -> Loops:
    """A corridor three times round, wider than its walls are apart."""
    turn = np.linspace(0.0, 2.0 * np.pi * rounds, 80 * rounds)
    way = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    return [np.concatenate([(1.0 + 0.3 * turn)[:, None] * way, ((0.1 + 0.3 * turn)[:, None] * way)[::-1]])]


def snowflake(order: int) -> Loops:
    """Koch's snowflake: corners of 60 and 240 degrees, at all scales."""
    z = np.array([0.0, 0.5 - 0.75**0.5 * 1j, 1.0])[::-1]
    for _ in range(order):
        third = (np.roll(z, -1) - z) / 3.0
        z = np.stack(
            [z, z + third, z + third * (1.0 + np.exp(1j * np.pi / 3)), z + 2 * third], axis=1
        ).ravel()
    z = z if (np.conj(z) * np.roll(z, -1)).imag.sum() > 0 else z[::-1]
    return [np.stack([z.real, z.imag], axis=1)]


def noisy(points: int, noise: float) -> Loops:
    """A circle, each point of which is moved at random."""
    turn = 2.0 * np.pi * np.arange(points) / points
    radius = 1.0 + noise * np.random.default_rng(0).normal(size=points)
    return [radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)]


def holes(columns: int, rows: int) -> Loops:
    """A plate with a square hole in each square of it."""
    middle = [(i + 0.3, i + 0.7, j + 0.3, j + 0.7) for i in range(columns) for j in range(rows)]
    return [box(0.0, columns, 0.0, rows), *(box(*sides) for sides in middle)]


def ell(width: float) -> Loops:
    """A thin L."""
    return [polygon(0, 0, 1, 0, 1, width, width, width, width, 1, 0, 1)]


def scaled(factor: float, shift: float = 0.0) -> Loops:
    """A plate with a hole in another unit, or far from the origin."""
    return [factor * loop + shift for loop in (box(-2, 2, -1, 1), circle(0.0, 0.0, 0.4))]


SQUARE = box(0.0, 1.0, 0.0, 1.0)
REFUSED: dict[str, tuple[Loops, str]] = {
    "crossing itself": ([polygon(0, 0, 1, 1, 1, 0, 0, 1)], "crosses itself at (0.5, 0.5)"),
    "loops that cross": ([SQUARE, circle(1.0, 0.51, 0.2)], "loop 0 (outer) and loop 1 (body)"),
    "holes that cross": ([SQUARE, circle(0.4, 0.5, 0.2), circle(0.6, 0.51, 0.2)], "loop 1 (body) and loop 2"),
    "touching in a point": ([SQUARE, polygon(0, 0.5, 0.3, 0.4, 0.3, 0.6)], "touch at (0, 0.5)"),
    "hole on the edge": ([SQUARE, box(0.3, 0.6, 0.0, 0.3)], "touch at (0.3, 0)"),
    "hole outside": ([SQUARE, circle(3.0, 3.0, 0.2)], "lies outside of loop 0"),
    "hole around": ([SQUARE, box(-1.0, 2.0, -1.0, 2.0)], "lies outside of loop 0"),
    "hole in a hole": ([SQUARE, circle(0.5, 0.5, 0.3), circle(0.5, 0.5, 0.1)], "lies inside of loop 1"),
    "hole as large": ([SQUARE, SQUARE], "touch at (0, 0)"),
    "spike": ([polygon(0, 0, 1, 0, 1, 0.5, 2, 0.5, 1, 0.5, 1, 1, 0, 1)], "(1, 0.5)"),
    "slit": ([polygon(0, 0, 1, 0, 1, 0.5, 0.5, 0.5, 1, 0.5, 1, 1, 0, 1)], "(1, 0.5)"),
    "a line": ([polygon(0, 0, 0.5, 0, 1, 0)], "(0, 0)"),
    "NaN": ([polygon(0, 0, 1, 0, np.nan, 1, 0, 1)], "not finite"),
    "infinite": ([polygon(0, 0, 1, 0, np.inf, 1, 0, 1)], "not finite"),
    "one point": ([np.zeros((1, 2))], ""),
    "two points": ([polygon(0, 0, 1, 0)], ""),
    "hole of one point": ([SQUARE, np.full((1, 2), 0.5)], ""),
}
"""Bad input, and what the line says of it: exit code 2."""

MADE: dict[str, Loops] = {
    "hairline gap": [SQUARE, box(1e-4, 0.4, 0.3, 0.6)],
    "needle of 1 degree": [polygon(0, 0, 10, 0, 10, 10 * np.tan(np.pi / 180))],
    "needle into the domain": [polygon(0, 0, 4, 0, 4, 2, 2.02, 2, 2, 0.5, 1.98, 2, 0, 2)],
    "needle out of the domain": [polygon(0, 0, 4, 0, 4, 2, 2.02, 2, 2, 4, 1.98, 2, 0, 2)],
    "body of a needle": [box(-2, 2, -1, 1), polygon(-1, 0, 1, -0.0175, 1, 0.0175)],
    "10,000 points": [circle(0, 0, 1, 10_000), circle(0.2, 0, 0.3, 10_000)],
    "40 holes": holes(8, 5),
    "unit of 1e-9": scaled(1e-9),
    "unit of 1e9": scaled(1e9),
    "far from the origin": scaled(1.0, 1e6),
    "duplicate points": [np.repeat(SQUARE, 3, axis=0), np.repeat(circle(0.5, 0.5, 0.2, 24), 2, axis=0)],
    "points hardly apart": [polygon(0, 0, 1, 0, 1, 1e-10, 1, 1, 0, 1)],
    "clockwise": [SQUARE[::-1], circle(0.5, 0.5, 0.2)],
    "spiral": spiral(3),
    "comb of 100 teeth": comb(100, 1.0),
    "maze": maze(8),
    "annulus of width 1e-3": [circle(0, 0, 1, 200), circle(0, 0, 1 - 1e-3, 200)],
    "L of width 1e-3": ell(1e-3),
    "strip of 1e6": [box(0, 1e6, 0, 1)],
    "hole of 1e-7": [SQUARE, circle(0.5, 0.5, 1e-7)],
}
"""Domains that a valid grid is made of."""

EITHER: dict[str, Loops] = {
    "gap of 1e-9": [SQUARE, box(1e-9, 0.4, 0.3, 0.6)],
    "long teeth": comb(100, 10.0),
    "snowflake of 768 corners": snowflake(4),
    "thousands of corners": noisy(2000, 3e-3),
}
"""Domains that may be refused with exit code 3 and the place, or be made into a valid grid."""


def made(meshonet: Meshonet, loops: Loops) -> Outcome:
    """Return what the program does with a domain, `grid.vtm` if it makes one, and check how long it takes."""
    rings = [np.concatenate([loop, loop[:1]]).tolist() for loop in loops]
    Path("domain.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": rings}))
    begun = time.process_time()
    outcome = meshonet("solve-pde", "domain.geojson", "--cells", 1500, "--quiet", "-o", "grid.vtm")
    assert time.process_time() - begun < LONGEST
    assert "internal error" not in outcome.err
    assert "Traceback" not in outcome.err
    return outcome


def one_line(outcome: Outcome, says: str) -> None:
    """Check that a refusal is one line, and that nothing is written."""
    assert outcome.err.count("\n") == 1
    assert outcome.err.startswith("error: ")
    assert says in outcome.err
    assert not Path("grid.vtm").exists()


def valid(loops: Loops) -> None:
    """Check that no cell is folded, that blocks conform, and that the area is right."""
    (grid,) = read_grids("grid.vtm")
    origin = loops[0].mean(axis=0)
    parts, cells, edges, every = 0.0, 0, set(), set()
    inside: set[tuple[bytes, bytes]] = set()
    for block in grid.blocks:
        nodes = block.nodes - origin
        ring = [nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]]
        for k in range(4):
            ahead, behind = ring[(k + 1) % 4] - ring[k], ring[(k - 1) % 4] - ring[k]
            assert (ahead[..., 0] * behind[..., 1] > ahead[..., 1] * behind[..., 0]).all()
            names = [[node.tobytes() for node in (ring[j] + 0.0).reshape(-1, 2)] for j in (k, (k + 1) % 4)]
            for first, last in zip(*names, strict=True):
                assert (first, last) not in inside  # a cell on either side of an edge at the most
                inside.add((first, last))
                edges.add(frozenset((first, last)))
                every |= {first, last}
        diagonals = ring[2] - ring[0], ring[3] - ring[1]
        parts += doubled(*diagonals) / 2
        cells += ring[0][..., 0].size
    assert len(every) - len(edges) + cells == 2 - len(loops)  # Euler: one piece, and all holes
    areas = [abs(doubled(loop - origin, np.roll(loop - origin, -1, axis=0))) / 2 for loop in loops]
    assert parts == pytest.approx(areas[0] - sum(areas[1:]), rel=2e-3)


def doubled(first: np.ndarray, second: np.ndarray) -> float:
    """Return twice the area of the triangles that pairs of vectors span."""
    return float((first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]).sum())


@pytest.mark.parametrize("name", REFUSED)
def test_bad_input_is_refused_in_one_line_that_says_where(name: str, meshonet: Meshonet) -> None:
    loops, says = REFUSED[name]
    outcome = made(meshonet, loops)
    assert outcome.code == 2
    one_line(outcome, says)


@pytest.mark.parametrize("name", MADE)
def test_hard_domains_become_valid_grids(name: str, meshonet: Meshonet) -> None:
    outcome = made(meshonet, MADE[name])
    assert outcome.code == 0, outcome.err
    valid(MADE[name])


@pytest.mark.parametrize("name", EITHER)
def test_domains_that_are_hardly_possible_are_refused_with_the_place_or_made(
    name: str, meshonet: Meshonet
) -> None:
    outcome = made(meshonet, EITHER[name])
    if outcome.code == 0:
        valid(EITHER[name])
    else:
        assert outcome.code == 3
        one_line(outcome, " at (")


def test_two_polygons_are_two_grids(meshonet: Meshonet) -> None:
    rings = [[np.concatenate([loop, loop[:1]]).tolist()] for loop in (SQUARE, SQUARE + 3.0)]
    Path("two.geojson").write_text(json.dumps({"type": "MultiPolygon", "coordinates": rings}))
    assert meshonet("solve-pde", "two.geojson", "--cells", 200, "-o", "two.h5").code == 0
    assert [grid.blocks[0].nodes.min() for grid in read_grids("two.h5")] == [0.0, 3.0]


@pytest.mark.parametrize(
    "text",
    [
        "", '{"type": "Polygon"', '{"type": "Polygon"}', '{"type": "Polygon", "coordinates": []}',
        '{"type": "Polygon", "coordinates": [[]]}', '{"type": "Polygon", "coordinates": [[null, [1, 0]]]}',
        '{"type": "Polygon", "coordinates": [[["a", "b"], [1, 0], [1, 1], ["a", "b"]]]}',
        '{"type": "Polygon", "coordinates": [[[1e308, 0], [1, 0], [1, 1e308], [1e308, 0]]]}',
        '{"type": "Feature", "geometry": null, "properties": {}}', "[" * 20_000,
    ],
)  # fmt: skip
def test_files_that_are_no_domain_are_refused(text: str, meshonet: Meshonet) -> None:
    Path("domain.geojson").write_text(text)
    outcome = meshonet("solve-pde", "domain.geojson", "--cells", 1500, "-o", "grid.vtm")
    assert outcome.code == 2
    assert "internal error" not in outcome.err
    one_line(outcome, "domain.geojson")
