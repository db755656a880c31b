"""Runs the golden commands of a checkout in batches and hands out what each of them left.

    for line, run in run_all(["tfi duct.csv --json"], tree, folder): ...

One process runs up to `BATCH` commands, since starting the program takes longer than most grids. A process
that dies leaves its command with the exit code of the signal, and the next process goes on behind it.
"""

import json
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

BATCH = 25
TIMEOUT_S = 600
"""Longest time for a command on this processor."""
TIMED_OUT = "timeout"
"""Exit code of a command that took longer."""
WITHOUT_OUTPUT = {"quality", "models"}
WORKER = Path(__file__).with_name("golden_worker.py")


@dataclass(frozen=True)
class Job:
    """A command: its line, its words, the file on its standard input, and the name of its output, if any."""

    line: str
    words: list[str]
    input: str | None
    name: str | None


@dataclass(frozen=True)
class Run:
    """What a command left: an exit code, and `out`, `stdout` and `stderr` in a folder."""

    exit: int | str
    folder: Path

    def files(self) -> Iterator[tuple[str, Path]]:
        """Yield name and path of every output file."""
        for path in sorted((self.folder / "out").rglob("*")):
            if path.is_file():
                yield str(path.relative_to(self.folder)), path

    def stream(self, name: str) -> bytes:
        """Return what was written to ``stdout`` or ``stderr``."""
        path = self.folder / name
        return path.read_bytes() if path.exists() else b""


def parse(line: str) -> Job:
    """Return the job of a line of `golden_commands`.

    Examples
    --------
    >>> parse("tfi duct.csv -> .vts").words
    ['tfi', 'duct.csv', '-o', 'out/grid.vts']
    """
    text, _, output = (part.strip() for part in line.partition("->"))
    standard_input = re.search(r"< (\S+)", text)
    words = shlex.split(re.sub(r"< \S+", "", text))
    target, *options = output.split() or [".h5"]
    name = None
    if target.startswith(".") and "/" not in target:
        target = f"out/grid{target}"
    elif target not in ("-", "no"):
        name, target = target, f"out/{target}"
    if target != "no" and words[0] not in WITHOUT_OUTPUT:
        words += ["-o", target, *options]
    return Job(line, words, standard_input[1] if standard_input else None, name)


def needed(lines: Sequence[str], chosen: Sequence[str]) -> list[str]:
    """Return the lines that `chosen` ones need: themselves and those whose outputs they read."""
    wanted = set(chosen)
    for line in reversed(lines):
        name = parse(line).name
        if name and any(re.search(rf"made/{re.escape(name)}\b", other) for other in wanted):
            wanted.add(line)
    return [line for line in lines if line in wanted]


@dataclass(frozen=True)
class Machine:
    """What commands are run on: words in front of Python, of an emulator, and settings of the environment."""

    before: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)
    cores: int = 0
    """How many cores commands may use; 0: all."""
    slower: int = 1
    """How many times longer than on this processor commands may take."""


def run_all(
    lines: Sequence[str], tree: Path, folder: Path, batch: int = BATCH, machine: Machine = Machine()
) -> Iterator[tuple[str, Run]]:
    """Yield every line with what its command left, run in `folder`, which holds the inputs."""
    jobs = [parse(line) for line in lines]
    for start in range(0, len(jobs), batch):
        here = range(start, min(start + batch, len(jobs)))
        folders = [folder / f"runs/{k:03d}" for k in here]
        _run_batch([jobs[k] for k in here], folders, tree, folder, machine)
        yield from ((lines[k], _run(folder / f"runs/{k:03d}")) for k in here)


def _run_batch(jobs: list[Job], folders: list[Path], tree: Path, folder: Path, machine: Machine) -> None:
    """Run jobs in one process, or in more where it dies."""
    while jobs:
        code = _run_worker(jobs, folders, tree, folder, machine)
        done = sum((path / "exit").exists() for path in folders)
        if done < len(jobs) and not folders[done].exists():
            raise SystemExit(f"the worker did not start (exit code {code})")
        if done < len(jobs):
            (folders[done] / "exit").write_text(str(code))
        jobs, folders = jobs[done + 1 :], folders[done + 1 :]


def _run_worker(
    jobs: list[Job], folders: list[Path], tree: Path, folder: Path, machine: Machine
) -> int | str:
    listed = [
        {"words": job.words, "input": job.input, "name": job.name, "folder": str(path)}
        for job, path in zip(jobs, folders, strict=True)
    ]
    (folder / "jobs.json").write_text(json.dumps(listed))
    command = [*machine.before, sys.executable, "-P", str(WORKER), str(tree), "jobs.json"]
    cores = sorted(os.sched_getaffinity(0))[: machine.cores or None]
    environment = {**_environment(tree), **machine.settings}
    process = subprocess.Popen(
        command, cwd=folder, env=environment, preexec_fn=lambda: os.sched_setaffinity(0, cores)
    )
    done = -1
    while True:
        try:
            return process.wait(TIMEOUT_S * machine.slower)
        except subprocess.TimeoutExpired:
            before, done = done, sum((path / "exit").exists() for path in folders)
            if done == before:  # all this time for one command
                process.kill()
                process.wait()
                return TIMED_OUT


def _environment(tree: Path) -> dict[str, str]:
    """Return the environment of a user's session: one thread, and no compiled files left in the tree."""
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    own = {"PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "100", "TERM": "dumb"}
    return {**os.environ, **threads, **own}


def _run(folder: Path) -> Run:
    code = (folder / "exit").read_text()
    return Run(int(code) if code.lstrip("-").isdigit() else code, folder)
