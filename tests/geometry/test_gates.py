"""Gates: what they accept, which figure they look at."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.gates import need_percentiles, parse_gate, parse_gates
from meshonet.geometry.quality.measure import measure


def parallelogram() -> Grid:
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    return Grid.from_nodes(np.stack([x + 0.5 * y, np.sqrt(0.75) * y], axis=-1))


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
    quality = measure(parallelogram())
    assert gate.broken(quality, {"relative_l2": 0.009}) is None
    assert (
        gate.broken(quality, {"relative_l2": 0.02}) == "relative_l2 is 0.02, and {fail_on} 'relative_l2>1e-2'"
    )
    with pytest.raises(InputError, match="statistic 'mean' is not known; use no statistic with relative_l2"):
        parse_gate("relative_l2.mean>1e-2", ("relative_l2",))
    with pytest.raises(InputError, match="metric 'relative_l2' is not known; use one of folded, max_angle"):
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
    told = parse_gate(text).broken(measure(parallelogram()))
    assert (told is not None) == broken
    assert told is None or f"{{fail_on}} '{text}'" in told


def test_equality_counts_only_when_asked_for() -> None:
    quality = measure(parallelogram())
    assert parse_gate("folded>=0").broken(quality)
    assert not parse_gate("folded>0").broken(quality)
    assert parse_gate("folded<=0").broken(quality)
    assert not parse_gate("folded<0").broken(quality)


def test_percentiles_are_asked_for_only_when_needed() -> None:
    assert need_percentiles(parse_gates(["max_angle>1", "skewness.p01<0"]))
    assert not need_percentiles(parse_gates(["max_angle>1", "skewness.mean>0"]))
    assert parse_gates(None) == ()
