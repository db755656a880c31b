"""Make docs/gallery/domains.md, its pictures and its table: python docs/make_gallery.py (make gallery).

Thirty domains of examples/domains, each gridded by `meshonet.solve_pde` and drawn with its blocks.
"""

import importlib.util
import tempfile
from pathlib import Path
from types import ModuleType

from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from reduce_pictures import place

import meshonet
from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import irregular_points
from meshonet.geometry.quality.blocks import deviation

DOCS = Path(__file__).parent
CELLS = 900
COLUMNS, ROWS = 3, 2
PICTURE = COLUMNS * ROWS
WIDTH, COLOURS = 1320, 24
FEW, MANY = "#f2b705", "#e4572e"

HEAD = """# Multi-block grids of plane domains

<!-- made by python docs/make_gallery.py (make gallery) -->

Look here for the [block decomposition](../guide/blocks.md) of a shape similar to yours. `meshonet solve-pde
DOMAIN.geojson --cells 900` generated each grid. Thick lines are the sides of blocks. At a yellow dot three
cells meet, at a red dot five or more. `python examples/domains/domains.py FOLDER` writes the domain files.
The [benchmark](../benchmarks/domains.md) gives numbers of cells and angles.
"""
TABLE = """# Multi-block grids of thirty domains

<!-- made by python docs/make_gallery.py (make gallery) -->

Use this page to find the number of blocks and the grid quality for a domain similar to yours. The
[gallery](../gallery/domains.md) shows the domains. The command is `meshonet solve-pde DOMAIN.geojson --cells
900`.

- *irregular vertices*: interior nodes at which more or fewer than four cells meet.
- *deviation*: deviation of cell corner angles from 90 degrees.

| domain | blocks | cells | irregular vertices | mean deviation, degrees | largest deviation, degrees |
| --- | --- | --- | --- | --- | --- |
"""


def main() -> None:
    """Write the page and its pictures."""
    rows: list[str] = []
    page = HEAD
    with tempfile.TemporaryDirectory() as folder:
        files = examples().write_all(Path(folder))
        page += "".join(
            montage(files[k : k + PICTURE], k // PICTURE + 1, rows) for k in range(0, len(files), PICTURE)
        )
    (DOCS / "gallery" / "domains.md").write_text(page, encoding="utf-8")
    (DOCS / "benchmarks" / "domains.md").write_text(TABLE + "\n".join(rows) + "\n", encoding="utf-8")


def montage(files: list[Path], number: int, rows: list[str]) -> str:
    """Draw the grids of some domains into one picture, append their rows, return the words that show it."""
    figure = Figure(figsize=(11.0, 6.6))
    for cell, path in enumerate(files, start=1):
        grid = meshonet.solve_pde(path, cells=CELLS)
        rows.append(draw(figure.add_subplot(ROWS, COLUMNS, cell), grid, path.stem))
    figure.tight_layout()
    picture = DOCS / "img" / f"gallery-{number}.png"
    with tempfile.NamedTemporaryFile(suffix=".png") as file:
        figure.savefig(file.name, dpi=120)
        place(Path(file.name), picture, WIDTH, COLOURS)
    return f"\n![{', '.join(path.stem for path in files)}](../img/{picture.name})\n"


def examples() -> ModuleType:
    """Return examples/domains/domains.py as a module."""
    path = DOCS.parent / "examples" / "domains" / "domains.py"
    spec = importlib.util.spec_from_file_location("domains", path)
    if spec is None or spec.loader is None:
        raise FileNotFoundError(path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def draw(ax: Axes, grid: Grid, name: str) -> str:
    """Draw a grid and return its row of the table."""
    nodes = [block.nodes for block in grid.blocks]
    lines = [line for each in nodes for line in (*each, *each.transpose(1, 0, 2))]
    ax.add_collection(LineCollection(lines, colors="#8a93a6", linewidths=0.4))
    sides = [block.face(side) for block in grid.blocks for side in SIDES]
    ax.add_collection(LineCollection(sides, colors="#1b2a41", linewidths=1.3))
    points, meeting = irregular_points(grid)
    for chosen, colour in ((meeting < 4, FEW), (meeting > 4, MANY)):
        ax.plot(*points[chosen].T, "o", color=colour, markersize=5.5, markeredgecolor="#1b2a41", zorder=5)
    ax.set_aspect("equal")
    ax.autoscale()
    ax.set_axis_off()
    ax.set_title(name, fontsize=10)
    angles = deviation(grid)
    cells = sum((each.shape[0] - 1) * (each.shape[1] - 1) for each in nodes)
    return f"| {name} | {len(nodes)} | {cells} | {len(points)} | {angles.mean:.1f} | {angles.max:.0f} |"


if __name__ == "__main__":
    main()
