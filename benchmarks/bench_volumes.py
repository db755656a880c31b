"""Volumes inside six faces: time beside a copy of the nodes, and quality of the methods.

    python benchmarks/bench_volumes.py [--domains 50] [--largest 257] [--networks 4] [--epochs 500]
      [--page docs/benchmarks/volumes.md]

Times are processor seconds of one thread, the least of several runs; a copy is one into memory in use.
Angles are deviations from 90 degrees, the worst of the three at a corner; SJ is the scaled corner Jacobian.
"""

import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np
from clock import clocked
from page import arguments, publish

import meshonet
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.threads import limited_to
from meshonet.solvers.neural.volumes.network import infer_volume
from meshonet.solvers.solution import Solution
from meshonet.solvers.volumes.interpolate import arc_laws, interpolate
from meshonet.solvers.volumes.tfi import tfi
from meshonet.solvers.volumes.variational import variational
from meshonet.solvers.volumes.winslow import winslow

HEAD = """# Volumes inside six faces

<!-- made by python benchmarks/bench_volumes.py --page docs/benchmarks/volumes.md -->

Use this page to choose one of the three methods for [volumes inside six faces](../guide/volumes.md): `tfi`
(transfinite interpolation), `winslow` and `variational`. It compares their CPU times and the quality of their
grids, with one thread.
"""

TIME = """## Time

The domain has slightly curved faces; strongly curved faces take more time. The first row is the time to
copy the array of nodes, for comparison.
"""

QUALITY = """## Quality

Each domain has random corners and random curved faces; each grid has 33³ nodes. Domains whose face nodes
allow no valid grid are left out.

- *valid grids*: grids in which all corner Jacobians are positive.
- *scaled Jacobian*: smallest scaled Jacobian of the cell corners of a grid, median over the domains.
- *mean deviation* and *99th percentile*: over all cell corners of a grid, median over the domains. The
  deviation of a corner is the largest deviation of its three angles from 90 degrees.
- *CPU time*: median / 90th percentile over the domains.
"""

NETWORKS = """## A network: 3DMeshNet

Use `variational`, not 3DMeshNet: the network takes far more CPU time and makes fewer valid grids.

A 3DMeshNet (`train --model meshnet`) is trained anew for each domain, here for the first {count} domains of
*Quality*, with {epochs} steps (default 15,000). The CPU time includes the training.

- *3DMeshNet*: the given boundary nodes replace the predicted ones (`infer --answer pasted`). The largest
  error of a predicted boundary node, median over the domains, is {off} % of the domain size.
- *3DMeshNet, repaired*: folded cells are repaired too, as by `infer` without options.
"""

METHODS: dict[str, Callable[[SixFaces], Solution]] = {
    "`tfi`": tfi, "`winslow`": winslow, "`variational`": variational,
}  # fmt: skip


def random_faces(seed: int, n: int, size: float = 0.06) -> SixFaces:
    """Return moved corners, a smooth warp and independent bubbles of `size` on each face, n nodes a side."""
    rng = np.random.default_rng(seed)
    bubbles, unit = rng.normal(size=(3, 2, 3, 3, 3)), np.linspace(0.0, 1.0, n)
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * 3, indexing="ij"), axis=-1)
    corners += 0.08 * rng.normal(size=(2, 2, 2, 3))
    warp = 0.025 * rng.normal(size=(3, 3, 3, 3))

    def face(axis: int, end: int) -> Floats:
        s, t = np.meshgrid(unit, unit, indexing="ij")
        place = [s, t]
        place.insert(axis, np.full_like(s, end))
        a, b, c = place
        nodes = np.zeros((n, n, 3))
        for i, j, k in np.ndindex(2, 2, 2):
            share = (a if i else 1 - a) * (b if j else 1 - b) * (c if k else 1 - c)
            nodes += share[..., None] * corners[i, j, k]
        for p, q, r in np.ndindex(3, 3, 3):
            wave = np.cos(np.pi * (p * a + q * b + r * c) + p - q) / (1 + p + q + r)
            nodes += wave[..., None] * warp[p, q, r]
        inside = 4 * s * (1 - s) * t * (1 - t)
        for p, q in np.ndindex(3, 3):
            wave = np.sin(np.pi * (p + 1) * s) * np.sin(np.pi * (q + 1) * t) / (1 + p + q)
            nodes += np.where(inside > 0, wave, 0.0)[..., None] * size * bubbles[axis, end, p, q]
        return nodes

    return SixFaces(*(face(axis, end) for axis in range(3) for end in (0, 1)))


def quality(nodes: Floats) -> tuple[int, float, float, float]:
    """Return folded cells, least SJ, mean and 99th percentile of the corners' deviation."""
    edges = [np.diff(nodes, axis=axis) for axis in range(3)]
    worst, scaled = [], []
    for corner in np.ndindex(2, 2, 2):
        three = []
        for axis in range(3):
            part = [slice(c, c - 1 or None) for c in corner]
            part[axis] = slice(None)
            edge = edges[axis][tuple(part)]
            three.append(edge / np.linalg.norm(edge, axis=-1, keepdims=True))
        u, v, w = three
        scaled.append((np.cross(u, v) * w).sum(axis=-1))
        dots = [np.abs((p * q).sum(axis=-1)) for p, q in ((u, v), (u, w), (v, w))]
        worst.append(np.degrees(np.arcsin(np.minimum(np.maximum.reduce(dots), 1.0))))
    every = np.stack(worst)
    return count_folded(nodes), float(np.min(scaled)), float(every.mean()), float(np.quantile(every, 0.99))


def times(sizes: list[int]) -> str:
    """Return the table of times at the largest counts."""
    lines = ["| nodes | computation | CPU time, ms | relative to a copy |", "| --- | --- | --- | --- |"]
    for n in sizes:
        faces = random_faces(1, n, 0.03)
        out, other = np.zeros((3, n, n, n)), np.ones((3, n, n, n))
        copy = clocked(partial(np.copyto, out, other), 15)[0]
        rows: dict[str, Callable[[], object]] = {
            "copy of the nodes": partial(np.copyto, out, other),
            "`tfi`": partial(interpolate, faces, arc_laws(faces), out=out),
            "`variational`": partial(variational, faces),
        }
        if n <= 129:
            rows["`winslow`"] = partial(winslow, faces)
        for name, act in rows.items():
            spent = copy if "copy" in name else clocked(act, 7 if n < 200 else 3)[0]
            lines.append(f"| {n}³ | {name} | {1e3 * spent:.1f} | {spent / copy:.2f} |")
    return "\n".join([*lines, "\n`variational` solves on 33³ nodes and interpolates to all nodes."])


def measured(method: Callable[[SixFaces], Solution], faces: SixFaces) -> tuple[float, ...]:
    """Return processor seconds and `quality` of a method's grid."""
    begun = time.process_time()
    nodes = method(faces).grid.nodes
    return (time.process_time() - begun, *quality(nodes))


def table(judged: dict[str, list[tuple[float, ...]]]) -> list[str]:
    """Return a table of what `measured` gave for each method."""
    lines = [
        "| method | valid grids | scaled Jacobian | mean deviation, degrees | 99th percentile, degrees "
        "| CPU time, s |"
    ]
    lines += ["| --- | --- | --- | --- | --- | --- |"]
    for name, rows in judged.items():
        spent, folded, sj, mean, high = np.array(rows).T
        middle = f"{np.median(sj):.3f} | {np.median(mean):.1f} | {np.median(high):.1f}"
        seconds = f"{np.median(spent):.3f} / {np.quantile(spent, 0.9):.3f}"
        lines.append(f"| {name} | {int((folded == 0).sum())} of {len(rows)} | {middle} | {seconds} |")
    return lines


def domains(number: int, n: int) -> tuple[str, list[SixFaces]]:
    """Return the table of random domains whose faces do not fold cells by themselves, and these."""
    judged: dict[str, list[tuple[float, ...]]] = {name: [] for name in METHODS}
    chosen: list[SixFaces] = []
    for seed in count(1000):
        faces = random_faces(seed, n)
        try:
            row = {name: measured(METHODS[name], faces) for name in reversed(METHODS)}
        except InputError:
            continue
        chosen.append(faces)
        for name, values in row.items():
            judged[name].append(values)
        if len(chosen) == number:
            break
    lines = [QUALITY, *table(judged)]
    own, other = (np.array(judged[name]) for name in ("`variational`", "`winslow`"))
    worse = int(((own[:, 2] < other[:, 2] - 1e-9) | (own[:, 3] > other[:, 3])).sum())
    lines.append(
        f"\nIn {number - worse} of the {number} domains, the grid of `variational` has a smaller mean "
        "deviation and a larger scaled\nJacobian than the grid of `winslow`."
    )
    return "\n".join(lines), chosen


def networks(chosen: Sequence[SixFaces], epochs: int) -> str:
    """Return the table of 3DMeshNet, trained for each of the domains, beside the solvers."""
    with tempfile.TemporaryDirectory() as folder:
        files, model = [], str(Path(folder, "model.safetensors"))
        for k, faces in enumerate(chosen):
            files.append(Path(folder, f"{k}.vts"))
            tfi(faces).grid.write(files[-1])
        begun = time.process_time()
        meshonet.train(files, model, model="meshnet", epochs=epochs, seed=0)
        training = (time.process_time() - begun) / len(chosen)
        answers: dict[str, Callable[[SixFaces], Solution]] = {
            "3DMeshNet": partial(infer_volume, model=model, answer="pasted"),
            "3DMeshNet, repaired": partial(infer_volume, model=model),
        }
        methods = {"`variational`": METHODS["`variational`"]} | answers
        judged = {name: [measured(act, faces) for faces in chosen] for name, act in methods.items()}
        off = [_off(infer_volume(faces, model=model, answer="raw").grid.nodes, faces) for faces in chosen]
    for name in answers:
        judged[name] = [(spent + training, *rest) for spent, *rest in judged[name]]
    head = NETWORKS.format(count=len(chosen), epochs=epochs, off=f"{100 * np.median(off):.1f}")
    return "\n".join([head, *table(judged)])


def _off(nodes: Floats, faces: SixFaces) -> float:
    """Return the largest distance of outer nodes from the given faces, relative to the largest extent."""
    own = SixFaces.of_block(nodes).faces
    pairs = zip(own, faces.faces, strict=True)
    size = max(np.ptp(np.concatenate([face.reshape(-1, 3) for face in faces.faces]), axis=0))
    return float(max(np.linalg.norm(a - b, axis=-1).max() for a, b in pairs) / size)


def main() -> None:
    """Print the tables, or write the page."""
    parser = arguments(__doc__)
    parser.add_argument("--domains", type=int, default=50)
    parser.add_argument("--largest", type=int, default=257)
    parser.add_argument("--networks", type=int, default=4, help="domains for which 3DMeshNet is trained")
    parser.add_argument("--epochs", type=int, default=500)
    chosen = parser.parse_args()
    with limited_to(1):
        spent = times([n for n in (129, 257) if n <= chosen.largest])
        quality, faces = domains(chosen.domains, 33)
        learnt = networks(faces[: chosen.networks], chosen.epochs)
    publish(f"{HEAD}\n{TIME}\n{spent}\n\n{quality}\n\n{learnt}\n", chosen.page)


if __name__ == "__main__":
    main()
