"""Nodes moved along the lines of a volume: the kernel compared, bit by bit, with whole arrays in NumPy."""

import math
from typing import cast

import numpy as np
import pytest

from meshonet.geometry import threads
from meshonet.geometry.arrays import Floats, Indices, norms
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.hyperbolic.volume.limited_growth import growth_of_levels, limit_growth


def drawn(lines: int, cells: int, growth: float, spread: float) -> Floats:
    """Return curved lines (3, n, cells + 1) that grow by about `growth`, by `spread` more or less."""
    rng = np.random.default_rng(7 * lines + cells)
    ratio = np.log(growth) + spread * rng.normal(size=(lines, cells - 1))
    steps = 1e-3 * np.exp(np.cumsum(np.concatenate([np.zeros((lines, 1)), ratio], axis=1), axis=1))
    ways = (
        rng.normal(size=(3, lines, 1)) + 0.2 * np.cumsum(rng.normal(size=(3, lines, cells)), axis=2) / cells
    )
    ways /= np.sqrt((ways**2).sum(axis=0))
    ends = np.concatenate([np.zeros((3, lines, 1)), np.cumsum(steps * ways, axis=2)], axis=2)
    return cast(Floats, rng.normal(size=(3, lines, 1)) + ends)


def in_numpy(lines: Floats, growth: float) -> None:
    most = math.log(growth)
    for _ in range(12):
        steps = norms(np.moveaxis(np.diff(lines, axis=2), 0, -1))
        change = np.diff(log(steps), axis=1)
        uneven = np.flatnonzero(np.abs(change).max(axis=1) > most)
        if not len(uneven):
            break
        move(lines, uneven, steps[uneven], limited(steps[uneven], change[uneven], (1.0 - 1e-3) * most))


def limited(steps: Floats, change: Floats, most: float) -> Floats:
    length = steps.sum(axis=1)
    longest = steps[:, 0] * math.expm1(most * steps.shape[1]) / math.expm1(most)
    bound = np.where(longest < length, math.inf, most)[:, None]
    change = np.where(longest < length, 0.0, 1.0)[:, None] * change

    def made(tilt: Floats) -> Floats:
        log_ratio = np.cumsum(np.clip(change + tilt[:, None], -bound, bound), axis=1)
        return np.concatenate([steps[:, :1], steps[:, :1] * exp(log_ratio)], axis=1)

    low, high = np.full(len(steps), -2.0 * most), np.full(len(steps), 2.0 * most)
    for _ in range(40):
        tilt = 0.5 * (low + high)
        short = made(tilt).sum(axis=1) < length
        low, high = np.where(short, tilt, low), np.where(short, high, tilt)
    return made(0.5 * (low + high))


def move(lines: Floats, which: Indices, old: Floats, new: Floats) -> None:
    before, after = (np.cumsum(steps, axis=1) for steps in (old, new))
    for row, n in enumerate(which):
        for axis in range(3):
            line = lines[axis, n]
            line[2:-1] = np.interp(after[row, 1:-1], before[row], line[1:])


@pytest.mark.parametrize(
    ("lines", "cells", "growth", "spread"),
    [(21, 40, 1.1, 0.05), (3, 7, 1.1, 0.1), (9, 90, 1.18, 0.02), (10, 150, 1.05, 0.1), (4, 300, 1.02, 0.05),
     (6, 30, 1.4, 0.1), (2, 2, 1.1, 0.5)],
)  # fmt: skip
def test_lines_are_those_of_numpy(lines: int, cells: int, growth: float, spread: float) -> None:
    """Sums of few and of many cells; among them are lines too long for the limit, and even ones."""
    start = drawn(lines, cells, growth, spread)
    expected, made = start.copy(), start.copy()
    in_numpy(expected, 1.2)
    limit_growth(made, 1.2)
    assert made.tobytes() == expected.tobytes()
    assert not np.array_equal(made, start) or cells == 2


def test_lines_do_not_depend_on_the_number_of_threads(eager_threads: None) -> None:
    start = drawn(43, 40, 1.1, 0.05)
    made = []
    for count in (1, 2, 3):
        made.append(start.copy())
        with threads.limited_to(count):
            limit_growth(made[-1], 1.2)
    assert made[0].tobytes() == made[1].tobytes() == made[2].tobytes()
    assert growth_of_levels(made[0]).max() <= 1.2 < growth_of_levels(start).max()


def test_even_lines_stay_where_they_are() -> None:
    start = drawn(21, 40, 1.1, 0.0)
    made = start.copy()
    limit_growth(made, 1.3)
    assert made.tobytes() == start.tobytes()
    limit_growth(made, math.inf)
    assert made.tobytes() == start.tobytes()
