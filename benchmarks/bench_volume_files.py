"""Volumes to files and back: processor seconds, bytes, and peak memory over that of the grid.

    python benchmarks/bench_volume_files.py [--nodes 129] [--formats plot3d,plot3d:binary,vts,...]

Each format works in a process of its own, in a temporary folder. Seconds are user and system time; `copy_s`
is what copying the nodes in memory takes. Memory is the peak resident set less that with the grid alone (when
read, without it), over the bytes of the grid.
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from meshonet.formats.registry import format_named, read_grids
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid

FORMATS = "plot3d,plot3d:binary,plot3d:fortran,plot3d:binary,float32,vts,vtk,hdf5"


def volume(nodes: int) -> Grid:
    """Return a skewed box whose numbers need all digits."""
    x, y, z = np.meshgrid(*(np.linspace(0, 1, nodes),) * 3, indexing="ij", sparse=True)
    coordinates = np.empty((3, nodes, nodes, nodes))
    coordinates[0] = x + 0.1 * np.sin(3 * y) * z
    coordinates[1] = y + 0.1 * np.cos(2 * z) * x
    coordinates[2] = z + 0.1 * x * y
    return Grid((Block(np.moveaxis(coordinates, 0, -1)),), name="box")


def peak() -> int:
    """Return the bytes that this process has had at the most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10


def measured(name: str, nodes: int, path: Path, *, read: bool) -> dict[str, float]:
    """Write, or read what was written, and return the figures."""
    record = format_named(name)
    figures = {}
    if not read:
        grid = volume(nodes)
        begun = time.process_time()
        grid.nodes.copy()
        figures["copy_s"] = time.process_time() - begun
        before, begun = peak(), time.process_time()
        assert record.write_grids is not None
        record.write_grids(path, [grid])
        figures |= {"write_s": time.process_time() - begun, "MB": path.stat().st_size / 1e6}
        figures["write_memory"] = (peak() - before) / grid.nodes.nbytes
        return figures
    before, begun = peak(), time.process_time()
    (grid,) = read_grids(str(path), record.name)
    figures["read_s"] = time.process_time() - begun
    figures["read_memory"] = (peak() - before) / grid.nodes.nbytes
    if "float32" not in name:
        assert np.array_equal(grid.nodes, volume(nodes).nodes)
    return figures


def main() -> None:
    """Print a line of JSON for each format."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, default=129)
    parser.add_argument("--formats", default=FORMATS)
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        name, path, what = options.one
        print(json.dumps(measured(name, options.nodes, Path(path), read=what == "read")))
        return
    names = options.formats.replace(",float", ";float").split(",")
    for name in (each.replace(";", ",") for each in names):
        figures: dict[str, object] = {"format": name, "nodes": options.nodes}
        with TemporaryDirectory() as folder:
            path = f"{folder}/g{format_named(name).suffixes[0]}"
            for what in ("write", "read"):
                words = [sys.executable, __file__, "--nodes", str(options.nodes), "--one", name, path, what]
                figures |= json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
        print(
            json.dumps({k: round(v, 3) if isinstance(v, float) else v for k, v in figures.items()}),
            flush=True,
        )


if __name__ == "__main__":
    main()
