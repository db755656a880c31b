"""What is kept of a golden command, and how two records differ.

A record has numbers (exit code, figures and facts of the JSON, hashes of arrays and files), words (messages,
notes, tables) and the arrays behind the hashes. Seconds, dates, versions, command lines and paths are left
out.

    record = record_of(run, tree)
    for difference in differences(before, after, tolerance=1e-10): print(difference)
"""

import hashlib
import io
import json
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

import h5py
import numpy as np
from golden_runs import Run
from numpy.typing import NDArray

HDF5_HEAD = b"\x89HDF\r\n\x1a\n"
SECONDS = {"seconds", "times"}
WORDS = {"notes", "error", "input", "output", "file", "recipe"}
"""Keys of the JSON whose values are words."""
TIES = {"worst", "worst_cells", "cycles"}
"""Keys whose values may jump when the last bits change; with a tolerance they count as words."""
SCRUBBED = (
    (rb'<Array type="String" Name="provenance".*?</Array>', b"PROVENANCE"),  # VTK XML
    (rb"provenance 1 \d+ unsigned_char\n.*?(?=\nDIMENSIONS)", b"PROVENANCE"),  # legacy VTK
    (rb'\{[^{}]*"software": "meshonet[^{}]*\}', b"PROVENANCE"),
    (rb"meshonet \d+(\.\d+)+\S*", b"meshonet VERSION"),
    (rb"(?i)(by meshio v[\d.]+?), \d{4}-\d\d-\d\dT[\d:.]+", rb"\1"),
    (rb"\b\d+(\.\d+)?(e[-+]\d+)? (ms|s)\b", b"TIME"),
)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w.])")


@dataclass
class Record:
    """What is kept of one command, each entry under the place where it was found."""

    numbers: dict[str, Any] = field(default_factory=dict)
    words: dict[str, str] = field(default_factory=dict)
    arrays: dict[str, NDArray[np.float64]] = field(default_factory=dict)

    def add_array(self, place: str, values: Any) -> None:
        """Keep an array and its hash."""
        array = np.ascontiguousarray(values, np.float64)
        self.arrays[place] = array
        self.numbers[place] = f"{'x'.join(map(str, array.shape))} {_hash(array.tobytes())}"


class Difference(NamedTuple):
    """One difference: `failed` (numbers), `within` (numbers, within the tolerance) or `words`."""

    kind: Literal["failed", "within", "words"]
    text: str


def record_of(run: Run, tree: Path) -> Record:
    """Return the record of what a command left."""
    record = Record()
    record.numbers["exit"] = run.exit
    for name, path in run.files():
        _add_file(record, name, path.read_bytes(), tree)
    _add_stdout(record, run.stream("stdout"), tree)
    record.words["stderr"] = _text(scrubbed(run.stream("stderr"), tree))
    return record


def scrubbed(data: bytes, tree: Path) -> bytes:
    """Return `data` without versions, command lines, dates, durations and the place of the checkout."""
    for path in {str(tree), str(tree.resolve())}:
        data = data.replace(path.encode(), b"TREE")
    for pattern, word in SCRUBBED:
        data = re.sub(pattern, word, data, flags=re.DOTALL)
    return data


# --- files


def _add_file(record: Record, name: str, data: bytes, tree: Path) -> None:
    if data.startswith(HDF5_HEAD):
        with h5py.File(io.BytesIO(data), "r") as file:
            _add_hdf5(record, name, file, tree)
    elif name.endswith(".safetensors"):  # the header tells of seconds and versions
        start = 8 + int.from_bytes(data[:8], "little")
        record.numbers[name] = _hash(data[start:])
    elif name.endswith(".csv"):
        record.add_array(name, _without_seconds(data.decode()))
    elif b"\0" in data:
        record.numbers[name] = f"{len(scrubbed(data, tree))} bytes {_hash(scrubbed(data, tree))}"
    else:
        _add_text(record, name, scrubbed(data, tree).decode("utf-8", "replace"))


def _add_text(record: Record, name: str, text: str) -> None:
    """Keep the hash of a text with its numbers left out, and the numbers."""
    record.numbers[f"{name}: text"] = _hash(NUMBER.sub("#", text).encode())
    record.add_array(f"{name}: numbers", [float(number) for number in NUMBER.findall(text)])


def _without_seconds(text: str) -> list[list[float]]:
    """Return the columns of a table that are numbers and no seconds."""
    head, *rows = (line.split(",") for line in text.splitlines())
    kept = [k for k, word in enumerate(head) if not word.startswith("seconds")]
    return [[_float(row[k]) for k in kept] for row in rows]


def _float(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan


def _add_hdf5(record: Record, name: str, file: h5py.File, tree: Path) -> None:
    for key in ("format", "version", "topology"):
        if key in file.attrs:
            record.numbers[f"{name}: {key}"] = str(file.attrs[key])

    def visit(place: str, item: Any) -> None:
        if not isinstance(item, h5py.Dataset):
            return
        if item.dtype.kind == "f":
            record.add_array(f"{name}: {place}", item[()])
        elif "provenance" in place:
            record.words[f"{name}: {place}"] = _text(scrubbed(_content(item), tree))
        else:
            record.numbers[f"{name}: {place}"] = f"{item.shape} {_hash(_content(item))}"

    file.visititems(visit)


def _content(dataset: h5py.Dataset) -> bytes:
    """Return texts line by line, and anything else as its bytes (the texts of CGNS are arrays of bytes)."""
    values = dataset[()]
    return b"\n".join(values.ravel()) if dataset.dtype.kind == "O" else np.asarray(values).tobytes()


# --- standard output


def _add_stdout(record: Record, data: bytes, tree: Path) -> None:
    if data.startswith(HDF5_HEAD):
        _add_file(record, "stdout", data, tree)
        return
    text = _text(scrubbed(data, tree))
    try:
        objects = [json.loads(line) for line in text.splitlines()]
    except ValueError:
        objects = []
    if not objects:
        record.words["stdout"] = text
    for k, value in enumerate(objects):
        _add_json(record, f"stdout[{k}]", value, worded=False)


def _add_json(record: Record, place: str, value: Any, *, worded: bool) -> None:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key not in SECONDS:
                _add_json(record, f"{place}.{key}", inner, worded=worded or key in WORDS)
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            _add_json(record, f"{place}[{k}]", inner, worded=worded)
    elif worded:
        record.words[place] = str(value)
    else:
        record.numbers[place] = value


# --- comparing


def differences(before: Record, after: Record, tolerance: float) -> Iterator[Difference]:
    """Yield what differs: what is gone or other has failed, what is new counts as words.

    If the exit codes differ, only these are listed, with the last line of messages.
    """
    ends = [f"{one.numbers['exit']} {_last_line(one)}" for one in (before, after)]
    if before.numbers["exit"] != after.numbers["exit"]:
        yield Difference("failed", f"exit code {ends[0]} became {ends[1]}")
        return
    for place, old in before.numbers.items():
        if place not in after.numbers:
            yield Difference("failed", f"{place} is gone (was {old})")
        elif not _same(old, after.numbers[place]):
            yield _difference(place, before, after, tolerance)
    for place in sorted(after.numbers.keys() - before.numbers.keys()):
        yield Difference("words", f"{place} is new ({after.numbers[place]})")
    for place in sorted(before.words.keys() | after.words.keys()):
        old, new = before.words.get(place, ""), after.words.get(place, "")
        if old != new:
            yield Difference("words", f"{place}: {_changed(old, new)}")


def _difference(place: str, before: Record, after: Record, tolerance: float) -> Difference:
    old, new = before.numbers[place], after.numbers[place]
    if place in before.arrays and place in after.arrays:
        largest, text = _array_difference(before.arrays[place], after.arrays[place])
    elif _is_float(old) and _is_float(new):
        largest = abs(old - new) / max(1.0, abs(old), abs(new))
        text = f"{old!r} became {new!r}"
    else:
        largest, text = math.inf, f"{old!r} became {new!r}"
    if largest <= tolerance:
        return Difference("within", f"{place}: {text}")
    tied = tolerance > 0 and not TIES.isdisjoint(re.split(r"[.\[]", place))
    return Difference("words" if tied else "failed", f"{place}: {text}")


def _array_difference(old: NDArray[np.float64], new: NDArray[np.float64]) -> tuple[float, str]:
    """Return the largest difference, relative to the extent of the old values, and what there is to tell."""
    if old.shape != new.shape:
        return math.inf, f"shape {old.shape} became {new.shape}"
    if not np.array_equal(np.isfinite(old), np.isfinite(new)):
        return math.inf, "values that are not finite differ"
    gap = np.abs(np.where(np.isfinite(old), new - old, 0.0))
    extent = float(np.ptp(old[np.isfinite(old)])) or 1.0
    k = np.unravel_index(int(gap.argmax()), gap.shape)
    largest = float(gap[k]) / extent
    largest_text = f"largest relative difference {largest:.3g} at {tuple(map(int, k))}"
    return largest, f"{largest_text}, {np.count_nonzero(gap)} of {gap.size} values differ"


def _is_float(value: Any) -> bool:
    """Say whether a value is a number that may differ a little; counts and flags may not."""
    return isinstance(value, float) and math.isfinite(value)


def _same(old: Any, new: Any) -> bool:
    both_nan = isinstance(old, float) and isinstance(new, float) and math.isnan(old) and math.isnan(new)
    return both_nan or (type(old) is type(new) and old == new)


def _last_line(record: Record) -> str:
    return record.words["stderr"].strip().rpartition("\n")[2][:150]


def _changed(old: str, new: str) -> str:
    """Return the first lines that differ, cut to a readable length."""
    for one, other in zip([*old.splitlines(), ""], [*new.splitlines(), ""], strict=False):
        if one != other:
            return f"{one[:150]!r} became {other[:150]!r}"
    return f"{len(old.splitlines())} lines became {len(new.splitlines())}"


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:32]
