"""Files that runs of every option read: boundaries, grids, domains, wings, rows, a model."""

import importlib.util
import shutil
from pathlib import Path

import numpy as np
import pytest
from blade_row import write_row
from command_line import dataset, duct, wave
from spatial_shapes import ball, cubed_sphere, half_sphere

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.revolve import Revolution, revolved
from meshonet_cli.app import run

TORCH = importlib.util.find_spec("torch") is not None
THERE = ("there.h5", "there.png", "there.json")
"""What is there before a run, and is not read."""
SECTIONS = """
[[sections]]
airfoil = "naca:0012"
chord = 1
z = 0

[[sections]]
airfoil = "naca:0012"
chord = 0.5
z = {}
"""
LISTS = {
    "shapes": ("duct.h5", "grid.h5"),
    "grids": ("grid.h5", "smooth.h5"),
    "domains": ("step.wkt", "tall.wkt"),
    "wings": ("wing.toml", "short.toml"),
    "pipes": ("circle:.4", "circle:.5"),
}
"""Inputs in lists."""


def write_inputs(folder: Path) -> None:
    """Write the files into a folder."""
    dataset(folder / "duct.h5", "quad", duct())
    dataset(folder / "wave.h5", "quad", wave())
    samples = [duct(bump=bump) for bump in (0.0, 0.1, 0.3)]
    dataset(folder / "three.h5", "quad", *samples, names=("a", "b", "c"))
    edges = duct()
    edges["south"][1] = [-0.05, -0.05]
    dataset(folder / "open.h5", "quad", edges)
    (folder / "square.csv").write_text("0,0\n3,0\n3,3\n0,3\n")
    (folder / "bolt.csv").write_text("1,1\n1,2\n2,2\n2,1\n")
    (folder / "step.wkt").write_text("POLYGON ((0 1, 2 1, 2 0, 6 0, 6 2, 0 2, 0 1))")
    (folder / "tall.wkt").write_text("POLYGON ((0 1, 2 1, 2 0, 6 0, 6 3, 0 3, 0 1))")
    (folder / "named.geojson").write_text(
        '{"type": "Feature", "properties": {"names": [["bottom", "right", "top", "left"], "hole"]}, '
        '"geometry": {"type": "Polygon", "coordinates": [[[0, 0], [3, 0], [3, 3], [0, 3], [0, 0]], '
        "[[1, 1.2], [1, 2.2], [2, 2.2], [2, 1.2], [1, 1.2]]]}}"
    )
    (folder / "hole.wkt").write_text("POLYGON ((0 0, 3 0, 3 3, 0 3, 0 0), (1 1, 1 2, 2 2, 2 1, 1 1))")
    (folder / "box.csv").write_text("0,0\n2,0\n3,1\n0,1\n")
    (folder / "hump.csv").write_text("0,0\n1,0.3\n2,0\n2,1\n0,1\n")
    for name, span in (("wing", 2), ("short", 1)):
        (folder / f"{name}.toml").write_text(SECTIONS.format(span))
    write_row(folder)
    moon = SECTIONS.format(1).replace("naca:0012", "moon.csv")
    (folder / "moon.toml").write_text(f'kind = "duct"\n{moon}')
    t = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    angle, radius = 1.57 + 1.37 * np.cos(t), 0.8 + 0.2 * np.sin(t)
    moon_points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    np.savetxt(folder / "moon.csv", moon_points, delimiter=",")
    for name, lines in LISTS.items():
        (folder / f"{name}.txt").write_text("\n".join(lines))
    (folder / "path.csv").write_text("0 0 0\n9 0 0\n18 3 0\n")
    cube = np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1)
    Grid.from_nodes(cube).write(folder / "cube.vts")
    Grid.from_nodes(cube + 0.03 * cube[..., ::-1] ** 2).write(folder / "bent.vts")
    walls = (Patch("hub", "south", 0, 3, kind="wall"), Patch("shroud", "north", 0, 3, kind="wall"))
    sector = Grid.from_nodes(cube[:, :, 0, :2] + [0.0, 1.0], patches=walls)
    revolved(sector, Revolution(20.0)).write(folder / "passage.h5")
    cubed_sphere().write(folder / "ball.xyz")
    half_sphere().write(folder / "cap.xyz")
    Grid.from_nodes(ball(12, 10)).write(folder / "nose.xyz")
    shape = np.loadtxt(Path(__file__).parents[2] / "examples" / "naca2412.dat", skiprows=1) * 40
    (folder / "large.dat").write_text("large\n" + "\n".join(f"{x} {y}" for x, y in shape))
    for name in THERE:
        (folder / name).write_text("mine")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for words in (
            "tfi duct.h5 -o grid.h5",
            "solve-pde duct.h5 -o smooth.h5",
            "tfi three.h5 -o {name}.vts",
            "convert b.vts c.vts -o bc.h5",
            "convert c.vts b.vts -o cb.h5",
            "sample-boundary --family wrench --count 1 --seed 1 -o wrench.h5",
            "sample-boundary --family arch --count 8 --res 17 --split interpolation -o edges.h5",
            "solve-pde edges.h5 -o arches.h5",
            "layout tall.wkt -o tall.json",
            "tfi wave.h5 --allow-invalid -o folded.h5",
        ):
            assert run([*words.split(), "-q"]) == 0
        if TORCH:
            quad = "train arches.h5 --epochs 4 --points 60 --batch 4 --set sensors=20 -o m.safetensors -q"
            assert run(quad.split()) == 0
    shutil.copy(folder / "grid.h5", folder / "odd.name")
    shutil.copy(folder / "arches.h5", folder / "solved.name")
