"""Tutorials run: the blocks of each page in their order, and they print what the page shows."""

import re
from pathlib import Path

import pytest
import run_tutorials as tutorials

PAGES = tutorials.PAGES
SMALL = {"operator": {"COUNT": "12", "EPOCHS": "2"}}
"""Smaller values of what a page exports, where its own take long; what it prints is not compared then."""


def name_of(page: Path) -> str:
    return page.stem


def check(page: Path, results: list[tutorials.Result], compared: bool = True) -> None:
    for result in results:
        assert result.status == 0, f"{result.step.text}\n{result.printed}"
        unlike = result.differences() if compared else []
        assert not unlike, "\n".join([f"{page.name}: not what is printed by\n{result.step.text}", *unlike])


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_the_steps_of_a_tutorial_run_and_print_what_it_shows(page: Path, tmp_path: Path) -> None:
    small = SMALL.get(page.stem, {})
    check(page, tutorials.run(page, tmp_path, small, quick=True), compared=not small)


WITH_OTHERS = [page for page in PAGES if any(step.needs for step in tutorials.steps_of(page))]


@pytest.mark.client("simpleFoam")
@pytest.mark.parametrize("page", WITH_OTHERS, ids=name_of)
def test_whole_tutorials_run_with_flow_solvers_and_checkers(page: Path, tmp_path: Path) -> None:
    for step in tutorials.steps_of(page):
        if not tutorials.is_there(step.needs):
            pytest.skip(f"{step.needs} is not installed")
    check(page, tutorials.run(page, tmp_path))


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_pictures_are_made_by_the_page_and_small(page: Path) -> None:
    code = "\n".join(step.text for step in tutorials.steps_of(page))
    names = tutorials.pictures_of(page)
    assert names
    for name in names:
        assert re.search(rf"\b{re.escape(name)}\b", code), f"no step of {page.name} makes {name}"
        assert (tutorials.FOLDER / "img" / name).stat().st_size < 120_000


def test_the_index_lists_every_tutorial() -> None:
    index = (tutorials.FOLDER / "index.md").read_text(encoding="utf-8")
    assert not [page.name for page in PAGES if f"]({page.name})" not in index]
