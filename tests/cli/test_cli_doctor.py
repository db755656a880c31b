"""`meshonet doctor`."""

import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from command_line import Meshonet

from meshonet import __version__
from meshonet.api import doctor as doctor_module

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]


def test_all_is_well_here(meshonet: Meshonet) -> None:
    done = meshonet("doctor")
    assert (done.code, done.err) == (0, ""), done.out
    assert done.out.endswith("all is well\n")
    assert f"meshonet     {__version__}" in done.out or f"  {__version__}, in " in done.out
    assert "compiled, " in done.out


def test_json_has_every_package_and_every_extra_for_users(meshonet: Meshonet) -> None:
    report = meshonet("doctor", "--json").only
    assert report["well"]
    names = {finding["name"] for finding in report["findings"]}
    installed = {name for name, _, extra in doctor_module.requirements() if not extra}
    assert {"numpy", "h5py", "typer"} <= installed <= names
    extras = {finding["name"]: finding for finding in report["findings"] if finding["group"] == "extras"}
    assert {"train", "dxf", "pyvista"} <= set(extras)
    assert not {"test", "lint", "docs"} & set(extras)
    for name, finding in extras.items():
        assert finding["well"] or f"meshonet[{name}]" in finding["remedy"]


def test_every_extra_for_users_says_what_it_adds() -> None:
    extras = set(PROJECT["optional-dependencies"]) - set(doctor_module._FOR_DEVELOPERS)
    assert extras <= set(doctor_module.ADDS)


def absent(name: str) -> str:
    raise metadata.PackageNotFoundError(name)


def test_what_is_missing_gives_1_and_the_remedy(meshonet: Meshonet, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor_module.metadata, "version", absent)
    done = meshonet("doctor")
    assert done.code == 1
    assert "NO  numpy" in done.out
    assert "not installed; pip install 'numpy>=" in done.out
    assert "of these need attention" in done.out
    line = next(line for line in done.out.splitlines() if " dxf " in line)
    assert line.split()[0] == "-"
    assert line.endswith("pip install 'meshonet[dxf]'")


def test_a_package_of_another_version_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor_module.metadata, "version", lambda _: "0.1")
    findings = {finding.name: finding for finding in doctor_module.doctor()}
    assert findings["numpy"].well is False
    assert findings["numpy"].value.startswith("0.1, and >=2")


def test_kernels_that_fail_are_told(meshonet: Meshonet, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ImportError("no kernels")

    monkeypatch.setattr("meshonet.api.grid.infer", broken)
    done = meshonet("doctor")
    assert done.code == 1
    assert "failed: ImportError: no kernels; install meshonet again" in done.out
