"""What a run tells of, where, and how it ends."""

import errno
import io
import json
import sys
from pathlib import Path

import pytest
from command_line import terminal

from meshonet.geometry.errors import InputError, NoValidGridError, SolverError
from meshonet.geometry.quality.gates import Judgement
from meshonet_cli.terminal.errors import explained
from meshonet_cli.terminal.session import Session
from meshonet_cli.terminal.summary import MemberRow
from meshonet_cli.terminal.text import aligned, figure, span


def test_the_worst_outcome_of_the_members_is_the_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session()
    for error, worst in (
        (None, 0),
        (InputError("bad", "mend it"), 2),
        (NoValidGridError("folded"), 3),
        (SolverError("diverged"), 3),
        (InputError("bad", "mend it"), 3),
    ):
        with session.member("m"):
            if error:
                raise error
        assert session.worst == worst
    assert session.finish() == 3


def test_an_error_names_the_member_unless_it_knows_better(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session()
    with session.member("a.dat"):
        raise InputError("is odd", "mend it")
    with session.member("a.dat"):
        raise InputError("is odd", "mend it", source="b.dat", place="line 3")
    report = capsys.readouterr().err.splitlines()
    assert report == ["error: a.dat: is odd; mend it", "error: b.dat: line 3: is odd; mend it"]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, SystemExit, BrokenPipeError])
def test_what_stops_the_program_stops_a_batch(stop: type[BaseException]) -> None:
    with pytest.raises(stop), Session().member("a.dat"):
        raise stop


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (OSError(errno.ENOSPC, "No space left on device", "g.vts"), "g.vts: No space left on device; check"),
        (OSError("odd"), "m: odd; check the path, its permissions and the free space"),
        (MemoryError("7 GiB"), "m: not enough memory (7 GiB); use a smaller --res"),
        (MemoryError(), "m: not enough memory; use a smaller --res"),
        (ZeroDivisionError("by zero"), "m: internal error: ZeroDivisionError: by zero; this is a bug"),
        (NoValidGridError("3 of 9 cells are folded"), "m: 3 of 9 cells are folded"),
    ],
)  # fmt: skip
def test_every_error_is_a_line(error: Exception, message: str) -> None:
    assert explained(error, "m").startswith(message)
    assert "\n" not in explained(error, "m")


FIGURES = {"folded": 0.0}


def test_gates_say_the_figure_and_set_one(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session(quiet=True)
    session.judge(MemberRow("g.vts", FIGURES, Judgement(("max_angle.max is 175",))))
    assert session.finish() == 1
    assert capsys.readouterr().err == "gate not met: g.vts: max_angle.max is 175\n"


def test_json_and_a_result_do_not_share_standard_output() -> None:
    Session(as_json=True).check_output("g.vts")
    Session().check_output("-")
    with pytest.raises(InputError, match="--json and -o - both want standard output; write"):
        Session(as_json=True).check_output("-")


def test_json_is_written_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stdout", stream)
    Session(as_json=True).result({"a": 1.5})
    assert json.loads(stream.getvalue()) == {"a": 1.5}


def test_progress_is_shown_on_a_terminal_and_wiped_off(monkeypatch: pytest.MonkeyPatch) -> None:
    with terminal(monkeypatch) as text:
        session = Session()
        session.begin("a.dat", 3)
        session.begin("b.dat", 3)
        session.note("a.dat done")
        session.finish()
        report = text()
    assert "[------------------------] 1/3: a.dat" in report
    assert "[########----------------] 2/3, 0 s left: b.dat" in report
    assert report.replace("\r\n", "\n").endswith("\r\x1b[2Ka.dat done\n")


def test_progress_is_not_shown_when_quiet_or_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    with terminal(monkeypatch) as text:
        Session(quiet=True).begin("a.dat", 3)
        Session().begin("a.dat")
        monkeypatch.setenv("TERM", "dumb")
        Session().begin("a.dat", 3)
        sys.stderr.write("end\n")
        assert text() == "end\r\n"


def test_tables_are_aligned() -> None:
    assert aligned([["a", "1"], ["bcd", "10"]]) == "a     1\nbcd  10"
    assert figure(0.5) == "0.5"
    assert (span(0.0123), span(12.3)) == ("12.3 ms", "12.30 s")


def test_a_session_counts_what_was_done(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session()
    session.batch = True
    session.skip("a.dat", "a.vts")
    session.fail("b.dat", "b.dat", InputError("bad", "mend it"))
    session.done += 1
    session.finish()
    assert "1 done, 1 there already, 1 failed in " in capsys.readouterr().err


def test_a_session_counts_grids_beyond_a_gate_among_those_done(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session()
    session.batch = True
    session.done = 3
    session.judge(MemberRow("a.vts", FIGURES, Judgement(("max_angle.max is 175", "folded is 1"))))
    session.judge(MemberRow("b.vts", FIGURES, Judgement()))
    session.finish()
    assert "3 done (1 of them beyond a gate) in " in capsys.readouterr().err


def test_undecodable_text_does_not_stop_a_message(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Session().warn("gr\u00f6\u00dfer")
    assert "gr" in capsys.readouterr().err
