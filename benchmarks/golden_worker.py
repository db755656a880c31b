"""Runs commands of one checkout one after another in one process, as a program: ``python -m meshonet_cli``.

    PYTHONPATH=TREE python -P golden_worker.py TREE JOBS.json      (started by golden_runs.py)

The current folder holds the inputs. Each job has its own folder: `out`, `stdout`, `stderr` and, written last,
`exit`. Standard streams are redirected as files of the operating system, so that compiled code is heard too.
Uses the standard library only, so that what the program loads is up to the program.
"""

import importlib.util
import json
import os
import runpy
import shutil
import sys
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

OUT = Path("out")


def main() -> None:
    """Run the jobs of a file."""
    tree, jobs = Path(sys.argv[1]).resolve(), json.loads(Path(sys.argv[2]).read_text())
    command_line = importlib.util.find_spec("meshonet_cli")
    if command_line is None or tree not in Path(str(command_line.origin)).resolve().parents:
        sys.exit(f"meshonet_cli is not that of {tree}: {command_line and command_line.origin}")
    for job in jobs:
        run(job["words"], job["input"], Path(job["folder"]), job["name"])


def run(words: list[str], standard_input: str | None, folder: Path, name: str | None) -> None:
    """Run one command into `folder`; what is in ``out`` then is kept in ``made`` too when it has a `name`."""
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir()
    folder.mkdir(parents=True)
    with redirected(standard_input or os.devnull, folder):
        code = exit_code(words)
    if name:
        shutil.copytree(OUT, "made", dirs_exist_ok=True)
    OUT.rename(folder / "out")
    (folder / "exit").write_text(str(code))


def exit_code(words: list[str]) -> int | str:
    """Return the exit code of the program, or ``traceback`` when it ends in one."""
    sys.argv = ["meshonet", *words]
    try:
        with warnings.catch_warnings():  # what was warned of before is warned of again
            runpy.run_module("meshonet_cli", run_name="__main__", alter_sys=True)
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except BaseException:
        traceback.print_exc()
        return "traceback"
    return 0


@contextmanager
def redirected(standard_input: str, folder: Path) -> Iterator[None]:
    """Connect the standard streams to files, and restore them."""
    kept = [os.dup(number) for number in range(3)]
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    files = [
        os.open(standard_input, os.O_RDONLY),
        *(os.open(folder / name, flags) for name in ("stdout", "stderr")),
    ]
    stdin = sys.stdin
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    sys.stdin = open(0, closefd=False)  # noqa: SIM115  a new one: the last one has read to its end
    try:
        yield
    finally:
        sys.stdin = stdin
        sys.stdout.flush()
        sys.stderr.flush()
        for number, file in enumerate(kept):
            os.dup2(file, number)
            os.close(file)


if __name__ == "__main__":
    main()
