"""Faces of STEP and B-rep files, read by Open Cascade (https://dev.opencascade.org)."""

import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from meshonet.formats.cad.topology import model_of, open_edges
from meshonet.formats.source import Source
from meshonet.geometry.cad.model import CadModel
from meshonet.geometry.errors import InputError

_MOST_BYTES = 1 << 28  # largest CAD file in bytes; reading takes some 10 times as much memory
_MILLIMETRES = {
    "millimetre": 1.0, "centimetre": 10.0, "metre": 1000.0, "inch": 25.4, "foot": 304.8, "micrometre": 1e-3,
}  # fmt: skip
"""Units of length as STEP files name them."""
SECONDS, _BYTES_PER_SECOND = 60.0, 1e5
"""Time limit for reading a file: seconds, and the number of bytes that extend it by a second."""
_SEWN = 1e-6  # largest distance at which edges of separate faces are joined, relative to the model's extent


def read_models(source: Source, *, kind: str) -> Iterator[CadModel]:
    """Yield the CAD model of a file; `kind` is its format, ``STEP`` or ``B-rep`` (of Open Cascade).

    Raises InputError if Open Cascade is not installed, the file has another format, or it has no faces.
    """
    try:
        from OCP.Message import Message
    except ImportError:
        problem = "needs the package cadquery-ocp-novtk"
        raise InputError(problem, "install it: pip install 'meshonet[cad]'") from None

    data = source.bytes_below(_MOST_BYTES, "a CAD file")
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):  # it writes to standard output, where reports go
        messenger.RemovePrinter(printer)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "part")
        path.write_bytes(data)
        notes: list[str] = []
        try:
            shape, *notes = _READERS[kind](str(path)) if _is_readable(path, kind) else (None,)
        except Exception:  # whatever a damaged file makes of it
            shape = None
    if shape is None or shape.IsNull():
        raise InputError(f"is no {kind} file that can be read", f"export it again as {kind}")
    shape, *sewn = _sewn(shape)
    yield model_of(shape, source.stem, (*notes, *sewn))


def _is_readable(path: Path, kind: str) -> bool:
    """Return whether Open Cascade can read a file; with a damaged file it may hang or end the process."""
    command = [sys.executable, "-m", __name__, kind, str(path)]
    seconds = SECONDS + path.stat().st_size / _BYTES_PER_SECOND
    try:
        return subprocess.run(command, timeout=seconds, capture_output=True, check=False).returncode == 0  # noqa: S603 - this module
    except subprocess.TimeoutExpired:
        return False


def _step_shape(path: str) -> tuple[Any, ...]:
    """Return the shape in the unit of the file, or None, and at most one note."""
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return (None,)
    units = _units(reader)
    known = len(units) == 1 and units[0] in _MILLIMETRES
    if known:
        reader.SetSystemLengthUnit(_MILLIMETRES[units[0]])
    shape = reader.OneShape() if reader.TransferRoots() else None
    which = "several units of length" if len(units) > 1 else "an unknown unit of length"
    return (shape,) if known else (shape, f"the file has {which}: coordinates are in millimetres")


def _units(reader: Any) -> list[str]:
    from OCP.collections import Sequence_TCollection_AsciiString as Names

    names, *others = Names(), Names(), Names()
    reader.FileUnits(names, *others)
    return sorted({names.Value(k).ToCString().lower() for k in range(1, names.Length() + 1)})


def _brep_shape(path: str) -> tuple[Any, ...]:
    from OCP.BRep import BRep_Builder
    from OCP.BRepTools import BRepTools
    from OCP.TopoDS import TopoDS_Shape

    shape = TopoDS_Shape()
    return (shape if BRepTools.Read_s(shape, path, BRep_Builder()) else None,)


def _sewn(shape: Any) -> tuple[Any, ...]:
    """Return a shape whose separate faces share their edges, and a note if they did not."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing

    free = open_edges(shape)
    if not free:
        return (shape,)
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    low, high = box.CornerMin(), box.CornerMax()
    size = max(high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z())
    sewing = BRepBuilderAPI_Sewing(_SEWN * size)
    sewing.Add(shape)
    sewing.Perform()
    joined = sewing.SewedShape()
    left = open_edges(joined)
    if joined.IsNull() or left >= free:
        return (shape,)
    return joined, f"{free - left} edges of separate faces were joined; {left} edges are open"


_READERS = {"STEP": _step_shape, "B-rep": _brep_shape}

if __name__ == "__main__":
    _, kind_of_file, file = sys.argv
    sys.exit(_READERS[kind_of_file](file)[0] is None)
