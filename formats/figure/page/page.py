"""Writes the interactive page of a grid."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.formats.figure.page.document import document, file_text
from meshonet.formats.figure.page.packing import Packed
from meshonet.formats.figure.page.scene import Scene, scene_of
from meshonet.formats.figure.slices import Slice, cut, layers
from meshonet.formats.figure.view import SEEN_FROM, View, check_flat, nothing_in
from meshonet.formats.format import only_one
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.metrics import metric_of

_PROGRAM = ["unpack", "camera", "lattice", "cut", "shaders", "painter", "panel", "pointer", "main"]
"""Files ``.js`` of the program, in the order in which the page contains them."""
_BODY = """{body}
<script type="application/json" id="facts">{facts}</script>
{numbers}
<script type="module">
{program}
</script>"""
"""Body of a page: markup, facts, numbers, program."""


def write_page(path: Path, grid: Grid, metric: str | None = "max_angle", view: View | None = None) -> None:
    """Write an interactive HTML page of `grid`, which initially shows this `metric` and `view`.

    Raises InputError if the cells do not have the metric, or if the view does not suit the grid.
    """
    start = _start(grid, metric, view or View())
    chosen = start["slice"]
    scene = scene_of(grid, chosen and (chosen["name"], chosen["at"]), metric)
    path.write_text(page_text(grid.name, scene, start), encoding="utf-8")


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write an interactive HTML page of a grid. Raises InputError unless `grids` has exactly one."""
    write_page(path, only_one(grids, "a page"))


def page_text(name: str, scene: Scene, start: dict[str, Any]) -> str:
    """Return the HTML page of a scene as text; `start` describes the initial view."""
    import matplotlib as mpl

    table = mpl.colormaps["YlGnBu"](np.linspace(0.0, 1.0, 256))[:, :3]  # light to dark
    colours = np.rint(255 * table).astype(np.uint8).tobytes().hex()
    facts = scene.facts | {"name": name, "start": start, "colours": colours}
    body = _BODY.format(
        body=own_file("body.html"),
        # no name of a patch may end the element, nor begin a comment or a script inside it
        facts=json.dumps(facts, separators=(",", ":")).replace("<", "\\u003c"),
        numbers="\n".join(_data(key, value) for key, value in scene.numbers.items()),
        program="\n".join(own_file(f"{part}.js") for part in _PROGRAM),
    )
    return document(name or "grid", own_file("page.css"), body)


def own_file(name: str) -> str:
    """Return the content of a file in this folder."""
    return file_text("meshonet.formats.figure.page", name)


def _start(grid: Grid, metric: str | None, view: View) -> dict[str, Any]:
    if grid.form == "plane":
        check_flat(view)
    if metric is not None:
        metric_of(grid, metric)
    return {
        "metric": metric,
        "zoom": None if view.zoom is None else _zoom(grid, view.zoom, view.part),
        "every": view.every,
        "slice": None if view.part is None else _slice(grid, view.part),
        "seen_from": list(view.seen_from or SEEN_FROM),
        "up": view.axis_up,
    }


def _zoom(grid: Grid, zoom: tuple[float, ...], at: Slice | None) -> list[float]:
    """Return a box in space; a planar box is extended normal to the slice `at`."""
    if len(zoom) == 4 and at is not None and at.index is None:
        zoom = (*zoom[: 2 * at.direction], at.coordinate, at.coordinate, *zoom[2 * at.direction :])
    (low, high), box_low, box_high = grid.box, np.array(zoom[::2]), np.array(zoom[1::2])
    if len(box_low) != len(low):
        remedy = "use x0,x1,y0,y1" if grid.form == "plane" else "use x0,x1,y0,y1,z0,z1"
        raise InputError("the box is not one of this grid", remedy, parameter="zoom")
    if (box_low > high).any() or (box_high < low).any():
        raise nothing_in(zoom, low, high)
    return list(zoom)


def _slice(grid: Grid, at: Slice) -> dict[str, Any]:
    """Return the description of the slice that is shown first."""
    if grid.form != "volume":
        raise InputError("a surface has no slices", "slice volumes", parameter="slice")
    if at.index is None:
        cut(grid, at, None)
        return {"name": "xyz"[at.direction], "at": at.coordinate}
    layers(grid, at, None)
    most = max(block.counts[at.direction] for block in grid.blocks)
    return {"name": "ijk"[at.direction], "at": at.index % most}


def _data(name: str, numbers: Packed) -> str:
    size = f'data-count="{numbers.count}" data-width="{numbers.width}"'
    return f'<script type="text/plain" id="{name}" {size}>{numbers.text}</script>'
