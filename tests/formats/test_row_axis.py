"""Rows about any axis: the grid is about the axis of the file, as that about x turned."""

from pathlib import Path

import numpy as np
import pytest
from blade_row import BLADES, HUB, SHROUD, curve, profiles, texts

import meshonet
from meshonet.formats.figure.row_sections import RowSections
from meshonet.formats.stack import stack_of
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.periodic import periods
from meshonet.geometry.rows.frame import axis_along
from meshonet.geometry.rows.row import Row

SLANTED = (2.0, -1.0, 2.0)
SETTINGS = {"cells": 20_000, "first_cell": 0.02, "growth": 1.8}


def rotation(axis: tuple[float, float, float]) -> np.ndarray:
    """The matrix whose first row is the axis; the others are at right angles to it, right-handed."""
    way = np.array(axis) / np.sqrt((np.array(axis) ** 2).sum())
    up = np.cross(way, [0.3, 0.5, -0.7])
    up /= np.sqrt((up**2).sum())
    return np.array([way, up, np.cross(way, up)])


def row_about(folder: Path, axis: tuple[float, float, float], words: str) -> Row:
    """The row in files that are turned about the origin, so that its axis is another one."""
    turn = rotation(axis)
    shroud = np.stack([SHROUD[:, 0], 0.6 * SHROUD[:, 1], 0.8 * SHROUD[:, 1]], axis=1)
    files = texts(f"axis = {words}", hub=HUB) | {
        "profile.curve": curve(*(points @ turn for points in profiles())),
        "shroud.curve": curve(shroud @ turn),
    }
    for name, text in files.items():
        (folder / name).write_text(text)
    row = stack_of(str(folder / "row.toml"))
    assert isinstance(row, Row)
    return row


@pytest.mark.parametrize(
    ("axis", "words"),
    [((0, 0, 1), '"z"'), ((-1, 0, 0), '"-x"'), ((0, -1, 0), "[0, -3, 0]"), (SLANTED, "[2, -1, 2]")],
)
def test_the_row_is_the_same_but_for_a_turn_about_x(axis, words: str, tmp_path: Path) -> None:
    row = row_about(tmp_path, axis, words)
    assert row.shroud == pytest.approx(SHROUD, abs=1e-12)
    for own, given in zip(row.profiles, profiles(), strict=True):
        x, r = own[:, 0], np.hypot(own[:, 1], own[:, 2])
        assert x == pytest.approx(given[:, 0], abs=1e-12)
        assert r == pytest.approx(np.hypot(given[:, 1], given[:, 2]), abs=1e-12)
        turns = (own[:, 1] + 1j * own[:, 2]) / (given[:, 1] + 1j * given[:, 2])
        assert turns == pytest.approx(turns[0], abs=1e-12)


@pytest.fixture(scope="module")
def slanted(tmp_path_factory: pytest.TempPathFactory) -> Grid:
    return meshonet.stack(row_about(tmp_path_factory.mktemp("row"), SLANTED, "[2, -1, 2]"), **SETTINGS)


def test_the_grid_is_about_the_axis_of_the_file(slanted: Grid) -> None:
    way = np.array(SLANTED) / 3.0
    (period,) = periods(slanted)
    assert period.angle == pytest.approx(360.0 / BLADES, rel=1e-14)
    assert period.mismatch < 1e-14
    hub = np.concatenate([slanted.at(p).reshape(-1, 3) for p in slanted.patches if p.name == "hub"])
    along = hub @ way
    off = hub - along[:, None] * way
    assert np.sqrt((off**2).sum(axis=1)) == pytest.approx(np.interp(along, *HUB.T), abs=1e-9)
    assert (along.min(), along.max()) == pytest.approx((-1.0, 2.0), abs=1e-12)


@pytest.mark.parametrize("copies", [1, BLADES])
def test_its_sections_are_drawn_about_this_axis(slanted: Grid, copies: int) -> None:
    sections = RowSections(copied(slanted, copies))
    cut = sections.meridional([np.ones(np.subtract(b.counts, 1)) for b in sections.grid.blocks])
    x, r = cut.polygons[..., 0], cut.polygons[..., 1]
    assert (x.min(), x.max()) == pytest.approx((-1.0, 2.0), abs=1e-3)
    assert (r.min(), r.max()) == pytest.approx((2.0, 3.0), abs=1e-2)


def test_axes_are_carried_to_axes() -> None:
    for axis in np.concatenate([np.eye(3), -np.eye(3)]):
        turn = np.array(axis_along(tuple(axis)).turn)
        assert set(np.abs(turn).ravel()) == {0.0, 1.0}
        assert np.linalg.det(turn) == 1.0
        assert turn[0].tolist() == axis.tolist()
