"""What is solved on fewer nodes when nobody says how many, and when those are too few."""

from collections.abc import Callable

import pytest
from solver_shapes import arch, folded, hole

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.pipeline.automatic import fewer_on_quads
from meshonet.solvers.pipeline.named import Each
from meshonet.solvers.solution import Solution


def spied(seen: list[tuple[int, int]]) -> Callable[[Boundary], Solution]:
    """A solver that notes the counts of what it is given, and folds copies of fewer than 200 nodes."""

    def solver(boundary: Boundary) -> Solution:
        seen.append((boundary.ni, boundary.nj))
        nodes = tfi(boundary).nodes.copy(order="K")
        if boundary.ni < 200:
            nodes[60:64, 5], nodes[70:74, 5] = nodes[70:74, 5].copy(), nodes[60:64, 5].copy()
        return Solution(boundary.grid(nodes), "variational")

    return solver


@pytest.mark.parametrize(
    ("make", "counts", "name", "expected"),
    [
        (arch, (257, 20), "variational", [(257, 20)]),
        (arch, (300, 20), "variational", [(129, 20), (257, 20)]),
        (arch, (512, 20), "winslow", [(512, 20)]),
        (arch, (513, 20), "winslow", [(257, 20)]),
        (arch, (600, 20), "thomas-middlecoff", [(600, 20)]),
        (hole, (600, 20), "variational", [(600, 20)]),
    ],
)
def test_large_quads_take_fewer_nodes_and_more_where_those_fold(make, counts, name, expected) -> None:  # type: ignore[no-untyped-def]
    seen: list[tuple[int, int]] = []
    (solution,) = fewer_on_quads(Each(name, spied(seen))).solve([make(*counts)])
    assert seen == expected
    assert solution.grid.nodes.shape[:2] == counts
    if len(expected) == 2:
        assert folded(solution.grid.nodes) == 0
