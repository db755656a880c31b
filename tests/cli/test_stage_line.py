"""What a single long input is at, on a terminal and nowhere else."""

import os
import pty
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from command_line import ROOT, terminal

from meshonet.solvers.stages import reached
from meshonet_cli import app
from meshonet_cli.app import run
from meshonet_cli.terminal import session as session_module
from meshonet_cli.terminal import stage_line
from meshonet_cli.terminal.session import Session
from meshonet_cli.terminal.stage_line import StageLine

WIPED = "\r\x1b[2K"


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines without the first second."""
    monkeypatch.setattr(stage_line, "DELAY", 0.0)
    monkeypatch.setattr(stage_line, "INTERVAL", 0.01)
    monkeypatch.setattr(session_module, "_is_pipe", lambda _: False)


@pytest.fixture
def line() -> Iterator[StageLine]:
    """A line that is not drawn."""
    line = StageLine(lambda: None, lambda: None)
    yield line
    line.stop()


def threads() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name == "stage line"]


def test_the_line_says_stage_and_seconds(line: StageLine) -> None:
    assert line.text() == "0 s, read"
    reached("quality")
    assert line.text() == "0 s, quality"


def test_steps_of_a_known_number_have_a_bar_and_the_time_left(line: StageLine) -> None:
    reached("grid", "level", 0, 100)
    assert line.text() == "[------------------------] 0 s, grid: level 0/100"
    reached("grid", "level", 50, 100)
    assert line.text() == "[############------------] 0 s, grid: level 50/100, 0 s left"


def test_steps_of_an_unknown_number_are_counted(line: StageLine) -> None:
    reached("grid", "cycle", 12)
    assert line.text() == "0 s, grid: cycle 12"


def test_a_detail_goes_with_its_stage(line: StageLine) -> None:
    line.detail = "residual 1e-5"
    assert line.text() == "0 s, read: residual 1e-5"
    reached("write")
    assert line.text() == "0 s, write"


def test_nothing_is_shown_for_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stage_line, "DELAY", 1.0)
    with terminal(monkeypatch) as screen:
        session = Session()
        session.watch()
        assert threads()
        time.sleep(0.1)
        session.finish()
        assert screen() == ""


def test_the_line_disappears_when_done(monkeypatch: pytest.MonkeyPatch) -> None:
    with terminal(monkeypatch) as screen:
        session = Session()
        session.watch()
        reached("grid")
        time.sleep(0.1)
        session.finish()
        shown = screen()
    assert f"{WIPED}0 s, grid" in shown
    assert shown.endswith(WIPED)
    assert not threads()


@pytest.mark.parametrize("words", [{"quiet": True}, {"as_json": True}])
def test_no_line_when_quiet_or_for_programs(monkeypatch: pytest.MonkeyPatch, words: dict[str, bool]) -> None:
    with terminal(monkeypatch):
        Session(**words).watch()
        assert not threads()


def test_batches_have_no_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    with terminal(monkeypatch):
        session = Session()
        session.watch()
        assert threads()
        session.batch = True  # a file turned out to hold several
        session.begin("a.h5")
        assert not threads()
        session.watch()
        assert not threads()


def test_an_interrupt_wipes_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    class Program:
        def main(self, *_: object, **__: object) -> None:
            Session().watch()
            time.sleep(0.1)
            raise KeyboardInterrupt

    monkeypatch.setattr(app, "application", lambda *_, **__: Program())
    with terminal(monkeypatch) as screen:
        assert run(["infer"]) == 130
        assert screen().endswith(f"0 s, read{WIPED}interrupted\r\n")
        assert not threads()


def test_a_command_that_fails_leaves_no_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "g.vts").write_text("not a grid")
    monkeypatch.chdir(tmp_path)
    with terminal(monkeypatch) as screen:
        for words in (["infer", "none.dat", "-o", "g.vts"], ["quality", "g.vts", "--html", "none/q.html"]):
            assert run(words) == 2
            assert re.match(r"error: \S+: [^\n]*\n\Z", screen().split(WIPED)[-1])
            assert not threads()


def test_a_command_shows_its_stages_and_no_colour(tmp_path: Path) -> None:
    shown = on_terminal(tmp_path, subprocess.DEVNULL)
    assert re.search(r"0 s, (read|boundary|grid|quality|write)", shown)
    assert "\x1b" not in shown.replace(WIPED, "")
    assert shown.replace(WIPED, "").rstrip().splitlines()[-1].startswith("  time")


def test_a_command_that_writes_into_a_pipe_shows_none(tmp_path: Path) -> None:
    assert "0 s, " not in on_terminal(tmp_path, subprocess.PIPE)


def on_terminal(folder: Path, stdout: int) -> str:
    """Return what a command prints on a terminal, without the first second."""
    leader, follower = pty.openpty()
    program = (
        "import sys, meshonet_cli.terminal.stage_line as s; s.DELAY = 0.0; s.INTERVAL = 0.001\n"
        "from meshonet_cli.app import run\n"
        "code = run(['infer', 'naca:0012', '--res', '300', '-o', 'g.vts'])\n"
        "sys.exit(code or ('rich' in sys.modules))"
    )
    running = subprocess.Popen(
        [sys.executable, "-c", program], stdout=stdout, stderr=follower, cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm"},
    )  # fmt: skip
    os.close(follower)
    shown = b""
    try:
        while part := os.read(leader, 65536):
            shown += part
    except OSError:  # the other end is closed
        pass
    os.close(leader)
    running.communicate(timeout=30)
    assert running.returncode == 0
    return shown.decode()
