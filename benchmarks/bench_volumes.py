"""Volumes inside six faces: time beside a copy of the nodes, and quality of the methods.

    python benchmarks/bench_volumes.py [--domains 50] [--largest 257] [--page docs/benchmarks/volumes.md]

Times are processor seconds of one thread, the least of several runs; a copy is one into memory in use.
Angles are deviations from 90 degrees, the worst of the three at a corner; SJ is the scaled corner Jacobian.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from itertools import count

import numpy as np
from clock import clocked
from page import arguments, publish

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.threads import limited_to
from meshonet.solvers.solution import Solution
from meshonet.solvers.volumes.interpolate import interpolate
from meshonet.solvers.volumes.laws import arc_laws, mean_laws, uniform_laws
from meshonet.solvers.volumes.refine import refine_volume, spline_of
from meshonet.solvers.volumes.tfi import tfi
from meshonet.solvers.volumes.variational import optimum, variational
from meshonet.solvers.volumes.winslow import winslow

HEAD = """# Volumes inside six faces

<!-- made by python benchmarks/bench_volumes.py --page docs/benchmarks/volumes.md -->

Use this page to find the CPU time and the quality of volume grids inside six faces. For their use see
[volumes](../guide/volumes.md). Times are CPU times of one thread, the minimum of several runs. The table
compares them with the time of copying the nodes into memory that is already allocated. Each cell corner
counts the largest deviation from 90 degrees of its three angles. SJ is the scaled Jacobian at the
corners.
"""


def random_faces(seed: int, n: int, size: float = 0.06) -> SixFaces:
    """Return moved corners, a smooth warp and independent bubbles of `size` on each face, n nodes a side."""
    rng = np.random.default_rng(seed)
    bubbles, unit = rng.normal(size=(3, 2, 3, 3, 3)), np.linspace(0.0, 1.0, n)
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3, indexing="ij"), axis=-1)
    corners += 0.08 * rng.normal(size=(2, 2, 2, 3))
    warp = 0.025 * rng.normal(size=(3, 3, 3, 3))

    def face(axis: int, end: int) -> Floats:
        s, t = np.meshgrid(unit, unit, indexing="ij")
        place = [s, t]
        place.insert(axis, np.full_like(s, end))
        a, b, c = place
        nodes = np.zeros((n, n, 3))
        for i, j, k in np.ndindex(2, 2, 2):
            share = (a if i else 1 - a) * (b if j else 1 - b) * (c if k else 1 - c)
            nodes += share[..., None] * corners[i, j, k]
        for p, q, r in np.ndindex(3, 3, 3):
            wave = np.cos(np.pi * (p * a + q * b + r * c) + p - q) / (1 + p + q + r)
            nodes += wave[..., None] * warp[p, q, r]
        inside = 4 * s * (1 - s) * t * (1 - t)
        for p, q in np.ndindex(3, 3):
            wave = np.sin(np.pi * (p + 1) * s) * np.sin(np.pi * (q + 1) * t) / (1 + p + q)
            nodes += np.where(inside > 0, wave, 0.0)[..., None] * size * bubbles[axis, end, p, q]
        return nodes

    return SixFaces(*(face(axis, end) for axis in range(3) for end in (0, 1)))


def quality(nodes: Floats) -> tuple[int, float, float, float]:
    """Return folded cells, least SJ, mean and 99th percentile of the corners' deviation."""
    edges = [np.diff(nodes, axis=axis) for axis in range(3)]
    worst, scaled = [], []
    for corner in np.ndindex(2, 2, 2):
        three = []
        for axis in range(3):
            part = [slice(c, c - 1 or None) for c in corner]
            part[axis] = slice(None)
            edge = edges[axis][tuple(part)]
            three.append(edge / np.linalg.norm(edge, axis=-1, keepdims=True))
        u, v, w = three
        scaled.append((np.cross(u, v) * w).sum(axis=-1))
        dots = [np.abs((p * q).sum(axis=-1)) for p, q in ((u, v), (u, w), (v, w))]
        worst.append(np.degrees(np.arcsin(np.minimum(np.maximum.reduce(dots), 1.0))))
    every = np.stack(worst)
    return count_folded(nodes), float(np.min(scaled)), float(every.mean()), float(np.quantile(every, 0.99))


def times(sizes: list[int]) -> str:
    """Return the table of times at the largest counts."""
    lines = ["| nodes | computation | CPU time, ms | relative to copy |", "| --- | --- | --- | --- |"]
    for n in sizes:
        faces = random_faces(1, n, 0.03)
        out, other = np.zeros((3, n, n, n)), np.ones((3, n, n, n))
        copy = clocked(partial(np.copyto, out, other), 15)[0]
        laws, few = mean_laws(arc_laws(faces)), faces.resampled((33, 33, 33))
        planes = optimum(few)[0]
        start = np.moveaxis(interpolate(few, uniform_laws(few.counts)), -1, 0)
        spline = spline_of(planes - start, (laws[0][0], laws[1][0], laws[2][0]))
        rows: dict[str, Callable[[], object]] = {
            "copy of the nodes": partial(np.copyto, out, other),
            "interpolation, linear": partial(interpolate, faces, uniform_laws(faces.counts), out=out),
            "interpolation, arc length": partial(interpolate, faces, arc_laws(faces), out=out),
            "spline evaluation of a 33³ grid": partial(interpolate, faces, laws, spline, out),
            "the same with coefficients, new memory": partial(refine_volume, planes, few, faces, laws),
            "test of all corner Jacobians": partial(count_folded, np.moveaxis(out, 0, -1)),
            "variational method, in total": partial(variational, faces),
        }
        if n <= 129:
            rows["Winslow's equations, in total"] = partial(winslow, faces)
        for name, act in rows.items():
            spent = copy if "copy" in name else clocked(act, 7 if n < 200 else 3)[0]
            lines.append(f"| {n}³ | {name} | {1e3 * spent:.1f} | {spent / copy:.2f} |")
    return "\n".join(lines)


def domains(number: int, n: int) -> str:
    """Return the table of random domains whose faces do not fold cells by themselves."""
    methods: dict[str, Callable[[SixFaces], Solution]] = {
        "interpolation": tfi, "Winslow": winslow, "variational": variational,
    }  # fmt: skip
    found: dict[str, list[tuple[float, ...]]] = {name: [] for name in methods}
    refused = 0
    for seed in count(1000):
        faces = random_faces(seed, n)
        row = {}
        try:
            for name in reversed(methods):
                begun = time.process_time()
                nodes = methods[name](faces).grid.nodes
                row[name] = (time.process_time() - begun, *quality(nodes))
        except InputError:
            refused += 1
            continue
        for name, values in row.items():
            found[name].append(values)
        if len(found["Winslow"]) == number:
            break
    table = {name: np.array(rows) for name, rows in found.items()}
    lines = [f"{number} random domains of {n}³ nodes ({refused} more are refused: their faces fold cells).\n"]
    lines += [
        "| method | valid | minimum SJ, median | deviation: mean / 99 %, medians | CPU s: median / 90 % |"
    ]
    lines += ["| --- | --- | --- | --- | --- |"]
    for name, rows in table.items():
        spent, folded, sj, mean, high = rows.T
        middle = f"{np.median(sj):.3f} | {np.median(mean):.1f} / {np.median(high):.1f}"
        seconds = f"{np.median(spent):.3f} / {np.quantile(spent, 0.9):.3f}"
        lines.append(f"| {name} | {int((folded == 0).sum())} of {number} | {middle} | {seconds} |")
    own, other = table["variational"], table["Winslow"]
    worse = int(((own[:, 2] < other[:, 2] - 1e-9) | (own[:, 3] > other[:, 3])).sum())
    lines.append(
        f"\nMean deviation or minimum SJ are worse than those of Winslow's grid in {worse} of {number}."
    )
    return "\n".join(lines)


def main() -> None:
    """Print the tables, or write the page."""
    parser = arguments(__doc__)
    parser.add_argument("--domains", type=int, default=50)
    parser.add_argument("--largest", type=int, default=257)
    chosen = parser.parse_args()
    with limited_to(1):
        parts = [times([n for n in (129, 257) if n <= chosen.largest]), domains(chosen.domains, 33)]
    publish(f"{HEAD}\n## Time\n\n{parts[0]}\n\n## Quality\n\n{parts[1]}\n", chosen.page)


if __name__ == "__main__":
    main()
