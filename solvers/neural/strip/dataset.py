"""Training data of the strip operator: lifted boundaries, and their Winslow solutions by Picard iteration."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.strip import across, harmonic, modes, picard, to_columns
from meshonet.solvers.conformal.walls import walls
from meshonet.solvers.neural.strip.encoding import encode
from meshonet.solvers.stages import reached

HEIGHT = 4.0  # of a typical strip: brings derivatives across it to the scale of those along it
MOST_STEPS = 30  # of Picard's iteration for a shape
CONVERGED = 2e-6  # change of w in a step (radians)
DIVERGED = 1.0  # change from which on there is none
ACCEPTED = 1e-4  # a slower one is still kept below this: the rest is in the highest modes


@dataclass(frozen=True)
class Strips:
    """Training shapes as Fourier modes: n regions, each around a body, that are mapped to periodic strips."""

    wall: Complexes  # (n, 2 MODES + 1) modes of the position F on the wall
    far: Complexes  # (n, 2 MODES + 1) the same on the far field
    residual: Complexes  # (n, 2 MODES + 1, LEVELS) modes of R, Winslow's solution minus the harmonic base

    def __len__(self) -> int:
        return len(self.wall)

    def __getitem__(self, rows: slice) -> "Strips":
        return Strips(self.wall[rows], self.far[rows], self.residual[rows])


def solve_strips(
    boundaries: Iterable[Boundary], progress: Callable[[int, int], None] | None = None
) -> Strips:
    """Map O boundaries conformally to strips, solve Winslow's equations there, and return the strips.

    Bodies without a conformal map or a solution are omitted. `progress` is called with the numbers of strips
    and of omitted bodies. Raises InputError if no strip results, or if a boundary is no O boundary.
    """
    rows: list[tuple[Complexes, Complexes, Complexes]] = []
    left_out = 0
    for boundary in boundaries:
        if not boundary.periodic:
            raise InputError(f"a {boundary.topology} boundary among the training shapes", "give O boundaries")
        row = _solved(boundary)
        if row is None:
            left_out += 1
        else:
            rows.append(row)
        reached("samples", "shape", len(rows))
        if progress is not None:
            progress(len(rows), left_out)
    if not rows:
        raise InputError("no boundary could be lifted and solved", "give airfoil O boundaries")
    wall, far, residual = (np.array(column) for column in zip(*rows, strict=True))
    return Strips(wall, far, residual)


def _solved(boundary: Boundary) -> tuple[Complexes, Complexes, Complexes] | None:
    try:
        body = walls(boundary)
    except InputError:
        return None
    a, b = modes(body.wall), modes(body.far)
    base = harmonic(a, b, across().eta)
    with np.errstate(all="ignore"):
        c, changes = picard(base, MOST_STEPS, CONVERGED, DIVERGED)
    return (a, b, c - base) if changes[-1] < ACCEPTED else None


@dataclass(frozen=True)
class StripTargets:
    """Training data: inputs, as `encode` returns them, and wanted outputs (n, 2 Q, COLUMNS).

    Regions around bodies are mapped to periodic strips. R is Winslow's solution in a strip, minus the
    harmonic function that is equal to it on the strip's sides. At each of COLUMNS points along the strip, R
    is approximately a sum of Q functions across the strip, each with its own complex factor. `basis` (Q,
    LEVELS - 2) has the functions. The wanted outputs are the real, then the imaginary parts of the factors
    divided by ``scale * size**2``, with `size` from `encode`.
    """

    channels: Floats
    scalars: Floats
    wanted: Floats
    basis: Floats
    scale: float


def make_targets(strips: Strips, count: int) -> StripTargets:
    """Return training data from Winslow's solutions `strips` and from the mirror images of these solutions.

    `count` is the number of basis functions across a strip whose coefficients are the wanted outputs.
    """
    # the mirror image F(theta) -> conj F(-theta) turns mode c_k into conj c_k
    wall, far, residual = (np.concatenate([c, c.conj()]) for c in (strips.wall, strips.far, strips.residual))
    channels, scalars, size = encode(wall, far)
    inner = np.array([to_columns(r.T).T[:, 1:-1] for r in residual])
    inner /= (size**2)[:, None, None]
    product = _h1_product()
    rows = inner[:, ::4].reshape(-1, inner.shape[2])  # every fourth column suffices
    gram = rows.real.T @ rows.real + rows.imag.T @ rows.imag
    root = np.linalg.cholesky(product)
    _, vectors = np.linalg.eigh(root.T @ gram @ root)
    basis = np.linalg.solve(root.T, vectors[:, ::-1][:, :count]).T
    c = np.einsum("nxe,eq->nqx", inner, product @ basis.T)
    wanted = np.concatenate([c.real, c.imag], axis=1)
    scale = float(np.sqrt((wanted**2).sum(axis=1).mean()))
    return StripTargets(channels, scalars, wanted / scale, basis, scale)


def _h1_product() -> Floats:
    """Return the (LEVELS - 2)^2 matrix of f g + f' g' across the strip, for f = g = 0 on its walls."""
    grid = across()
    quadrature = np.gradient(grid.eta)
    derivative = grid.d1[:, 1:-1] / HEIGHT
    product: Floats = np.diag(quadrature[1:-1]) + derivative.T @ (quadrature[:, None] * derivative)
    return product
