"""Model files: safetensors with a header that describes the model, checked when read."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Topology
from meshonet.geometry.errors import InputError

HEADER = "meshonet"  # the metadata entry that holds the header as JSON
LARGEST_BYTES = 64 * 1024 * 1024  # a larger file is not one of ours

OURS = "use a file made by meshonet train"  # remedy for a file that is no model


class Kind(NamedTuple):
    """A kind of model file, recognised by two entries of its header."""

    text: str  # value of the entry ``kind``
    key: str  # name of the other entry
    version: int  # value of the other entry


# the version changes with the meaning of the arrays
STRIP = Kind("meshonet strip operator", "encoding", 1)
QUAD = Kind("meshonet quad operator", "encoding", 2)
PAPER = Kind("meshonet operator", "version", 1)
VOLUME = Kind("meshonet volume network", "version", 1)
KINDS = {kind.text: kind for kind in (STRIP, QUAD, PAPER, VOLUME)}  # by their text


def read_model(path: Path) -> tuple[Kind, dict[str, Any], dict[str, NDArray[Any]]]:
    """Return the kind, the header and the arrays of a model file.

    Raises InputError if the file is no model of this version of meshonet, or if an array is not finite.
    """
    header, arrays = read_tensors(path)
    kind = KINDS.get(str(header.get("kind")))
    if kind is None or header.get(kind.key) != kind.version:
        shown = f"it holds {str(header.get('kind'))[:60]!r}"
        shown += f", {kind.key} {str(header.get(kind.key))[:20]}" if kind else ""
        raise InputError(shown, "use a file made by this version's meshonet train", source=str(path))
    return kind, header, arrays


def read_tensors(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Return header and arrays of a safetensors file. Raises InputError for other files, NaN or inf."""
    from safetensors import SafetensorError, safe_open

    source = str(path)
    if path.stat().st_size > LARGEST_BYTES:
        raise InputError(f"it is larger than {LARGEST_BYTES >> 20} MiB", OURS, source=source)
    try:
        with safe_open(path, framework="numpy") as file:
            header = json.loads((file.metadata() or {}).get(HEADER, "{}"))
            arrays = {key: file.get_tensor(key) for key in file.keys()}  # noqa: SIM118 - not a mapping
    except (SafetensorError, OSError, ValueError, TypeError, RecursionError) as error:
        raise InputError(f"not a safetensors file ({error})", OURS, source=source) from None
    if not isinstance(header, dict):
        raise InputError("its header is not an object", OURS, source=source)
    for key, array in arrays.items():
        if not np.issubdtype(array.dtype, np.floating) or not np.isfinite(array).all():
            raise InputError(f"array {key!r} is not finite floating point", "train it again", source=source)
    return header, arrays


def write_model(
    path: Path, kind: Kind, arrays: Mapping[str, NDArray[Any]], name: str, topology: Topology, *,
    recipe: Mapping[str, Any], figures: Mapping[str, Any], **facts: Any,
) -> None:  # fmt: skip
    """Write a model file for `read_model`, whole or not at all; each array keeps its precision.

    `recipe` has training settings, `figures` error measures on held-out shapes, `facts` other header entries.
    """
    from safetensors.numpy import save

    header = {"kind": kind.text, kind.key: kind.version, "name": name, "topology": topology, **facts}
    header |= {"recipe": dict(recipe), "figures": dict(figures)}
    # safetensors takes an array's memory as it lies: C order, or it comes back scrambled
    tensors = {key: np.ascontiguousarray(value) for key, value in arrays.items()}
    part = path.with_name(path.name + ".part")
    # one entry: safetensors writes several in an order that changes from run to run
    part.write_bytes(save(tensors, metadata={HEADER: json.dumps(header, sort_keys=True)}))
    part.replace(path)
