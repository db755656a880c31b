"""The judge: angles, folded cells and errors at the boundary, by NumPy alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from yardstick.shapes import Floats, Shape


@dataclass(frozen=True)
class Figures:
    """Quality of one grid.

    `folded`: cells with a corner whose Jacobian is not positive; `largest`, `smallest`: included angles in
    degrees; `skew`: mean over the cells of the largest deviation of an angle from 90 degrees; `boundary`:
    largest distance of a boundary node from the given one, relative to the diagonal of the shape (of the body
    for an O grid).
    """

    folded: int
    largest: float
    smallest: float
    skew: float
    boundary: float


def judge(shape: Shape, nodes: Floats) -> Figures:
    """Return the figures of the grid (ni, nj, 2) of a shape. Raises ValueError: other node counts."""
    counts = (len(shape.south), len(shape.west), 2)
    if nodes.shape != counts:
        raise ValueError(f"{shape.name}: {nodes.shape} nodes, expected {counts}")
    corners = np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]])
    ahead, behind = np.roll(corners, -1, 0) - corners, np.roll(corners, 1, 0) - corners
    jacobian = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    angles = np.degrees(np.arctan2(jacobian, (ahead * behind).sum(-1))) % 360.0
    edges = [nodes[:, 0] - shape.south, nodes[:, -1] - shape.north]
    if shape.topology == "quad":
        edges += [nodes[0] - shape.west, nodes[-1] - shape.east]
    else:
        edges.append(nodes[0] - nodes[-1])
    outline = shape.south if shape.topology == "o" else np.concatenate([shape.south, shape.north])
    size = np.hypot(*np.ptp(outline, axis=0))
    return Figures(
        folded=int((~(jacobian > 0.0)).any(axis=0).sum()),
        largest=float(angles.max()),
        smallest=float(angles.min()),
        skew=float(np.abs(angles - 90.0).max(axis=0).mean()),
        boundary=float(max(np.hypot(*edge.T).max() for edge in edges) / size),
    )


def summary(shapes: Sequence[Shape], grids: Mapping[str, Floats]) -> dict[str, float]:
    """Return figures of all grids; shapes without a grid count as missing."""
    figures = [judge(shape, grids[shape.name]) for shape in shapes if shape.name in grids]
    if not figures:
        return {"shapes": len(shapes), "missing": len(shapes)}
    return {
        "shapes": len(shapes),
        "missing": len(shapes) - len(figures),
        "folded_grids": sum(one.folded > 0 for one in figures),
        "folded_cells": sum(one.folded for one in figures),
        "largest_mean": float(np.mean([one.largest for one in figures])),
        "largest": max(one.largest for one in figures),
        "smallest": min(one.smallest for one in figures),
        "skew": float(np.mean([one.skew for one in figures])),
        "boundary": max(one.boundary for one in figures),
    }
