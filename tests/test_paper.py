"""`make paper`: meshonet commands and nothing else make the results, and the tables say what those hold."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAPER = ROOT / "examples" / "paper"


@pytest.mark.skipif(shutil.which("make") is None, reason="needs make")
def test_results_are_made_of_meshonet_commands(tmp_path: Path) -> None:
    words = [
        "make",
        "-n",
        "-C",
        str(PAPER),
        f"OUT={tmp_path}/out",
        f"PAGES={tmp_path}/pages",
        "MESHONET=meshonet",
    ]
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
    lines = [line for line in lines if not re.match(r"make(\[\d+\])?: ", line)]
    others = [line for line in lines if not re.match(r"(meshonet|mkdir -p|rm -f|sed) ", line)]
    assert others == [
        "python3 tables.py " + str(tmp_path / "pages") + " --machine '" + others[0].split("'")[1] + "'"
    ]
    text = "\n".join(lines)
    for family in ("arch", "hexagon", "wrench", "semicircle", "airfoil", "hole"):
        assert f"--family {family} --count 36 --res 101" in text
    for model in (
        "meshonet",
        "meshonet-hard",
        "deeponet",
        "pod-deeponet",
        "fno1d",
        "fno2d",
        "wno",
        "kno",
        "lno",
        "mionet",
    ):
        for seed in (0, 1, 2):
            assert re.search(rf"train \S+ --model {model} --epochs 1000 --seed {seed} ", text)
    assert len(re.findall(r"--epochs 15000 ", text)) == 22
    assert len(re.findall(r"train \S+\.fewer\.h5 --model \S+ --epochs 300 --seed [01] ", text)) == 10 * 12 * 2
    assert len(re.findall(r"meshonet-hard --set modes=24 --points 300 --epochs 3000 ", text)) == 2
    words = "--set within=true --set modes=24 --points 300 --rate 0.003 --schedule cosine --epochs 15000 "
    assert text.count(words) == 2
    for words in ("mgnet", "mgnet --set finite=0.01", "mgnet --set lines=3", "meshnet"):
        assert re.search(rf"train \S+ --model {words} --epochs 5000 ", text)
    assert len(re.findall(r"--answer valid ", text)) == 24
    for size in (100, 200, 400, 800, 1600, 3200):
        assert f"sample-boundary --family arch --range 0.15:0.15 --count 1 --res {size} " in text


def statistics(value: float) -> dict[str, float]:
    return {
        "min": value,
        "median": value,
        "mean": value,
        "p90": value,
        "max": 2 * value,
        "sum": 7,
        "members": 3,
    }


def test_tables_say_what_the_results_hold(tmp_path: Path) -> None:
    results = tmp_path / "results"
    results.mkdir()
    columns = ("relative_l2", "boundary", "max_angle", "mean_angle", "folded")
    reports = {"summary": {"members": 6, **{name: statistics(0.0123) for name in columns}}}
    raced = [f"arch.interpolation.{model}.race0" for model in ("deeponet", "meshonet", "wno")]
    for name in ("wrench.extrapolation.meshonet.pasted", *raced):
        (results / f"{name}.json").write_text(json.dumps(reports))
    rows = (
        "epoch,seen,loss,interior,boundary,rate,seconds\n1,30,2,1.5,0.5,0.001,0.1\n2,60,1,0.75,0.25,0.001,7\n"
    )
    (results / "arch.interpolation.deeponet.race0.csv").write_text(rows)
    least = rows.replace("0.75", "360").replace("0.25", "200")  # weighted by 900 and 1000
    (results / "arch.interpolation.meshonet.race0.csv").write_text(least)
    (results / "arch.interpolation.wno.race0.csv").write_text(rows)
    (results / "arch.interpolation.wno.race1.csv").write_text(rows)  # still in training
    for model, errors in (("meshonet", (0.01, 0.03)), ("kno", (0.002, 0.004))):
        for seed, error in enumerate(errors):
            figures = {"figures": {"test": {"median": error}}}
            (results / f"hole.random.{model}.shelf{seed}.json").write_text(json.dumps(figures))
    (results / "time.tfi.100.json").write_text(json.dumps({"seconds": {"grid": 0.00042}}))
    subprocess.run([sys.executable, str(PAPER / "tables.py"), str(tmp_path)], check=True)
    page = (tmp_path / "index.md").read_text()
    assert "| extrapolation | MeshONet, boundary pasted | 1.2e-02 / 2.5e-02 | 2e-02 |" in page
    assert "| 7 (3 of 6) |" in page
    assert "| arch.interpolation | wno | 60 | 1 | 1.0e+00" in page
    assert "| hole | random | 2.0e-02 ± 1e-02 | **3.0e-03 ± 1e-03** |" in page
    assert "| `kno` | 0 of 1 | 0.15 to 0.15 |" in page
    assert "| arch.interpolation | deeponet | 60 | 1 | 1.0e+00 ± 0e+00 | 1.7 | 1.2e-02 ± 0e+00 |" in page
    loss = (
        "**Loss: not confirmed on this budget** (case arch.interpolation). MeshONet's loss is the lowest "
        "of 2. The losses of the baselines are 1.7 (`deeponet`) times MeshONet's."
    )
    assert loss in page, "below, but not by orders of magnitude"
    assert "| TFI (`tfi`) | 0.0004 |" in page
    assert "| TFI, the paper's | 0.087 |" in page
    assert "### hexagon" not in page, "what is missing is left out"
    assert (tmp_path / "loss.png").stat().st_size > 5000


def test_claims_about_quality_are_confirmed_or_not(tmp_path: Path) -> None:
    results = tmp_path / "results"
    results.mkdir()
    angles = {
        "arch.interpolation": {"tfi": 120.0, "pde": 119.0, "meshonet.pasted": 110.0, "meshonet.raw": 100.0},
        "wrench.extrapolation": {"tfi": 120.0, "pde": 119.0, "meshonet.pasted": 130.0, "meshonet.raw": 131.0},
        "semicircle.random": {"tfi": 120.0, "pde": 119.0, "meshonet.pasted": 119.05},
    }
    for case, ways in angles.items():
        for way, angle in ways.items():
            columns = {
                name: statistics(angle) for name in ("relative_l2", "boundary", "mean_angle", "folded")
            }
            totals = {"members": 6, "max_angle": statistics(angle), **columns}
            (results / f"{case}.{way}.json").write_text(json.dumps({"summary": totals}))
    for way, seconds in (("meshonet", 0.02), ("pde", 0.01)):
        (results / f"time.{way}.100.json").write_text(json.dumps({"seconds": {"grid": seconds}}))
    subprocess.run([sys.executable, str(PAPER / "tables.py"), str(tmp_path)], check=True)
    page = (tmp_path / "index.md").read_text()
    assert "| arch | interpolation | below / below | below / below | yes |" in page
    assert "| wrench | extrapolation | above / above | above / below | no |" in page
    assert "| semicircle | random | below / equal | - | - |" in page
    assert "**Quality: confirmed in 1 of 2 cases.**" in page
    words = " ".join(page.split())
    assert "the largest angle is below TFI's and the PDE solver's in 1 of 3 cases, but" in words
    assert "The pasted boundary folds cells in 3 of 3 cases." in words
    assert "`solve-pde` takes 0.5 to 0.5 times as long as MeshONet" in " ".join(page.split())


def test_a_result_appears_when_its_command_has_ended() -> None:
    """Else a run that was killed would take half a file for a result."""
    recipes = (PAPER / "Makefile").read_text(encoding="utf-8")
    assert re.findall(r"> \$+@(?!\.)", recipes) == []
