"""Volumes marched from surfaces: folds, first cells, quality, angles, growth, time.

    python benchmarks/bench_marching.py [--surfaces FOLDER] [--page docs/benchmarks/marching-surfaces.md]

Surfaces are those of the tests and the Plot3D files ``*.fmt`` of FOLDER, marched as its ``README.md`` has it
in rows ``| names | script | N | s0 | marchDist |``. One thread.
"""

import re
import resource
import subprocess
import sys
import tempfile
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
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids
from meshonet.geometry.surface.hollows import hollows_of
from meshonet.geometry.surface.surface import Surface, surface_of
from meshonet.geometry.threads import limited_to
from meshonet.solvers.hyperbolic.volume.graph import march_graph
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_levels, march_surface
from meshonet.solvers.hyperbolic.volume.settings import attempts_for
from meshonet.solvers.hyperbolic.volume.symmetry import in_planes, symmetry_of

HEAD = """# Volumes marched from surfaces: quality and time

<!-- made by python benchmarks/bench_marching.py --page docs/benchmarks/marching-surfaces.md -->

Use this page to find the quality and the CPU time of volume grids that are marched from surfaces. For the
method see [marching from surfaces](../guide/marching-surfaces.md).

- *surface*: the first four (a blended wing body, the ONERA M6 wing, two spheres) are read from files. *star*
  and *dented* are deformed spheres. *patches, nodes*: numbers of patches and of nodes of the surface.
  *levels*: number of nodes along a grid line from the surface to the far field.
- *first cell, distance*: prescribed first-cell height, and distance of the far field, in the unit of the
  surface.
- *tries*: number of marches, each with other smoothing parameters, until the grid was valid.
- *folded*: number of cells in which a corner Jacobian, or a Bezier coefficient of the Jacobian, is not
  positive. If all these coefficients are positive, the Jacobian is positive everywhere in the cell.
- *error*: largest relative error of the first-cell height.
- *quality*: the smallest divided by the largest Jacobian at the eight corners of a cell, in the worst
  cell. The marching program pyHyp prints the same measure. *SJ*: minimum scaled Jacobian at the corners.
- *off the normal*: angle in degrees between the grid lines that leave the surface and the normals of the
  grid surfaces that they cross, mean / 99th percentile / maximum.
- *growth*: three growth ratios, each minus 1. The first is prescribed. The others are the largest along a
  grid line: after the march / after nodes are then redistributed along the grid lines.
- *CPU*: CPU time in seconds to march and to test the volume, without reading and writing, best of 3. *us a
  node*: the same time in microseconds per node of the volume. *process*: CPU time of the whole command,
  including reading and writing; only for surfaces that are read from files. One thread of {machine}, while
  other programs used the machine.

"""
COLUMNS = (
    "surface", "patches", "nodes", "levels", "first cell, distance", "tries", "folded", "error",
    "quality", "SJ",
    "off the normal", "growth", "CPU", "us a node", "process",
)  # fmt: skip


@dataclass(frozen=True)
class Case:
    """A surface and how it is marched."""

    name: str
    grid: Grid
    march: VolumeMarch
    path: Path | None = None


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
            yield Case(path.stem, read(path), march, path)


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


def corners(nodes: Floats) -> tuple[float, float]:
    """Return the least ratio of a cell's corner determinants, and the least scaled one."""
    edges = [np.diff(nodes, axis=axis) for axis in range(3)]
    shape = tuple(n - 1 for n in nodes.shape[:3])
    low, high, scaled = np.full(shape, np.inf), np.zeros(shape), np.inf
    for a in (slice(None, -1), slice(1, None)):
        for b in (slice(None, -1), slice(1, None)):
            for c in (slice(None, -1), slice(1, None)):
                u, v, w = edges[0][:, b, c], edges[1][a, :, c], edges[2][a, b]
                value = (np.cross(u, v) * w).sum(axis=-1)
                size = np.sqrt((u**2).sum(-1) * (v**2).sum(-1) * (w**2).sum(-1))
                scaled = min(scaled, float((value / size).min()))
                low, high = np.minimum(low, value), np.maximum(high, np.abs(value))
    return float((low / high).min()), scaled


def worst_growth(edges: Floats) -> float:
    """Return the largest change between neighbours of `edges` (cells, lines)."""
    ratio = edges[1:] / edges[:-1]
    return float(np.maximum(ratio, 1.0 / ratio).max()) - 1.0


def growth_as_marched(surface: Surface, march: VolumeMarch, attempt: int) -> float:
    """Return the worst growth of the march number `attempt`, before nodes are moved along lines."""
    planes, inside, _ = symmetry_of(surface, march.symmetry, march.distance(surface.size))
    nodes, steps = in_planes(surface, planes, inside), march.steps(surface.size)
    hollows = hollows_of(surface)
    smoothing = attempts_for(concave=len(hollows.edges) > 0, wing=False)[attempt - 1]
    graph = march_graph(surface, planes, inside, hollows.distance, smoothing.splay, smoothing.boost)
    levels = march_levels(surface, graph, nodes, steps, smoothing)
    return worst_growth(np.linalg.norm(np.diff(levels, axis=0), axis=1))


def process_seconds(path: Path, march: VolumeMarch) -> float:
    """Return the processor seconds of the command that marches a file and writes the volume."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable, "-c", "import sys; from meshonet_cli.app import run; sys.exit(run(sys.argv[1:]))",
            "solve-pde", str(path), "--method", "hyperbolic", "--first-cell", repr(march.first_cell),
            "--layers", str(march.layers), "--far-field", repr(march.far_field), "--threads", "1", "-o",
            str(Path(folder) / "volume.xyz"),
        ]  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise MeshonetError(done.stderr.strip().splitlines()[-1])
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def row_of(case: Case, process: bool) -> str:
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
    quality, scaled = np.min([corners(b.nodes) for b in grid.blocks], axis=0)
    lean = off_normal(grid)
    lines = [
        np.linalg.norm(np.diff(b.nodes, axis=2), axis=-1).reshape(-1, b.counts[2] - 1).T for b in grid.blocks
    ]
    growth = max(worst_growth(edges) for edges in lines)
    steps = case.march.steps(surface.size)
    several = re.search(r"best of (\d+) marches", "\n".join(solution.notes))
    tries = int(several[1]) if several else 1
    levels = grid.blocks[0].counts[2]
    whole = f"{process_seconds(case.path, case.march):.2f}" if case.path and process else ""
    cells = [
        case.name, len(grid.blocks), len(surface.nodes), levels,
        f"{case.march.first_cell:g}, {case.march.far_field:g}", tries, folded,
        f"{np.abs(first / case.march.first_cell - 1).max():.0e}", f"{quality:.3f}", f"{scaled:.3f}",
        f"{lean.mean():.1f} / {np.quantile(lean, 0.99):.1f} / {lean.max():.0f}",
        f"{steps[1] / steps[0] - 1:.3f}, {growth_as_marched(surface, case.march, tries):.2f} / {growth:.2f}",
        f"{best:.2f}", f"{1e6 * best / len(surface.nodes) / levels:.2f}", whole,
    ]  # fmt: skip
    return "| " + " | ".join(map(str, cells)) + " |"


def main() -> None:
    """Print the rows, and write the page where one is named."""
    parser = arguments(__doc__)
    parser.add_argument("--surfaces", type=Path)
    parser.add_argument("--no-process", action="store_true", help="do not time the command")
    options = parser.parse_args()
    rows = []
    cases = [*(cases_of(options.surfaces) if options.surfaces else ()), *own_cases()]
    for case in cases:
        with limited_to(1):
            rows.append(row_of(case, not options.no_process))
        print(rows[-1], flush=True)
    head = ["| " + " | ".join(COLUMNS) + " |", "|" + " --- |" * len(COLUMNS)]
    text = HEAD.format(machine=processor()) + "\n".join([*head, *rows]) + "\n"
    publish(text, options.page, shown=True)


if __name__ == "__main__":
    main()
