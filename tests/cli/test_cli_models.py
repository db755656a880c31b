"""`meshonet models`."""

from pathlib import Path

from command_line import Meshonet

from meshonet.solvers.neural.registry import shipped


def test_models_are_listed_a_line_each(meshonet: Meshonet) -> None:
    done = meshonet("models")
    assert (done.code, done.err) == (0, "")
    head, *lines = done.out.splitlines()
    assert head.split() == ["model", "for", "takes", "median", "error"]
    rows = lines[: len(shipped())]
    assert [line.split()[0] for line in rows] == list(shipped())
    assert all("held out" in line and " ms at " in line for line in rows)
    assert max(map(len, rows)) <= 150


def test_a_model_tells_its_recipe(meshonet: Meshonet) -> None:
    done = meshonet("models", "quad-general")
    assert done.code == 0
    assert done.out.startswith("quad-general\n  use ")
    assert "command: meshonet train" in done.out
    assert "hole-o" not in done.out


def test_json_is_one_object_a_model(meshonet: Meshonet) -> None:
    report = meshonet("models", "--json").objects
    assert [item["name"] for item in report] == list(shipped())
    assert all(Path(item["file"]).is_file() and item["use"] and item["error"] for item in report)
    assert [item["name"] for item in meshonet("models", "hole-o", "--json").objects] == ["hole-o"]


def test_an_unknown_model_is_refused(meshonet: Meshonet) -> None:
    done = meshonet("models", "hole")
    assert (done.code, done.out) == (2, "")
    assert "no model 'hole'; did you mean 'hole-o'?" in done.err
