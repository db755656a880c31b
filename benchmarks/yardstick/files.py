"""Files of boundaries and of grids: HDF5 with a few arrays, or folders of Plot3D files."""

from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np

from yardstick.shapes import Floats, Shape

SIDES = ("south", "north", "west", "east")


def write_boundaries(path: Path, shapes: Sequence[Shape]) -> None:
    """Write shapes of one topology and size: to a file if `path` ends in .h5, else to a folder of .xyz files.

    A .h5 file has the arrays south and north (n, ni, 2), west and east (n, nj, 2) and names (n,). A .xyz file
    is 2D ASCII Plot3D with four blocks, the sides, of ni x 1 and 1 x nj nodes.
    """
    if path.suffix == ".h5":
        with h5py.File(path, "w") as file:
            file.attrs.update(format="meshonet-boundary", version=1, topology=shapes[0].topology)
            for side in SIDES:
                file[side] = np.array([getattr(shape, side) for shape in shapes])
            file["names"] = [shape.name for shape in shapes]
        return
    path.mkdir(parents=True, exist_ok=True)
    for shape in shapes:
        blocks = [getattr(shape, side) for side in SIDES]
        blocks = [side[:, None] if k < 2 else side[None] for k, side in enumerate(blocks)]
        write_plot3d(path / f"{shape.name}.xyz", blocks)


def read_boundaries(path: Path) -> list[Shape]:
    """Return the shapes of a .h5 file of boundaries."""
    with h5py.File(path) as file:
        names = [name.decode() for name in file["names"][:]]
        sides = [file[side][:] for side in SIDES]
        topology = str(file.attrs["topology"])
    return [
        Shape(name, topology, *(side[k].astype(np.float64) for side in sides)) for k, name in enumerate(names)
    ]


def write_grids(path: Path, grids: dict[str, Floats]) -> None:
    """Write grids of one size, by the names of their shapes, to a .h5 file."""
    with h5py.File(path, "w") as file:
        file["nodes"] = np.array(list(grids.values()))
        file["names"] = list(grids)


def read_grids(path: Path) -> dict[str, Floats]:
    """Return the grids (ni, nj, 2) of a .h5 file or of a folder of .xyz files, by the names of their shapes.

    A .h5 file has the arrays nodes (n, ni, nj, 2) and names (n,).
    """
    if path.is_dir():
        return {file.stem: read_plot3d(file)[0] for file in sorted(path.glob("*.xyz"))}
    with h5py.File(path) as file:
        names = [name.decode() for name in file["names"][:]]
        return dict(zip(names, file["nodes"][:].astype(np.float64), strict=True))


def write_plot3d(path: Path, blocks: Sequence[Floats]) -> None:
    """Write blocks (ni, nj, 2) as 2D ASCII Plot3D: counts, then all x and all y of each, i fastest."""
    lines = [str(len(blocks)), *(f"{block.shape[0]} {block.shape[1]}" for block in blocks)]
    for block in blocks:
        lines += [repr(float(value)) for c in (0, 1) for value in block[..., c].T.ravel()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_plot3d(path: Path) -> list[Floats]:
    """Return the blocks (ni, nj, 2) of a 2D ASCII Plot3D file; a third coordinate, all zero, is left out."""
    words = path.read_text(encoding="utf-8").split()
    count = int(words[0])
    for dimensions in (2, 3):
        sizes = np.array(words[1 : 1 + dimensions * count], dtype=int).reshape(count, dimensions)
        values = words[1 + dimensions * count :]
        if dimensions * sizes.prod(axis=1).sum() == len(values):
            break
    else:
        raise ValueError(f"{path}: counts and coordinates do not fit")
    numbers, blocks = np.array(values, dtype=float), []
    for size in sizes:
        n = int(size.prod())
        planes, numbers = numbers[: dimensions * n].reshape(dimensions, n), numbers[dimensions * n :]
        blocks.append(np.stack([plane.reshape(size[1], size[0]).T for plane in planes[:2]], axis=-1))
    return blocks
