"""Golden grids: what some hundred commands make, recorded before a change and compared after it.

    python benchmarks/goldens.py record build/before.json --domains --tree ../before
    python benchmarks/goldens.py compare build/before.json --domains
    python benchmarks/goldens.py compare build/before.json --only 'infer|quad.h5' --tolerance 1e-10

Kept of every command (`golden_commands`) are its exit code, the figures of its JSON and the nodes and files
that it wrote, the nodes themselves in FILE.npz; not kept are seconds, versions, command lines and paths.
The comparison is bitwise unless a tolerance is given: for nodes it is relative to their extent, for figures
to the larger one, or to 1 when both are smaller. Differences of messages, notes and tables are printed as
``words differ`` and are no failure. The exit code is 1 when numbers differ.

``--domains`` adds folds and angles of 500 random four-sided domains and of a folder of airfoil files: folds
have to be equal, angles to 1e-6. Only the command line of the checkout is used, none of its modules. Up to
25 commands run in one process, to save time; with ``--batch 1`` each has its own, with the same results.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import argparse
import hashlib
import json
import re
import shutil
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from golden_commands import commands
from golden_domains import SAMPLED, Figures, airfoil_names, differing, domain_lines, figures_of, summary
from golden_records import Difference, Record, differences, record_of
from golden_runs import BATCH, needed, run_all
from golden_shapes import write_inputs

ROOT = Path(__file__).resolve().parents[1]
EXAMPLE = ROOT / "examples" / "naca2412.dat"
SHOWN = 5
"""Differences of a kind that are shown of one command."""


@dataclass
class Goldens:
    """What was recorded: records by command, and figures of domains by label."""

    commands: dict[str, Record] = field(default_factory=dict)
    domains: dict[str, Figures] = field(default_factory=dict)


def main() -> int:
    """Record or compare, and return the exit code."""
    options = _options()
    if options.what == "record":
        made = Goldens(dict(_records(options, commands())), dict(_domains(options)))
        save(made, options.file)
        _tell_of_record(made)
        return 0
    return compare(load(options.file), options)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("file", type=Path, help="JSON file of the records; arrays are beside it in .npz")
    parser.add_argument("--tree", type=Path, default=ROOT, help="checkout whose program is run, compiled")
    parser.add_argument("--only", default="", metavar="REGEX", help="commands in which this is found")
    parser.add_argument("--tolerance", type=float, default=0.0, help="relative; 0 is bit for bit")
    parser.add_argument("--batch", type=int, default=BATCH, help="commands that one process runs at the most")
    parser.add_argument("--domains", action="store_true", help="random domains and airfoil files as well")
    parser.add_argument("--airfoils", type=Path, default=ROOT.parent / "shared" / "airfoils")
    options = parser.parse_args()
    options.tree = options.tree.resolve()
    return options


# --- running


def _records(options: argparse.Namespace, wanted: Iterable[str]) -> Iterator[tuple[str, Record]]:
    """Yield line and record of every wanted command that is chosen."""
    chosen = [line for line in wanted if re.search(options.only, line)]
    lines = list(dict.fromkeys([*commands(), *chosen]))
    with TemporaryDirectory(prefix="goldens-") as name:
        write_inputs(Path(name), EXAMPLE)
        for line, run in run_all(needed(lines, chosen), options.tree, Path(name), options.batch):
            if line in chosen:
                yield line, record_of(run, options.tree)


def _domains(options: argparse.Namespace) -> Iterator[tuple[str, Figures]]:
    """Yield label and figures of every chosen command over random domains and airfoils."""
    if not options.domains:
        return
    airfoils = airfoil_names(options.airfoils)
    if not airfoils:
        print(f"no airfoil files in {options.airfoils}: left out")
    lines = {label: line for label, line in domain_lines(airfoils).items() if re.search(options.only, label)}
    with TemporaryDirectory(prefix="goldens-") as name:
        for airfoil in airfoils:
            shutil.copy(options.airfoils / airfoil, name)
        runs = run_all([SAMPLED, *lines.values()], options.tree, Path(name))
        labels = {line: label for label, line in lines.items()}
        yield from ((labels[line], figures_of(run)) for line, run in runs if line in labels)


# --- comparing


def compare(before: Goldens, options: argparse.Namespace) -> int:
    """Run what was recorded, print what differs, and return the exit code."""
    begun, count = time.perf_counter(), Counter[str]()
    for line, after in _records(options, before.commands):
        gaps = list(differences(before.commands[line], after, options.tolerance))
        _print_of(line, gaps)
        kinds = {one.kind for one in gaps}
        count["commands"] += 1
        count["failed" if "failed" in kinds else "within" if "within" in kinds else "same"] += 1
        count["words"] += "words" in kinds
    wrong = _compare_domains(before.domains, dict(_domains(options)))
    for line in commands():
        if line not in before.commands and re.search(options.only, line):
            print(f"not recorded: {line}")
    print(
        f"{count['commands']} commands: {count['same']} the same bit for bit, {count['within']} within "
        f"{options.tolerance:g}, {count['words']} other words, {count['failed']} failed "
        f"({time.perf_counter() - begun:.0f} s)"
    )
    return int(count["failed"] > 0 or wrong)


def _print_of(line: str, gaps: list[Difference]) -> None:
    for kind, heading in {"failed": "FAILED", "within": "within", "words": "words differ"}.items():
        texts = [one.text for one in gaps if one.kind == kind]
        hidden = [f"and {len(texts) - SHOWN} more"] if len(texts) > SHOWN else []
        for text in [*texts[:SHOWN], *hidden]:
            print(f"{heading}: {line}: {text}", flush=True)


def _compare_domains(before: Mapping[str, Figures], after: Mapping[str, Figures]) -> bool:
    """Print what differs between grids of domains, and say whether any does."""
    wrong = False
    for label, figures in after.items():
        gaps = list(differing(before[label], figures)) if label in before else ["not recorded"]
        print(f"{summary(label, figures)}: {'DIFFERENT' if gaps else 'the same'}")
        for text in gaps:
            print(f"FAILED: {label}: {text}")
        wrong = wrong or bool(gaps)
    return wrong


def _tell_of_record(made: Goldens) -> None:
    codes = Counter(record.numbers["exit"] for record in made.commands.values())
    print(f"{len(made.commands)} commands, by exit code: {dict(sorted(codes.items(), key=str))}")
    for label, figures in made.domains.items():
        print(summary(label, figures))


# --- files


def save(made: Goldens, path: Path) -> None:
    """Write what was recorded to a JSON file, and the arrays to a .npz beside it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    commands = {line: {"numbers": one.numbers, "words": one.words} for line, one in made.commands.items()}
    path.write_text(json.dumps({"commands": commands, "domains": made.domains}, indent=0))
    arrays = {_key(line, place): a for line, one in made.commands.items() for place, a in one.arrays.items()}
    np.savez_compressed(path.with_suffix(".npz"), **arrays)


def load(path: Path) -> Goldens:
    """Return what was recorded to a file."""
    content = json.loads(path.read_text())
    made = Goldens(domains=content["domains"])
    with np.load(path.with_suffix(".npz")) as file:
        stored = set(file.files)
        for line, one in content["commands"].items():
            arrays = {p: file[_key(line, p)] for p in one["numbers"] if _key(line, p) in stored}
            made.commands[line] = Record(one["numbers"], one["words"], arrays)
    return made


def _key(line: str, place: str) -> str:
    """Return the name of an array in the .npz file."""
    return f"{hashlib.sha256(line.encode()).hexdigest()[:16]} {place.replace('/', ' ')}"


if __name__ == "__main__":
    sys.exit(main())
