"""Methods that wrap methods, batches, and what is carried as data instead of being read from words."""

import numpy as np
import pytest
from solver_shapes import arch, hole

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, NoValidGridError, SolverError
from meshonet.geometry.spacing.y_plus import first_cell_note
from meshonet.solvers.algebraic.tfi import solve as interpolate
from meshonet.solvers.pipeline.coarse import Coarse, Sequenced
from meshonet.solvers.pipeline.fallback import guard
from meshonet.solvers.pipeline.make_grid import make_grid, make_grids
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.named import Each, method_named
from meshonet.solvers.pipeline.parameters import grid_request
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.solution import Outcome, Solution

METHOD_OF = "meshonet.solvers.pipeline.make_grid.method_of"


@pytest.mark.slow
def test_what_cannot_be_repaired_is_refused_or_marked() -> None:
    made = interpolate(impossible())
    with pytest.raises(NoValidGridError, match="stay folded after repair, then winslow, then tfi; use more"):
        guard(made, impossible(), margin=2)
    assert guard(made, impossible(), allow_invalid=True).outcome is Outcome.FOLDED


def impossible() -> Boundary:
    """A channel whose floor pierces its ceiling, cells of which stay folded whatever is done."""
    boundary = arch(12, 4)
    south = boundary.south.copy()
    south[5:7, 1] += 1.2 * (boundary.north[5:7, 1] - south[5:7, 1])
    return Boundary(south, boundary.north, boundary.west, boundary.east)


def test_wrappers_have_the_name_of_their_method_and_combine() -> None:
    method = method_named("winslow", tol=1e-9)
    for wrapped in (Coarse(method, 17), Sequenced(method, 1)):
        assert wrapped.name == "winslow"
    with pytest.raises(InputError, match="a coarse solve has no use for a grid to start from; drop initial"):
        grid_request("winslow", coarse=17, initial=interpolate(arch(33, 17)).grid)
    fine = method.solve([arch(33, 17)])[0].grid
    again = Sequenced(method, 1).solve([arch(33, 17)])[0].grid
    np.testing.assert_allclose(again.nodes, fine.nodes, atol=1e-7)


def test_rows_of_methods_load_what_they_name() -> None:
    for name, row in METHODS.items():
        method = method_named(name)
        assert method.name == name
        assert isinstance(method, Each) != row.is_class


def test_a_request_says_what_excludes_what() -> None:
    for parameters, problem in (
        ({"first_cell": 1e-3, "y_plus": 1, "reynolds": 1e6}, "first_cell and y_plus both say"),
        ({"y_plus": 1}, "y_plus without reynolds"),
        ({"coarse": 33, "refine": 1}, "coarse and refine both solve on fewer nodes"),
        ({"method": "hyperbolic"}, "method hyperbolic without a first cell"),
        ({"wall_angle": 80}, "wall_angle: method best sets no angle"),
        ({"spacing_west": -1}, "spacing_west: a first cell of -1"),
        ({"repair": True, "answer": "raw"}, "repair would change a raw answer"),
        ({"method": "winslow", "tol": 3}, "tol: 3 is not between 0 and 1"),
    ):
        with pytest.raises(InputError, match=problem):
            grid_request(**parameters)  # type: ignore[arg-type]


def test_first_cells_that_the_guard_changes_are_noted(monkeypatch: pytest.MonkeyPatch) -> None:
    def fold(boundary: Boundary) -> Solution:
        made = interpolate(boundary)
        nodes = made.grid.nodes.copy(order="K")
        nodes[10, 1], nodes[10, 2] = nodes[10, 2].copy(), nodes[10, 1].copy()
        exact = (first_cell_note(1e-3, 1e-3, 1e-3, None),)
        return Solution(boundary.grid(nodes), "fake", notes=exact, first_cells={"south": 1e-3})

    monkeypatch.setattr(METHOD_OF, lambda _: Each("fake", fold))
    result = make_grid(arch(21, 11), GridRequest())
    assert result.solution.path == ("repair",)
    assert any("the guard changed first cells" in note for note in result.notes)
    assert not any("at every wall node" in note for note in result.notes)


@pytest.mark.parametrize("failure", [MemoryError, SolverError])
def test_many_are_solved_in_one_call_and_one_by_one_when_that_fails(
    monkeypatch: pytest.MonkeyPatch, failure: type[Exception]
) -> None:
    calls: list[int] = []

    class Many:
        name, together = "many", "quad"

        def solve(self, problems: list[Boundary], start: object = None) -> list[Solution]:
            calls.append(len(problems))
            if len(problems) > 1 and any(problem.ni == 13 for problem in problems):
                raise failure
            return [interpolate(problem) for problem in problems]

    monkeypatch.setattr(METHOD_OF, lambda _: Many())
    shapes = [arch(21, 11), hole(21, 11), arch(21, 11)]
    assert all(not isinstance(result, Exception) for result in make_grids(shapes, GridRequest()))
    assert calls == [2, 1]
    calls.clear()
    assert len(list(make_grids([arch(21, 11), arch(13, 11)], GridRequest()))) == 2
    assert calls == [2, 1, 1]


def test_a_mistake_in_a_method_that_solves_many_is_seen_and_not_worked_around(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Mistaken:
        name, together = "mistaken", "quad"

        def solve(self, problems: list[Boundary], start: object = None) -> list[Solution]:
            if len(problems) > 1:
                raise AttributeError("a name that is not there")
            return [interpolate(problem) for problem in problems]

    monkeypatch.setattr(METHOD_OF, lambda _: Mistaken())
    first, other, last = make_grids([arch(21, 11), hole(21, 11), arch(21, 11)], GridRequest())
    assert isinstance(first, AttributeError)
    assert isinstance(last, AttributeError)
    assert not isinstance(other, Exception)


@pytest.mark.parametrize("shape", [np.eye(3, 2), "naca:0012"])
def test_points_and_names_are_no_shapes_and_the_error_says_what_makes_them_one(shape: object) -> None:
    with pytest.raises(InputError, match=r"make_grid takes shapes, not .*; use meshonet.grid, or"):
        make_grid(shape, GridRequest())  # type: ignore[arg-type]
