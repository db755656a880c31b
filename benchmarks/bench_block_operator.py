"""What `quad-general` is worth on the blocks of a layout: as a start of the joint optimum, and as a judge.

    python benchmarks/bench_block_operator.py [--domains 12] [--cells 2500]

For domains of examples/domains/domains.py: the layout is refined to so many cells, as splines and, block by
block, by the network from the same edges, all blocks in one batch; the joint optimum goes on from either.
Printed are the value of the functional after 0, 10, 40 and 150 iterations from both starts, and milliseconds
of processor time of splines, network, and ten iterations.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from clock import clocked

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "domains"))

from domains import DOMAINS, random_domain

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.neural.registry import load
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import refine

AFTER = (0, 10, 40, 150)


def edges_of(layout: Layout) -> list[Boundary]:
    """Return the four edges of every block."""
    nodes = layout.mesh.nodes
    return [
        Boundary(nodes[b[:, 0]], nodes[b[:, -1]], nodes[b[0]], nodes[b[-1]], topology="quad")
        for b in layout.blocks
    ]


def by_network(layout: Layout, operator) -> Floats:  # type: ignore[no-untyped-def]
    """Return the nodes (n, 2), those inside blocks from the network."""
    nodes = layout.mesh.nodes.copy()
    wide = [k for k, b in enumerate(layout.blocks) if min(b.shape) > 2]
    edges = edges_of(layout)
    solutions = operator.solve([edges[k] for k in wide], "off", dtype="float32")
    for k, solution in zip(wide, solutions, strict=True):
        nodes[layout.blocks[k][1:-1, 1:-1]] = solution.grid.nodes[1:-1, 1:-1]
    return nodes


def values(layout: Layout) -> list[float]:
    """Return the functional after some iterations, infinite while folded."""
    return [optimise(layout.mesh, iterations=n, tolerance=0.0).value for n in AFTER]


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--domains", type=int, default=12)
    parser.add_argument("--cells", type=int, default=2500)
    options = parser.parse_args()
    operator = load("quad-general")
    loops = {name: make() for name, make in DOMAINS.items()}
    loops |= {f"random-{seed}": random_domain(seed) for seed in range(20)}
    rows = []
    for name in list(loops)[:: max(1, len(loops) // options.domains)]:
        try:
            layout = decompose(Domain.of_polygons(loops[name]))
        except MeshonetError as error:
            print(f"{name}: {error}")
            continue
        chords = Chords.of(layout)
        counts = chords.counts_for_cells(options.cells)
        spline_s, fine = clocked(lambda c=chords, n=counts: refine(c.layout, n, c), 3)
        network_s, nodes = clocked(lambda f=fine: by_network(f, operator), 3)
        other = replace(fine, mesh=fine.mesh.with_nodes(nodes))
        ten_s, _ = clocked(lambda f=fine: optimise(f.mesh, iterations=10), 3)
        a, b = values(fine), values(other)
        rows.append((spline_s, network_s, ten_s))
        show = " ".join(f"{x:.4f}/{y:.4f}" for x, y in zip(a, b, strict=True))
        print(
            f"{name:24s} {len(fine.blocks):3d} blocks  spline/network after {AFTER}: {show}"
            f"  spline {1e3 * spline_s:.1f} ms, network {1e3 * network_s:.1f}, ten steps {1e3 * ten_s:.1f}"
        )
    print(
        "medians, ms: spline {:.1f}, network {:.1f}, ten iterations {:.1f}".format(
            *(1e3 * np.median(rows, axis=0))
        )
    )


if __name__ == "__main__":
    main()
