"""The inputs of the golden commands, written with numpy and h5py alone: ducts, outlines, airfoils, grids.

    write_inputs(folder, example)     # duct.csv, ellipse.csv, ring.wkt, quad.h5 ...

Coordinates are rounded to twelve decimals, so that they do not depend on the last bits of sine and cosine.
The grids are given by formulas: what `quality` and `convert` make of them does not depend on any solver.
"""

import json
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Part = tuple[str, str, int, int]


def write_inputs(folder: Path, example: Path) -> None:
    """Write every input to `folder`; `example` is an airfoil file that is copied."""
    shutil.copy(example, folder / "example.dat")
    _write_domains(folder)
    _write_bodies(folder)
    _write_vectors(folder)
    _write_bad(folder)
    for name, (nodes, topology, parts) in _grids().items():
        write_grid(folder / f"{name}.h5", nodes, topology, parts, name)


def write_grid(path: Path, nodes: Points, topology: str, parts: Sequence[Part], name: str) -> None:
    """Write one grid (ni, nj, 2) as the program's HDF5 layout has it."""
    text = h5py.string_dtype()
    sides = {"south": nodes[:, 0], "north": nodes[:, -1], "west": nodes[0], "east": nodes[-1]}
    with h5py.File(path, "w") as file:
        file.attrs.update(format="meshonet-grid", version=1, topology=topology)
        for key, values in {**sides, "nodes": nodes}.items():
            file.create_dataset(key, data=values[None])
        file.create_dataset("names", data=[name], dtype=text)
        file.create_dataset("parts", data=[json.dumps(parts)], dtype=text)


# --- four-sided domains


def _write_domains(folder: Path) -> None:
    t41, t21, t30 = (np.linspace(0, 1, n) for n in (41, 21, 30))
    _write_csv(folder / "duct.csv", _graph_sides(t41, t41, t21, bump=0.15, dip=0.1))
    _write_csv(folder / "channel.csv", _graph_sides(t41, t30, t21, bump=0.0, dip=0.25))
    _write_csv(folder / "flat.csv", _graph_sides(t41, t41, t21, bump=0.0, dip=0.0))
    _write_csv(folder / "bend.csv", _bend(t41, t21))
    _write_csv(folder / "tight.csv", _tight(np.linspace(0, 1, 65), t41))
    _write_csv(folder / "square.csv", [np.array([[0, 0], [1, 0], [1.1, 1], [0, 0.9]])])
    _write_csv(folder / "outline.csv", [_blob(48)])


def _graph_sides(south: Points, north: Points, side: Points, bump: float, dip: float) -> list[Points]:
    """Return the sides of a duct of length 3: a bump on its south side, a dip in its north side."""
    low = np.column_stack([3 * south, bump * np.exp(-(((3 * south - 1.2) / 0.4) ** 2))])
    high = np.column_stack([3 * north, 1 - dip * np.sin(np.pi * north) ** 2])
    west, east = (low[k] + side[:, None] * (high[k] - low[k]) for k in (0, -1))
    return [low, east, high, west]


def _bend(along: Points, across: Points) -> list[Points]:
    """Return the sides of a bend of 150 degrees, its inner radius a quarter of the outer one."""
    angle = np.radians(150) * along
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    ends = [np.outer(1 - 0.75 * across, circle[k]) for k in (0, -1)]
    return [circle, ends[1], 0.25 * circle, ends[0]]


def _tight(along: Points, across: Points) -> list[Points]:
    """Return the sides of a passage between two teeth, in which interpolation folds cells."""
    low = _even(np.array([[0, 0], [0.9, 0], [1.0, 0.75], [1.1, 0], [2, 0]]), along)
    high = _even(np.array([[0, 1], [1.2, 1], [1.3, 0.2], [1.4, 1], [2, 1]]), along)
    return [low, np.column_stack([0 * across + 2, across]), high, np.column_stack([0 * across, across])]


def _even(corners: Points, t: Points) -> Points:
    """Return points at the shares `t` of the length of a polyline."""
    length = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    return np.column_stack([np.interp(t * length[-1], length, column) for column in corners.T])


def _blob(n: int) -> Points:
    """Return a closed curve with four corners and curved sides."""
    t = np.arange(n) / n
    square = _even(np.array([[0, 0], [1.5, 0], [1.5, 1], [0, 1], [0, 0]]), t)
    return square + 0.08 * np.column_stack([np.sin(np.pi * square[:, 1]), np.sin(np.pi * square[:, 0] / 1.5)])


# --- bodies and airfoils


def _write_bodies(folder: Path) -> None:
    _write_csv(folder / "ellipse.csv", [_ellipse(80, 0.5, 0.2)])
    hexagon = 0.5 * np.column_stack(
        [np.cos(np.radians(60 * np.arange(6))), np.sin(np.radians(60 * np.arange(6)))]
    )
    _write_csv(folder / "hexagon.csv", [_even(np.vstack([hexagon, hexagon[:1]]), np.arange(60) / 60)])
    _write_dat(folder / "blunt.dat", _section(30, 0.15, base=0.01))
    _write_dat(folder / "sharp.dat", _section(40, 0.10, base=0.0, camber=0.03))
    upper, lower = _section(30, 0.12, base=0.0)[30::-1], _section(30, 0.12, base=0.0)[30:]
    rows = ["a Lednicer file", f"{len(upper)}. {len(lower)}.", "", *_rows(upper), "", *_rows(lower)]
    (folder / "lednicer.dat").write_text("\n".join(rows) + "\n")


def _ellipse(n: int, a: float, b: float) -> Points:
    angle = 2 * np.pi * np.arange(n) / n
    return np.column_stack([a * np.cos(angle), b * np.sin(angle)])


def _section(n: int, thickness: float, base: float, camber: float = 0.0) -> Points:
    """Return an airfoil of 2 n + 1 points from its trailing edge over its upper side and back."""
    x = 0.5 * (1 + np.cos(np.pi * np.arange(2 * n + 1) / n))
    half = 5 * thickness * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    sign = np.where(np.arange(2 * n + 1) <= n, 1.0, -1.0)
    return np.column_stack([x, sign * (half + 0.5 * base * x) + 4 * camber * x * (1 - x)])


# --- vector files, and files that cannot be read


def _write_vectors(folder: Path) -> None:
    outer, hole, blob = _ellipse(60, 4, 3), _ellipse(40, 0.5, 0.3)[::-1], _blob(32)
    (folder / "blob.wkt").write_text(f"POLYGON ({_ring(blob)})\n")
    (folder / "ring.wkt").write_text(f"POLYGON ({_ring(outer)}, {_ring(hole)})\n")
    (folder / "two.wkt").write_text(f"POLYGON ({_ring(blob)})\nPOLYGON ({_ring(blob + np.array([3, 0]))})\n")
    _write_geojson(folder / "two.geojson", {"left": [blob], "right": [1.5 * blob]})
    _write_geojson(folder / "ring.geojson", {"ring": [outer, hole]})
    _write_dxf(folder / "blob.dxf", blob)


def _ring(points: Points) -> str:
    return "(" + ", ".join(f"{x:.12g} {y:.12g}" for x, y in np.vstack([points, points[:1]])) + ")"


def _write_geojson(path: Path, shapes: Mapping[str, Sequence[Points]]) -> None:
    features = []
    for name, rings in shapes.items():
        closed = [np.vstack([ring, ring[:1]]).round(12).tolist() for ring in rings]
        geometry = {"type": "Polygon", "coordinates": closed}
        features.append({"type": "Feature", "properties": {"name": name}, "geometry": geometry})
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))


def _write_dxf(path: Path, points: Points) -> None:
    pairs: list[tuple[int, object]] = [(0, "SECTION"), (2, "ENTITIES")]
    for (x0, y0), (x1, y1) in zip(points.round(12), np.roll(points, -1, axis=0).round(12), strict=True):
        pairs += [(0, "LINE"), (8, "outline"), (10, x0), (20, y0), (30, 0.0), (11, x1), (21, y1), (31, 0.0)]
    pairs += [(0, "ENDSEC"), (0, "EOF")]
    path.write_text("".join(f"{code}\n{value}\n" for code, value in pairs))


def _write_bad(folder: Path) -> None:
    (folder / "prose.dat").write_text("no numbers here\nnone at all\n")
    (folder / "crossed.csv").write_text("0,0\n1,1\n1,0\n0,1\n")
    (folder / "nan.csv").write_text("0,0\n1,0\nnan,1\n0,1\n")
    (folder / "open.csv").write_text("0,0\n1,0\n\n1,0\n1,1\n\n1,1\n0,1\n\n0,2\n0,0.5\n")
    (folder / "empty.csv").write_text("")


# --- grids


def _grids() -> dict[str, tuple[Points, str, list[Part]]]:
    """Return nodes, topology and named parts of grids by name."""
    sides: list[Part] = [
        ("inlet", "west", 0, 16), ("outlet", "east", 0, 16),
        ("wall", "south", 0, 24), ("lid", "north", 0, 24),
    ]  # fmt: skip
    around: list[Part] = [("wall", "south", 0, 48), ("farfield", "north", 0, 48)]
    wake: list[Part] = [
        ("wake", "south", 0, 12), ("wall", "south", 12, 44), ("wake", "south", 44, 56),
        ("farfield", "north", 0, 56), ("farfield", "east", 0, 12), ("farfield", "west", 0, 12),
    ]  # fmt: skip
    return {
        "quad": (_wavy(25, 17, 0.04), "quad", sides),
        "other": (_wavy(25, 17, 0.05), "quad", sides),
        "folded": (_wavy(25, 17, 0.35), "quad", sides),
        "o": (_around(49, 17), "o", around),
        "c": (_wrapped(12, 32, 13), "c", wake),
    }


def _wavy(ni: int, nj: int, height: float) -> Points:
    x, y = np.meshgrid(np.linspace(0, 2, ni), np.linspace(0, 1, nj) ** 1.3, indexing="ij")
    wave = height * np.sin(np.pi * x) * np.sin(2 * np.pi * y)
    return np.stack([x + wave, y + 0.5 * wave], axis=-1).round(12)


def _around(ni: int, nj: int) -> Points:
    """Return an O grid around an ellipse: the first and the last node along xi are the same."""
    angle = -2 * np.pi * np.arange(ni - 1) / (ni - 1)
    radius = np.linspace(1, 2.5, nj) ** 2
    x, y = 0.5 * np.outer(np.cos(angle), radius), 0.5 * np.outer(np.sin(angle), radius - 0.7 / radius)
    nodes = np.stack([x, y], axis=-1).round(12)
    return np.concatenate([nodes, nodes[:1]])


def _wrapped(wake: int, wall: int, nj: int) -> Points:
    """Return a C grid around a slender body and its wake, whose two sides have the same nodes."""
    line = np.column_stack([np.linspace(4, 1, wake + 1), np.zeros(wake + 1)])
    angle = 2 * np.pi * np.arange(wall + 1) / wall
    body = np.column_stack([0.5 + 0.5 * np.cos(angle), -0.08 * np.sin(angle) * np.sin(angle / 2)])
    south = np.concatenate([line[:-1], body, line[-2::-1]]).round(12)
    south[wake + wall] = south[wake]
    turn = np.pi * np.clip((np.arange(len(south)) - wake) / wall, 0, 1)
    north = np.column_stack([np.where(south[:, 0] > 1, south[:, 0], 1 - 3 * np.sin(turn)), -3 * np.cos(turn)])
    share = (np.linspace(0, 1, nj) ** 1.5)[:, None]
    return ((1 - share) * south[:, None] + share * north[:, None]).round(12)


# --- text


def _rows(points: Points) -> list[str]:
    return [f"{x:.12g} {y:.12g}" for x, y in points.round(12)]


def _write_dat(path: Path, points: Points) -> None:
    path.write_text("\n".join([f"section of {len(points)} points", *_rows(points)]) + "\n")


def _write_csv(path: Path, blocks: Iterable[Points]) -> None:
    path.write_text("\n".join("\n".join(_rows(block)).replace(" ", ",") + "\n" for block in blocks))
