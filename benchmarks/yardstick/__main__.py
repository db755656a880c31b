"""The comparison, from shapes to the table.

    python benchmarks/yardstick shapes FOLDER [--count 20] [--seed 1] [--plot3d]
    python benchmarks/yardstick run FOLDER NAME 'PROGRAM {boundaries} {grids}' [--kinds wavy,duct]
    python benchmarks/yardstick judge FOLDER
    python benchmarks/yardstick entries FOLDER [--page docs/benchmarks/yardstick.md]

`shapes` writes a file of boundaries for each kind of shape. `run` calls a program once for each, with the
paths of boundaries and of the grids to write, and records its processor time. Grids may also be put into
FOLDER/NAME by hand. `judge` measures all grids; `entries` runs the programs of this repository and Gmsh's.
"""

import argparse
import json
import resource
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from page import publish

from yardstick.files import read_boundaries, read_grids, write_boundaries
from yardstick.judge import summary
from yardstick.networks import OPERATORS, PHYSICS, trained
from yardstick.shapes import BODIES, KINDS, shapes
from yardstick.words import COLUMNS, HEAD, NETWORKS, TAIL

NODES = {"quad": (65, 65), "o": (65, 33)}
HERE = Path(__file__).parent
PYTHON = shlex.quote(sys.executable)
_OURS = {
    name: f"{PYTHON} -m meshonet_cli {name} {{boundaries}} -o {{grids}} -q --allow-invalid"
    for name in (
        "tfi", "solve-pde --method winslow --no-repair", "solve-pde --method variational", "infer",
        "infer --model quad-general", "infer --model quad-winslow", "infer --model hole-o",
        "infer --model airfoil-o",
    )
}  # fmt: skip
_GMSH = f"{PYTHON} {shlex.quote(str(HERE / 'gmsh_transfinite.py'))} {{boundaries}} {{grids}}"
ENTRIES = {f"meshonet {name}": words for name, words in _OURS.items()} | {
    "Gmsh transfinite": _GMSH,
    "Gmsh transfinite, 50 smoothing steps": f"{_GMSH} 50",
}
"""The first entries: what is called for each kind of shape."""
_ASKED = f"{PYTHON} -m meshonet_cli infer {{boundaries}} -o {{grids}} -q --model"
ONLY = {"quad-general": "quad", "quad-winslow": "quad", "hole-o": "o", "airfoil-o": "o"}
"""Topology of the networks."""


def main() -> None:
    """Run one of the four commands."""
    parser = argparse.ArgumentParser(prog="yardstick", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("command", choices=("shapes", "run", "judge", "entries"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("name", nargs="?", help="of the entry to run")
    parser.add_argument("program", nargs="?", help="with {boundaries} and {grids}")
    parser.add_argument("--count", type=int, default=20, help="shapes of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plot3d", action="store_true", help="folders of Plot3D files in place of .h5 files")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    folder: Path = options.folder
    if options.command == "shapes":
        draw(folder, options.seed, options.count, plot3d=options.plot3d)
    elif options.command == "run":
        if not options.program:
            parser.error("run needs a name and a program")
        run(folder, options.name, options.program, options.kinds.split(","), plot3d=options.plot3d)
    else:
        if options.command == "entries":
            draw(folder, options.seed, options.count)
            for name, program, kinds in entries(folder):
                print(f"{name}: {', '.join(kinds)}", file=sys.stderr)
                run(folder, name, program, kinds)
        rows = list(judged(folder))
        text = "\n".join(rows)
        if options.page:
            head = HEAD.format(count=options.count, seed=options.seed)
            trained_here = [row for row in rows if "| meshonet train " in row]
            others = [row for row in rows if row not in trained_here]
            text = "\n".join([head + COLUMNS, *others, NETWORKS + COLUMNS, *trained_here, TAIL])
        publish(text, options.page)


def entries(folder: Path) -> Iterator[tuple[str, str, list[str]]]:
    """Yield name, program and kinds of shapes of the entries of this repository and of Gmsh.

    Networks are trained before their turn, and kept in `folder`.
    """
    for name, program in ENTRIES.items():
        topology = ONLY.get(name.rpartition(" ")[2])
        yield name, program, [kind for kind in KINDS if topology in (None, _topology(kind))]
    for model in OPERATORS:
        for topology in NODES:
            network = shlex.quote(str(trained(folder / "trained", topology, model)))
            program = f"{_ASKED} {network} --answer pasted --allow-invalid"
            yield f"meshonet train --model {model}", program, [k for k in KINDS if _topology(k) == topology]
    for model in PHYSICS:
        program = f"{PYTHON} {shlex.quote(str(HERE / 'networks.py'))} {{boundaries}} {{grids}} {model}"
        yield f"meshonet train --model {model}", program, list(KINDS)


def draw(folder: Path, seed: int, count: int, *, plot3d: bool = False) -> None:
    """Write the boundaries of every kind: .h5 files always, which the judge reads; Plot3D beside them."""
    folder.mkdir(parents=True, exist_ok=True)
    for kind in KINDS:
        drawn = list(shapes(kind, seed, count, *NODES[_topology(kind)]))
        write_boundaries(folder / f"{kind}.h5", drawn)
        if plot3d:
            write_boundaries(folder / kind, drawn)


def run(folder: Path, name: str, program: str, kinds: list[str], *, plot3d: bool = False) -> None:
    """Call a program for each kind; its grids and seconds are in the folder of its name."""
    own = folder / _file_name(name)
    own.mkdir(exist_ok=True)
    (own / "name").write_text(name, encoding="utf-8")
    for kind in kinds:
        ending = "" if plot3d else ".h5"
        words = program.replace("{boundaries}", str(folder / f"{kind}{ending}"))
        before = _seconds()
        words = words.replace("{grids}", str(own / f"{kind}{ending}"))
        done = subprocess.run(shlex.split(words), check=False, capture_output=True, text=True)
        spent = _seconds() - before
        (own / f"{kind}.json").write_text(json.dumps({"seconds": spent, "code": done.returncode}))
        if not (own / f"{kind}{ending}").exists():
            print(f"{name}, {kind}: no grids; {done.stderr.strip()[-200:]}", file=sys.stderr)


def judged(folder: Path) -> Iterator[str]:
    """Yield the rows of the table: every entry on four-sided domains, then on bodies."""
    for topology, what in (("quad", "four-sided"), ("o", "body")):
        kinds = [kind for kind in KINDS if _topology(kind) == topology]
        for own in sorted(path for path in folder.iterdir() if (path / "name").exists()):
            row = _row(folder, own, kinds)
            if row:
                yield f"| {what} | {row} |"


def _row(folder: Path, own: Path, kinds: list[str]) -> str:
    """Return the cells of an entry's row over several kinds; nothing without any grid."""
    drawn, grids, seconds = [], {}, 0.0
    for kind in kinds:
        drawn += read_boundaries(folder / f"{kind}.h5")
        result = next((path for path in (own / f"{kind}.h5", own / kind) if path.exists()), None)
        grids |= read_grids(result) if result else {}
        record = own / f"{kind}.json"
        seconds += json.loads(record.read_text())["seconds"] if record.exists() else 0.0
    report = summary(drawn, grids)
    if "largest" not in report:
        return ""
    made = report["shapes"] - report["missing"]
    return " | ".join([
        (own / "name").read_text(encoding="utf-8"), f"{made} of {report['shapes']}",
        f"{report['folded_grids']} ({report['folded_cells']})",
        f"{report['largest_mean']:.1f} / {report['largest']:.1f}",
        f"{report['smallest']:.1f}", f"{report['skew']:.1f}", f"{report['boundary']:.0e}",
        f"{1e3 * seconds / made:.0f}" if seconds else "-",
    ])  # fmt: skip


def _topology(kind: str) -> str:
    return "o" if kind in BODIES else "quad"


def _file_name(name: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in name)


def _seconds() -> float:
    """Return the processor seconds of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
