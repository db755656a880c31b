"""A dataset of a million grids in parts: memory while it is made, its files, and how fast samples are read.

    python benchmarks/bench_datasets.py [--members 1000000] [--page docs/benchmarks/datasets.md]

The grids are tiny and computed in no time; what is measured is everything else that a batch does, in one
process: inputs, digests, parts, reports, the index. Samples are read by fresh processes of h5py alone.
"""

import json
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from itertools import starmap
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from page import arguments, publish

from meshonet.formats.hdf5.parts import PartFiles
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.families.draw import draws
from meshonet_cli.batch.drawn import DrawnInputs
from meshonet_cli.batch.item import Item, Pair, attempted
from meshonet_cli.batch.parts import (
    PartDone,
    PartMaker,
    PartTask,
    deliver_parts,
)
from meshonet_cli.report.delivered import delivered
from meshonet_cli.tasks.boundaries import itself
from meshonet_cli.terminal.session import Session

HEAD = """# Datasets of a million grids

<!-- made by python benchmarks/bench_datasets.py --page docs/benchmarks/datasets.md -->

Read this page before you generate a dataset of very many grids. It gives the memory and the time to generate
a million grids, and the time to read a sample. Times are wall-clock times of one process. Other programs ran
during some measurements.

A large dataset consists of files called *parts* and of an *index file*, which presents all parts as one HDF5
file ([large datasets](../guide/datasets.md)). Each grid here has only 5 x 4 nodes and is made without a
solver.
"""
READING = """
## Reading

A new process opens the index file with h5py, reads the nodes of one sample, then its name. Times are medians
of {repeats} processes, with the maximum in brackets.
"""
PARTS = """
## Number of parts

Each part has ten grids. *open* and *read* are times of a new process that reads the nodes of the last sample;
medians of five processes.
"""
ZARR = """
## Comparison with Zarr

The nodes of 200,000 grids are stored in 200 files, by HDF5 as parts with an index file, by Zarr as shards.
*import*, *open* and *read* are times of a new process that reads the last grid; medians of five processes.
"""
TAIL = """
## Conclusions

- **Memory** does not grow with the number of grids: 63 MB after 100,000 grids, 64 MB after a million.
- **Writing** takes 0.3 ms per grid. The index file of 1,000 parts takes 4 s.
- **Reading** the nodes of a sample takes 5 ms with 1,000 parts and 46 ms with 10,000 parts. By default a part
  has 1,000 grids, or fewer if it would exceed 256 MiB.
- **Zarr** takes 1.6 ms to read a sample from 200 files, HDF5 0.6 ms.
"""
READER = """
import json, sys, time, h5py
path, k = sys.argv[1], int(sys.argv[2])
begun = time.perf_counter()
file = h5py.File(path)
opened = time.perf_counter()
nodes = file["nodes"][k]
read = time.perf_counter()
name = file["names"].asstr()[k]
named = time.perf_counter()
times = [opened - begun, read - opened, named - read]
print(json.dumps({"name": name, "corner": nodes[-1, -1].tolist(), "ms": [1e3 * t for t in times]}))
""".lstrip()  # no text of the page
COLUMN_READER = """
import json, sys, time
path, package, k = sys.argv[1], sys.argv[2], int(sys.argv[3])
begun = time.perf_counter()
module = __import__(package)
imported = time.perf_counter()
nodes = module.File(path)["nodes"] if package == "h5py" else module.open_group(path, mode="r")["nodes"]
opened = time.perf_counter()
corner = float(nodes[k][-1, -1, 0])
read = time.perf_counter()
times = [imported - begun, opened - imported, read - opened]
print(json.dumps({"corner": corner, "ms": [1e3 * t for t in times]}))
""".lstrip()  # no text of the page
NI, NJ = 5, 4


@dataclass(frozen=True)
class Tiny:
    """Makes tiny grids, each another one, and reports of them."""

    def __call__(self, todo: Iterable[Item[Any]]) -> Iterator[Pair]:
        """Yield each member with grid and report."""
        for item in todo:
            grid = tiny(item.what.index)
            named = item.without_content()
            yield named, (grid, delivered(named, grid, {}))


def tiny(number: int) -> Grid:
    """Return the grid of a number, which is the x of its last corner."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0 + number, NI), np.linspace(0.0, 1.0, NJ), indexing="ij")
    provenance = {"software": "meshonet", "command": "meshonet infer @list.txt --res 5x4"}
    return Grid.from_nodes(np.stack([x, y], axis=-1), "quad", name=f"grid-{number}", provenance=provenance)


def resident() -> float:
    """Return the MB of memory that this process has now."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 1e6


def make(index: Path, members: int, size: int, watched: list[float]) -> dict[str, float]:
    """Make a dataset and return figures; `watched` gets the memory after each tenth."""
    files = PartFiles(index, "tiny", size)
    inputs = DrawnInputs(draws("arch", members))
    maker = PartMaker(files, "grids", itself, Tiny())
    begun = time.perf_counter()
    marks = {max(1, members // size) * tenth // 10 for tenth in range(1, 11)}

    def outcomes() -> Iterator[tuple[PartTask, PartDone | Exception]]:
        for part, done in attempted(maker, starmap(PartTask, inputs.parts(size))):
            yield part, done
            if part.number + 1 in marks:
                watched.append(resident())

    session = Session(quiet=True)
    deliver_parts(outcomes(), files, session, session.written, skip_existing=False, whole=True)
    total = time.perf_counter() - begun
    begun = time.perf_counter()
    files.build()
    sizes = [path.stat().st_size for path in files.folder.iterdir()]
    return {
        "seconds": total, "index_seconds": time.perf_counter() - begun, "parts": len(sizes),
        "largest": max(sizes) / 1e6, "all": sum(sizes) / 1e6, "index": index.stat().st_size / 1e6,
    }  # fmt: skip


def read(index: Path, number: int, repeats: int) -> list[list[float]]:
    """Return milliseconds to open, to read nodes, and to read a name, of fresh processes."""
    rows = []
    for _ in range(repeats):
        command = [sys.executable, "-c", READER, str(index), str(number)]
        answer = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
        assert answer["name"] == f"grid-{number}"
        assert answer["corner"] == [1.0 + number, 1.0]
        rows.append(answer["ms"])
    return rows


def reading_rows(index: Path, numbers: Iterable[int], repeats: int) -> Iterator[str]:
    """Yield a row of a table for each sample."""
    for number in numbers:
        times = np.array(read(index, number, repeats))
        cells = (f"{statistics.median(column):.1f} ({max(column):.1f})" for column in times.T)
        yield f"| {number:,} | {' | '.join(cells)} |"


def parts_row(folder: Path, parts: int) -> str:
    """Return a row for an index over so many parts."""
    index = folder / f"parts{parts}.h5"
    figures = make(index, 10 * parts, 10, [])
    times = np.median(read(index, 10 * parts - 1, 5), axis=0)
    return (
        f"| {parts:,} | {figures['index_seconds']:.2f} | {figures['index']:.2f} | {times[0]:.1f} | "
        f"{times[1]:.1f} |"
    )


def write_zarr(path: Path, parts: int, size: int) -> None:
    """Write columns of nodes, the number of the part everywhere, as shards of Zarr."""
    import zarr

    shape = (NI, NJ, 2)
    settings = {"chunks": (50, *shape), "shards": (size, *shape), "compressors": None}
    nodes = zarr.open_group(path, mode="w").create_array(
        "nodes", shape=(parts * size, *shape), dtype="f8", **settings
    )
    for k in range(parts):
        nodes[k * size : (k + 1) * size] = np.full((size, *shape), float(k))


def write_hdf5(path: Path, parts: int, size: int) -> None:
    """Write the same as parts of HDF5 and a virtual dataset."""
    import h5py

    shape = (NI, NJ, 2)
    layout = h5py.VirtualLayout((parts * size, *shape), "f8")
    for k in range(parts):
        part = path.with_name(f"part-{k}.h5")
        with h5py.File(part, "w") as file:
            data = file.create_dataset("nodes", (size, *shape), "f8", chunks=(50, *shape))
            data[:] = np.full((size, *shape), float(k))
        layout[k * size : (k + 1) * size] = h5py.VirtualSource(part.name, "nodes", (size, *shape), "f8")
    with h5py.File(path, "w") as file:
        file.create_virtual_dataset("nodes", layout)


def beside_zarr(parts: int = 200, size: int = 1000) -> Iterator[str]:
    """Yield the lines of the comparison with Zarr."""
    if find_spec("zarr") is None:
        return
    yield ZARR
    yield "| library | write, µs per grid | import, ms | open, ms | read, ms |"
    yield "| --- | --- | --- | --- | --- |"
    with TemporaryDirectory() as name:
        for title, package, write in (("HDF5", "h5py", write_hdf5), ("Zarr", "zarr", write_zarr)):
            path = Path(name) / f"out.{package}"
            begun = time.perf_counter()
            write(path, parts, size)
            seconds = time.perf_counter() - begun
            command = [sys.executable, "-c", COLUMN_READER, str(path), package, str(parts * size - 1)]
            answers = [
                json.loads(subprocess.run(command, capture_output=True, check=True).stdout) for _ in range(5)
            ]
            assert {answer["corner"] for answer in answers} == {parts - 1.0}
            times = np.median([answer["ms"] for answer in answers], axis=0)
            cells = " | ".join(f"{each:.1f}" for each in times)
            yield f"| {title} {version(package)} | {1e6 * seconds / (parts * size):.1f} | {cells} |"


def page(members: int, size: int, repeats: int, parts: Iterable[int]) -> str:
    """Return the page."""
    watched: list[float] = []
    with TemporaryDirectory() as name:
        index = Path(name) / "out.h5"
        figures = make(index, members, size, watched)
        numbers = (0, members // 2, members - 1)
        lines = [
            "", "| quantity | value |", "| --- | --- |",
            f"| grids | {members:,} |",
            f"| parts, with {size:,} grids each | {figures['parts']:,} |",
            f"| time in total | {figures['seconds']:.0f} s |",
            f"| time per grid | {1e6 * figures['seconds'] / members:.0f} µs |",
            f"| memory of the process after a tenth of the grids | {watched[0]:.0f} MB |",
            f"| memory of the process at the end | {watched[-1]:.0f} MB |",
            f"| size of the largest part | {figures['largest']:.2f} MB |",
            f"| size of all parts together | {figures['all']:.0f} MB |",
            f"| time to write the index file | {figures['index_seconds']:.1f} s |",
            f"| size of the index file | {figures['index']:.2f} MB |",
            READING.format(repeats=repeats),
            "| sample number | open file, ms | read nodes, ms | read name, ms |", "| --- | --- | --- | --- |",
            *reading_rows(index, numbers, repeats), PARTS,
            "| parts | write index file, s | size of index file, MB | open, ms | read, ms |",
            "| --- | --- | --- | --- | --- |",
            *(parts_row(Path(name), count) for count in parts), *beside_zarr(),
        ]  # fmt: skip
    return HEAD + "\n".join(lines) + "\n" + TAIL


def main() -> None:
    """Print the page, or write it."""
    parser = arguments(__doc__)
    parser.add_argument("--members", type=int, default=1_000_000)
    parser.add_argument("--part-size", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=9)
    parser.add_argument("--parts", type=int, nargs="*", default=[100, 1000, 3000, 10_000])
    options = parser.parse_args()
    text = page(options.members, options.part_size, options.repeats, options.parts)
    publish(text, options.page)


if __name__ == "__main__":
    main()
