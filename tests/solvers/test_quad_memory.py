"""Descents of quad meshes that cannot begin: memory that does not suffice, nodes that are not finite."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from quad_meshes import rectangle

from meshonet.kernels._native import QuadDescent
from meshonet.solvers.energy.quad_problem import Problem, unknowns_of
from meshonet.solvers.energy.walls import walls_of

WEIGHTS = (0.5, 1.0, 0.0, 0.0)


def problem_of(n: int) -> Problem:
    """Return the problem of a square of n x n nodes."""
    mesh = rectangle(np.linspace(0.0, 1.0, n), np.linspace(0.0, 1.0, n))
    unknowns = unknowns_of(mesh, None)
    walls = walls_of(mesh, unknowns.fixed, unknowns.tied)
    assert walls is not None
    return Problem(mesh, unknowns, walls, None, None)


def run(descent: QuadDescent) -> float:
    return descent.run(*WEIGHTS, 1e-5, 1, False)[0]


def main() -> None:
    """Say how descents begin without memory, and when there is some again."""
    import resource

    problem = problem_of(150)
    gradient = np.empty(2 * 148 * 148 + 4 * 148)  # inner nodes, and those that slide
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize(), hard))
    reports = []
    for begin in (
        lambda: problem.descent.evaluate(*WEIGHTS, gradient),
        lambda: problem.descent.evaluate(*WEIGHTS, gradient),
        lambda: run(problem.descent),
    ):
        try:
            begin()
        except MemoryError:
            reports.append("no memory")
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    reports.append(str(np.isfinite(run(problem.descent))))
    sys.stdout.write(" ".join(reports))


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="needs Linux")
def test_memory_that_does_not_suffice_is_told_and_spoils_nothing() -> None:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    done = subprocess.run([sys.executable, __file__], env=environment, capture_output=True, text=True)
    assert done.stdout == "no memory no memory no memory True", done.stderr


def test_nodes_that_are_not_finite_are_refused() -> None:
    problem = problem_of(5)
    problem.nodes[problem.inner[0]] = np.nan
    with pytest.raises(ValueError, match="not finite"):
        run(problem.descent)


if __name__ == "__main__":
    main()
