"""Gates: what they accept, which figure they look at."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.criteria import Criteria
from meshonet.geometry.quality.figures import FIGURES, Figure, Figures
from meshonet.geometry.quality.gates import parse_gate, parse_gates
from meshonet.geometry.quality.measure import measure


def parallelogram() -> Grid:
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    return Grid.from_nodes(np.stack([x + 0.5 * y, np.sqrt(0.75) * y], axis=-1))


def figures_of(grid: Grid) -> Figures:
    return Figures(grid, measure(grid), grid.walls())


@pytest.mark.parametrize(
    ("text", "metric", "statistic", "compare", "limit"),
    [
        ("max_angle>170", "max_angle", "max", ">", 170),
        (" scaled_jacobian <= 0.2 ", "scaled_jacobian", "min", "<=", 0.2),
        ("skewness.p99>=8e-1", "skewness", "p99", ">=", 0.8),
        ("skewness>=0.8", "skewness", "max", ">=", 0.8),
        ("min_angle.mean<45", "min_angle", "mean", "<", 45),
        ("folded>0", "folded", "max", ">", 0),
        ("orthogonality<-.5", "orthogonality", "min", "<", -0.5),
    ],
)
def test_a_gate_names_metric_statistic_and_limit(
    text: str, metric: str, statistic: str, compare: str, limit: float
) -> None:
    gate = parse_gate(text)
    assert (gate.metric, gate.statistic, gate.compare, gate.limit) == (metric, statistic, compare, limit)


@pytest.mark.parametrize(
    "text",
    ["", "max_angle", "max_angle=5", "max_angle>nan", ">5", "max_angle>5>6", "a.b.c>1", "max_angle>1_0x"],
)
def test_what_is_no_gate_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match="is not a gate; write METRIC>VALUE or METRIC<VALUE"):
        parse_gate(text)


def test_a_gate_may_name_a_figure_beside_the_metrics() -> None:
    gate = parse_gate("relative_l2>1e-2", ("relative_l2",))
    figures = figures_of(parallelogram())
    assert gate.broken(figures, {"relative_l2": Figure(0.009)}) is None
    message = gate.broken(figures, {"relative_l2": Figure(0.02)})
    assert message == "relative_l2 is 0.02, which fails {fail_on} 'relative_l2>1e-2'"
    with pytest.raises(InputError, match="statistic 'mean' is not known; use no statistic with relative_l2"):
        parse_gate("relative_l2.mean>1e-2", ("relative_l2",))
    with pytest.raises(InputError, match="relative_l2 needs compare; use quality compare"):
        parse_gate("relative_l2>1e-2")


@pytest.mark.parametrize(
    ("text", "broken"),
    [
        ("max_angle>119", True),
        ("max_angle>121", False),
        ("max_angle.mean<119", False),
        ("max_angle.mean<121", True),
        ("min_angle<61", True),
        ("min_angle<59", False),
        ("folded>0", False),
        ("folded>=0", True),
    ],
)
def test_a_gate_is_broken_when_it_holds(text: str, broken: bool) -> None:
    message = parse_gate(text).broken(figures_of(parallelogram()))
    assert (message is not None) == broken
    assert message is None or f"{{fail_on}} '{text}'" in message


def test_equality_counts_only_when_asked_for() -> None:
    figures = figures_of(parallelogram())
    assert parse_gate("folded>=0").broken(figures)
    assert not parse_gate("folded>0").broken(figures)
    assert parse_gate("folded<=0").broken(figures)
    assert not parse_gate("folded<0").broken(figures)


def test_percentiles_are_asked_for_only_when_needed() -> None:
    assert Criteria(parse_gates(["max_angle>1", "skewness.p01<0"])).percentiles
    assert not Criteria(parse_gates(["max_angle>1", "skewness.mean>0"])).percentiles
    assert parse_gates(None) == ()


def stretched() -> Grid:
    """Steps of 1, 1, 1.5 along i, and of 1, 1.25 along j away from the walls south and north."""
    x, y = np.meshgrid([0.0, 1.0, 2.0, 3.5], [0.0, 1.0, 2.25], indexing="ij")
    return Grid.from_nodes(np.stack([x, y], axis=-1))


def test_growth_is_the_greatest_along_both_families_and_wall_growth_along_those_that_leave_walls() -> None:
    figures = figures_of(stretched())
    assert figures("growth") == Figure(1.5, (2, 0), "xi")
    assert figures("wall_growth") == Figure(1.25, (0, 1), "eta")
    message = parse_gate("growth>1.4").broken(figures)
    assert message == "growth is 1.5 along xi at i=2, j=0, which fails {fail_on} 'growth>1.4'"
    assert parse_gate("wall_growth>1.4").broken(figures) is None


def test_places_of_metrics_are_told_where_they_are_of_the_figure() -> None:
    nodes = stretched().nodes.copy()
    nodes[3, 2] += [0.4, 0.0]
    figures = figures_of(Grid.from_nodes(nodes))
    assert "at i=2, j=1, which fails" in str(parse_gate("max_angle>91").broken(figures))
    assert " at " not in str(parse_gate("max_angle.mean>0").broken(figures))


def test_every_figure_is_a_gate_and_only_what_is_named_is_measured() -> None:
    figures = figures_of(parallelogram())
    assert parse_gate("max_angle>170").broken(figures) is None
    assert not {"faces", "growth", "blocks", "wall_rows"} & set(vars(figures))
    assert parse_gate("face_skewness>100").broken(figures) is None
    assert "blocks" not in vars(figures)
    for name in FIGURES:
        assert parse_gate(f"{name}>5").metric == name


def test_a_figure_that_a_grid_lacks_is_refused() -> None:
    with pytest.raises(InputError, match="this grid has no far_field; use folded, max_angle"):
        parse_gate("far_field<20").broken(figures_of(parallelogram()))
