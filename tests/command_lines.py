"""Lines of commands as pages and the help show them, run in a folder."""

from __future__ import annotations

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
