"""One word for one thing: no two classes have one name; names are nouns."""

import io
import re
import tokenize
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("geometry", "formats", "solvers", "meshonet_cli", "meshonet/api", "kernels")
EVERYWHERE = (*ROOMS, "meshonet", "tests", "benchmarks", "examples", "docs")
NOT_NOUNS = {"told", "found", "unasked"}


@cache
def classes() -> dict[str, list[str]]:
    """Return the modules of each class name, from the sources."""
    modules: dict[str, list[str]] = defaultdict(list)
    for path in sorted(path for room in ROOMS for path in (ROOT / room).rglob("*.py")):
        for name in set(re.findall(r"^ *class (\w+)[:([]", path.read_text(), re.MULTILINE)):
            modules[name].append(str(path.relative_to(ROOT)))
    return modules


def test_a_class_name_stands_in_one_module() -> None:
    twice = {name: modules for name, modules in classes().items() if len(modules) > 1}
    assert not twice, "give one of them a name of its own"


def test_the_classes_are_seen() -> None:
    modules = classes()
    assert modules["Grid"] == ["geometry/blocks/grid.py"]
    assert len(modules) > 300


def names(text: str) -> set[str]:
    return {
        token.string
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.NAME
    }


def test_variables_have_nouns_for_names() -> None:
    """`told` and `found` do not say what a value is."""
    assert names("found = 1  # not found") == {"found"}
    texts = {path: path.read_text() for room in EVERYWHERE for path in (ROOT / room).rglob("*.py")}
    suspects = {path: text for path, text in texts.items() if any(word in text for word in NOT_NOUNS)}
    used = {str(path.relative_to(ROOT)): names(text) & NOT_NOUNS for path, text in suspects.items()}
    assert not {path: words for path, words in used.items() if words}
