"""Any planar domain by `solve-pde`, beside Gmsh's quads: valid, irregular vertices, angles, seconds.

    python benchmarks/bench_blocks.py [--files FOLDER] [--random 200] [--gmsh 40] [--algorithms 11,8,9]
                                      [--keep build/bench-blocks] [--page docs/benchmarks/blocks.md]

Each domain is a whole process on one thread. Gmsh (of the extra `test`) runs in processes of its own.
What is measured is kept in a folder, and a run goes on from there.
"""

import json
import os
import resource
import subprocess
import sys
import time
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from page import arguments, publish
from quads_checked import judged, merged

import meshonet

ROOT = Path(__file__).resolve().parents[1]
CELLS = 2500
LONGEST = {"ours": 60.0, "gmsh": 900.0}
"""Seconds after which a process is ended."""
Row = dict[str, Any]


def main() -> None:
    """Measure what was not measured yet, and print; write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--files", type=Path, help="folder of GeoJSON domains besides")
    parser.add_argument("--random", type=int, default=200, help="how many random domains")
    parser.add_argument("--gmsh", type=int, default=40, help="how many domains Gmsh gets, spread over all")
    parser.add_argument("--algorithms", default="11,8,9", help="Mesh.Algorithm of Gmsh")
    parser.add_argument("--keep", type=Path, default=ROOT / "build" / "bench-blocks")
    options = parser.parse_args()
    options.keep.mkdir(parents=True, exist_ok=True)
    groups = domains(options.files, options.random, options.keep / "domains")
    environment = own_environment(options.keep)
    ours = {
        path: kept(options.keep, "ours", path, environment) for group in groups.values() for path in group
    }
    every = list(ours)
    sampled = every[:: max(1, len(every) // options.gmsh)][: options.gmsh] if options.gmsh else []
    theirs = {
        algorithm: {path: kept(options.keep, f"gmsh{algorithm}", path, environment) for path in sampled}
        for algorithm in (options.algorithms.split(",") if sampled else [])
    }
    text = page(groups, ours, theirs)
    publish(text, options.page)


def domains(files: Path | None, random: int, folder: Path) -> dict[str, list[Path]]:
    """Return the files of each group of domains; the own and the random ones are written into a folder."""
    sys.path.insert(0, str(ROOT / "examples" / "domains"))
    from domains import write_all

    written = write_all(folder, range(random))
    named = [path for path in written if not path.stem.startswith("random-")]
    groups = {"gallery": named, "random": written[len(named) :]}
    all_groups = ({"files": sorted(files.glob("*.geojson"))} if files else {}) | groups
    return {name: paths for name, paths in all_groups.items() if paths}


def own_environment(keep: Path) -> dict[str, str]:
    """Return the environment of processes: this package, one thread, modules compiled."""
    environment = dict(os.environ) | {
        "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", "PYTHONPYCACHEPREFIX": str(keep / "compiled"),
    }  # fmt: skip
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    subprocess.run([sys.executable, "-m", "compileall", "-q", "geometry", "formats", "solvers", "kernels",
                    "meshonet", "meshonet_cli"], cwd=ROOT, env=environment, check=False)  # fmt: skip
    return environment


def kept(keep: Path, way: str, path: Path, environment: dict[str, str]) -> Row:
    """Return what a way makes of a domain: from the folder, else measured now."""
    record = keep / f"{way}-{path.stem}.json"
    if not record.exists():
        row = by_blocks(path, environment) if way == "ours" else by_gmsh(path, way[4:], environment)
        record.write_text(json.dumps(row))
        print(path.stem, way, row, file=sys.stderr, flush=True)
    row = json.loads(record.read_text())
    assert isinstance(row, dict)
    return row


def by_blocks(path: Path, environment: dict[str, str]) -> Row:
    """Return the figures of the grid that the command makes of a domain."""
    out = Path(environment["PYTHONPYCACHEPREFIX"]).parent / f"grid-{os.getpid()}.vtm"
    command = [sys.executable, "-m", "meshonet_cli", "solve-pde", str(path), "--cells", str(CELLS)]
    row = timed([*command, "-o", str(out), "--quiet"], "ours", environment)
    if row["status"] != 0:
        return row
    blocks = [block.nodes for block in meshonet.read(out).blocks]  # type: ignore[union-attr]
    facts = judged(*merged(blocks), loops_of(path))
    return row | asdict(facts) | {"blocks": len(blocks)}


def by_gmsh(path: Path, algorithm: str, environment: dict[str, str]) -> Row:
    """Return the figures of Gmsh's quads; its seconds are those of meshing alone."""
    out = Path(environment["PYTHONPYCACHEPREFIX"]).parent / f"gmsh{algorithm}-{path.stem}-{os.getpid()}.npz"
    out.unlink(missing_ok=True)
    command = [sys.executable, str(ROOT / "benchmarks" / "gmsh_quads.py"), str(path), algorithm, str(CELLS)]
    row = timed([*command, str(out)], "gmsh", environment)
    if not out.exists():
        return row | {"status": row["status"] or 1}
    with np.load(out) as result:
        nodes, quads = result["nodes"], result["quads"]
        row |= {"cpu": float(result["seconds"]), "triangles": int(result["triangles"])}
    if not len(quads):
        return row | {"status": 1, "said": "no quads"}
    z = nodes[quads] @ np.array([1.0, 1j])
    turned = (np.conj(z[:, 1] - z[:, 0]) * (z[:, 3] - z[:, 0])).imag < 0
    quads = quads[:, ::-1] if turned.mean() > 0.5 else quads
    return row | asdict(judged(nodes, quads, loops_of(path), strict=False))


def timed(command: list[str], tool: str, environment: dict[str, str]) -> Row:
    """Return status, seconds by the clock and of the processor, and the last line on standard error."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=LONGEST[tool], check=False
        )
        status, said = done.returncode, (done.stderr.strip().splitlines() or [""])[-1]
    except subprocess.TimeoutExpired:
        status, said = 124, "still running"
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"status": status, "wall": time.perf_counter() - begun, "cpu": cpu, "said": said[:200]}


def loops_of(path: Path) -> list[Any]:
    """Return the polygons (n, 2) of a GeoJSON file as they stand in it."""
    data = json.loads(path.read_text())
    geometry = data["features"][0] if "features" in data else data
    rings = geometry.get("geometry", geometry)["coordinates"]
    return [np.array(ring, dtype=float)[:-1, :2] for ring in rings]


def page(groups: dict[str, list[Path]], ours: dict[Path, Row], theirs: dict[str, dict[Path, Row]]) -> str:
    """Return the text of the page."""
    lines = [HEAD, VALID]
    for name, paths in [*groups.items(), ("**all**", list(ours))]:
        lines.append(group_line(name, [ours[path] for path in paths]))
    bad = [(path.stem, row) for path, row in ours.items() if row["status"] or row["wrong"]]
    if bad:
        lines.append("")
    lines += [
        *(f"- {name}: exit {row['status']}, {row.get('wrong') or row['said']}" for name, row in bad),
    ]
    if theirs:
        lines += [BESIDE, *chain(*(beside_lines(a, rows, ours) for a, rows in theirs.items()))]
    if "11" in theirs:
        lines += claims(theirs["11"], ours)
    return "\n".join(lines) + "\n"


def group_line(name: str, rows: list[Row]) -> str:
    """Return the line of a group of domains."""
    good = [row for row in rows if not row["status"] and not row["wrong"]]
    cpu = np.array([row["cpu"] for row in rows])
    kinds = [float(np.median([row[key] for row in good])) for key in ("blocks", "irregular", "mean", "p99")]
    blocks, irregular, mean, p99 = kinds
    spent = f"{np.median(cpu):.2f} / {np.percentile(cpu, 90):.2f} / {cpu.max():.2f}"
    figures = f"{blocks:.0f} | {irregular:.0f} | {mean:.1f} | {p99:.1f}"
    return f"| {name} | {len(good)} of {len(rows)} | {figures} | {spent} |"


def beside_lines(algorithm: str, rows: dict[Path, Row], ours: dict[Path, Row]) -> list[str]:
    """Return the lines of meshonet and one of Gmsh's algorithms, on the same domains."""
    both = pairs(rows, ours)
    if not both:
        return [f"| Gmsh, algorithm {algorithm} | 0 of {len(rows)} | | | | | | |"]
    keys = ("irregular", "mean", "p99", "cpu", "cells")
    cells = [" | ".join(f"{np.median([pair[k][key] for pair in both]):.4g}" for key in keys) for k in (0, 1)]
    left = sum(pair[1].get("triangles", 0) > 0 for pair in both)
    meshed = f"{len(both)} of {len(rows)}"
    return [
        f"| meshonet | {meshed} | 0 | {cells[0]} |",
        f"| Gmsh, algorithm {algorithm} | {meshed} | {left} | {cells[1]} |",
    ]


def pairs(rows: dict[Path, Row], ours: dict[Path, Row]) -> list[tuple[Row, Row]]:
    """Return ours and theirs where both are meshes."""
    return [(ours[path], row) for path, row in rows.items() if not row["status"] and not ours[path]["status"]]


def claims(rows: dict[Path, Row], ours: dict[Path, Row]) -> list[str]:
    """Return what is claimed of algorithm 11, as it was measured."""
    both = pairs(rows, ours)
    irregular = [sum(pair[k]["irregular"] for pair in both) for k in (0, 1)]
    angles = sum(one["p99"] < other["p99"] for one, other in both)
    factors = np.array([other["cpu"] / one["cpu"] for one, other in both])
    return [
        "",
        f"- The grids of meshonet have {irregular[0]} irregular vertices in total, the meshes of Gmsh "
        f"{irregular[1]}.",
        f"- In {angles} of {len(both)} domains, the 99th percentile is smaller for meshonet than for Gmsh.",
        f"- Gmsh takes {np.median(factors):.1f} times the CPU time of meshonet in the median, "
        f"and at least {factors.min():.1f} times in every domain.",
    ]


HEAD = """# Multi-block grids of plane domains, compared with Gmsh

<!-- made by python benchmarks/bench_blocks.py --page docs/benchmarks/blocks.md -->

Use this page to see how often `meshonet solve-pde` generates a valid multi-block grid, how good the grid is,
and how long it takes. CPU times are for one thread.

Each domain is a GeoJSON file for the command `meshonet solve-pde FILE --cells 2500 -o F.vtm`.

- *files*: domain files from other sources than meshonet. *gallery*: the domains of the
  [gallery](../gallery/domains.md). *random*: random domains.
- *valid grids*: all corner Jacobians are positive, and nodes of adjacent blocks match. Boundary nodes lie on
  the outline within 1e-8 of the domain size. The area of the grid is exact within 0.1 %.
- *irregular vertices*: interior nodes at which more or fewer than four cells meet.
- *mean deviation*: deviation of a cell corner angle from 90 degrees, averaged over all corners of a grid.
- *99th percentile*: 99 % of the cells of a grid have no corner angle with a larger deviation.
- *CPU time*: time of the whole command.

The columns *blocks* to *99th percentile* are medians over the domains.
"""
VALID = """\
| domains | valid grids | blocks | irregular vertices | mean deviation, degrees | 99th percentile, degrees \
| CPU time, s: median / 90th percentile / largest |
| --- | --- | --- | --- | --- | --- | --- |"""
BESIDE = """
## Comparison with Gmsh

Gmsh meshed a sample of the domains with its algorithm 11, for quadrilaterals, and with about as many cells as
meshonet. The CPU time of Gmsh is the time to mesh; that of meshonet is the time of the whole command, with
reading and writing. The last five columns are medians over the domains.

| program | domains meshed | meshes with triangles | irregular vertices | mean deviation, degrees \
| 99th percentile, degrees | CPU time, s | cells |
| --- | --- | --- | --- | --- | --- | --- | --- |"""

if __name__ == "__main__":
    main()
