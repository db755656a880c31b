"""The gallery of domains: its script draws, and its table is that of today's grids."""

from pathlib import Path

import make_gallery
import pytest

TABLE = Path(__file__).parents[1] / "docs" / "benchmarks" / "domains.md"


def test_the_script_draws_domains_and_the_page_has_their_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = make_gallery.examples().write_all(tmp_path)[: make_gallery.PICTURE]
    monkeypatch.setattr(make_gallery, "DOCS", tmp_path)
    (tmp_path / "img").mkdir()
    rows: list[str] = []
    make_gallery.montage(files, 1, rows)
    assert (tmp_path / "img" / "gallery-1.png").stat().st_size
    assert set(rows) <= set(TABLE.read_text(encoding="utf-8").splitlines()), "run make gallery"
