"""Every command stopped at random moments: what has its final name afterwards is the old or the new, whole.

    python benchmarks/kills.py [--count 200] [--seed 0]

Each round starts one of the commands over a copy of the same folder and sends it SIGKILL, SIGINT or SIGTERM
at a random moment of its usual duration. Checked are: outputs are those from before or of a finished run,
byte for byte or node for node; inputs are as they were; nothing else lies there, but for hidden unfinished
files after SIGKILL; and these are gone once the next command has written to the folder. Prints one line of
JSON for each command; the exit code is 1 when something was not so.
"""

import argparse
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from meshonet.formats.output import PART_SUFFIX
from meshonet.formats.registry import read_grids, read_shapes

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "Agg"}
COMMANDS = {
    "infer": ("infer naca:2412 --res 500 -o out.vts", "out.vts"),
    "infer, marched": ("infer naca:0012 --wall-spacing 1e-5 --res 300x80 -o out.cgns", "out.cgns"),
    "tfi": ("tfi naca:2412 --res 600 -o out.p3d", "out.p3d"),
    "solve-pde": ("solve-pde naca:2412 --res 300 -o out.vtk", "out.vtk"),
    "sample-boundary": ("sample-boundary naca:2412 a.vts b.vts --res 300x100 -o 'out-{index}.h5'", "out-"),
    "a batch into one": ("tfi a.vts a.vts a.vts a.vts --res 200 -o out.h5", "out.h5"),
    "a batch, a file each": ("tfi a.vts a.vts a.vts --res 200 -o 'out-{index}.bin'", "out-"),
    "two processes": ("solve-pde a.vts b.vts a.vts b.vts --jobs 2 --res 150 -o 'out-{index}.vts'", "out-"),
    "quality": ("quality a.vts --per-cell out.vts", "out.vts"),
    "convert to itself": ("convert a.vts a.vts", "a.vts"),
    "convert to SU2": ("convert a.vts out.su2", "out.su2"),
    "convert to Gmsh": ("convert a.vts out.msh", "out.msh"),
    "convert to OpenFOAM": ("convert a.vts case/case.foam", "case"),
    "convert to blocks": ("convert a.vts b.vts out.vtm", "out"),
    "convert to HDF5": ("convert a.vts out.h5", "out.h5"),
    "plot": ("plot a.vts -o out.png", "out.png"),
    "train": ("train strips.h5 -o out.safetensors --epochs 2 --batch 4 --held-out 4", "out."),
    "models": ("models --json", "none"),
}
"""Words of each command, and what the names of its outputs begin with."""


def start(words: str, folder: Path) -> subprocess.Popen[bytes]:
    """Start a command in `folder`."""
    line = [word.strip("'") for word in words.split()]
    return subprocess.Popen(
        [sys.executable, "-m", "meshonet_cli", *line], cwd=folder, env=ENVIRONMENT,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip


def _digest(path: Path) -> str:
    data = path.read_bytes()
    if path.suffix in (".h5", ".vts", ".cgns", ".vtk") and PART_SUFFIX not in path.name:
        # provenance holds seconds, which differ from run to run: the nodes are what counts
        held = [item.nodes.tobytes() for item in read_grids(str(path))] if _has_grids(path) else [
            shape.south.tobytes() + shape.north.tobytes() for shape in read_shapes(str(path))  # type: ignore[union-attr]
        ]  # fmt: skip
        data = b"".join(held)
    return hashlib.sha256(data).hexdigest()[:16]


def _has_grids(path: Path) -> bool:
    return not (path.suffix == ".h5" and (path.name.startswith(("out-", "strips"))))


def prepared(folder: Path) -> None:
    """Make the inputs."""
    for words in (
        "infer naca:0012 --res 300x200 -o a.vts", "infer naca:23012 --res 200 -o b.vts",
        "sample-boundary --family procedural --count 12 --seed 3 --res 129x5 -o strips.h5 -q",
    ):  # fmt: skip
        process = start(words, folder)
        _, report = process.communicate()
        assert process.returncode == 0, report


class Victim:
    """One command: its folder before, after a finished run, and how long that takes.

    Parameters
    ----------
    name, words, output : of `COMMANDS`.
    inputs : folder of the inputs.
    scratch : folder to work in.
    """

    def __init__(self, name: str, words: str, output: str, inputs: Path, scratch: Path) -> None:
        self.name, self.words, self.output = name, words, output
        self.before, self.scratch = scratch / "before", scratch
        shutil.copytree(inputs, self.before)
        done = scratch / "done"
        shutil.copytree(inputs, done)
        begun = time.monotonic()
        process = start(words, done)
        _, report = process.communicate()
        self.seconds = time.monotonic() - begun
        assert process.returncode == 0, (name, report)
        self.new, self.counts, self.wrong = _state(done), Counter[str](), list[str]()
        for path in done.rglob("*"):  # every other round starts over outputs of an earlier run
            if path.is_file() and str(path.relative_to(done)) not in _state(self.before):
                path.write_bytes(b"earlier")
        self.over = done

    def attack(self, random: Random) -> None:
        """Run the command, stop it somewhere, and look."""
        folder = self.scratch / "round"
        shutil.copytree(random.choice((self.before, self.over)), folder)
        old = _state(folder)
        number = random.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGINT, signal.SIGTERM))
        process = start(self.words, folder)
        time.sleep(random.uniform(0.0, 1.1) * self.seconds)
        stopped = process.poll() is None
        if stopped:
            target = os.killpg if number == signal.SIGKILL else os.kill
            target(process.pid, number)
        _, report = process.communicate()
        self.counts[signal.Signals(number).name if stopped else "finished first"] += 1
        self._look(
            folder, old, number if stopped else None, process.returncode, report.decode("utf-8", "replace")
        )
        shutil.rmtree(folder)

    def _look(self, folder: Path, old: dict[str, str], number: int | None, code: int, message: str) -> None:
        unfinished = list(folder.rglob(f".*{PART_SUFFIX}"))
        for path in unfinished:
            if number != signal.SIGKILL:
                self.wrong.append(f"{path.name} left after {number}")
        now = {name: digest for name, digest in _state(folder).items() if PART_SUFFIX not in name}
        for name, digest in now.items():
            allowed = {old.get(name), self.new.get(name) if name.startswith(self.output) else old.get(name)}
            if digest not in allowed and not self._resumable(name):
                self.wrong.append(f"{name} is neither old nor new after {number}")
        self.wrong += [f"{name} is lost after {number}" for name in old if name not in now]
        if (
            "meshonet_cli" in message and "Traceback" in message
        ):  # Python's own start shows one, which is not ours
            self.wrong.append(f"traceback after {number}: {message[-300:]}")
        if number in (signal.SIGINT, signal.SIGTERM) and code not in (0, 130, 143, -number):
            self.wrong.append(f"exit {code} after {number}: {message[-200:]}")
        if unfinished:
            self.counts["left unfinished files"] += 1
            for place in {path.parent for path in unfinished}:
                process = start(f"convert {folder / 'b.vts'} {place / 'next.vts'}", folder)
                process.communicate()
            if list(folder.rglob(f".*{PART_SUFFIX}")):
                self.wrong.append("unfinished files stay after the next run")

    def _resumable(self, name: str) -> bool:
        """Say whether this is a checkpoint, of whatever epoch; going on from it is tested elsewhere."""
        return "checkpoint" in name


def _state(folder: Path) -> dict[str, str]:
    """Return a digest of each file: of the nodes where it holds some, else of its bytes."""
    digests = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file():
            try:
                digests[str(path.relative_to(folder))] = _digest(path)
            except Exception:  # not readable: the placeholder, or neither old nor new
                digests[str(path.relative_to(folder))] = hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    return digests


def main() -> None:
    """Attack the commands in turn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    random = Random(given.seed)  # noqa: S311  (no secret)
    with TemporaryDirectory() as scratch:
        inputs = Path(scratch) / "inputs"
        inputs.mkdir()
        prepared(inputs)
        victims = []
        for k, (name, (words, output)) in enumerate(COMMANDS.items()):
            (Path(scratch) / str(k)).mkdir()
            victims.append(Victim(name, words, output, inputs, Path(scratch) / str(k)))
        for k in range(given.count):
            victims[k % len(victims)].attack(random)
        for victim in victims:
            reports = {"command": victim.name, "seconds": round(victim.seconds, 2), **victim.counts}
            print(json.dumps({**reports, "wrong": victim.wrong}), flush=True)
        total = sum((victim.counts for victim in victims), Counter[str]())
        print(json.dumps({"total": given.count, **total, "wrong": sum(len(v.wrong) for v in victims)}))
        sys.exit(int(any(victim.wrong for victim in victims)))


if __name__ == "__main__":
    main()
