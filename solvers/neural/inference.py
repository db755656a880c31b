"""From boundaries to grids by the model that is named, or by the method that measures best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from meshonet.geometry.arrays import Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.conformal import solve as conformal
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.devices import Device, solve_on
from meshonet.solvers.neural.registry import BASE, DEFAULTS, load
from meshonet.solvers.solution import Solution

Answer = Literal["valid", "pasted", "raw"]
"""What becomes of a network's answer: ``raw`` nothing; ``pasted`` the boundary's own nodes are put on its
edges, as the paper does; ``valid`` folded cells are repaired as well (by the caller's guard)."""


def infer(
    boundary: Boundary,
    model: str | None = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: Device | None = None,
) -> Solution:
    """Return the grid inside one boundary: `infer_many` of it alone."""
    return infer_many([boundary], model, polish, answer, device)[0]


def infer_many(
    boundaries: Sequence[Boundary],
    model: str | None = None,
    polish: Polish = "auto",
    answer: Answer = "valid",
    device: Device | None = None,
) -> list[Solution]:
    """Return a grid inside each boundary by a shipped model, or by one that `meshonet train` made.

    `model` is the name of a shipped model, the path of a ``.safetensors`` file, ``base``, or None for what
    measures best. That is no network unless steps or a device are given: the conformal solver for O grids,
    the variational method for four-sided domains; C grids are marched where that is possible, else
    variational too. `polish` are steps after the network (`operator.Operator.solve`). On a `device` torch
    computes the grids, with 3 Picard steps or no descent when polish is ``auto``; by default numpy does.

    Polished until nothing changes, O grids are the same without the network, in less time. What the conformal
    solver cannot take goes to the operator for bodies if no model is named, else to the elliptic solver, and
    the solution says so. Raises InputError: a model that does not exist, cannot be read or does not suit a
    boundary; no such device.
    """
    operator = None if model is None else load(model)
    plain = polish == "auto" and device is None
    solutions: dict[int, Solution] = {}
    for topology in dict.fromkeys(boundary.topology for boundary in boundaries):
        rows = [k for k, boundary in enumerate(boundaries) if boundary.topology == topology]
        some = [boundaries[k] for k in rows]
        if topology == "c" and (operator is None or operator.batched):
            _refuse(model=model, polish=None if polish == "auto" else polish, device=device)
        if operator is None and plain:
            solved = _by_best(topology, some)
        else:
            chosen = operator or load(DEFAULTS[topology])
            if device is None:
                solved = chosen.solve(some, polish, paste=answer != "raw")
            else:
                solved = solve_on(device, chosen, some, polish, instead=lambda b: infer(b))
        solutions |= zip(rows, solved, strict=True)
    return [solutions[k] for k in range(len(boundaries))]


def many_of(model: str | None, device: Device | None = None, polish: Polish = "auto") -> Topology | None:
    """Return the topology of boundaries that `infer_many` solves faster together; None: one by one."""
    if device is None and (model == BASE or (model is None and polish == "auto")):
        return None  # no network
    operator = load(model or DEFAULTS["o"])
    return operator.topology if operator.batched else None


def _by_best(topology: Topology, boundaries: Sequence[Boundary]) -> list[Solution]:
    """Return solutions by the method that measures best for a topology; it needs no network."""
    if topology == "o":
        return conformal.solve(boundaries, substitute=_by_bodies)
    from meshonet.solvers.pipeline.select import without_network

    return without_network(topology).solve(boundaries)


def _by_bodies(boundary: Boundary, why: str) -> Solution | None:
    """Return the grid of a compact body by `hole-o`, None if it is folded."""
    from meshonet.solvers.algebraic.resample.grids import thinned
    from meshonet.solvers.neural.quad.encoding import LATENT
    from meshonet.solvers.neural.quad.o_grids import compact
    from meshonet.solvers.neural.quad.unrolled import AROUND

    if boundary.ni < LATENT or not compact(boundary):
        return None
    operator = load("hole-o")
    try:
        coarse = operator.solve([thinned(boundary, AROUND, LATENT)], "off")[0]
        if count_folded(coarse.grid.nodes):
            return None  # to untangle it takes longer than to solve
        solution = operator.solve([boundary])[0]
    except InputError:
        return None
    if count_folded(solution.grid.nodes):
        return None
    return replace(solution, notes=(f"{why}: hole-o used",))


def _refuse(**parameters: object) -> None:
    """Raise InputError for parameters that C grids, which no network makes, have no use for."""
    for name, value in parameters.items():
        if value is not None:
            problem = f"{{{name}}} {value} is of no use to a c grid: it is marched, no model makes it"
            raise InputError(problem, f"drop {{{name}}}")


@dataclass(frozen=True)
class Operator:
    """A neural operator; its settings are those of `infer_many`."""

    model: str | None = None
    polish: Polish = "auto"
    answer: Answer = "valid"
    device: Device | None = None
    name = "operator"

    @cached_property
    def together(self) -> Topology | None:
        """The topology of boundaries that go through the network in one pass; None if none do."""
        return many_of(self.model, self.device, self.polish)

    def solve(
        self,
        problems: Sequence[Boundary],
        start: Sequence[Grid] | None = None,  # noqa: ARG002 - networks start from nothing
    ) -> list[Solution]:
        """Return a solution for each of the boundaries, by one pass of the network where it can."""
        return infer_many(problems, self.model, self.polish, self.answer, self.device)
