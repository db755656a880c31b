"""C grids that keep a base: a C block, and an H block behind it, whose nodes on the wake lines are one."""

import re
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

import meshonet
from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.transform import coarser_grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.checkmesh import faces
from meshonet.geometry.quality.report import quality_report
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result


def blunt(base: float, slant: float = 0.0) -> Airfoil:
    """A section 18 % thick with a base of `base` chords, its upper corner `slant` of it farther aft."""
    x = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 81)))
    half = (
        0.9 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
        + 0.5 * base * x**3
    )
    upper, lower = np.stack([x + slant * base * x**9, half], axis=1), np.stack([x, -half], axis=1)
    return Airfoil(np.concatenate([upper[::-1], lower[1:]]), f"blunt {base:g}")


def made(body: Airfoil, first: float = 1e-5, growth: float | None = 1.2, **sampling: int | str) -> Result:
    return make_grid(
        body,
        GridRequest(sampling=Sampling(topology="c", **sampling), first_cell=first, growth=growth),  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("growth", [1.1, 1.2, 1.3])
@pytest.mark.parametrize(("base", "slant"), [(0.0025, 0.0), (0.02, 0.2), (0.08, 0.0), (0.1, -0.05)])
def test_cells_grow_as_asked_off_walls_and_across_the_wake(base: float, slant: float, growth: float) -> None:
    result = made(blunt(base, slant), growth=growth)
    report = quality_report(result.grid)
    assert result.quality.folded == 0
    for figure in ("wall_growth", "growth_across"):
        value = report.figures(figure)
        assert value is not None
        assert value.value <= growth
    rows = report.figures.wall_rows
    for row in rows:
        assert row.height.min == pytest.approx(1e-5, rel=1e-7)
        assert row.height.max == pytest.approx(1e-5, rel=1e-7)


def test_both_corners_of_the_base_are_those_of_the_file_on_every_level() -> None:
    body = blunt(0.08)
    grid = made(body, ni=401, nj=97).grid
    for k in (1, 2, 4, 8):
        wall = coarser_grid(grid, k).blocks[1].nodes[0]
        np.testing.assert_allclose(wall[[0, -1]], body.curve.points[[1, -1]], atol=1e-15)
        assert np.ptp(wall[:, 0]) < 1e-12  # straight, and nothing of a wedge


def test_the_outlet_is_straight_and_the_wake_as_long_as_asked_for() -> None:
    grid = made(blunt(0.04)).grid
    outlet = np.concatenate([grid.blocks[0].nodes[0], grid.blocks[1].nodes[-1], grid.blocks[0].nodes[-1]])
    assert np.ptp(outlet[:, 0]) < 1e-9
    assert outlet[0, 0] == pytest.approx(16.0, abs=1e-6)


def test_so_many_nodes_as_are_asked_for_are_on_the_base() -> None:
    assert made(blunt(0.08), first=1e-4, base_nodes=70).grid.blocks[1].counts[1] == 70
    with pytest.raises(InputError, match=r"base_nodes: 11 nodes on the base, .* grow by .*; use \d+ or more"):
        made(blunt(0.08), base_nodes=11)


def test_a_base_of_few_nodes_is_noted_with_its_growth_and_a_number_that_keeps_the_default() -> None:
    def note(nodes: int) -> str:
        result = made(blunt(0.08), growth=None, base_nodes=nodes)
        return next((each for each in result.notes if "nodes on the base" in each), "")

    few = made(blunt(0.08), growth=None, base_nodes=41)
    match = re.search(r"41 nodes on the base, .* grow by (\S+) from .*; {base_nodes} (\d+) or more", note(41))
    assert match is not None
    steps = np.hypot(*np.diff(few.grid.blocks[1].nodes[0], axis=0).T)
    assert float(match[1]) == pytest.approx((steps[1:20] / steps[:19]).max(), rel=0.01)
    assert note(int(match[2])) == ""


@pytest.mark.parametrize(("topology", "near"), [("c", "49 or 53"), ("o", "49 or 57")])
def test_numbers_of_nodes_on_a_base_that_can_be_coarsened_are_named(topology: str, near: str) -> None:
    sampling = Sampling(201, 60, topology, base_nodes=50)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=f"a base of 50 nodes .*; use {near}$"):
        make_grid(blunt(0.08), GridRequest(sampling=sampling, first_cell=1e-4, refine=2))


def test_too_few_nodes_are_refused_with_a_number_that_suffices() -> None:
    with pytest.raises(InputError, match="leave too few for the wall; use at least") as error:
        made(blunt(0.08), ni=101)
    least = re.search(r"at least (\d+)", str(error.value))
    assert least is not None
    made(blunt(0.08), ni=int(least[1]))


@pytest.mark.parametrize("ending", ["vtm", "cgns", "p3d", "h5"])
def test_formats_hold_both_blocks(ending: str, tmp_path: Path) -> None:
    grid = made(blunt(0.02), first=1e-3, growth=None, ni=201, nj=40).grid
    path = tmp_path / "case" / f"grid.{ending}"
    path.parent.mkdir()
    grid.write(path)
    (again,) = read_grids(str(path))
    cells, wanted = (sum(int(np.prod(np.array(b.counts) - 1)) for b in each.blocks) for each in (again, grid))
    assert cells == wanted


def test_a_wedge_is_made_where_it_is_asked_for_only() -> None:
    asked = meshonet.grid("naca:0012", topology="c", first_cell=1e-4, te="wedge")
    assert asked.topology == "c"
    kept = meshonet.grid("naca:0012", topology="c", first_cell=1e-4)
    assert len(kept.blocks) == 2
    assert "changes" not in kept.provenance


def test_a_base_stays_without_layers_unless_it_is_thin() -> None:
    kept = meshonet.grid(blunt(0.04), topology="c", res=(401, 101))
    assert kept.quality().folded == 0
    assert len(kept.blocks) == 2
    np.testing.assert_allclose(kept.blocks[1].nodes[0, [0, -1], 1], [-0.02, 0.02], atol=1e-12)
    assert meshonet.grid("naca:0012", topology="c").topology == "c"
    assert len(meshonet.grid("naca:0012", topology="c", te="exact").blocks) == 2
    assert meshonet.grid(blunt(0.04), topology="c", te="wedge").topology == "c"


@pytest.mark.parametrize(("base", "first"), [(0.0025, 3e-4), (0.0025, 5e-3), (0.005, 0.02), (0.02, 0.021)])
def test_a_base_that_first_cells_do_not_resolve_is_closed_by_a_wedge(base: float, first: float) -> None:
    result = made(blunt(base), first=first)
    assert result.quality.folded == 0
    assert result.quality["max_angle"].max < 171.0
    assert len(result.grid.blocks) == 1
    assert any("is closed by a wedge" in note for note in result.notes)


@pytest.mark.parametrize(("base", "first"), [(0.0025, 2.5e-4), (0.02, 5e-3)])
def test_a_base_ten_first_cells_or_half_a_percent_of_the_chord_high_stays(base: float, first: float) -> None:
    assert len(made(blunt(base), first=first).grid.blocks) == 2
    assert len(made(blunt(base), first=1.5 * first, base_nodes=9, growth=None).grid.blocks) == 2


def test_first_cells_twice_as_high_as_a_base_have_a_remedy() -> None:
    remedies = r"no number of rows .* smaller first_cell, or close .* te wedge"
    with pytest.raises(InputError, match=remedies):
        made(Airfoil(meshonet.read("naca:4412").curve.points[1:], "4412"), first=0.01, te="exact")
    with pytest.raises(InputError, match=r"no number of rows .* use a smaller first_cell"):
        meshonet.grid("naca:2424", topology="c", base=0.05, first_cell=0.1, growth=1.2, method="hyperbolic")


@pytest.mark.parametrize(("nodes", "problem"), [(3, "two wakes"), (4, "grow by more than 10")])
def test_too_few_nodes_on_a_base_are_refused_with_enough(nodes: int, problem: str) -> None:
    with pytest.raises(InputError, match=rf"{problem}.*; use 19 or more"):
        meshonet.grid("naca:0012", topology="c", base_nodes=nodes, first_cell=1e-4)


@pytest.mark.parametrize(("ni", "most"), [(81, 0.18), (121, 0.13)])
def test_few_nodes_are_shared_between_wake_and_wall(ni: int, most: float) -> None:
    result = made(blunt(0.08), first=1e-4, growth=None, ni=ni, nj=33)
    assert result.quality.folded == 0
    (row,) = (p for p in result.grid.patches if p.name == "wall" and p.block == 0)
    wall = result.grid.blocks[0].nodes[row.start : row.stop + 1, 0]
    longest = np.linalg.norm(np.diff(wall, axis=0), axis=1).max()
    assert longest < most  # 0.32 and 0.25 chords where cells at the corners are as long as high


def test_other_corners_of_the_section_are_on_nodes_of_every_level() -> None:
    round_nose = 0.5 * np.pi * np.linspace(0.0, 1.0, 20)[1:]
    upper = np.concatenate(
        [
            np.linspace([1.0, 0.02], [0.7, 0.1], 12),
            np.linspace([0.7, 0.1], [0.3, 0.1], 12)[1:],
            np.stack([0.3 * (1.0 - np.sin(round_nose)), 0.1 * np.cos(round_nose)], axis=1),
        ]
    )
    body = Airfoil(np.concatenate([upper, upper[-2::-1] * [1.0, -1.0]]))
    corners = body.curve.points[body.curve.corner_index]
    assert len(corners) == 4  # two of them where the tail begins
    grid = made(body, ni=401, nj=97).grid
    for k in (1, 2, 4):
        wall = coarser_grid(grid, k).blocks[0].nodes[:, 0]
        for corner in corners:
            assert np.hypot(*(wall - corner).T).min() < 1e-12


@pytest.mark.parametrize("topology", ["o", "c"])
def test_cells_grow_as_asked_off_a_concave_corner(topology: Literal["o", "c"]) -> None:
    points = blunt(0.2).curve.points[1:]
    step = np.array([[1.0, 0.095], [0.999, 0.095], [0.9988, 0.0958]])  # a shoulder that turns by 76 degrees
    upper = points[points[:, 1] > 0][::-1]
    body = Airfoil(np.concatenate([step, upper[upper[:, 0] < 0.99], points[points[:, 1] <= 0][::-1]]))
    sampling = Sampling(topology=topology, ni=513, nj=129)
    result = make_grid(body, GridRequest(sampling=sampling, first_cell=1e-5, growth=1.2))
    figure = quality_report(result.grid).figures("wall_growth")
    assert figure is not None
    assert figure.value <= 1.2
    assert result.quality.folded == 0


@pytest.mark.parametrize(("base", "first"), [(0.0025, 1e-3), (0.005, 5e-4), (0.02, 5e-3)])
def test_first_cells_too_thick_for_a_base_are_noted_with_ones_that_fit(base: float, first: float) -> None:
    def advice(first: float) -> tuple[list[float], float]:
        result = made(blunt(base), first=first, growth=None, ni=257, nj=65, te="exact")
        notes = "; ".join(result.notes)
        fits = re.findall(r"too thick for a base .* use {first_cell} (\S+) or less, or {te} wedge", notes)
        return [float(size) for size in fits], result.quality["max_angle"].max

    (fits,), angle = advice(first)
    assert angle > 140.0
    none, angle = advice(fits)
    assert not none
    assert angle < 130.0


def rounded(base: float, upper: float, lower: float) -> Airfoil:
    """`blunt` whose surfaces turn by `upper` and `lower` degrees towards the base over 40 % of its height."""
    reach, sides = 0.4 * base, []
    points = blunt(base + reach).curve.points[1:]
    for sign, turn in ((1.0, np.radians(upper)), (-1.0, np.radians(lower))):
        side = points[sign * points[:, 1] > 0]
        side = side[np.argsort(side[:, 0])]
        side = side[side[:, 0] < 1.0 - 1.3 * reach]
        angle = np.linspace(0.0, turn, 24)
        x = 1.0 - reach + reach * np.sin(angle) / np.sin(turn)
        y = abs(side[-1, 1]) - reach * (1.0 - np.cos(angle)) / np.sin(turn)
        sides.append(np.concatenate([side, np.stack([x, sign * y], axis=1)]))
    return Airfoil(np.concatenate([sides[0][::-1], [[0.0, 0.0]], sides[1]]), "rounded")


@pytest.mark.parametrize("ni", [400, 401])
@pytest.mark.parametrize(("base", "upper", "lower"), [(0.2, 60, 50), (0.04, 75, 2), (0.1, 45, 70)])
def test_flanks_rounded_towards_the_base_leave_even_cells(
    base: float, upper: float, lower: float, ni: int
) -> None:
    result = made(rounded(base, upper, lower), growth=1.15, ni=ni, nj=130)  # were 150 to 178 degrees
    report = quality_report(result.grid)
    assert result.quality.folded == 0
    assert report.quality["max_angle"].max < 135.0
    for figure, most in (("wall_growth", 1.15), ("growth", 1.4)):
        value = report.figures(figure)
        assert value is not None
        assert value.value <= most
    for row in report.figures.wall_rows:
        assert row.height.max == pytest.approx(row.height.min, rel=1e-9)


def test_too_few_rows_beside_a_rounded_flank_are_refused_with_as_many_as_suffice() -> None:
    body = rounded(0.2, 60, 50)
    with pytest.raises(
        InputError, match=r"rows of nodes cannot reach the far field growing by 1\.15"
    ) as error:
        made(body, growth=1.15, ni=401, nj=97)
    least = re.search(r"use (\d+) rows or more", str(error.value))
    assert least is not None
    assert made(body, growth=1.15, ni=401, nj=int(least[1])).quality["max_angle"].max < 135.0


@pytest.mark.parametrize(("body", "nj"), [(rounded(0.2, 60, 30), 101), (blunt(0.02), 61)])
def test_growth_off_walls_above_the_default_is_noted_with_the_option_that_limits_it(
    body: Airfoil, nj: int
) -> None:
    def advice(result: Result) -> list[str]:
        pattern = r"from the wall and its base grow by up to (\S+); {growth} 1\.2 limits"
        return re.findall(pattern, "; ".join(result.notes))

    few = made(body, first=8e-6, growth=None, ni=401, nj=nj)
    figure = quality_report(few.grid).figures("wall_growth")
    assert figure is not None
    assert advice(few) == [f"{figure.value:.3f}"]
    assert not advice(made(body, first=8e-6, growth=1.2))
    assert not advice(made(blunt(0.02), first=8e-6, growth=None, ni=401, nj=101))


def most_oblique(result: Result, k: int = 1) -> float:
    """Return the largest non-orthogonality as in checkMesh, of every k-th node."""
    worst = faces(coarser_grid(result.grid, k) if k > 1 else result.grid).non_orthogonality
    assert worst is not None
    return worst.max


def test_cells_at_the_outlet_behind_rounded_flanks_are_orthogonal_for_flow_solvers() -> None:
    result = made(rounded(0.2, 60, 30), first=8e-6, growth=None, ni=401, nj=100)
    assert most_oblique(result) < 60.0  # was 85: the ends of rows were widened at each try


@pytest.mark.parametrize("growth", [1.2, 1.3])
@pytest.mark.parametrize("body", [blunt(0.003), blunt(0.02), rounded(0.2, 60, 30)])
def test_lines_off_a_base_stay_orthogonal_for_flow_solvers_in_the_far_field(
    body: Airfoil, growth: float
) -> None:
    result = made(body, first=8e-6, growth=growth)
    assert most_oblique(result) < 72.0  # were up to 89, where the limit of growth moved some of them
    assert result.quality["max_angle"].max < 135.0


def test_cells_behind_a_base_are_nearly_orthogonal_for_flow_solvers_on_coarser_grids_too() -> None:
    result = made(blunt(0.003), first=8e-6, growth=None, ni=377, nj=97)
    assert most_oblique(result, 2) < 71.0  # was 72
    assert most_oblique(result, 4) < 80.5  # was 84


def test_cells_too_long_for_their_height_behind_a_base_are_noted_with_the_nodes_that_suffice() -> None:
    def advice(**nodes: int) -> tuple[list[str], float]:
        result = made(blunt(0.02), first=8e-6, growth=None, ni=401, nj=100, **nodes)
        nodes = re.findall(r"non-orthogonality .* degrees; {wake_nodes} (\d+) makes", "; ".join(result.notes))
        return nodes, most_oblique(result)

    (enough,), angle = advice(wake_nodes=25)
    assert angle > 80.0
    none, angle = advice(wake_nodes=int(enough))
    assert not none
    assert angle < 72.0


def test_cells_too_long_for_their_height_on_the_wall_are_noted_with_the_nodes_that_suffice() -> None:
    def advice(ni: int) -> tuple[list[str], float]:
        result = made(blunt(0.02), first=4e-7, growth=None, ni=ni, nj=100)
        nodes = re.findall(r"non-orthogonality .* degrees; {res} (\d+)x100 makes", "; ".join(result.notes))
        return nodes, most_oblique(result)

    (enough,), angle = advice(401)
    assert angle > 80.0
    none, angle = advice(int(enough))
    assert not none
    assert angle < 72.0
