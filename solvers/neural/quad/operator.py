"""The operator for four-sided domains or for bodies: a network with two outputs, then polish steps."""

import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from typing import Any, Self

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.threads import limited_to, thread_count
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.confidence import Goal
from meshonet.solvers.neural.operator import Operator, in_batches
from meshonet.solvers.neural.quad.canonical_frame import canonical
from meshonet.solvers.neural.quad.encoding import HEADS, WINSLOW
from meshonet.solvers.neural.quad.network import Network, Reals, sizes
from meshonet.solvers.neural.quad.polish import polished
from meshonet.solvers.solution import Solution

AUTO = {WINSLOW: 2, 1: 5}  # steps of "auto": multigrid cycles for Winslow's answer, else of descent


@dataclass(frozen=True)
class QuadOperator(Operator):
    """A trained U-Net for four-sided domains, or for O grids around bodies."""

    widths: tuple[int, ...] = ()  # of the network
    blocks: tuple[int, ...] = ()
    weights: Mapping[str, Reals] = field(default_factory=dict)  # its arrays, as `network.shapes` has them
    head: int = len(HEADS) - 1  # which of the network's answers is taken, an index into `encoding.HEADS`
    _networks: dict[str, Network] = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def of_file(cls, name: str, header: Mapping[str, Any], arrays: dict[str, Floats]) -> Self:
        """Return the operator from the header and the arrays of a model file."""
        widths, blocks = sizes(arrays)
        return cls(name, "o" if header.get("topology") == "o" else "quad", header, widths, blocks, arrays)

    def network(self, dtype: str = "float64") -> Network:
        """Return the network in ``float64`` or ``float32`` arithmetic; each is built once."""
        if dtype not in self._networks:
            self._networks[dtype] = Network(self.weights, self.blocks, dtype, around=self.topology == "o")
        return self._networks[dtype]

    @property
    def goal(self) -> Goal:
        """Name of the method whose grids the operator imitates."""
        return "winslow" if self.head == WINSLOW else "variational"

    def solve(
        self,
        boundaries: Sequence[Boundary],
        polish: Polish = "auto",
        *,
        dtype: str = "float64",
        threads: int = 1,
        **_: Any,
    ) -> list[Solution]:
        """Return a grid inside each boundary, with exactly the given boundary nodes.

        Boundaries with equal node counts form batches. The seconds of a solution are the seconds of the
        batch, divided by its number of boundaries.
        """
        self.check(boundaries)
        network = self.network(dtype)
        steps = AUTO[self.head] if polish == "auto" else 0 if polish == "off" else polish
        groups = list(in_batches(boundaries, threads))
        batches = [[boundaries[k] for k in group] for group in groups]
        share = max(thread_count() // threads, 1)  # of the kernels' threads, for each batch
        solved = partial(self._solved, network=network, steps=steps, threads=share)
        if threads == 1:
            answers = [solved(batch) for batch in batches]
        else:
            with ThreadPoolExecutor(threads) as pool:
                answers = list(pool.map(solved, batches))
        solutions = dict(zip(chain(*groups), chain(*answers), strict=True))
        return [solutions[k] for k in range(len(boundaries))]

    def _solved(
        self, boundaries: Sequence[Boundary], network: Network, steps: int, threads: int
    ) -> list[Solution]:
        begun = time.perf_counter()
        # descents amplify rounding: taken in canonical frames they are the same wherever a domain lies
        framed = steps and (self.topology == "o" or self.head != WINSLOW)
        frames = [canonical(boundary) for boundary in boundaries] if framed else []
        inner = [frame.boundary for frame in frames] or boundaries
        with limited_to(threads):
            planes, taken = polished(inner, network, self.topology, self.head, steps)
        if frames:
            planes = np.stack([frame.back(grid) for frame, grid in zip(frames, planes, strict=True)])
        spent = (time.perf_counter() - begun) / len(boundaries)
        with np.errstate(invalid="ignore"):  # infinity less infinity
            finite = bool(np.isfinite(planes.sum()))
        solutions = []
        for boundary, nodes, cycles in zip(boundaries, planes.transpose(0, 2, 3, 1), taken, strict=True):
            facts = {"method": "operator", "model": self.name, "polish": cycles}
            grid, seconds = boundary.grid(nodes, facts, finite=finite), {"grid": spent}
            solutions.append(Solution(grid, "operator", model=self.name, cycles=cycles, seconds=seconds))
        return solutions
