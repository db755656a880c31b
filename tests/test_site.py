"""The site has every page in its place, and every page says when to use it; `make site` builds it."""

import inspect
import re
from pathlib import Path
from statistics import median

import pytest

import meshonet

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
MADE = DOCS / "reference" / "api", DOCS / "gallery" / "python"
PAGES = sorted(page for page in DOCS.rglob("*.md") if not any(folder in page.parents for folder in MADE))
MEASURED = DOCS / "benchmarks"
WHEN = r"\b([Uu]se|[Rr]ead|[Ll]ook|[Cc]ome|[Ff]ind|[Ss]tart|[Ww]ork|[Ww]hen|default|minutes)\b"


def path_of(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


def listed(page: Path) -> set[Path]:
    """Return the pages of the toctrees of a page."""
    pages: set[Path] = set()
    for block in re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text(), flags=re.DOTALL | re.MULTILINE):
        for line in block.splitlines():
            if line and not line.startswith(":"):
                pages |= set(page.parent.glob(f"{line}.md"))
    return pages


def prose(page: Path) -> str:
    """Return the text of a page without code, tables and comments."""
    return re.sub(r"```.*?```|^\|.*?$|<!--.*?-->", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)


def test_every_page_can_be_reached_from_the_start() -> None:
    reached, linked = set(), {DOCS / "index.md"}
    while linked - reached:
        page = (linked - reached).pop()
        reached.add(page)
        linked |= listed(page)
    assert [path_of(page) for page in PAGES if page not in reached] == []


@pytest.mark.parametrize("page", PAGES, ids=path_of)
def test_a_page_says_first_when_to_use_it(page: Path) -> None:
    title, *paragraphs = [part for part in re.split(r"\n\s*\n", prose(page)) if part.strip()]
    assert title.strip().startswith("# ")
    assert re.search(WHEN, paragraphs[0]), paragraphs[0]


def test_pages_are_short() -> None:
    words = {page: len(page.read_text().split()) for page in PAGES}
    assert median(words.values()) < 800
    generated = {*(DOCS / "reference" / "commands").iterdir(), DOCS / "development" / "blocking.md"}
    long = [page for page, n in words.items() if n > 1500 and page not in generated]
    assert [path_of(page) for page in long if MEASURED not in page.parents] == []


@pytest.mark.parametrize("page", sorted((DOCS / "theory").glob("[!i]*.md")), ids=path_of)
def test_theory_has_a_drawing_its_failures_and_its_source(page: Path) -> None:
    text = page.read_text()
    if page.stem not in ("paper-models", "physics-informed"):  # their results are under benchmarks
        assert "](../img/" in text
        assert re.search(r"(?i)when (it|they) fails?", text)
        assert re.search(r"Source|Code:|\(\d{4}\)", text)


def test_pictures_are_small() -> None:
    pictures = [path for path in DOCS.rglob("*") if path.suffix in (".png", ".svg", ".jpg", ".webp")]
    kept = [path for path in pictures if not any(folder in path.parents for folder in MADE)]
    assert sum(path.stat().st_size for path in kept) < 3 * 2**20
    for name in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", (ROOT / "README.md").read_text()):
        assert (ROOT / name).stat().st_size < 200_000


def parameters(function: object) -> set[str]:
    """Return the names of the section Parameters of a numpydoc docstring."""
    section = (inspect.getdoc(function) or "").partition("Parameters\n----------\n")[2].split("\n\n")[0]
    heads = [line.partition(" : ")[0] for line in section.splitlines() if not line.startswith(" ")]
    return {name.strip("* ") for head in heads for name in head.split(",")}


FUNCTIONS = [n for n in meshonet.__all__ if inspect.isfunction(getattr(meshonet, n))]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_documents_its_parameters_and_what_it_returns(name: str) -> None:
    function = getattr(meshonet, name)
    doc = inspect.getdoc(function) or ""
    signature = inspect.signature(function)
    assert "as of `grid`" in doc or parameters(function) == set(signature.parameters)
    if signature.return_annotation not in (None, "None"):
        assert re.search(r"^(Returns|Yields)\n-+$", doc, flags=re.MULTILINE)
    if signature.parameters:
        assert re.search(r"^Raises\n-+$", doc, flags=re.MULTILINE)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_types_its_parameters_and_has_an_example(name: str) -> None:
    """Examples run with the doctests; here they are there."""
    doc = inspect.getdoc(getattr(meshonet, name)) or ""
    assert re.search(r"^Examples\n-+\n(.+\n)*?>>> ", doc, flags=re.MULTILINE)
    section = doc.partition("Parameters\n----------\n")[2].split("\n\n")[0]
    heads = [line for line in section.splitlines() if not line.startswith((" ", "*", "shape, res"))]
    assert not [head for head in heads if not re.fullmatch(r"[\w, ]+ : .+", head)]


@pytest.mark.parametrize("name", meshonet.__all__[1:])
def test_the_reference_lists_every_public_name(name: str) -> None:
    assert re.search(rf"\b{name}\b", (DOCS / "reference" / "api.md").read_text())
