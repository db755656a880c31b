"""The text of every page of docs/benchmarks is that of the script which makes it."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SCRIPTS = {
    "o-grids": "operator",
    "elliptic": "elliptic",
    "marching": "hyperbolic",
    "variational": "variational",
    "quad-operator": "quads",
    "body-operator": "bodies",
    "training-speed": "training",
    "marching-surfaces": "marching",
    "wings": "wings",
    "rows": "rows",
    "aircraft": "aircraft",
    "volumes": "volumes",
    "engines": "engines",
    "threads": "threads",
    "gpu": "gpu",
    "datasets": "datasets",
    "deform": "deform",
    "pages": "pages",
    "kershaw": "kershaw",
    "blocks": "blocks",
    "confidence": "confidence",
    "layers": "layers",
}
"""Page to script, benchmarks/bench_NAME.py."""


def fixed_lines(script: Path) -> list[str]:
    """Every line without a value to fill in of the texts that a script puts around its tables."""
    texts = [
        node.value.value
        for node in ast.parse(script.read_text(encoding="utf-8")).body
        if isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    ]
    return [
        line
        for text in texts
        if "\n" in text
        for line in text.splitlines()
        if not re.search(r"\{\w+(:\w+)?\}", line)
    ]


def test_every_page_has_its_script() -> None:
    pages = {path.stem for path in (ROOT / "docs" / "benchmarks").glob("*.md")} - {
        "index",
        "models",
        "domains",
        "yardstick",
    }  # made by scripts in docs/, and by benchmarks/yardstick
    assert pages == set(SCRIPTS)


@pytest.mark.parametrize("page", SCRIPTS)
def test_the_page_has_its_scripts_words(page: str) -> None:
    wanted = fixed_lines(ROOT / "benchmarks" / f"bench_{SCRIPTS[page]}.py")
    assert len(wanted) > 3
    lines = (ROOT / "docs" / "benchmarks" / f"{page}.md").read_text(encoding="utf-8").splitlines()
    assert [line for line in wanted if line not in lines] == []
