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
    lines += [
        "",
        *(f"- {name}: exit {row['status']}, {row.get('wrong') or row['said']}" for name, row in bad),
    ]
    if theirs:
        lines += [BESIDE, *(beside_line(a, rows, ours) for a, rows in theirs.items())]
    if "11" in theirs:
        lines += claims(theirs["11"], ours)
    return "\n".join(lines) + "\n"


def group_line(name: str, rows: list[Row]) -> str:
    """Return the line of a group of domains."""
    good = [row for row in rows if not row["status"] and not row["wrong"]]
    silent = sum(not row["status"] and bool(row["wrong"]) for row in rows)
    refused = sum(row["status"] in (2, 3) for row in rows)
    cpu, wall = (np.array([row[key] for row in rows]) for key in ("cpu", "wall"))
    kinds = [float(np.median([row[key] for row in good])) for key in ("blocks", "irregular", "mean", "p99")]
    blocks, irregular, mean, p99 = kinds
    spent = f"{np.median(cpu):.2f} / {np.percentile(cpu, 90):.2f} / {cpu.max():.2f}"
    waited = f"{np.median(wall):.2f} / {np.percentile(wall, 90):.2f}"
    figures = f"{blocks:.0f} | {irregular:.0f} | {mean:.1f} | {p99:.1f}"
    return f"| {name} | {len(rows)} | {len(good)} | {refused} | {silent} | {spent} | {waited} | {figures} |"


def beside_line(algorithm: str, rows: dict[Path, Row], ours: dict[Path, Row]) -> str:
    """Return the line of one of Gmsh's algorithms, with ours on the same domains."""
    both = pairs(rows, ours)
    if not both:
        return f"| {algorithm} | {len(rows)} | 0 | | | | |"
    keys = ("irregular", "mean", "p99", "cpu", "cells")
    cells = [" / ".join(f"{np.median([pair[k][key] for pair in both]):.4g}" for k in (0, 1)) for key in keys]
    left = sum(pair[1].get("triangles", 0) > 0 for pair in both)
    return f"| {algorithm} | {len(rows)} | {len(both)} | {left} | {' | '.join(cells)} |"


def pairs(rows: dict[Path, Row], ours: dict[Path, Row]) -> list[tuple[Row, Row]]:
    """Return ours and theirs where both are meshes."""
    return [(ours[path], row) for path, row in rows.items() if not row["status"] and not ours[path]["status"]]


def claims(rows: dict[Path, Row], ours: dict[Path, Row]) -> list[str]:
    """Return what is claimed of algorithm 11, as it was measured."""
    both = pairs(rows, ours)
    irregular = [sum(pair[k]["irregular"] for pair in both) for k in (0, 1)]
    each = np.mean([3 * one["irregular"] <= other["irregular"] for one, other in both])
    angles = np.mean([one["p99"] < other["p99"] for one, other in both])
    factors = np.array([other["cpu"] / one["cpu"] for one, other in both])
    return [
        "",
        f"- Irregular vertices in total: meshonet {irregular[0]}, Gmsh {irregular[1]}, a ratio of "
        f"{irregular[0] / max(irregular[1], 1):.2f}. In {100 * each:.0f} % of the domains the grid of\n"
        "  meshonet has at most a third as many irregular vertices as the mesh of Gmsh.",
        f"- In {100 * angles:.0f} % of the domains, the 99th percentile of the deviation is smaller for "
        "meshonet than for Gmsh.",
        f"- Gmsh takes {np.median(factors):.1f} times the CPU time of meshonet in the median, "
        f"and at least {factors.min():.1f} times in every domain.",
    ]


HEAD = """# Multi-block grids of plane domains, compared with Gmsh

<!-- made by python benchmarks/bench_blocks.py --page docs/benchmarks/blocks.md -->

Use this page to see for how many domains `solve-pde` generates a valid multi-block grid, how good the grids
are, and how long it takes.

- *files*: domains from other sources. *gallery*: the thirty domains of the [gallery](../gallery/domains.md).
  *random*: random domains.
- Each domain is a GeoJSON file. A separate process makes each grid: `solve-pde FILE --cells 2500 -o F.vtm`,
  with one thread, while other programs used the machine. Times are those of the whole process.
- *valid*: all corner Jacobians are positive, the nodes of adjacent blocks match, wall nodes lie on the
  outline within 1e-8 of the domain size, and the relative error of the area is at most 1e-3. The benchmark
  tests this independently of meshonet.
- *refused*: exit code 2 or 3 with a message. *silent*: exit code 0, but the grid is not valid.
- *blocks*, *irregular*: number of blocks, and of interior vertices at which more or fewer than four cells
  meet. *mean*: mean deviation of cell corner angles from 90 degrees. *99 %*: for each cell the largest
  deviation of its corners, and of these values the 99th percentile. These four columns are medians over the
  valid grids. *90 %* in the columns of times: 90th percentile over the domains.
"""
VALID = """
| domains | number | valid | refused | silent | CPU s: median / 90 % / max | elapsed s: median / 90 % \
| blocks | irregular | mean | 99 % |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"""
BESIDE = """
## Gmsh at about equal numbers of cells

Gmsh meshes a sample of these domains; the column *domains* gives their number. In Gmsh, the outline between
two neighbouring corners is one spline. Gmsh uses one thread and the options for quadrilaterals only. Its time
is the time of `generate(2)`; the time of meshonet is the time of the whole process.

*algorithm*: number of Gmsh's algorithm; 11 makes quasi-structured quadrilaterals. *meshed*: number of domains
that Gmsh meshes; *with triangles*: number of these meshes that contain triangles. The other columns give
medians over these domains, meshonet / Gmsh.

| algorithm | domains | meshed | with triangles | irregular | mean | 99 % | CPU time, s | cells |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |"""

if __name__ == "__main__":
    main()
