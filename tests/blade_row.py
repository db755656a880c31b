"""A row of blades that exists nowhere: circular arcs of a thickness, in a channel that narrows."""

from functools import cache
from pathlib import Path

import numpy as np

from meshonet.geometry.arrays import read_only
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.rows.row import Row

BLADES = 23
HUB = np.stack([np.linspace(-1.0, 2.0, 31), 2.0 + 0.05 * np.linspace(0.0, 1.0, 31)], axis=1)
SHROUD = np.stack([np.linspace(-1.0, 2.0, 31), 3.0 - 0.1 * np.linspace(0.0, 1.0, 31)], axis=1)


def profile(radius: float, stagger: float, count: int = 80) -> np.ndarray:
    """Points (2 count, 3) around an ellipse 1 long and 0.08 thick, bent, on a cylinder about the x axis."""
    t = np.linspace(0.0, 2.0 * np.pi, 2 * count, endpoint=False)
    a, b = 0.5 * np.cos(t), 0.04 * np.sin(t)
    b = b + 0.06 * (1.0 - 4.0 * a * a)
    c, s = np.cos(np.radians(stagger)), np.sin(np.radians(stagger))
    angle = (a * s + b * c) / radius
    return np.stack([0.5 + a * c - b * s, radius * np.sin(angle), radius * np.cos(angle)], axis=1)


@cache
def profiles() -> tuple[np.ndarray, ...]:
    """Profiles from below the hub to above the shroud, more and more staggered."""
    return tuple(read_only(profile(radius, 20.0 * (radius - 1.0))) for radius in (1.95, 2.3, 2.7, 3.02))


def blade_row(tip_gap: float = 0.0, hub_gap: float = 0.0) -> Row:
    return Row(profiles(), HUB, SHROUD, BLADES, tip_gap, hub_gap, "made up")


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    """Points rotated about the x axis, towards growing theta = atan2(y, z)."""
    other = (points[:, 1] + 1j * points[:, 2]) * np.exp(-1j * np.radians(degrees))
    return np.stack([points[:, 0], other.real, other.imag], axis=1)


def curve(*blocks: np.ndarray) -> str:
    """Text of blocks of points (n, 3) as TurboGrid writes profiles."""
    text = ""
    for number, points in enumerate(blocks, start=1):
        text += f"# Profile {number}\n" + "".join("{:.17g} {:.17g} {:.17g}\n".format(*p) for p in points)
    return text


def texts(
    more: str = "", *, hub: np.ndarray = HUB, shroud: np.ndarray = SHROUD, blade: str | None = None
) -> dict[str, str]:
    """Texts of the files of the row by name: a TOML file with `more` lines, and the files that it names."""
    lines = ['kind = "row"', f"blades = {BLADES}", 'hub = "hub.csv"', 'shroud = "shroud.curve"']
    if "profiles" not in more and "[[sections]]" not in more:
        lines.append('profiles = "profile.curve"')
    given = {line.split("=")[0] for line in more.split("[[sections]]")[0].splitlines()}
    lines = [line for line in lines if line.split("=")[0] not in given]
    return {
        "row.toml": "\n".join([*lines, more]),
        "hub.csv": "# x,r\n" + "".join("{:.18e},{:.18e}\n".format(*p) for p in hub),
        "shroud.curve": "".join("{:.18e} 0 {:.18e}\n".format(*p) for p in shroud),
        "profile.curve": curve(*profiles()) if blade is None else blade,
    }


def write_row(folder: Path, more: str = "", *, hub: np.ndarray = HUB) -> Path:
    """Write the row as a TOML file with its files beside it; return its path."""
    for name, text in texts(more, hub=hub).items():
        (folder / name).write_text(text)
    return folder / "row.toml"


def off_walls(grid: Grid, name: str) -> np.ndarray:
    """Lengths of all edges that leave a wall for the inside."""
    heights = []
    for patch in grid.patches:
        if patch.name == name:
            axis, end = patch.place
            rows = np.moveaxis(grid.blocks[patch.block].nodes, axis, 0)
            rows = rows if end == 0 else rows[::-1]
            away = np.linalg.norm(rows[1] - rows[0], axis=-1)
            across = patch.across or (0, away.shape[1] - 1)
            heights.append(away[patch.start : patch.stop + 1, across[0] : across[1] + 1].ravel())
    return np.concatenate(heights)
