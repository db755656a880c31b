"""Sections of blade rows: their areas are those of the unrolled annulus and of the meridional channel."""

from pathlib import Path

import numpy as np
import pytest
from blade_row import BLADES, blade_row

import meshonet
from meshonet.formats.figure.row_sections import RowSections
from meshonet.formats.figure.slices import Cut
from meshonet.formats.figure.view import View
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.revolve import Revolution, revolved
from meshonet.geometry.blocks.transform import rotated
from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.frame import axis_along

PITCH = 2.0 * np.pi / 9
INNER, OUTER, LENGTH = 1.0, 2.0, 3.0


def annulus(slope: float = 0.0, skew: float = 0.0) -> Grid:
    """A ninth of the annulus, widening by `slope`, whose nodes are turned by `skew` radians along x."""
    x, r = np.meshgrid(np.linspace(0.0, LENGTH, 31), [INNER, 1.1, 1.4, 1.9, OUTER], indexing="ij")
    patches = (Patch("hub", "south", 0, 30, kind="wall"), Patch("shroud", "north", 0, 30, kind="wall"))
    flat = Grid((Block(np.stack([x, r * (1.0 + slope * x)], axis=-1)),), patches)
    grid = revolved(flat, Revolution(np.degrees(PITCH), 17))
    nodes = grid.nodes
    turn = np.exp(1j * skew * nodes[..., 0] / LENGTH)
    other = (nodes[..., 1] + 1j * nodes[..., 2]) * turn
    turned = np.stack([nodes[..., 0], other.real, other.imag], axis=-1)
    (period,) = (each for each in grid.connections if each.transform)
    axis, end = {"bottom": (2, 0), "top": (2, -1)}[period.donor_side]
    np.moveaxis(turned, axis, 0)[end] = period.transform(np.moveaxis(turned, axis, 0)[-1 - end])  # type: ignore[misc]
    return Grid((Block(turned),), grid.patches, grid.connections)


def area(cut: Cut) -> float:
    x, y = np.moveaxis(cut.polygons, -1, 0)
    return float(0.5 * np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)).sum())


@pytest.mark.parametrize("skew", [0.0, 2.5])
@pytest.mark.parametrize("span", [0.03, 0.25, 0.8])
def test_a_span_of_a_cylinder_is_unrolled_with_its_area(span: float, skew: float) -> None:
    made = RowSections(annulus(skew=skew)).at(span, None)
    radius = INNER + span * (OUTER - INNER)
    # chords of the cells, 1/16 of the pitch wide, lie a little below their radius
    assert area(made) == pytest.approx(LENGTH * radius * PITCH, rel=1e-3)
    assert np.ptp(made.polygons[..., 0]) == pytest.approx(LENGTH, rel=1e-9)


def test_angles_of_a_cone_are_kept() -> None:
    slope = 0.2
    made = RowSections(annulus(slope)).at(0.5, None)
    ends = (1.5 * (1.0 + slope * x) for x in (0.0, LENGTH))
    low, high = ends
    steep = np.hypot(1.0, 1.5 * slope) / (1.5 * slope)
    assert np.ptp(made.polygons[..., 0]) == pytest.approx(
        0.5 * (low + high) * steep * np.log(high / low), rel=1e-3
    )


@pytest.mark.parametrize("copies", [1, 3, 9])
@pytest.mark.parametrize("skew", [0.0, 0.3, 2.5])
def test_a_meridional_section_is_the_whole_channel_once(skew: float, copies: int) -> None:
    grid = copied(annulus(skew=skew), copies)
    made = RowSections(grid).meridional([np.ones(np.subtract(b.counts, 1)) for b in grid.blocks])
    assert made.values is not None
    assert len(made.values) == len(made.polygons)
    assert area(made) == pytest.approx(LENGTH * (OUTER - INNER), rel=1e-2)


def test_the_blade_is_missing_from_sections_below_the_gap_alone() -> None:
    grid = meshonet.stack(blade_row(tip_gap=0.1), cells=20_000, first_cell=0.02, growth=1.8)
    sections = RowSections(grid)
    assert sections.pitch == pytest.approx(2.0 * np.pi / BLADES)
    blade = 0.25 * np.pi * 1.0 * 0.08
    for span, missing in ((0.5, blade), (0.95, 0.0)):
        radius = 2.025 + span * 0.925
        whole = 3.0 * radius * 2.0 * np.pi / BLADES
        assert whole - area(sections.at(span, None)) == pytest.approx(missing, abs=0.15 * blade)


def test_a_span_between_layers_of_cells_has_the_lines_of_a_layer_alone() -> None:
    grid = annulus(slope=0.1)
    nodes = grid.nodes.copy()
    span = (nodes[..., 1] ** 2 + nodes[..., 2] ** 2) ** 0.5 / (1.0 + 0.1 * nodes[..., 0]) - INNER
    nodes[..., 1:] *= (1.0 + 0.05 * np.sin(9.0 * nodes[..., 0]) * span * (OUTER - INNER - span))[..., None]
    bent = Grid((Block(nodes),), grid.patches)
    along, around = nodes.shape[0] - 1, nodes.shape[2] - 1
    moved = Grid((Block(np.moveaxis(nodes, 1, 2)),), tuple(
        Patch(name, side, 0, 30, kind="wall") for name, side in (("hub", "bottom"), ("shroud", "top"))
    ))  # fmt: skip
    assert len(RowSections(bent).at(0.4, None).polygons) > along * around
    made = RowSections(moved).at(0.4, None)
    assert len(made.polygons) == along * around
    assert area(made) == pytest.approx(area(RowSections(bent).at(0.4, None)), rel=1e-3)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"span": (0.0,)}, "span: 0 of the span; use more than 0 and less than 1"),
        ({"span": (0.5, 1.2)}, "span: 1.2 of the span"),
        ({"span": (0.5, np.nan)}, "span: nan of the span"),
        ({"span": (0.5,), "slice": "k=0"}, "slice and span are different pictures"),
        ({"span": (0.5,), "meridional": True}, "span and meridional are different pictures"),
    ],
)
def test_settings_that_do_not_go_together_are_refused(settings, words: str) -> None:
    with pytest.raises(InputError, match=words):
        View(**settings)


def test_what_is_no_row_has_no_sections(tmp_path: Path) -> None:
    cube = np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1)
    for name in ("span", "meridional"):
        setting = {name: 0.5 if name == "span" else True}
        with pytest.raises(InputError, match="the grid is no blade row with patches hub and shroud"):
            meshonet.plot(Grid.from_nodes(cube), tmp_path / "made.png", **setting)  # type: ignore[arg-type]
        with pytest.raises(InputError, match=f"{name}: the grid is in the plane"):
            meshonet.plot(Grid.from_nodes(cube[:, :, 0, :2]), tmp_path / "made.png", **setting)  # type: ignore[arg-type]
        with pytest.raises(InputError, match=r"write .png, .svg or .pdf"):
            meshonet.plot(annulus(), tmp_path / "made.html", **setting)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("way", "name"), [((1, 0, 0), "x"), ((0, 0, -1), "z"), ((0, 1, 0), "y"), ((1, 1, 0), "axis")]
)
def test_the_meridional_section_names_the_axis_of_its_row(way: tuple[int, int, int], name: str) -> None:
    assert RowSections(rotated(annulus(), axis_along(way).inverse())).axis_name == name


def test_several_spans_are_beside_each_other(tmp_path: Path) -> None:
    sizes = []
    for number, span in enumerate((0.5, (0.2, 0.5, 0.8), [0.2, 0.8])):
        meshonet.plot(annulus(), tmp_path / f"{number}.svg", span=span)
        sizes.append((tmp_path / f"{number}.svg").read_text().count('id="axes_'))
    assert sizes == [2, 4, 3]  # and the scale of colours
