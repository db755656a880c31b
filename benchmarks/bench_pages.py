"""Interactive pages of grids: bytes, seconds to write, seconds until a browser shows them.

    python benchmarks/bench_pages.py --page docs/benchmarks/pages.md

Needs chromium and chromedriver. Of the other libraries those are measured that are installed: plotly, bokeh,
k3d, pyvista with trame-pyvista and nest_asyncio2.
"""

import importlib.util
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from page import arguments, publish

import meshonet
from meshonet import Grid

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "formats"))
from browser import Browser

HEAD = """# Interactive pages: size and time

<!-- made by python benchmarks/bench_pages.py --page docs/benchmarks/pages.md -->

Use this page to find the size of an [interactive HTML page](../guide/pictures.md) of a grid (`meshonet plot
-o grid.html`), and the times to write and to display the page.

Times are elapsed times, medians of three runs, on a shared machine with two cores. *Time to display*: from
loading the page to the first drawing of the grid, in Chromium without a graphics card.

## Size and time by number of cells

| nodes | cells | size, MB | time to write, s | time to display, s |
| --- | --- | --- | --- | --- |
"""
OTHERS = """
## Comparison with other libraries

Each library writes a page of the grid of 401 x 251 nodes, with grid lines and coloured by one cell metric.
meshonet was timed again. *Metrics in the page*: the metrics that a user of the page can choose.

| library | size, MB | time to write, s | time to display, s | metrics in the page |
| --- | --- | --- | --- | --- |
"""
TAIL = """
- The page of meshonet is at most a fifth as large as the pages of the other libraries. It is displayed in at
  most an eighth of their time.
- Only the page of meshonet has a list of the worst cells and switches that hide blocks.
"""
PLANES = ((101, 101), (401, 251), (1251, 801))
PATIENCE = 90.0
RUNS = 3
Parts = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def airfoil(ni: int, nj: int) -> Grid:
    """Return an O grid with a boundary layer."""
    return meshonet.infer("naca:2412", res=(ni, nj), y_plus=1, reynolds=6e6)


def ball(nodes: int) -> Grid:
    """Return a volume of one block around a part of a ball."""
    angle = np.linspace(0.3, 1.2, nodes)
    radius = np.geomspace(1.0, 20.0, nodes)[None, None, :]
    u, v = angle[:, None, None], angle[None, :, None]
    nodes_ = np.stack(
        np.broadcast_arrays(
            radius * np.cos(u) * np.cos(v), radius * np.sin(u) * np.cos(v), radius * np.sin(v) + 0 * u
        ),
        axis=-1,
    )
    return Grid.from_nodes(nodes_, name="part of a ball")


def parts(grid: Grid) -> Parts:
    """Return nodes (n, 3), triangles (m, 3), values (m / 2,) of cells, and ends of the edges (k, 2)."""
    ni, nj = grid.ni, grid.nj
    points = np.concatenate([grid.nodes.reshape(-1, 2), np.zeros((ni * nj, 1))], axis=1)
    number = np.arange(ni * nj).reshape(ni, nj)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 2).reshape(-1, 3)
    from meshonet.geometry.quality.measure import per_cell

    along = np.stack([number[:-1], number[1:]], -1).reshape(-1, 2)
    across = np.stack([number[:, :-1], number[:, 1:]], -1).reshape(-1, 2)
    return points, triangles, per_cell(grid, "max_angle").ravel(), np.concatenate([along, across])


def by_meshonet(grid: Grid, path: Path) -> None:
    """Write our own."""
    meshonet.plot(grid, path)


def by_plotly(grid: Grid, path: Path) -> None:
    """Write triangles and lines in space."""
    import plotly.graph_objects as go

    points, triangles, values, edges = parts(grid)
    mesh = dict(zip("xyz", points.T, strict=True)) | dict(zip("ijk", triangles.T, strict=True))
    ends = np.concatenate([points[edges], np.full((len(edges), 1, 3), np.nan)], axis=1).reshape(-1, 3)
    cells = go.Mesh3d(**mesh, intensity=np.repeat(values, 2), intensitymode="cell", colorscale="YlGnBu")
    lines = go.Scatter3d(**dict(zip("xyz", ends.T, strict=True)), mode="lines")
    go.Figure([cells, lines]).write_html(path, include_plotlyjs=True)


def by_bokeh(grid: Grid, path: Path) -> None:
    """Write a polygon a cell."""
    from bokeh.embed import file_html
    from bokeh.plotting import figure
    from bokeh.resources import INLINE
    from bokeh.transform import linear_cmap

    x, y = grid.x, grid.y
    rings = [np.stack([c[:-1, :-1], c[1:, :-1], c[1:, 1:], c[:-1, 1:]], 2).reshape(-1, 4) for c in (x, y)]
    columns = {"xs": list(rings[0]), "ys": list(rings[1]), "v": parts(grid)[2]}
    chart = figure(output_backend="webgl", match_aspect=True, width=1100, height=700)
    chart.patches("xs", "ys", source=columns, fill_color=linear_cmap("v", "YlGnBu9", 90, 130), line_width=0.4)
    path.write_text(file_html(chart, INLINE, "grid"))


def by_k3d(grid: Grid, path: Path) -> None:
    """Write triangles and lines in space."""
    import k3d

    points, triangles, values, edges = parts(grid)
    scene, places = k3d.plot(), points.astype(np.float32)
    colours = np.repeat(values, 2).astype(np.float32)
    scene += k3d.mesh(places, triangles.astype(np.uint32), triangles_attribute=colours)
    scene += k3d.lines(places, edges.astype(np.uint32), indices_type="segment", shader="simple", color=0)
    path.write_text(scene.get_snapshot())


def by_pyvista(grid: Grid, path: Path) -> None:
    """Write a scene for vtk.js."""
    import pyvista

    mesh = grid.to_pyvista()
    mesh.cell_data["max_angle"] = parts(grid)[2].reshape(grid.ni - 1, -1).ravel(order="F")
    plotter = pyvista.Plotter(off_screen=True)
    plotter.add_mesh(mesh, scalars="max_angle", cmap="YlGnBu", show_edges=True)
    plotter.view_xy()
    plotter.trame.export_html(str(path))


LIBRARIES: dict[str, tuple[str, Callable[[Grid, Path], None]]] = {
    "meshonet": ("meshonet", by_meshonet),
    "pyvista, vtk.js": ("trame_pyvista", by_pyvista),
    "k3d, three.js": ("k3d", by_k3d),
    "plotly": ("plotly", by_plotly),
    "bokeh": ("bokeh", by_bokeh),
}


def shown_after(browser: Browser, page: Path) -> float:
    """Return the seconds until many colours are in the middle of the window."""
    browser.load("about:blank")
    while colours_in(browser) != 1:  # of the page before, or busy with it
        time.sleep(0.1)
    begun = time.perf_counter()
    browser.load(page.resolve().as_uri())
    while (spent := time.perf_counter() - begun) < PATIENCE:
        if colours_in(browser) > 8:
            return spent
    return float("nan")


def colours_in(browser: Browser) -> int:
    """Return how many colours are in the middle of the window, 0 while the browser does not answer."""
    try:
        picture = browser.picture()
    except AssertionError:
        return 0
    rows, columns = picture.shape[:2]
    middle = picture[rows // 4 : 3 * rows // 4 : 3, columns // 4 : 5 * columns // 8 : 3].reshape(-1, 3)
    return len(np.unique(middle, axis=0))


def measured(browser: Browser, write: Callable[[Grid, Path], None], grid: Grid, path: Path) -> list[float]:
    """Return megabytes, seconds to write, and seconds to the first picture."""
    spent, shown = [], []
    for _ in range(RUNS):
        begun = time.perf_counter()
        write(grid, path)
        spent.append(time.perf_counter() - begun)
        shown.append(shown_after(browser, path))
    return [path.stat().st_size / 1e6, statistics.median(spent), statistics.median(shown)]


def main() -> None:
    """Print the page, and write it where it is wanted."""
    parser = arguments(__doc__)
    options = parser.parse_args()
    text = HEAD
    with TemporaryDirectory() as folder:
        browser, path = Browser(Path(folder) / "profile"), Path(folder) / "g.html"
        try:
            grids = [airfoil(*size) for size in PLANES] + [ball(47), ball(101)]
            for grid in grids:
                size = " x ".join(str(count) for count in grid.blocks[0].counts)
                cells = int(np.prod([count - 1 for count in grid.blocks[0].counts]))
                mega, spent, shown = measured(browser, by_meshonet, grid, path)
                row = f"{size} | {cells:,} | {mega:.2f} | {spent:.2f} | {shown:.1f}"
                print(row, flush=True)
                text += f"| {row} |\n"
            text += OTHERS
            for name, (module, write) in LIBRARIES.items():
                if importlib.util.find_spec(module):
                    mega, spent, shown = measured(browser, write, grids[1], path)
                    metrics = "all" if name == "meshonet" else "one"
                    print(name, mega, spent, shown, flush=True)
                    text += f"| {name} | {mega:.1f} | {spent:.1f} | {shown:.1f} | {metrics} |\n"
        finally:
            browser.close()
    publish(text + TAIL, options.page)


if __name__ == "__main__":
    main()
