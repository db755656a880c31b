"""Members of a batch on the workers of an engine: order, failures, deaths, interrupts; the same nodes."""

import importlib.util
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from command_line import ROOT, Meshonet
from engine_tasks import deadly, deadly_once, double

from meshonet.formats.output import PART_SUFFIX
from meshonet.formats.registry import read_grids
from meshonet_cli.batch.executors.workers import WorkerDiedError
from meshonet_cli.batch.settings import Engine

DASK = importlib.util.find_spec("distributed") is not None
BESIDE = Path(sys.executable).parent
MPIEXEC = shutil.which("mpiexec", path=f"{BESIDE}{os.pathsep}{os.environ.get('PATH', '')}")
MPI = importlib.util.find_spec("mpi4py") is not None and MPIEXEC
needs_dask = pytest.mark.skipif(not DASK, reason="needs distributed")
needs_mpi = pytest.mark.skipif(not MPI, reason="needs mpi4py and mpiexec")
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
FAMILY = "sample-boundary --family arch --count 60 --seed 1 --res 101 -o arches.h5"
SLOW = "solve-pde arches.h5 --tol 1e-9 -o {index}.h5"


def program(*words: object) -> list[str]:
    return [sys.executable, "-m", "meshonet_cli", *map(str, words)]


def nodes(path: str) -> list[bytes]:
    return [grid.nodes.tobytes() for grid in read_grids(path)]


def no_warning(text: str) -> None:
    raise AssertionError(text)


def test_results_come_in_order_and_errors_with_their_tasks() -> None:
    taken = []

    def tasks() -> Iterator[int]:
        for k in range(9):
            taken.append(k)
            yield k

    with Engine(jobs=2).workers(no_warning) as workers:
        for k, (task, outcome) in enumerate(workers.in_order(double, tasks(), ahead=1)):
            assert task == k
            assert isinstance(outcome, ValueError) if k == 3 else outcome == 2 * k
            assert len(taken) <= k + 3  # two under way and one ahead


def test_what_a_dead_worker_had_is_done_again(tmp_path: Path) -> None:
    said: list[str] = []
    tasks = [(k, str(tmp_path / "mark")) for k in range(6)]
    with Engine(jobs=2).workers(said.append) as workers:
        assert [outcome for _, outcome in workers.in_order(deadly_once, tasks, 1)] == list(range(6))
    assert said == ["a worker process died; what was under way is done again"]


def test_a_task_that_kills_twice_fails_alone() -> None:
    with Engine(jobs=2).workers(lambda _: None) as workers:
        outcomes = [outcome for _, outcome in workers.in_order(deadly, range(5), 1)]
    assert isinstance(outcomes.pop(2), WorkerDiedError)
    assert outcomes == [0, 1, 3, 4]


@needs_dask
def test_a_result_that_died_with_its_worker_is_made_again(tmp_path: Path) -> None:
    code = (
        "import asyncio\n"
        "from concurrent.futures import Future\n"
        "from distributed.cfexecutor import _cascade_future\n"
        "from engine_tasks import double\n"
        "from meshonet_cli.batch.settings import Engine\n"
        "class Lost:\n"
        "    status = 'pending'\n"  # it was 'finished' when its result was asked for
        "    async def _result(self, raiseit): return 4\n"
        "async def hand_on(future): await _cascade_future(Lost(), future)\n"
        "if __name__ == '__main__':\n"
        "    with Engine('dask', 1).workers(print) as workers:\n"
        "        future = Future()\n"
        "        asyncio.run(hand_on(future))\n"
        "        workers._tasks[future] = double, 2\n"
        "        print(repr(future.exception())[:9], workers.result(future))\n"
    )
    (tmp_path / "run.py").write_text(code)
    environment = ENVIRONMENT | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(Path(__file__).parent)])}
    done = subprocess.run(
        [sys.executable, "run.py"], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert done.stdout == "TypeError 4\n"


@needs_dask
def test_a_cluster_of_its_own_survives_its_workers(tmp_path: Path) -> None:
    """In a process of its own: what Dask loads and logs is kept from other tests."""
    code = (
        "from engine_tasks import *\n"
        "from meshonet_cli.batch.settings import Engine\n"
        "if __name__ == '__main__':\n"
        "    with Engine('dask', 2).workers(print) as workers:\n"
        "        tasks = [(k, 'mark') for k in range(6)]\n"
        "        print([outcome for _, outcome in workers.in_order(deadly_once, tasks, 1)])\n"
        "        for k, outcome in workers.in_order(deadly, range(4), 1): print(k, repr(outcome)[:15])\n"
        "        for k, outcome in workers.in_order(double, range(4), 1): print(k, repr(outcome))\n"
    )
    Path(tmp_path / "run.py").write_text(code)
    environment = ENVIRONMENT | {"PYTHONPATH": os.pathsep.join([str(ROOT), str(Path(__file__).parent)])}
    done = subprocess.run(
        [sys.executable, "run.py"], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    said = [line for line in done.stdout.splitlines() if "died; what it was doing" in line]
    assert len(said) == 3
    assert [line for line in done.stdout.splitlines() if line not in said] == [
        "[0, 1, 2, 3, 4, 5]",
        "0 0", "1 1", "2 WorkerDiedError", "3 3",
        "0 0", "1 2", "2 4", "3 ValueError('three')",
    ]  # fmt: skip
    assert done.stderr == ""


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return int(listener.getsockname()[1])


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """Address and process of a scheduler with one worker, which was started in another folder."""
    address = f"tcp://127.0.0.1:{free_port()}"
    away = tmp_path / "away"
    away.mkdir()
    options = {"cwd": away, "env": ENVIRONMENT, "stderr": subprocess.DEVNULL}
    dask = [sys.executable, "-m", "dask"]
    port = address.rpartition(":")[2]
    head = subprocess.Popen([*dask, "scheduler", "--port", port, "--no-dashboard"], **options)
    worker = [*dask, "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    workers = subprocess.Popen(worker, **options)
    yield address, head
    for process in (workers, head):
        process.kill()
        process.wait()


@needs_dask
def test_a_cluster_that_is_there_is_used_until_its_scheduler_dies(
    meshonet: Meshonet, tmp_path: Path, scheduler: tuple[str, subprocess.Popen[bytes]]
) -> None:
    address, head = scheduler
    assert meshonet(*FAMILY.split()).code == 0
    words = program(*SLOW.split(), "--engine", "dask", "--scheduler", address)
    running = subprocess.Popen(words, cwd=tmp_path, env=ENVIRONMENT, stderr=subprocess.PIPE)
    wait_for(tmp_path / "3.h5")
    head.kill()
    *reports, last = running.communicate(timeout=60)[1].decode().splitlines()
    assert running.returncode == 2
    assert last == (
        f"error: the Dask scheduler at {address} is gone; run the command again with another; "
        "--skip-existing keeps what is done"
    )
    # the worker may join after the command has asked for it, which it says first
    assert " -> 0.h5: " in next(line for line in reports if not line.startswith("warning: "))
    assert meshonet(*SLOW.split(), "--skip-existing").code == 0
    kept = nodes("0.h5")
    assert meshonet(*SLOW.split()).code == 0
    assert nodes("0.h5") == kept
    assert not list((tmp_path / "away").glob("*.h5"))


@needs_dask
def test_a_scheduler_that_does_not_answer_gets_a_line(
    meshonet: Meshonet, three_h5: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshonet_cli.batch.executors.dask_engine._SECONDS", 0.3)
    address = f"tcp://127.0.0.1:{free_port()}"
    done = meshonet("tfi", three_h5, "-o", "all.h5", "--engine", "dask", "--scheduler", address)
    assert (done.code, done.err) == (
        2, f"error: --scheduler: no Dask scheduler answers at '{address}'; start one: dask scheduler; then "
        "give its address, tcp://HOST:8786\n",
    )  # fmt: skip
    assert not Path("all.h5").exists()


@needs_mpi
def test_ranks_of_mpi_make_the_same_grids(meshonet: Meshonet, tmp_path: Path, three_h5: Path) -> None:
    assert meshonet("tfi", three_h5, "-o", "one.h5").code == 0
    words = ("tfi", three_h5, "missing.h5", "-o", "two.h5", "--engine", "mpi", "--json")
    done = subprocess.run(
        [str(MPIEXEC), "-n", "2", *program(*words)], cwd=tmp_path, env=ENVIRONMENT, capture_output=True
    )
    assert done.returncode == 2  # of the file that is missing
    assert len(done.stdout.splitlines()) == 4  # of rank 0 alone
    assert nodes("two.h5") == nodes("one.h5")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (
            "--scheduler tcp://a:1",
            "--scheduler without --engine dask; add --engine dask, or drop --scheduler",
        ),
        ("--engine mpi --jobs 2", "--jobs is of no use: mpiexec -n says how many workers there are"),
        ("--engine dask --scheduler a:1 --jobs 2", "--jobs is of no use: the cluster of --scheduler says"),
        pytest.param("--engine mpi", "--engine: there is no other rank; start", marks=needs_mpi),
    ],
)
def test_options_that_do_not_go_together(meshonet: Meshonet, three_h5: Path, words: str, says: str) -> None:
    done = meshonet("tfi", three_h5, "-o", "all.h5", *words.split())
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert says in done.err
    assert not Path("all.h5").exists()


@pytest.mark.parametrize(("engine", "package"), [("dask", "distributed"), ("mpi", "mpi4py")])
def test_an_engine_that_is_not_installed_is_named(
    meshonet: Meshonet, three_h5: Path, monkeypatch: pytest.MonkeyPatch, engine: str, package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)  # importing it fails
    done = meshonet("tfi", three_h5, "-o", "all.h5", "--engine", engine)
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert f"pip install 'meshonet[{engine}]'" in done.err


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_a_batch_that_is_stopped_leaves_whole_files_and_no_process(
    meshonet: Meshonet, tmp_path: Path, number: signal.Signals
) -> None:
    assert meshonet(*FAMILY.split()).code == 0
    command = [sys.executable, "-m", "meshonet_cli", *SLOW.split(), "--jobs", "2", "-q"]
    running = subprocess.Popen(command, cwd=tmp_path, env=ENVIRONMENT, start_new_session=True)
    wait_for(tmp_path / "0.h5")
    running.send_signal(number)
    running.wait(timeout=30)
    assert running.returncode == {signal.SIGINT: 130, signal.SIGTERM: 143}.get(number, -number)
    deadline = time.monotonic() + 20
    while group_lives(running.pid):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert not list(tmp_path.glob(f".*{PART_SUFFIX}"))
    assert all(len(list(read_grids(str(path)))) == 1 for path in tmp_path.glob("[0-9]*.h5"))


def group_lives(leader: int) -> bool:
    """Whether there are processes of this session."""
    try:
        os.killpg(leader, 0)
    except ProcessLookupError:
        return False
    return True


def wait_for(path: Path) -> None:
    deadline = time.monotonic() + 60
    while not path.exists():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_importing_the_options_loads_no_engine() -> None:
    code = "import sys, meshonet_cli.tasks.grids, meshonet_cli.options; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], env=ENVIRONMENT, capture_output=True, text=True)
    assert not {"concurrent.futures", "multiprocessing", "distributed", "mpi4py"} & set(done.stdout.split())
    assert np.isin("meshonet_cli.batch.run", done.stdout.split())
