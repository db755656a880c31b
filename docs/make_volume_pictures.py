"""Draw pictures of the guides of wings, pipes and aircraft: python docs/make_volume_pictures.py."""

import tempfile
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from PIL import Image, ImageChops
from reduce_pictures import place

import meshonet
from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.grid import Grid

FOLDER = Path(__file__).parent / "img"
GAP = 40
BEHIND, AHEAD = 6.0, 12.0
"""Range of x in which parts of the body with a fin are drawn."""
PAGES = Path(__file__).parent / "guide"
LIGHT = np.array([0.35, -0.5, 0.8]) / np.linalg.norm([0.35, -0.5, 0.8])


def toml_of(page: str, number: int = 0) -> str:
    """Return the text of a block of TOML of a page."""
    return (PAGES / page).read_text().split("```toml\n")[number + 1].split("```")[0]


def quads(patch: Floats) -> Floats:
    """Return the cells (n, 4, 3) of a patch, y upwards."""
    corners = patch[:-1, :-1], patch[1:, :-1], patch[1:, 1:], patch[:-1, 1:]
    return np.stack(corners, axis=2).reshape(-1, 4, 3)[..., [0, 2, 1]]


def draw(ax: object, patches: list[tuple[Floats, str]], width: float = 0.25) -> None:
    """Draw the cells of patches, shaded, with their edges."""
    cells = np.concatenate([quads(patch) for patch, _ in patches])
    colours = [np.tile(mpl.colors.to_rgb(colour), (len(quads(patch)), 1)) for patch, colour in patches]
    normal = np.cross(cells[:, 2] - cells[:, 0], cells[:, 3] - cells[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    shade = np.round(0.62 + 0.38 * np.abs(normal @ LIGHT), 1)
    faces = shade[:, None] * np.concatenate(colours)
    ax.add_collection3d(Poly3DCollection(cells, facecolors=faces, edgecolors="0.2", linewidths=width))  # type: ignore[attr-defined]


def show(ax: object, points: Floats, angles: tuple[float, float], zoom: float = 1.3) -> None:
    """Set limits, equal scales and the direction of view."""
    low, high = points.min(axis=0), points.max(axis=0)
    ax.set_xlim(low[0], high[0])  # type: ignore[attr-defined]
    ax.set_ylim(low[2], high[2])  # type: ignore[attr-defined]
    ax.set_zlim(low[1], high[1])  # type: ignore[attr-defined]
    ax.set_box_aspect((high - low)[[0, 2, 1]], zoom=zoom)  # type: ignore[attr-defined]
    ax.view_init(*angles)  # type: ignore[attr-defined]
    ax.set_axis_off()  # type: ignore[attr-defined]


def near(patch: Floats, middle: Indices, reach: float) -> Floats:
    """Return the rows of levels of a patch that stay within a reach of a point."""
    away = np.linalg.norm(patch - middle, axis=-1).max(axis=0)
    return patch[:, : max(2, int(np.searchsorted(away, reach)))]


def wing() -> None:
    """Draw the wing of docs/guide/wings.md, its tip, and levels of the volume at its root."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "wing.toml"
        path.write_text(toml_of("wings.md"))
        volume: Grid = meshonet.stack(path, around=97, span=41)
    colours = ("#9db8d9", "#f2c572", "#e39a8f")
    surface = [(block.nodes[:, :, 0], colour) for block, colour in zip(volume.blocks, colours, strict=True)]
    root = volume.blocks[0].nodes[:, 0]
    plane = near(root, np.array([0.5, 0.0, 0.0]), 0.9)
    left = view([(plane, "#dddddd"), *surface], (38.0, -150.0), inches=8.0)
    tip = surface[0][0][:, -9:]
    around = [(tip, ""), surface[1]]
    right = view([(tip, colours[0]), *surface[1:]], (14.0, 35.0), around=around, width=0.4)
    save([left, right], "wing.png")


def pipe() -> None:
    """Draw the pipe bend of docs/guide/pipes.md."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bend.toml"
        path.write_text(toml_of("pipes.md"))
        volume = meshonet.sweep("circle:0.5", path, around=40, first_cell=0.01)
    wall = [(block.nodes[:, 0], "#9db8d9") for block in volume.blocks[1:]]
    colours = "#e39a8f", *["#f2c572"] * 4
    ends = [
        (block.nodes[:, :, k], colour)
        for block, colour in zip(volume.blocks, colours, strict=True)
        for k in (0, -1)
    ]
    shown = [(patch[..., [0, 2, 1]], colour) for patch, colour in wall + ends]  # z upwards
    save([view(shown, (35.0, -150.0), inches=7.5)], "pipe.png")


def aircraft() -> None:
    """Draw the aircraft of docs/guide/aircraft.md, and the collar of its wing on three levels."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "aircraft.toml"
        path.write_text(toml_of("aircraft.md") + toml_of("aircraft.md", 1))
        volume = meshonet.stack(path, around=49, span=13, first_cell=1e-2, growth=1.35, far_field=8)
    colours = {
        "fuselage": "#9db8d9",
        "wing": "#f2c572",
        "tip": "#f2c572",
        "tail": "#e39a8f",
        "tail-tip": "#e39a8f",
    }
    walls = [
        (np.squeeze(volume.at(patch)), colours[patch.name])
        for patch in volume.patches
        if patch.name in colours
    ]
    levels = [(volume.blocks[0].nodes[:, :, k], "#dddddd") for k in (0, 14, 22)]
    wings = [(patch, colour) for patch, colour in walls if colour == colours["wing"]]
    views = (walls, (40.0, -240.0)), ([*levels, *wings], (48.0, -150.0))
    save([view(*each, 0.9) for each in views], "aircraft.png")


def fin() -> None:
    """Draw the fin and tail plane of docs/guide/aircraft-fins.md, and one level around them."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "aircraft.toml"
        path.write_text(toml_of("aircraft.md") + toml_of("aircraft-fins.md"))
        volume = meshonet.stack(path, around=49, span=13, first_cell=1e-2, growth=1.35, far_field=8)
    colours = {"fuselage": "#9db8d9", "tail": "#e39a8f", "tail-tip": "#e39a8f"}
    colours |= {"fin": "#a8cf9a", "fin-tip": "#a8cf9a"}
    walls = [
        (patch, colours[name])
        for patch, name in ((np.squeeze(volume.at(each)), each.name) for each in volume.patches)
        if name in colours and (name != "fuselage" or patch[..., 0].max() > BEHIND)
    ]
    beside = [
        block for block, zone in zip(volume.blocks, volume.provenance["zones"], strict=True) if "tail" in zone
    ]
    beside = [block.nodes[:, :, 14] for block in beside if block.counts[2] > volume.blocks[-1].counts[2]]
    levels = [(patch, "#dddddd") for patch in beside if patch[..., 0].max() < AHEAD]
    views = (walls, (28.0, 125.0)), ([*levels, *walls], (28.0, 60.0))
    save([view(*each, around=walls) for each in views], "fin.png")


def view(
    shown: list[tuple[Floats, str]], angles: tuple[float, float], zoom: float = 1.0, *,
    around: list[tuple[Floats, str]] | None = None, inches: float = 9.0, width: float = 0.25,
) -> Image.Image:  # fmt: skip
    """Return an image of patches; the view is `around` some patches, by default all of them."""
    fig = plt.figure(figsize=(inches, inches))
    ax = fig.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
    draw(ax, shown, width)
    show(ax, np.concatenate([patch.reshape(-1, 3) for patch, _ in around or shown]), angles, zoom)
    return image(fig)


def image(fig: plt.Figure) -> Image.Image:
    """Return a figure without its white margins."""
    with tempfile.NamedTemporaryFile(suffix=".png") as file:
        fig.savefig(file.name, dpi=90)
        plt.close(fig)
        drawn = Image.open(file.name).convert("RGB")
    box = ImageChops.difference(drawn, Image.new("RGB", drawn.size, "white")).getbbox()
    return drawn.crop(box)


def save(images: list[Image.Image], name: str) -> None:
    """Write images side by side."""
    width = sum(each.width for each in images) + GAP * (len(images) - 1)
    whole = Image.new("RGB", (width, max(each.height for each in images)), "white")
    x = 0
    for each in images:
        whole.paste(each, (x, (whole.height - each.height) // 2))
        x += each.width + GAP
    with tempfile.NamedTemporaryFile(suffix=".png") as file:
        whole.save(file.name)
        place(Path(file.name), FOLDER / name)


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    wing()
    pipe()
    aircraft()
    fin()
