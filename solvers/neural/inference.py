"""Grids of boundaries by a given network, or by the default one of their topology."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Literal

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.conformal import solve as conformal
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.confidence import THRESHOLD, Confidence, Goal
from meshonet.solvers.neural.devices import Device, solve_on
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.registry import BASE, DEFAULTS, load, makes_volumes
from meshonet.solvers.solution import Solution

Answer = Literal["valid", "pasted", "raw"]
"""Treatment of a network's output. ``raw``: none; ``pasted``: its boundary nodes are replaced by the given
nodes, as in the paper; ``valid``: the caller also repairs folded cells.
"""


def infer_many(
    boundaries: Sequence[Boundary],
    model: str | None = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: Device | None = None,
    *,
    fallback: bool = False,
) -> list[Solution]:
    """Return a grid inside each boundary by a shipped model, or by one that `meshonet train` made.

    `model` is the name of a shipped model, the path of a ``.safetensors`` file, or ``base`` for the conformal
    solver; None is the default of the topology. `polish`: see `operator.Operator.solve`. If a `device` is
    given, torch computes the grids on it, and ``auto`` polish is 3 Picard steps for models of airfoils and
    off for others. With `fallback`, the method that the network imitates makes a grid anew if it has folded
    cells or too large an expected error (see `confidence`). Raises InputError if there is no such model or
    device, or if a boundary does not suit the model.
    """
    named = None if model is None else load(model)
    solutions: dict[int, Solution] = {}
    for topology in dict.fromkeys(boundary.topology for boundary in boundaries):
        rows = [k for k, boundary in enumerate(boundaries) if boundary.topology == topology]
        some = [boundaries[k] for k in rows]
        if topology == "c" and (named is None or named.batched):
            _refuse(
                model=model, polish=None if polish == "auto" else polish, device=device,
                fallback=fallback or None,
            )  # fmt: skip
        network = named or load(DEFAULTS[topology])
        if device is None:
            solved = network.solve(some, polish, paste=answer != "raw")
        else:
            instead = partial(_solved, goal="conformal" if topology == "o" else "variational")
            solved = solve_on(device, network, some, polish, instead)
        pairs = zip(some, solved, strict=True)
        judged = [_judged(network, boundary, own, fallback=fallback) for boundary, own in pairs]
        solutions |= zip(rows, judged, strict=True)
    return [solutions[k] for k in range(len(boundaries))]


def _judged(network: Operator, boundary: Boundary, solution: Solution, *, fallback: bool) -> Solution:
    """Return a solution with the confidence in it, or its replacement if it is not accepted."""
    if solution.model in (None, BASE):  # no network made it
        return solution
    error, folded = network.expected_error(boundary, solution), count_folded(solution.grid.nodes)
    confidence = Confidence(error, THRESHOLD, accepted=error <= THRESHOLD and not folded)
    if confidence.accepted or not fallback:
        return replace(solution, confidence=confidence)
    solved = _solved(boundary, network.goal)
    why = f"{folded} cells are folded" if folded else f"its expected error is {error:.1e}"
    note = f"the answer of {network.name} was replaced by the {network.goal} method's: {why}"
    return replace(solved, confidence=confidence, notes=(*solved.notes, note))


def _solved(boundary: Boundary, goal: Goal) -> Solution:
    if goal == "conformal":
        return conformal.solve([boundary], substitute=grid_of_body)[0]
    if goal == "variational":
        from meshonet.solvers.energy import variational

        return variational.solve(boundary)
    from meshonet.solvers.elliptic import solve as elliptic

    return elliptic.solve(boundary)


def grid_of_body(boundary: Boundary, why: str) -> Solution | None:
    """Return the grid of a compact body by the model ``hole-o``, with a note; None if cells are folded."""
    from meshonet.solvers.algebraic.resample.grids import thinned
    from meshonet.solvers.neural.quad.encoding import LATENT
    from meshonet.solvers.neural.quad.o_grids import compact
    from meshonet.solvers.neural.quad.unrolled import AROUND

    if boundary.ni < LATENT or not compact(boundary):
        return None
    network = load("hole-o")
    try:
        coarse = network.solve([thinned(boundary, AROUND, LATENT)], "off")[0]
        if count_folded(coarse.grid.nodes):
            return None  # to untangle it takes longer than to solve
        solution = network.solve([boundary])[0]
    except InputError:
        return None
    if count_folded(solution.grid.nodes):
        return None
    return replace(solution, notes=(f"{why}: hole-o used",))


def _refuse(**parameters: object) -> None:
    """Raise InputError for parameters that do not apply to C grids, which no network makes."""
    for name, value in parameters.items():
        if value is not None:
            option = f"{{{name}}}" if value is True else f"{{{name}}} {value}"
            problem = f"{option} is of no use to a c grid: it is marched, no model makes it"
            raise InputError(problem, f"drop {{{name}}}")


@dataclass(frozen=True)
class OperatorMethod:
    """The method ``operator``, which makes grids by `infer_many`; fields are the parameters of `infer_many`.

    Raises InputError if `fallback` is set and `model` is ``base``, which has no network.
    """

    model: str | None = None
    polish: Polish = "auto"
    answer: Answer = "valid"
    device: Device | None = None
    fallback: bool = False
    name = "operator"

    def __post_init__(self) -> None:
        if self.fallback and self.model == BASE:
            problem = f"{{fallback}} is of no use to {{model}} {BASE}: no network makes the grid"
            raise InputError(problem, "drop {fallback}")

    @cached_property
    def together(self) -> Topology | None:
        """Topology of boundaries whose grids are computed in batches; None: all grids one by one."""
        if self.device is None and self.model == BASE:
            return None  # no network
        if self.model is not None and makes_volumes(self.model):
            return None
        network = load(self.model or DEFAULTS["o"])
        return network.topology if network.batched else None

    def solve(
        self,
        problems: Sequence[Boundary],
        start: Sequence[Grid] | None = None,  # noqa: ARG002 - networks start from nothing
    ) -> list[Solution]:
        """Return a solution for each of the boundaries `problems`, in batches if the network allows it."""
        return infer_many(problems, self.model, self.polish, self.answer, self.device, fallback=self.fallback)
