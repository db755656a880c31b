import os
import re
import signal
import stat
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest
from format_shapes import PYTHON, Pipe, file_names

from meshonet.formats.output import PART_SUFFIX, _swapped, final_name, whole_file, whole_folder
from meshonet.geometry.errors import InputError


def test_the_file_appears_when_the_block_ends_and_nothing_else_stays(tmp_path: Path) -> None:
    target = tmp_path / "grid.vts"
    with whole_file(str(target)) as part:
        part.write_bytes(b"half")
        assert not target.exists()
        assert part.parent == tmp_path
        assert part.name.endswith(PART_SUFFIX)
        part.write_bytes(b"whole")
    assert target.read_bytes() == b"whole"
    assert file_names(tmp_path) == ["grid.vts"]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, InputError])
def test_any_exception_leaves_the_old_file_and_no_part(error: type[BaseException], tmp_path: Path) -> None:
    target = tmp_path / "grid.vts"
    target.write_text("old")

    def stopped() -> None:
        with whole_file(str(target)) as part:
            part.write_text("half")
            raise error("stop")

    with pytest.raises(error):
        stopped()
    assert target.read_text() == "old"
    assert file_names(tmp_path) == ["grid.vts"]


@pytest.mark.parametrize("stream", [False, True])
def test_a_signal_that_comes_while_the_part_is_made_leaves_nothing(
    stream: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make = os.open

    def interrupted(*words: Any) -> int:
        os.close(make(*words))
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "open", interrupted)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(KeyboardInterrupt), whole_file("-" if stream else str(tmp_path / "a")):
        pass
    assert file_names(tmp_path) == []


def test_what_a_killed_process_left_is_swept_and_nothing_else(tmp_path: Path) -> None:
    code = (
        "import os, signal; from meshonet.formats.output import whole_file\n"
        f"with whole_file({str(tmp_path / 'a')!r}) as part:\n    os.kill(os.getpid(), signal.SIGKILL)"
    )
    assert subprocess.run([PYTHON, "-c", code], timeout=60, check=False).returncode == -signal.SIGKILL
    (left,) = file_names(tmp_path)
    boot = Path("/proc/sys/kernel/random/boot_id").read_text().strip().replace("-", "")
    machine, container, process, _ = re.findall(
        r"[0-9a-f]+", left.removeprefix(".a.").removesuffix(PART_SUFFIX)
    )
    assert machine == boot
    others = [
        left.replace(machine, machine[::-1]),  # of a machine that may have the same name
        left.replace(container, container + "0"),
        left.replace(f"-{process}-", f"-{os.getpid()}-"),
        f".a.{os.uname().nodename}-{process}-01234567{PART_SUFFIX}",
        "b",
        ".hidden" + PART_SUFFIX,
    ]
    for name in others:
        (tmp_path / name).touch()
    with whole_file(str(tmp_path / "c")) as part:
        part.touch()
    assert file_names(tmp_path) == sorted([*others, "c"])


def test_nothing_is_swept_where_the_system_does_not_say_who_is_who(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshonet.formats.output._machine", lambda: "-")
    left = f".a.--999999999-01234567{PART_SUFFIX}"
    (tmp_path / left).touch()
    with whole_file(str(tmp_path / "c")) as part:
        assert final_name(part) == "c"
        part.touch()
    assert file_names(tmp_path) == [left, "c"]


def test_permissions_are_those_of_any_new_file(tmp_path: Path) -> None:
    old = os.umask(0o027)
    try:
        with whole_file(str(tmp_path / "a")) as part:
            part.write_text("x")
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "a").stat().st_mode) == 0o640


def test_a_link_is_written_through(tmp_path: Path) -> None:
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to("real")
    with whole_file(str(tmp_path / "link")) as part:
        part.write_text("new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_standard_output_gets_the_bytes_at_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    out = Pipe()
    monkeypatch.setattr(sys, "stdout", out)
    with whole_file("-") as part:
        part.write_bytes(b"\x00\xff\n")
        assert out.buffer.getvalue() == b""
    assert out.buffer.getvalue() == b"\x00\xff\n"
    assert not part.exists()


def test_standard_output_gets_nothing_on_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    out = Pipe()
    monkeypatch.setattr(sys, "stdout", out)

    def stopped() -> None:
        with whole_file("-") as part:
            part.write_bytes(b"half")
            raise RuntimeError("stop")

    with pytest.raises(RuntimeError, match="stop"):
        stopped()
    assert out.buffer.getvalue() == b""


def test_a_reader_that_stops_early_is_no_error() -> None:
    code = (
        "from meshonet.formats.output import whole_file\n"
        "with whole_file('-') as part: part.write_bytes(bytes(10**7))"
    )
    # more than a pipe holds: the writer is still at it when the reader leaves, whichever of them is slower
    pipe = f'{PYTHON} -c "{code}" | head -c 10 | wc -c; echo ${{PIPESTATUS[0]}}'
    done = subprocess.run(["bash", "-c", pipe], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.split() == ["10", "0"]
    assert done.stderr == ""


def test_a_device_is_written_to_and_stays(tmp_path: Path) -> None:
    with whole_file("/dev/null") as part:
        part.write_text("x")
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)


def test_a_named_pipe_is_fed(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with subprocess.Popen(["cat", str(pipe)], stdout=subprocess.PIPE) as reader:
        with whole_file(str(pipe)) as part:
            part.write_bytes(b"through")
        assert reader.communicate(timeout=30)[0] == b"through"


def test_folders_are_made_only_when_asked(tmp_path: Path) -> None:
    with whole_file(str(tmp_path / "new" / "a"), make_folder=True) as part:
        part.write_text("x")
    assert (tmp_path / "new" / "a").read_text() == "x"


@pytest.mark.parametrize(
    ("where", "message"),
    [
        ("", "is a folder; name a file in it"),
        ("none/a.vts", "its folder does not exist; make it: mkdir -p .*none"),
    ],
)
def test_a_place_that_cannot_be_written_is_named(where: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message), whole_file(str(tmp_path / where)):
        pass


def test_a_full_disc_is_named() -> None:
    message = r"/dev/full: cannot be written \(No space left on device\); free space"
    with pytest.raises(InputError, match=message), whole_file("/dev/full") as part:
        part.write_text("x")


def test_an_error_of_the_system_about_the_input_is_not_blamed_on_the_output(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), whole_file(str(tmp_path / "a")):
        (tmp_path / "missing").read_bytes()


def test_sigterm_turned_into_an_exit_removes_the_part(tmp_path: Path) -> None:
    code = (
        "import signal, sys, time; from meshonet.formats.output import whole_file\n"
        "signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))\n"
        f"with whole_file({str(tmp_path / 'a')!r}) as part:\n"
        "    part.write_text('half'); print('ready', flush=True); time.sleep(60)"
    )
    with subprocess.Popen([PYTHON, "-c", code], stdout=subprocess.PIPE) as child:
        assert child.stdout is not None
        child.stdout.readline()
        assert len(file_names(tmp_path)) == 1
        child.send_signal(signal.SIGTERM)
        assert child.wait(timeout=30) == 143
    assert file_names(tmp_path) == []


def test_a_folder_takes_the_place_of_the_old_one_only_when_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "mesh"
    swaps: list[Path] = []

    def swapped(one: Path, other: Path) -> bool:
        swaps.append(other)
        return _swapped(one, other)

    monkeypatch.setattr("meshonet.formats.output._swapped", swapped)
    for text in ("first", "second"):
        with whole_folder(target) as folder:
            (folder / text).write_text(text)
        assert file_names(target) == [text]
        assert file_names(tmp_path) == ["mesh"]
    with pytest.raises(FileNotFoundError), whole_folder(target) as folder:
        (folder / "third" / "missing").write_text("half")
    assert file_names(target) == ["second"]
    assert file_names(tmp_path) == ["mesh"]
    assert swaps == [target]  # in one step, once there was an old one


def test_a_folder_is_replaced_where_the_system_cannot_swap(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("meshonet.formats.output._swapped", lambda one, other: False)
    for text in ("first", "second"):
        with whole_folder(tmp_path / "mesh") as folder:
            (folder / text).write_text(text)
        assert file_names(tmp_path / "mesh") == [text]
        assert file_names(tmp_path) == ["mesh"]


@pytest.mark.parametrize("stream", ["-", "/dev/null"])
def test_a_stream_has_no_room_for_a_folder(stream: str) -> None:
    with (
        pytest.raises(InputError, match="is a stream, and a folder is to be written; name a file"),
        whole_file(stream, beside=True),
    ):
        pass
