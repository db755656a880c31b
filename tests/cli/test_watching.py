"""Cycles on the terminal and in the file of `--history`."""

import csv
import os
import pty
import re
import select
import signal
import subprocess
import sys
import threading
import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from command_line import ROOT, Meshonet, dataset, ellipse

from meshonet.formats.registry import read_grids
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.energy.functional import Weights, value
from meshonet.solvers.progress import Cycle, cycle_ended, listening
from meshonet_cli.report.cycles import COLUMNS, Live


def table(path: str = "h.csv") -> list[dict[str, str]]:
    with Path(path).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_history_has_every_cycle(meshonet: Meshonet, body_h5: Path) -> None:
    words = ("solve-pde", body_h5, "--res", "101x65", "--tol", "1e-8", "-o", "g.vts")
    report = meshonet(*words, "--history", "h.csv", "--json").only
    rows = table()
    assert tuple(rows[0]) == COLUMNS
    assert [int(row["cycle"]) for row in rows] == list(range(report["cycles"] + 1))
    assert float(rows[-1]["residual"]) == report["residual"]
    residuals, seconds = ([float(row[name]) for row in rows] for name in ("residual", "seconds"))
    assert all(after < 0.5 * before for before, after in pairwise(residuals[1:]))
    assert seconds == sorted(seconds)
    assert rows[0]["change"] == ""
    assert float(rows[1]["change"]) > float(rows[-1]["change"]) > 0
    assert {(row["method"], row["ni"], row["nj"], row["attempt"]) for row in rows} == {
        ("winslow", "101", "65", "1")
    }
    (grid,) = read_grids("g.vts")
    assert int(rows[-1]["folded"]) == count_folded(grid.nodes)
    assert meshonet(*words).code == 0  # and the grid is the same without
    (again,) = read_grids("g.vts")
    np.testing.assert_array_equal(grid.nodes, again.nodes)


def test_history_of_a_batch_names_its_members(meshonet: Meshonet, three_h5: Path) -> None:
    words = ("solve-pde", three_h5, "--tol", "1e-6", "-o", "{name}.vts", "--history", "h.csv")
    assert meshonet(*words, "--jobs", "2").code == 0
    names = [row["input"] for row in table()]
    assert sorted(set(names), key=names.index) == [f"{three_h5}[{name}]" for name in ("flat", "low", "high")]


@pytest.mark.parametrize("words", [(), ("--res", "65")])
def test_history_of_a_minimisation_has_every_iteration(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...]
) -> None:
    asked = ("solve-pde", duct_h5, "--method", "variational", *words, "-o", "g.vts")
    report = meshonet(*asked, "--history", "h.csv", "--json").only
    rows = table()
    assert {row["method"] for row in rows} == {"variational"}
    finest = [row for row in rows if (row["ni"], row["nj"]) == (str(report["ni"]), str(report["nj"]))]
    assert [int(row["cycle"]) for row in finest] == list(range(report["cycles"] + 1))
    values, slopes = ([float(row[name]) for row in finest] for name in ("functional", "residual"))
    assert all(after <= before for before, after in pairwise(values))
    assert 1 < values[-1] < values[0]
    assert slopes[0] == 1
    assert slopes[-1] < 0.2
    (grid,) = read_grids("g.vts")
    terms = value(grid.nodes, Weights())
    assert values[-1] == pytest.approx(terms, rel=1e-9)  # the last iteration's is that of the grid
    assert meshonet(*asked).code == 0  # and the grid is the same without
    (again,) = read_grids("g.vts")
    np.testing.assert_array_equal(grid.nodes, again.nodes)


def test_history_of_other_methods_has_their_result(meshonet: Meshonet, body_h5: Path) -> None:
    words = ("--wall-spacing", "1e-3", "--res", "41x60", "-o", "g.vts", "--history", "h.csv")
    assert meshonet("solve-pde", body_h5, *words).code == 0
    (row,) = table()
    assert (row["method"], row["cycle"]) == ("hyperbolic", "")


def test_history_of_refined_grids_has_every_level(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("solve-pde", duct_h5, "--refine", "2", "-o", "g.vts", "--history", "h.csv")
    counts = [row["ni"] for row in table()]
    assert sorted(set(counts), key=counts.index) == ["21", "41", "81"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("h.txt", "--history: 'h.txt' is no CSV file; name it FILE.csv"),
        ("-", "--history: '-' is no CSV file; name it FILE.csv"),
        ("none/h.csv", "none/h.csv: its folder does not exist"),
    ],
)
def test_history_that_cannot_be_is_told(meshonet: Meshonet, duct_h5: Path, name: str, message: str) -> None:
    done = meshonet("solve-pde", duct_h5, "-o", "g.vts", "--history", name)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


def test_interrupts_leave_no_file_half_written(tmp_path: Path) -> None:
    dataset(tmp_path / "many.h5", "o", *[ellipse(thickness=0.2 + 0.001 * k) for k in range(300)])
    (tmp_path / "h.csv").write_text("mine")
    words = ["solve-pde", "many.h5", "--res", "150", "--tol", "1e-9", "-o", "g.h5", "--history", "h.csv"]
    running = subprocess.Popen(
        [sys.executable, "-m", "meshonet_cli", *words],
        stderr=subprocess.PIPE, cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert running.stderr is not None
    running.stderr.readline()  # the first report: it is in the middle of its work
    running.send_signal(signal.SIGINT)
    _, report = running.communicate(timeout=30)
    assert running.returncode == 130
    assert report.endswith(b"interrupted\n")
    assert (tmp_path / "h.csv").read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["h.csv", "many.h5"]


def test_the_residual_is_live_on_a_terminal(tmp_path: Path) -> None:
    report = on_terminal(tmp_path)
    assert re.search(r"129x129: cycle \d+, residual \d\.\de[-+]\d\d", report)
    assert report.replace("\r\n", "\n").rstrip().splitlines()[-1].startswith("  time")
    assert "cycle" not in on_terminal(tmp_path, "--quiet")


def test_a_pipe_sees_no_residual(meshonet: Meshonet, duct_h5: Path) -> None:
    assert "\x1b" not in meshonet("solve-pde", duct_h5, "-o", "g.vts").err


def on_terminal(folder: Path, *words: str) -> str:
    """Return what a solve prints on a terminal."""
    leader, follower = pty.openpty()
    command = ["solve-pde", "naca:0012", "--res", "129", "--tol", "1e-8", "-o", "g.vts", *words]
    running = subprocess.Popen(
        [sys.executable, "-m", "meshonet_cli", *command],
        stderr=follower, cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm"},
    )  # fmt: skip
    os.close(follower)
    report, end = b"", time.monotonic() + 60
    while time.monotonic() < end:
        if select.select([leader], [], [], 0.2)[0]:
            try:
                report += os.read(leader, 65536)
            except OSError:  # the other end is closed
                break
        elif running.poll() is not None:
            break
    os.close(leader)
    assert running.wait() == 0
    return report.decode()


def test_the_terminal_is_not_flooded() -> None:
    shown: list[str] = []
    live = Live(shown.append)
    for number in range(1000):
        live(Cycle("winslow", 9, 9, number, 1e-3, None, 2))
    assert 1 <= len(shown) < 5
    assert shown[0] == "9x9: cycle 0, residual 1.0e-03, 2 folded"


def test_who_does_not_listen_hears_nothing() -> None:
    heard: list[Cycle] = []
    nodes = np.zeros((3, 4, 2))
    cycle_ended("winslow", nodes, 1, 0.5)
    with listening(heard.append):
        cycle_ended("winslow", nodes, 2, 0.25, 0.1)
    cycle_ended("winslow", nodes, 3, 0.1)
    assert heard == [Cycle("winslow", 3, 4, 2, 0.25, 0.1, 6)]


def test_threads_do_not_hear_one_another() -> None:
    heard: dict[str, list[int]] = {"a": [], "b": []}
    both = threading.Barrier(2)

    def solve(name: str, number: int) -> None:
        with listening(lambda cycle: heard[name].append(cycle.number)):
            both.wait(10)
            cycle_ended("winslow", np.zeros((3, 4, 2)), number, 0.5)
            both.wait(10)

    threads = [threading.Thread(target=solve, args=item) for item in (("a", 1), ("b", 2))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert heard == {"a": [1], "b": [2]}
