"""Lines of commands as pages and the help show them, run in a folder."""

import io
import re
import shlex
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest
import run_tutorials as tutorials

from meshonet_cli.app import run


def run_line(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a line in a folder: in this process, except where it is more than one command to a shell."""
    if line.startswith("python ") or re.search(r"[|&;$<*?]|> |-o -$", line):
        return _in_shell(line, folder)
    words, out, error = shlex.split(line, comments=True), io.StringIO(), io.StringIO()
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(out), redirect_stderr(error):
        patch.chdir(folder)
        patch.setattr(sys, "argv", words)
        code = run(words[1:])
    return subprocess.CompletedProcess(words, code, out.getvalue(), error.getvalue())


def _in_shell(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    words = ["bash", "-o", "pipefail", "-c", line]
    return subprocess.run(
        words, cwd=folder, env=tutorials.environment(folder), capture_output=True, text=True, timeout=120
    )


SIZES, FEW = {"--cells": 3000, "--around": 49, "--span": 13}, "--around 49 --span 13"
"""The most that a command that makes layers or volumes gets here; tutorials are run with their own sizes."""


def smaller(line: str) -> str:
    """Return a command with sizes of at most `SIZES`, or as it is if it is fast.

    Wings and aircraft whose numbers of cells a page leaves to the command get those of `FEW`.
    """
    if re.match(r"meshonet stack (wing|aircraft)\.toml ", line) and not re.search("--(around|cells) ", line):
        return line.replace(".toml ", f".toml {FEW} ", 1)
    if not re.search("--(first-cell|y-plus|around) ", line):
        return line

    def size(hit: re.Match[str]) -> str:
        return f"{hit[1]} {min(int(hit[2]), SIZES[hit[1]])}"

    return re.sub(rf"({'|'.join(SIZES)}) (\d+)(?= |$)", size, line)
