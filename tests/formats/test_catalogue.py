from __future__ import annotations

from pathlib import Path

from meshonet.formats.catalogue import page, plain, rows
from meshonet.formats.registry import TABLE

DOCS = Path(__file__).parents[2] / "docs"


def test_the_page_is_current() -> None:
    assert (DOCS / "formats.md").read_text(encoding="utf-8") == page(), "run: make docs"


def test_every_format_has_its_row() -> None:
    assert [row["format"] for row in rows()] == list(TABLE)
    assert len(plain().splitlines()) == len(TABLE) + 1
    told = {row["format"]: row for row in rows()}
    assert (told["cgns"]["reads"], told["cgns"]["names"], told["cgns"]["3D"]) == ("grids", "yes", "yes")
    assert (told["su2"]["reads"], told["su2"]["writes"]) == ("boundaries", "grids")
    assert told["hdf5"]["writes"] == "grids, boundaries"
    assert (told["png"]["3D"], told["vtu"]["names"]) == ("", "")
