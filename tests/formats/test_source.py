import os
import sys
import threading
from pathlib import Path

import pytest
from format_shapes import Pipe

from meshonet.formats.source import Source, open_source, printable
from meshonet.geometry.errors import InputError


def test_a_file_is_read_where_it_lies(tmp_path: Path) -> None:
    path = tmp_path / "Wing.DAT"
    path.write_bytes(b"0123456789")
    source = open_source(str(path))
    assert (source.stem, source.suffix, source.size) == ("Wing", ".dat", 10)
    assert source.head(4) == b"0123"
    assert source.read_bytes() == b"0123456789"
    with source.open() as stream:
        stream.seek(8)
        assert stream.read() == b"89"
    assert source.data is None


def test_standard_input_is_read_to_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Pipe(b"abc\x00"))
    source = open_source("-")
    assert (source.stem, source.suffix, source.read_bytes()) == ("stdin", "", b"abc\x00")


def test_a_named_pipe_is_read_to_its_end(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.vts"
    os.mkfifo(pipe)
    feeder = threading.Thread(target=pipe.write_bytes, args=(b"through",))
    feeder.start()
    source = open_source(str(pipe))
    feeder.join()
    assert (source.read_bytes(), source.suffix, source.size) == (b"through", ".vts", 7)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such devices here")
def test_a_device_which_may_have_no_end_is_refused() -> None:
    with pytest.raises(InputError, match="/dev/zero: is a device; name a file"):
        open_source("/dev/zero")


def test_nothing_on_standard_input_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Pipe())
    with pytest.raises(InputError, match="-: is empty; give a file"):
        open_source("-")


def test_a_source_of_nothing_is_refused() -> None:
    with pytest.raises(InputError, match="x: has neither a path nor data"):
        Source("x").read_bytes()


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("naca 2412 é", "naca 2412 é"),
        ("a\x1b[2Jb", "a\\x1b[2Jb"),
        ("a\nb\tc", "a\\nb\\tc"),
        ("\udcff", "\\udcff"),
    ],
)
def test_names_cannot_act_on_a_terminal(text: str, shown: str) -> None:
    assert printable(text) == shown
