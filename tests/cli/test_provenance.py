"""The command line that travels in a grid: whole but for the output, and made once for all grids of a run."""

import shlex

import pytest

from meshonet_cli.batch.provenance import provenance


@pytest.mark.parametrize(
    "output", [["-o", "x.vts"], ["--output", "x.vts"], ["--output=x.vts"], ["-ox.vts"], ["-o"]]
)
def test_the_outputs_name_is_left_out(output: list[str]) -> None:
    report = provenance(["infer", "a b.dat", *output])
    assert report["command"] == "meshonet infer 'a b.dat'"


def test_the_command_of_many_inputs_is_put_together_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    join = shlex.join
    monkeypatch.setattr(shlex, "join", lambda words: calls.append(len(words)) or join(words))
    files = [f"once-{k}.dat" for k in range(50)]
    monkeypatch.setattr("sys.argv", ["meshonet", "infer", *files, "-o", "g.h5"])
    assert provenance() == provenance() == provenance()
    assert calls == [5]  # meshonet infer FIRST [48 more] LAST


def test_another_command_is_another() -> None:
    assert provenance(["tfi", "a.csv"]) != provenance(["tfi", "b.csv"])
