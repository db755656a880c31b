from meshonet.formats.catalogue import rows
from meshonet.formats.registry import TABLE


def test_every_format_has_its_row() -> None:
    assert [row["format"] for row in rows()] == list(TABLE)
    message = {row["format"]: row for row in rows()}
    assert (message["cgns"]["reads"], message["cgns"]["names"], message["cgns"]["3D"]) == (
        "grids", "yes", "volumes, surfaces",
    )  # fmt: skip
    assert (message["su2"]["reads"], message["su2"]["writes"]) == ("boundaries", "grids")
    assert message["hdf5"]["writes"] == "grids, boundaries"
    assert (message["png"]["3D"], message["vtu"]["names"]) == ("", "")
    assert [message[name]["blocks"] for name in ("cgns", "su2", "vts")] == ["kept", "merged", ""]
