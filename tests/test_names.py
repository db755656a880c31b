"""One word for one thing: no two classes have one name, unless a reason for it is written down."""

import re
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOMS = ("geometry", "formats", "solvers", "meshonet_cli", "meshonet/api", "kernels")
PAGE = ROOT / "docs" / "development" / "architecture.md"


@cache
def classes() -> dict[str, list[str]]:
    """Return the modules of each class name, from the sources."""
    modules: dict[str, list[str]] = defaultdict(list)
    for path in sorted(path for room in ROOMS for path in (ROOT / room).rglob("*.py")):
        for name in set(re.findall(r"^ *class (\w+)[:([]", path.read_text(), re.MULTILINE)):
            modules[name].append(str(path.relative_to(ROOT)))
    return modules


def excused() -> set[str]:
    """Return the names that the page on architecture gives a reason for: | `Name` | modules | reason |."""
    table = PAGE.read_text().partition("## Classes of one name")[2].partition("\n## ")[0]
    return {match[1] for match in re.finditer(r"^\| `(\w+)` \|[^|]+\|[^|]*\w[^|]*\|$", table, re.MULTILINE)}


def test_a_class_name_stands_in_one_module() -> None:
    twice = {name: modules for name, modules in classes().items() if len(modules) > 1}
    unexcused = {name: modules for name, modules in twice.items() if name not in excused()}
    assert not unexcused, f"give one of them a name of its own: {unexcused}"


def test_reasons_are_for_names_that_do_stand_twice() -> None:
    assert excused() <= {name for name, modules in classes().items() if len(modules) > 1}


def test_the_classes_are_seen() -> None:
    modules = classes()
    assert modules["Grid"] == ["geometry/blocks/grid.py"]
    assert len(modules) > 300
