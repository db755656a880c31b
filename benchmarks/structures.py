"""Block structures to try: vertices, counts, gradings and curves as `block_mesh` takes them."""

from collections.abc import Callable
from typing import Any

import numpy as np

Structure = dict[str, Any]


def pipe() -> Structure:
    """Return the section of a round pipe: a square core, four blocks that are graded to the wall."""
    core = 0.42
    vertices = [*_ring(core * np.sqrt(2.0)), *_ring(1.0)]
    ring = [
        _block((k, 4 + k, 4 + (k + 1) % 4, (k + 1) % 4), (14, 16), (0.2, 0.2, 1.0, 1.0)) for k in range(4)
    ]
    arcs = [_arc(4 + k, 4 + (k + 1) % 4, 0.5 * np.pi * k - 0.5 * np.pi) for k in range(4)]
    wall = [[4 + k, 4 + (k + 1) % 4] for k in range(4)]
    return _structure(vertices, [_block((0, 1, 2, 3), (16, 16)), *ring], {"wall": wall}, arcs)


def cylinder_in_channel() -> Structure:
    """Return a cylinder in a channel: four graded blocks around it, eight between those and walls."""
    x, y = (-3.0, -1.4, 1.4, 8.0), (-2.0, -1.4, 1.4, 2.1)
    vertices = [*_ring(0.5), *([x[i], y[j]] for j in range(4) for i in range(4))]

    def box(i: int, j: int) -> int:
        return 4 + 4 * j + i

    around = [box(1, 1), box(2, 1), box(2, 2), box(1, 2)]
    ring = [
        _block((k, around[k], around[(k + 1) % 4], (k + 1) % 4), (20, 24), (12.0, 12.0, 1.0, 1.0))
        for k in range(4)
    ]
    cells_x, cells_y = (14, 24, 40), (6, 24, 6)
    graded = (0.6, 1.0, 4.0)
    boxes = [
        _block(
            (box(i, j), box(i + 1, j), box(i + 1, j + 1), box(i, j + 1)),
            (cells_x[i], cells_y[j]), (graded[i], graded[i], 1.0, 1.0),
        )
        for j in range(3) for i in range(3) if (i, j) != (1, 1)
    ]  # fmt: skip
    patches = {
        "cylinder": [[k, (k + 1) % 4] for k in range(4)],
        "wall": [[box(i, j), box(i + 1, j)] for i in range(3) for j in (0, 3)],
        "inlet": [[box(0, j), box(0, j + 1)] for j in range(3)],
        "outlet": [[box(3, j), box(3, j + 1)] for j in range(3)],
    }
    arcs = [_arc(k, (k + 1) % 4, 0.5 * np.pi * k - 0.5 * np.pi, 0.5) for k in range(4)]
    return _structure(vertices, [*ring, *boxes], patches, arcs)


def bump() -> Structure:
    """Return a channel over a circular bump: three blocks, graded to the floor."""
    xs, height = (-1.5, -0.5, 0.5, 2.5), 1.0
    vertices = [[x, 0.0] for x in xs] + [[x, height] for x in xs]
    cells, grades = (24, 30, 40), (0.25, 1.0, 6.0)
    blocks = [
        _block((k, k + 1, k + 5, k + 4), (cells[k], 30), (grades[k], grades[k], 40.0, 40.0)) for k in range(3)
    ]
    edges = [{"type": "arc", "start": 1, "end": 2, "points": [[0.0, 0.12]]}]
    patches = {
        "floor": [[k, k + 1] for k in range(3)], "top": [[k + 4, k + 5] for k in range(3)],
        "inlet": [[0, 4]], "outlet": [[3, 7]],
    }  # fmt: skip
    return _structure(vertices, blocks, patches, edges)


def junction() -> Structure:
    """Return a branch that leaves a duct obliquely: four blocks, one of them common to both."""
    vertices = [
        [-3, 0],
        [-0.6, 0],
        [0.6, 0],
        [4, 0],
        [-3, 1],
        [-0.6, 1],
        [0.6, 1],
        [4, 1],
        [1.4, 3],
        [2.6, 3],
    ]
    walls = (0.3, 0.3)
    both = [[0.5, 0.5, 6.0], [0.5, 0.5, 1 / 6.0]]
    blocks = [
        _block((0, 1, 5, 4), (40, 20), (*walls, both, both)),
        _block((1, 2, 6, 5), (20, 20), (both, both, both, both)),
        _block((2, 3, 7, 6), (50, 20), (3.0, 3.0, both, both)),
        _block((5, 6, 9, 8), (20, 30), (both, both, 3.0, 3.0)),
    ]
    patches = {
        "wall": [[0, 1], [1, 2], [2, 3], [4, 5], [6, 7], [5, 8], [6, 9]],
        "inlet": [[0, 4]], "outlet": [[3, 7], [8, 9]],
    }  # fmt: skip
    return _structure(vertices, blocks, patches)


def diffuser() -> Structure:
    """Return a nozzle and a curved diffuser, two blocks high, with cells that jump at the throat."""
    top = [[-2.0, 1.0], [0.0, 0.45], [3.0, 1.1], [5.0, 1.1]]
    vertices = [*([x, 0.0] for x, _ in top), *([x, 0.55 * y] for x, y in top), *top]
    cells, grades = (30, 50, 20), (0.5, 3.0, 1.5)
    blocks = []
    for first, rows, across in ((0, 14, 1.0), (4, 18, 0.08)):
        for k in range(3):
            a = first + k
            graded = (grades[k], grades[k], across, across)
            blocks.append(_block((a, a + 1, a + 5, a + 4), (cells[k], rows), graded))
    edges = [
        {"type": "spline", "start": 8, "end": 9, "points": [[-1.6, 0.97], [-1.0, 0.72], [-0.5, 0.49]]},
        {"type": "spline", "start": 9, "end": 10, "points": [[0.7, 0.5], [1.5, 0.75], [2.3, 1.02]]},
    ]
    patches = {
        "wall": [[k + 8, k + 9] for k in range(3)], "axis": [[k, k + 1] for k in range(3)],
        "inlet": [[0, 4], [4, 8]], "outlet": [[3, 7], [7, 11]],
    }  # fmt: skip
    return _structure(vertices, blocks, patches, edges)


STRUCTURES: dict[str, Callable[[], Structure]] = {
    "pipe": pipe, "cylinder-in-channel": cylinder_in_channel, "bump": bump, "junction": junction,
    "diffuser": diffuser,
}  # fmt: skip


def _ring(radius: float) -> list[list[float]]:
    """Four points on a circle, counter-clockwise from the lower left."""
    angles = np.pi * (-0.75 + 0.5 * np.arange(4))
    return [[float(radius * np.cos(a)), float(radius * np.sin(a))] for a in angles]


def _arc(start: int, end: int, middle: float, radius: float = 1.0) -> dict[str, Any]:
    point = [float(radius * np.cos(middle)), float(radius * np.sin(middle))]
    return {"type": "arc", "start": start, "end": end, "points": [point]}


def _block(corners: tuple[int, ...], counts: tuple[int, int], grading: Any = (1.0,) * 4) -> dict[str, Any]:
    return {"corners": list(corners), "counts": list(counts), "grading": list(grading)}


def _structure(
    vertices: Any, blocks: list[Any], patches: dict[str, Any], edges: list[Any] | None = None
) -> Structure:
    walls = ("wall", "cylinder", "floor", "top")
    rows = {name: {"type": "wall" if name in walls else "patch", "edges": e} for name, e in patches.items()}
    return {"vertices": vertices, "blocks": blocks, "edges": edges or [], "patches": rows}
