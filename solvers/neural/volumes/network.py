"""3DMeshNet: physics-informed networks for volumes, one for each geometry, evaluated by NumPy.

Peng, Chen & Liu, 3DMeshNet: a three-dimensional differential neural network for structured mesh generation,
arXiv 2407.01560.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.six_faces import FACES, SixFaces
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.model_file import OURS, VOLUME, read_model
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes
from meshonet.solvers.neural.registry import model_path
from meshonet.solvers.solution import Solution, timed

SAME = 0.01  # largest distance of sensors, over the size, at which two geometries are one
SENSORS = 5  # nodes a direction of every face by which geometries are told apart
CHUNK = 1 << 15  # points that are evaluated together

Answer = Literal["valid", "pasted", "raw"]


@dataclass(frozen=True)
class VolumeMeshNet:
    """Settings of the network 3DMeshNet."""

    width: int = 40  # of the hidden layers
    depth: int = 4
    finite: float = 0.02  # step of the central differences in the loss
    rim: float = 1000.0  # weight of the faces in the loss, at the beginning of training
    projected: bool = True  # whether conflicting gradients of both parts of the loss are projected

    def shapes(self, count: int) -> Shapes:
        """Return the array shapes of the parameters of `count` networks, by name."""
        return dense_shapes("net", (3, *[self.width] * self.depth, 3), stacked=count)


@dataclass(frozen=True)
class VolumeNetwork:
    """Trained networks N_g, one for each geometry g, which can be evaluated at any number of nodes.

    ``(x, y, z) = centre + size N_g(2 xi - 1, 2 eta - 1, 2 zeta - 1)``. `weights` also has centres (count, 3),
    sizes (count, 1), and points (count, s, 3) of the faces by which a geometry is recognised.
    """

    name: str
    weights: Weights

    def nodes(self, faces: SixFaces) -> Floats:
        """Return predicted nodes (ni, nj, nk, 3). Raises InputError: no network for this volume."""
        k = self._which(faces)
        net = {key: value[k : k + 1] for key, value in self.weights.items() if key.startswith("net/")}
        axes = [np.linspace(-1.0, 1.0, n) for n in faces.counts]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3).astype(np.float32)
        chunks = (points[None, at : at + CHUNK] for at in range(0, len(points), CHUNK))
        scaled = np.concatenate([dense(np, net, "net", chunk)[0] for chunk in chunks]).astype(np.float64)
        places = scaled * self.weights["fixed/size"][k] + self.weights["fixed/centre"][k]
        return np.asarray(places.reshape(*faces.counts, 3))

    def _which(self, faces: SixFaces) -> int:
        away = norms(self.weights["fixed/sensors"] - sensors(faces)).max(axis=-1)
        away = away / self.weights["fixed/size"][:, 0]
        k = int(away.argmin())
        if away[k] > SAME:
            problem = f"the model knows {len(away)} volumes, and this one is off the nearest by {away[k]:.1e}"
            raise InputError(problem, "train it on this one too: it has a network for each volume")
        return k


def sensors(faces: SixFaces) -> Floats:
    """Return points (s, 3) of the six faces at equal steps of their parameters."""
    few = faces.resampled((SENSORS, SENSORS, SENSORS))
    return np.concatenate([face.reshape(-1, 3) for face in few.faces])


def scales(volumes: Sequence[SixFaces]) -> dict[str, Floats]:
    """Return points of the faces (n, s, 3), centre (n, 3) and half the greatest extent (n, 1) of volumes."""
    seen = np.array([sensors(faces) for faces in volumes])
    low, high = seen.min(axis=1), seen.max(axis=1)
    return {
        "fixed/sensors": seen,
        "fixed/centre": 0.5 * (low + high),
        "fixed/size": 0.5 * (high - low).max(axis=1, keepdims=True),
    }


def load_volume(name: str) -> VolumeNetwork:
    """Return the networks in a model file. Raises InputError: no such file; a model of planar grids."""
    path = model_path(name)
    kind, header, arrays = read_model(path)
    if kind != VOLUME:
        remedy = "use one that meshonet train --model meshnet made of volumes"
        raise InputError("this model makes no volumes", remedy, source=str(path))
    try:
        _check(header, arrays)
    except (KeyError, ValueError, TypeError) as error:
        raise InputError(f"its header or arrays do not fit ({error})", OURS, source=str(path)) from None
    return VolumeNetwork(path.stem, arrays)


def _check(header: Mapping[str, Any], arrays: Mapping[str, Floats]) -> None:
    count = len(arrays["fixed/size"])
    width, depth = (int(header["settings"][key]) for key in ("width", "depth"))
    expected = VolumeMeshNet(width, depth).shapes(count) | {
        "fixed/sensors": (count, len(FACES) * SENSORS**2, 3),
        "fixed/centre": (count, 3),
        "fixed/size": (count, 1),
    }
    if count < 1 or {key: array.shape for key, array in arrays.items()} != expected:
        raise ValueError("shapes")


@timed
def infer_volume(faces: SixFaces, *, model: str, answer: Answer = "valid") -> Solution:
    """Return the grid inside `faces` by a trained network.

    `answer`: ``raw`` returns predicted nodes, ``pasted`` replaces boundary nodes by `faces`, ``valid`` also
    repairs folded cells. Raises InputError: no such model; a geometry on which it was not trained.
    """
    network = load_volume(model)
    nodes = network.nodes(faces)
    error = 0.0
    for side in FACES:
        own, face = face_of(nodes, side), getattr(faces, side)
        error = max(error, float(norms(own - face).max()))
        if answer != "raw":
            own[...] = face
    path: tuple[str, ...] = ()
    if answer == "valid":
        from meshonet.geometry.quality.measure import folded_cells
        from meshonet.solvers.volumes.repair import repair

        if len(folded_cells(nodes)):
            planes = np.ascontiguousarray(np.moveaxis(nodes, -1, 0))
            repair(planes)
            nodes, path = np.moveaxis(planes, 0, -1), ("repair",)
    done = "left so" if answer == "raw" else "replaced by the true ones"
    notes = (f"the network's own faces were off by {error:.1e} at most, and were {done}",)
    grid = faces.grid(nodes, {"method": "operator", "model": network.name, "boundary_error": error})
    return Solution(grid, "operator", model=network.name, path=path, notes=notes)
