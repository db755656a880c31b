"""The runner of golden commands: its time limit is for each command, and what exceeds it is said to."""

from pathlib import Path
from types import ModuleType

import pytest

SLEEPER = """
import json, sys, time
from pathlib import Path
for job in json.loads(Path(sys.argv[2]).read_text()):
    folder = Path(job["folder"])
    folder.mkdir(parents=True)
    time.sleep(float(job["words"][0]))
    (folder / "exit").write_text("0")
"""
"""A worker whose commands take as many seconds as they say."""


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> ModuleType:
    monkeypatch.syspath_prepend(Path(__file__).parents[1] / "benchmarks")
    import golden_runs

    (tmp_path / "worker.py").write_text(SLEEPER)
    monkeypatch.setattr(golden_runs, "WORKER", tmp_path / "worker.py")
    monkeypatch.setattr(golden_runs, "TIMEOUT_S", 1)
    return golden_runs


def test_the_time_limit_is_that_of_a_command_not_of_all_in_a_process(
    runs: ModuleType, tmp_path: Path
) -> None:
    lines = ["0.5 -> no", "0.50 -> no", "0.500 -> no", "60 -> no", "0 -> no"]
    left = {line: run.exit for line, run in runs.run_all(lines, tmp_path, tmp_path)}
    assert left == dict.fromkeys(lines, 0) | {"60 -> no": runs.TIMED_OUT}


def test_commands_of_an_emulated_processor_may_take_longer(runs: ModuleType, tmp_path: Path) -> None:
    slow = runs.Machine(slower=20)
    assert [run.exit for _, run in runs.run_all(["2.5 -> no"], tmp_path, tmp_path, machine=slow)] == [0]
