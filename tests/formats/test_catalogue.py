from __future__ import annotations

from meshonet.formats.catalogue import plain, rows
from meshonet.formats.registry import TABLE


def test_every_format_has_its_row() -> None:
    assert [row["format"] for row in rows()] == list(TABLE)
    assert len(plain().splitlines()) == len(TABLE) + 1
    told = {row["format"]: row for row in rows()}
    assert (told["cgns"]["reads"], told["cgns"]["names"], told["cgns"]["3D"]) == (
        "grids", "yes", "volumes, surfaces",
    )  # fmt: skip
    assert (told["su2"]["reads"], told["su2"]["writes"]) == ("boundaries", "grids")
    assert told["hdf5"]["writes"] == "grids, boundaries"
    assert (told["png"]["3D"], told["vtu"]["names"]) == ("", "")
    assert [told[name]["blocks"] for name in ("cgns", "su2", "vts")] == ["kept", "merged", ""]
