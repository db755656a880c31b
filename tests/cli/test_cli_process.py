"""The program as a process: exit codes, pipes, signals, files it cannot have, how quickly it starts."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import ROOT, Process, dataset, duct, ellipse


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "meshonet_cli", *words]


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT)}


def test_the_exit_code_is_that_of_the_outcome(process: Process, duct_h5: Path, folding_h5: Path) -> None:
    assert process("tfi", duct_h5, "-o", "g.vts").returncode == 0
    assert process("tfi", duct_h5, "-o", "g.vts", "--fail-on", "max_angle>90").returncode == 1
    assert process("tfi", "nothing.h5", "-o", "g.vts").returncode == 2
    assert process("tfi", folding_h5, "-o", "g.vts").returncode == 3


def test_version_and_help(process: Process) -> None:
    assert process("--version").stdout.startswith(b"meshonet 0.")
    assert process().stdout == process("-h").stdout == process("--help").stdout
    assert process().returncode == 0


def test_commands_join_through_pipes(tmp_path: Path, three_h5: Path) -> None:
    first = subprocess.run(
        command("sample-boundary", str(three_h5), "-o", "-", "-q"), capture_output=True, env=environment()
    )
    second = subprocess.run(
        command("tfi", "-", "-o", "-"), input=first.stdout, capture_output=True, env=environment()
    )
    third = subprocess.run(
        command("quality", "-", "--json"), input=second.stdout, capture_output=True, env=environment()
    )
    assert (first.returncode, second.returncode, third.returncode) == (0, 0, 0)
    assert second.stdout.startswith(b"\x89HDF")
    assert b"3 done" in second.stderr
    reports = [json.loads(line) for line in third.stdout.splitlines()]
    assert [item["name"] for item in reports] == ["flat", "low", "high"]
    assert all(item["folded"] == 0 for item in reports)


@pytest.mark.parametrize("lines", [0, 1])
def test_a_reader_that_stops_early_is_no_error(tmp_path: Path, lines: int) -> None:
    """Through a pipe too small for what is written, so that the writer is not done when its reader leaves."""
    fcntl = pytest.importorskip("fcntl")
    if not hasattr(fcntl, "F_SETPIPE_SZ"):
        pytest.skip("pipes have a size of their own here")
    source = dataset(tmp_path / "many.h5", "quad", *[duct(bump=0.01 * k) for k in range(9)])
    subprocess.run(command("tfi", str(source), "-o", f"{tmp_path}/g.h5"), env=environment(), check=True)
    output, end = os.pipe()
    fcntl.fcntl(end, fcntl.F_SETPIPE_SZ, 4096)
    if not lines:
        os.close(output)
    words = command("quality", f"{tmp_path}/g.h5", "--json")
    running = subprocess.Popen(words, stdout=end, stderr=subprocess.PIPE, env=environment())
    os.close(end)
    if lines:
        with os.fdopen(output) as stream:
            assert json.loads(stream.readline())["folded"] == 0
    _, report = running.communicate(timeout=60)
    assert (running.returncode, report) == (0, b"")


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_it_without_a_trace(tmp_path: Path, number: int, code: int) -> None:
    source = dataset(tmp_path / "many.h5", "o", *[ellipse(thickness=0.2 + 0.001 * k) for k in range(400)])
    Path(tmp_path / "grids.h5").write_text("mine")
    running = subprocess.Popen(
        command("solve-pde", str(source), "--res", "150", "-o", f"{tmp_path}/grids.h5"),
        stderr=subprocess.PIPE,
        env=environment(),
    )
    assert running.stderr is not None
    assert b"many.h5[0]" in running.stderr.readline()  # the first report: it is in the middle of its work
    running.send_signal(number)
    _, report = running.communicate(timeout=30)
    assert running.returncode == code
    assert b"Traceback" not in report
    assert (tmp_path / "grids.h5").read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["grids.h5", "many.h5"]


def test_an_interrupt_while_the_program_is_loaded_shows_no_trace(tmp_path: Path) -> None:
    (tmp_path / "typer.py").write_text("import signal\nsignal.raise_signal(signal.SIGINT)\n")
    results = {**environment(), "PYTHONPATH": f"{tmp_path}:{ROOT}"}
    done = subprocess.run(command("models"), capture_output=True, env=results)
    assert (done.returncode, done.stderr) == (130, b"interrupted\n")


def test_a_full_disc_is_told_in_a_line(process: Process, duct_h5: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full here")
    done = process("tfi", duct_h5, "-o", "/dev/full", "--to", "vts")
    assert done.returncode == 2
    assert done.stderr.startswith(b"error: /dev/full: cannot be written (No space left on device)")
    assert done.stderr.count(b"\n") == 1


def test_files_it_may_not_have_are_told_in_a_line(process: Process, tmp_path: Path, duct_h5: Path) -> None:
    (tmp_path / "folder.vts").mkdir()
    done = process("tfi", duct_h5, "-o", "folder.vts")
    assert done.returncode == 2
    assert done.stderr == b"error: folder.vts: is a folder; name a file in it\n"
    done = process("tfi", "folder.vts", "-o", "g.vts")
    assert done.returncode == 2
    assert done.stderr.startswith(b"error: folder.vts: holds no file that can be read; endings are ")
    if os.geteuid() != 0:  # root may read everything
        duct_h5.chmod(0)
        done = process("tfi", duct_h5, "-o", "g.vts")
        assert done.returncode == 2
        assert b"may not be read; check its permissions" in done.stderr


def test_undecodable_names_are_told_printably(process: Process, tmp_path: Path) -> None:
    done = process("tfi", os.fsdecode(b"\xff\x1b[31m.h5"), "-o", "g.vts")
    assert done.returncode == 2
    assert b"\x1b" not in done.stderr
    assert b"no such file" in done.stderr


def test_a_terminal_that_lacks_letters_still_gets_the_table(process: Process, duct_h5: Path) -> None:
    assert process("tfi", duct_h5, "-o", "größe.vts").returncode == 0
    asked = {**environment(), "PYTHONIOENCODING": "ascii"}
    done = subprocess.run(command("quality", "größe.vts"), cwd=duct_h5.parent, env=asked, capture_output=True)
    assert done.returncode == 0
    assert done.stdout.startswith(b"gr\\xf6\\xdfe.vts: 21 x 11")


def test_a_command_that_is_none_is_told_in_a_line(process: Process) -> None:
    done = process("grid")
    assert done.returncode == 2
    assert done.stderr.startswith(b"error: no such command 'grid'")
    assert done.stderr.endswith(b"; see meshonet --help\n")


def test_too_many_nodes_for_the_memory_are_told_in_a_line(process: Process) -> None:
    resource = pytest.importorskip("resource")

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))

    done = process("tfi", "naca:0012", "--res", "20000", "-o", "g.vts", preexec_fn=limited)
    assert done.returncode == 2
    assert b"naca:0012: not enough memory" in done.stderr
    assert done.stderr.endswith(b"use a smaller --res\n")


def test_help_is_quick(process: Process) -> None:
    resource = pytest.importorskip("resource")

    def processor_seconds() -> float:  # of the children so far; wall-clock time would measure the neighbours
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return float(used.ru_utime + used.ru_stime)

    spent = []
    for _ in range(3):
        begun = processor_seconds()
        process("--help")
        spent.append(processor_seconds() - begun)
    assert min(spent) < 0.4  # 0.15 s on the machine it was written on


def test_completion_is_offered(process: Process) -> None:
    assert b"--install-completion" in process("--help").stdout
    asked = {"_MESHONET_COMPLETE": "complete_bash", "COMP_WORDS": "meshonet so", "COMP_CWORD": "1"}
    done = subprocess.run(
        command(),
        capture_output=True,
        env={**environment(), **asked},
    )
    assert done.stdout.split() == [b"solve-pde"]
