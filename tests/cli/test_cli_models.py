"""`meshonet models`."""

from pathlib import Path

from command_line import Meshonet

from meshonet.solvers.neural.registry import shipped


def test_models_are_listed(meshonet: Meshonet) -> None:
    done = meshonet("models")
    assert (done.code, done.err) == (0, "")
    names = [line for line in done.out.splitlines() if not line.startswith(" ")]
    assert names == list(shipped())


def test_json_is_one_object_a_model(meshonet: Meshonet) -> None:
    told = meshonet("models", "--json").objects
    assert [item["name"] for item in told] == list(shipped())
    assert all(Path(item["file"]).is_file() for item in told)
