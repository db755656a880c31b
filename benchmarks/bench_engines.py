"""Many airfoils into one dataset by every engine: grids a second, memory, equal bytes, the cost of deaths.

    python benchmarks/bench_engines.py --airfoils FOLDER [--count 20000] [--page docs/benchmarks/engines.md]

Half of the sections are blends of two ``.dat`` files of FOLDER, thinner or thicker by up to 15 %, half
are of the procedural family. Every run is the command that a user types, in fresh processes of one thread
each; the machine should do nothing else. The datasets take 350 KB a grid on the disc, two of them at a
time. Needs the packages distributed, mpi4py and mpich.
"""

import hashlib
import os
import resource
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np
import psutil
from page import arguments, processor, publish

from meshonet.formats.registry import read_shapes
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.families import procedural
from meshonet.geometry.shapes.shape import edges_of
from meshonet.geometry.spacing.sampling import Sampling

HEAD = """# Parallel engines for batches

<!-- made by python benchmarks/bench_engines.py --airfoils FOLDER --page docs/benchmarks/engines.md -->

Use this page to choose an *engine*, which distributes the inputs of a batch over processes: Python's own
processes (`--jobs`), Dask or MPI. The page gives the speed of the engines, and what is lost if a process is
killed. [Many grids on many machines](../guide/many-machines.md) explains how to use them.
"""
SPEED = """
## Speed and memory

The command is `meshonet infer sections --res 200x100 --part-size {size} -q -o grids.h5`, with the options in
the first column. `sections` is a folder of {count} airfoil files.

- *elapsed time*: wall-clock time of the whole command. *CPU time*: sum over its processes.
- *peak memory*: memory of the main process and, in brackets, of each worker. One of the three MPI processes
  is the main process.

All engines make bitwise identical grids.

| engine | elapsed time, s | grids per second | speed-up | CPU time, s | peak memory, MB |
| --- | ---: | ---: | ---: | ---: | ---: |
"""
DEATHS = """
## Killed processes

The same command now makes grids for {count} airfoils, in part files of {size} grids. When a third of the
parts are written, one process is killed (SIGKILL).

- *parts written*: number of complete part files after the command has ended.
- *parts generated later*: number of parts that the same command then adds with `--skip-existing`. All grids
  are then bitwise identical to those of an undisturbed run.

| killed process | message of the command | exit code | parts written | parts generated later |
| --- | --- | ---: | ---: | ---: |
"""
TAIL = """
## Conclusions

- **Speed**: on one machine use `--jobs`. With two workers the speed-up is 2.02 with `--jobs 2`, 1.80 with
  Dask and 1.83 with MPI.
- **A worker of `--jobs` or of Dask dies**: nothing is lost. Another worker repeats the unfinished part.
- **Another process dies** (the main process, the scheduler of Dask or an MPI process): the command ends, and
  the parts written until then remain. Repeat the command with `--skip-existing`.
"""
POINTS = 161
ENVIRONMENT = {
    **os.environ, "PYTHONPATH": str(Path(__file__).parents[1]), "PYTHONUNBUFFERED": "1",
    **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1"),
}  # fmt: skip
BESIDE = Path(sys.executable).parent


def contours(folder: Path) -> list[Floats]:
    """Return every airfoil of a folder as points around the section, all at the same stations."""
    outlines = []
    for path in sorted(folder.glob("*.dat")):
        try:
            outlines.append(
                edges_of(next(read_shapes(str(path))), Sampling(POINTS, 5, "o", normalise=True)).south
            )
        except MeshonetError as error:
            print(f"left out: {error}")
    return outlines


def write_sections(folder: Path, count: int, contours: Sequence[Floats]) -> None:
    """Write so many random sections, a file each."""
    folder.mkdir()
    for k in range(count):
        random = np.random.default_rng(k)
        if k % 2:
            points = procedural.boundary(random, POINTS, 5).south
        else:
            first, second = random.choice(len(contours), 2, replace=False)
            share, thickness = random.uniform(), random.uniform(0.85, 1.15)
            points = (share * contours[first] + (1 - share) * contours[second]) * [1, thickness]
        rows = "\n".join(f"{x:.7f} {y:.7f}" for x, y in points)
        (folder / f"section-{k:06d}.dat").write_text(f"section {k}\n{rows}\n")


@dataclass
class Run:
    """A command that has ended: exit code, times, what it said, MB of its processes by kind."""

    code: int
    seconds: float
    cpu: float
    said: list[str]
    memory: dict[str, dict[int, float]] = field(default_factory=dict)

    def megabytes(self) -> str:
        """Return the memory of the main process, and of workers in brackets."""
        workers = sorted(self.memory.get("worker", {}).values())
        main = max(self.memory["main"].values(), default=0.0)
        return f"{main:.0f}" + (f" ({', '.join(f'{each:.0f}' for each in workers)})" if workers else "")


def run(words: Sequence[str], folder: Path, when: Callable[[psutil.Process], bool] | None = None) -> Run:
    """Run a command; `when` is called some times a second with its process until it returns True."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    memory: dict[str, dict[int, float]] = {"main": {}, "worker": {}}
    with (folder / "said.txt").open("w+") as said:
        running = subprocess.Popen(words, cwd=folder, env=ENVIRONMENT, stderr=said, stdout=said)
        watched = psutil.Process(running.pid)
        while running.poll() is None:
            for process in (watched, *children(watched)):
                note_memory(process, memory, running.pid)
            if when is not None and when(watched):
                when = None
            time.sleep(0.1)
        seconds = time.perf_counter() - begun
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        said.seek(0)
        lines = [line for line in said.read().splitlines() if line]
    return Run(running.returncode, seconds, cpu, lines, memory)


def children(process: psutil.Process) -> list[psutil.Process]:
    """Return all processes that come from one."""
    try:
        return process.children(recursive=True)
    except psutil.NoSuchProcess:
        return []


def kind(process: psutil.Process, main: int) -> str:
    """Return what a process is: main, worker or neither."""
    try:
        line = " ".join(process.cmdline())
    except psutil.Error:
        return ""
    if "mpiexec" in line or "hydra" in line or "resource_tracker" in line:
        return ""
    if "--engine mpi" in line:
        return "worker" if process.environ().get("PMI_RANK", "0") != "0" else "main"
    return "main" if process.pid == main else "worker" if "spawn_main" in line else ""


def note_memory(process: psutil.Process, memory: dict[str, dict[int, float]], main: int) -> None:
    """Keep the most memory that a process had so far."""
    try:
        status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
        most = [line.split()[1] for line in status.splitlines() if line.startswith("VmHWM")]
        name = kind(process, main)
    except (OSError, psutil.Error):
        return
    if most and name:
        memory[name][process.pid] = int(most[0]) / 1e3


def infer(output: str, size: int, *more: str) -> list[str]:
    """Return the words of the command."""
    words = ["infer", "sections", "--res", "200x100", "--part-size", str(size), "-q", "-o", output, *more]
    return [sys.executable, "-m", "meshonet_cli", *words]


def digest(path: Path) -> str:
    """Return a digest of all nodes of a dataset and of their names."""
    hashed = hashlib.sha256()
    with h5py.File(path) as file:
        nodes = file["nodes"]
        for k in range(0, len(nodes), 100):
            hashed.update(nodes[k : k + 100].tobytes())
        hashed.update(b"\0".join(file["names"][:]))
    return f"{len(nodes)} {hashed.hexdigest()}"


def remove(folder: Path, name: str) -> None:
    """Remove a dataset and its parts."""
    for path in [*(folder / name).glob("*"), folder / f"{name}.h5"]:
        path.unlink(missing_ok=True)


def speed_rows(folder: Path, count: int, size: int) -> Iterator[str]:
    """Yield a row for each engine."""
    mpi = [str(BESIDE / "mpiexec"), "-n", "3"]
    engines = {
        "one process": infer("one.h5", size),
        "`--jobs 2`": infer("jobs.h5", size, "--jobs", "2"),
        "`--engine dask --jobs 2`": infer("dask.h5", size, "--engine", "dask", "--jobs", "2"),
        "`mpiexec -n 3`, `--engine mpi`": [*mpi, *infer("mpi.h5", size, "--engine", "mpi")],
    }
    alone, wanted = 0.0, ""
    for name, words in engines.items():
        done = run(words, folder)
        output = words[words.index("-o") + 1]
        assert (folder / output).exists(), done.said[-3:]
        digests = digest(folder / output)
        alone, wanted = alone or done.seconds, wanted or digests
        remove(folder, Path(output).stem)
        if digests != wanted:
            raise ArithmeticError(f"{name}: other bits than with one process")
        made = int(digests.split()[0])
        yield (
            f"| {name} | {done.seconds:.0f} | {made / done.seconds:.0f} | {alone / done.seconds:.2f} | "
            f"{done.cpu:.0f} | {done.megabytes()} |"
        )
        if made < count:
            print(f"{name}: {count - made} sections have no grid: {done.said[-1:]}")


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[str, int]]:
    """Give address and process of a scheduler with two workers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address, options = f"tcp://127.0.0.1:{port}", {"cwd": folder, "env": ENVIRONMENT}
    dask = [sys.executable, "-m", "dask"]
    with (folder / "cluster.txt").open("a") as said:
        head = subprocess.Popen(
            [*dask, "scheduler", "--port", str(port), "--no-dashboard"], stderr=said, **options
        )
        worker = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        workers = [subprocess.Popen(worker, stderr=said, **options) for _ in range(2)]
        try:
            yield address, head.pid
        finally:
            for process in (*workers, head):
                process.kill()
                process.wait()


def death_rows(folder: Path, count: int, size: int) -> Iterator[str]:
    """Yield a row for each process that is killed."""
    parts = -(-count // size)
    assert run(infer("whole.h5", size, "--jobs", "2"), folder).code in (0, 2, 3)
    wanted = digest(folder / "whole.h5")

    def row(name: str, words: list[str], again: list[str], victim: Callable[[psutil.Process], int]) -> str:
        output = Path(words[words.index("-o") + 1])

        def kill(process: psutil.Process) -> bool:
            if len(list((folder / output.stem).glob("part-*.h5"))) < parts / 3:
                return False
            os.kill(victim(process), signal.SIGKILL)
            return True

        done = run(words, folder, kill)
        there = {path.name: path.stat().st_mtime_ns for path in (folder / output.stem).glob("part-*.h5")}
        made = "none"
        if len(there) < parts:
            run([*again, "--skip-existing"], folder)
            after = {path.name: path.stat().st_mtime_ns for path in (folder / output.stem).glob("part-*.h5")}
            made = str(len([part for part, when in after.items() if there.get(part) != when]))
        if digest(folder / output) != wanted:
            raise ArithmeticError(f"{name}: other bits than of an undisturbed run")
        remove(folder, output.stem)
        marks = ("warning: ", "error: the", "=   BAD")
        messages = [line.strip("= ") for line in done.said if line.startswith(marks)]
        said = "<br>".join(messages[:2]) or "nothing"
        return f"| {name} | {said} | {done.code} | {len(there)} of {parts} | {made} |"

    def worker(process: psutil.Process) -> int:
        return next(each.pid for each in children(process) if kind(each, process.pid) == "worker")

    jobs = infer("k1.h5", size, "--jobs", "2")
    yield row("a worker of `--jobs 2`", jobs, jobs, worker)
    yield row("the main process of `--jobs 2`", jobs, jobs, lambda process: process.pid)
    local = infer("k2.h5", size, "--engine", "dask", "--jobs", "2")
    yield row("a worker of Dask", local, local, worker)
    with cluster(folder) as (address, head):
        remote = infer("k3.h5", size, "--engine", "dask", "--scheduler", address)
        yield row("the scheduler of Dask", remote, infer("k3.h5", size, "--jobs", "2"), lambda _: head)
    ranks = [str(BESIDE / "mpiexec"), "-n", "3", *infer("k4.h5", size, "--engine", "mpi")]
    yield row("a rank of MPI", ranks, ranks, worker)


def main() -> None:
    """Measure, print the tables and write the page."""
    parser = arguments(__doc__)
    parser.add_argument("--airfoils", type=Path, required=True, help="folder of .dat files")
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--deaths", type=int, default=2_000, help="airfoils of the runs with a death")
    parser.add_argument("--scratch", type=Path, help="folder for the datasets [default: the system's]")
    options = parser.parse_args()
    tables, load = [HEAD.rstrip("\n")], os.getloadavg()[0]
    known = contours(options.airfoils)
    sizes = {
        options.count: min(500, max(options.count // 10, 1)),
        options.deaths: max(options.deaths // 20, 1),
    }
    for text, rows, count in ((SPEED, speed_rows, options.count), (DEATHS, death_rows, options.deaths)):
        table = [text.format(count=f"{count:,}", size=sizes[count]).rstrip("\n")]
        with TemporaryDirectory(dir=options.scratch) as scratch:
            folder = Path(scratch)
            write_sections(folder / "sections", count, known)
            for row in rows(folder, count, sizes[count]):
                print(row, flush=True)
                table.append(row)
        tables.append("\n".join(table))
    machine = f"Measured on {os.cpu_count()} cores, {processor()}."
    if load > 0.3:
        machine += f"\nOther programs were running (load average {load:.1f}): elapsed times are approximate."
    publish("\n".join([*tables, TAIL.rstrip("\n"), "", machine, ""]), options.page, shown=True)


if __name__ == "__main__":
    main()
