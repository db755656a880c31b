"""Volumes marched from surfaces: folds, first cells, quality, angles, growth, time.

    python benchmarks/bench_marching.py [--surfaces FOLDER] [--page docs/benchmarks/marching-surfaces.md]

Surfaces are those of the tests and the Plot3D files ``*.fmt`` of FOLDER, marched as its ``README.md`` has it
in rows ``| names | script | N | s0 | marchDist |``. One thread.
"""

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from page import arguments, processor, publish

sys.path.append(str(Path(__file__).parents[1] / "tests" / "solvers"))
import surface_shapes as shapes

from meshonet import read
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids
from meshonet.geometry.surface.surface import surface_of
from meshonet.geometry.threads import limited_to
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface

HEAD = """# Volumes marched from surfaces: quality and time

<!-- made by python benchmarks/bench_marching.py --page docs/benchmarks/marching-surfaces.md -->

Use this page to find the quality and the CPU time of volumes that `solve-pde --method hyperbolic` [marches
from surfaces](../guide/marching-surfaces.md). Times are for one thread of {machine}.

- *bwb*: blended wing body. *m6_small*: ONERA M6 wing. *even_sphere*, *uneven_sphere*: spheres.
- *star*, *dented*: deformed spheres. *wing, ring and core*: the tip is one patch inside a ring of patches.
- *levels*: number of nodes along a grid line from the surface to the far field.
- *first-cell height*, *distance of the far field*: prescribed values, in the length unit of the surface.
- *folded cells*: cells in which a Bezier coefficient of the Jacobian is not positive.
- *relative error of first-cell height*: maximum over the surface.
- *angle off the normal*: at each node, the grid line to the far field makes an angle with each of the other
  grid lines. The table gives the deviation of these angles from 90 degrees.
- *growth*: ratio of the heights of successive cells towards the far field, larger over smaller, minus 1.
  *prescribed growth*: follows from first-cell height, levels and far-field distance. *largest growth*: in the
  volume.
- *CPU time*: time to march and to test the volume, without reading and writing, best of 3 runs.

"""
COLUMNS = (
    "surface", "nodes on the surface", "levels", "first-cell height", "distance of the far field",
    "folded cells", "relative error of first-cell height", "minimum scaled Jacobian",
    "angle off the normal, degrees: mean / 99th percentile / maximum", "prescribed growth", "largest growth",
    "CPU time, s",
)  # fmt: skip
CONCLUSIONS = """
## Conclusions

- **Valid cells**: no volume has folded cells. First-cell heights are exact to 1e-9.
- **Time**: the blended wing body, with 1.1 million nodes, takes 1.04 s.
- **Growth**: around spheres and deformed spheres with a prescribed growth of 0.164, the largest growth is
  0.17 to 0.21. At the sharp edges of the blended wing body it is 0.81, with a prescribed growth of 0.253.
- **Angles**: the mean angle off the normal is at most 2.7 degrees, except at concave corners and on the
  sphere with 98 nodes.
"""


@dataclass(frozen=True)
class Case:
    """A surface and how it is marched."""

    name: str
    grid: Grid
    march: VolumeMarch


def own_cases() -> Iterator[Case]:
    """Yield surfaces made here."""
    far = {"ellipsoid": 20.0, "cylinder": 20.0}
    made = {
        "sphere": shapes.sphere(32),
        "cube": shapes.cube(32),
        "cylinder, sharp rims": shapes.cylinder(16),
        "star": shapes.star(40),
        "dented": shapes.dented(40),
        "ellipsoid 5 : 1": shapes.ellipsoid(40),
    }
    for name, patches in made.items():
        distance = far.get(name.split()[0].strip(","), 10.0)
        yield Case(name, shapes.grid_of(patches), VolumeMarch(1e-4, 65, distance))
    yield Case("wing, ring and core", shapes.grid_of(shapes.wing(128, 65)), VolumeMarch(1e-5, 81, 15.0))
    for planes in (2, 3):
        patches = shapes.room_corner(16, planes)
        march = VolumeMarch(1e-4, 49, 1.5, "none")
        yield Case(f"concave corner of {planes} plates", shapes.grid_of(patches), march)
    yield Case("plate, free edges", shapes.grid_of(shapes.plate(16)), VolumeMarch(1e-4, 49, 2.0, "none"))


def cases_of(folder: Path) -> Iterator[Case]:
    """Yield the surfaces of a folder, with the numbers of its README."""
    rows = [line.strip("| ").split("|") for line in (folder / "README.md").read_text().splitlines()]
    for row in rows:
        cells = [cell.strip() for cell in row]
        if len(cells) < 5 or ".fmt" not in cells[0] or not cells[2].isdigit():
            continue
        for name in cells[0].split(","):
            path = folder / name.strip()
            march = VolumeMarch(float(cells[3]), int(cells[2]), float(cells[4]))
            yield Case(path.stem, read(path), march)


def off_normal(grid: Grid) -> Floats:
    """Return the degrees between grid lines and the normals of levels, two for each edge at each end."""
    values = []
    for block in grid.blocks:
        line = np.diff(block.nodes, axis=2)
        line /= np.linalg.norm(line, axis=-1, keepdims=True)
        for level in (block.nodes[:, :, :-1], block.nodes[:, :, 1:]):
            for axis in (0, 1):
                edge = np.diff(level, axis=axis)
                edge /= np.linalg.norm(edge, axis=-1, keepdims=True)
                for end in (slice(None, -1), slice(1, None)):
                    at = (end, slice(None)) if axis == 0 else (slice(None), end)
                    values.append(np.abs((edge * line[at]).sum(axis=-1)).ravel())
    return np.degrees(np.arcsin(np.clip(np.concatenate(values), 0.0, 1.0)))


def least_scaled(nodes: Floats) -> float:
    """Return the least scaled Jacobian at the corners of cells."""
    edges = [np.diff(nodes, axis=axis) for axis in range(3)]
    scaled = np.inf
    for a in (slice(None, -1), slice(1, None)):
        for b in (slice(None, -1), slice(1, None)):
            for c in (slice(None, -1), slice(1, None)):
                u, v, w = edges[0][:, b, c], edges[1][a, :, c], edges[2][a, b]
                value = (np.cross(u, v) * w).sum(axis=-1)
                size = np.sqrt((u**2).sum(-1) * (v**2).sum(-1) * (w**2).sum(-1))
                scaled = min(scaled, float((value / size).min()))
    return scaled


def worst_growth(edges: Floats) -> float:
    """Return the largest change between neighbours of `edges` (cells, lines)."""
    ratio = edges[1:] / edges[:-1]
    return float(np.maximum(ratio, 1.0 / ratio).max()) - 1.0


def row_of(case: Case) -> str:
    """March a case and return its row."""
    best = np.inf
    for _ in range(3):
        begun = time.process_time()
        surface = surface_of(case.grid)
        solution = march_surface(surface, case.march)
        best = min(best, time.process_time() - begun)
    grid = solution.grid
    folded = sum(count_folded_solids(b.nodes, BEZIER) for b in grid.blocks)
    first = np.concatenate(
        [np.linalg.norm(np.diff(b.nodes[:, :, :2], axis=2), axis=-1).ravel() for b in grid.blocks]
    )
    scaled = min(least_scaled(b.nodes) for b in grid.blocks)
    lean = off_normal(grid)
    lines = [
        np.linalg.norm(np.diff(b.nodes, axis=2), axis=-1).reshape(-1, b.counts[2] - 1).T for b in grid.blocks
    ]
    growth = max(worst_growth(edges) for edges in lines)
    steps = case.march.steps(surface.size)
    cells = [
        case.name, len(surface.nodes), grid.blocks[0].counts[2],
        f"{case.march.first_cell:g}", f"{case.march.far_field:g}", folded,
        f"{np.abs(first / case.march.first_cell - 1).max():.0e}", f"{scaled:.3f}",
        f"{lean.mean():.1f} / {np.quantile(lean, 0.99):.1f} / {lean.max():.0f}",
        f"{steps[1] / steps[0] - 1:.3f}", f"{growth:.2f}", f"{best:.2f}",
    ]  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |"


def main() -> None:
    """Print the rows, and write the page where one is named."""
    parser = arguments(__doc__)
    parser.add_argument("--surfaces", type=Path)
    options = parser.parse_args()
    rows = []
    cases = [*(cases_of(options.surfaces) if options.surfaces else ()), *own_cases()]
    for case in cases:
        with limited_to(1):
            rows.append(row_of(case))
        print(rows[-1], flush=True)
    head = ["| " + " | ".join(COLUMNS) + " |", "|" + " --- |" * len(COLUMNS)]
    text = HEAD.format(machine=processor()) + "\n".join([*head, *rows]) + "\n" + CONCLUSIONS
    publish(text, options.page, shown=True)


if __name__ == "__main__":
    main()
