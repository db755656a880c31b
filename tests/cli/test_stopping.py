"""Signals are honoured even when Python drops the exception they raise."""

import os
import signal
import subprocess
import sys

import pytest
from command_line import ROOT

from meshonet_cli.terminal.stopping import check

DROPPED = """
import os, sys, weakref
from meshonet_cli.terminal.session import Session
from meshonet_cli.terminal.stopping import install

number = int(sys.argv[1])
install()

class Thing: pass

thing = Thing()
reference = weakref.ref(thing, lambda _: os.kill(os.getpid(), number))
del thing  # the signal comes inside the callback, where Python drops what it raises
print("went on", flush=True)
try:
    Session(quiet=True).begin("next member")
except BaseException as error:
    print(type(error).__name__)
"""


@pytest.mark.parametrize(
    ("number", "raised"),
    [(signal.SIGINT, "KeyboardInterrupt"), (signal.SIGTERM, "SystemExit"), (signal.SIGHUP, "SystemExit")],
)
def test_a_dropped_signal_stops_at_the_next_member(number: int, raised: str) -> None:
    command = [sys.executable, "-c", DROPPED, str(int(number))]
    done = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True
    )
    assert done.stdout.split("\n")[:2] == ["went on", raised]


def test_an_ignored_signal_stays_ignored() -> None:
    code = "import os, signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); "
    code += (
        "from meshonet_cli.terminal.stopping import install; install(); os.kill(os.getpid(), signal.SIGHUP)"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    assert subprocess.run([sys.executable, "-c", code], env=environment).returncode == 0


def test_tests_that_are_to_ignore_a_signal_start_processes_that_heed_it() -> None:
    line = 'trap "" INT; "$0" -m pytest -n 0 -p no:cacheprovider -k "dropped and KeyboardInterrupt" "$1"'
    done = subprocess.run(
        ["sh", "-c", line, sys.executable, __file__], cwd=ROOT, capture_output=True, text=True
    )
    assert "1 passed" in done.stdout


TWICE = """
import os, signal
from meshonet_cli.batch.executors.processes_engine import _begin, _call

def task(_):
    try:
        os.kill(os.getpid(), signal.SIGTERM)
    finally:
        os.kill(os.getpid(), signal.SIGTERM)
        print("cleaned up", flush=True)

_begin()
_call(task, None)
"""


def test_a_worker_that_is_ended_twice_still_cleans_up() -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", TWICE], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (143, "cleaned up\n")


def test_without_a_signal_nothing_is_raised() -> None:
    check()
