"""Differentiable airfoil O grids in torch, by the formulas of `meshonet.solvers.conformal.solve`."""

from functools import partial
from typing import Literal

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal import strip
from meshonet.solvers.conformal.bisector import LARGEST, fading, shifts
from meshonet.solvers.conformal.evaluate import StripGrid
from meshonet.solvers.conformal.strip import MODES, across, wavenumbers
from meshonet.solvers.neural.differentiable.arguments import as_numpy, batched, check_sides
from meshonet.solvers.neural.differentiable.lift import TorchWalls, torch_walls
from meshonet.solvers.neural.differentiable.members import Failed, MemberError, check_failed
from meshonet.solvers.neural.differentiable.recorded import recorded
from meshonet.solvers.neural.differentiable.strip_limit import Settled, picard
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.neural.registry import load
from meshonet.solvers.neural.strip.encoding import decode, encode
from meshonet.solvers.neural.strip.network import StripNetwork
from meshonet.solvers.neural.strip.operator import StripOperator

CLOSED = 1e-2  # what is left of an angle's difference (radians) where a corner counts as halved


class AirfoilGrids:
    """The neural operator for airfoils as a differentiable function; folded cells are not repaired.

    `model` is an operator for airfoils, its name or its path; ``base`` means harmonic grids, made without a
    network. `polish` is the number of Picard steps that follow, or ``converged``. `device` is torch's name of
    the device. Raises InputError if the model does not exist, cannot be read, or is not for airfoils.
    """

    def __init__(
        self, model: str | Operator = "airfoil-o", polish: int | Literal["converged"] = 2, device: str = "cpu"
    ) -> None:
        operator = load(model) if isinstance(model, str) else model
        if not isinstance(operator, StripOperator):
            raise InputError(f"model {operator.name} is no strip operator", "use airfoil-o or base")
        self._correction = _Correction(operator, device) if operator.network else None
        self._polish = polish
        self._device = device

    def __call__(self, south: Tensor, north: Tensor, nj: int, *, failed: Failed = "raise") -> Tensor:
        """Return the nodes (..., ni, nj, 2) of O grids around bodies.

        `south`, `north`: (..., ni, 2) nodes of the bodies and of the far fields, clockwise from the trailing
        edge, the first repeated at the end; `nj`: node count from wall to far field; `failed`: as in
        `conformal`. The arithmetic is in double precision. Raises InputError: tensors of other shapes; `nj`
        below 2. Raises SolverError: a body has no conformal lift, or a member does not converge.
        """
        check_sides(4, nj, south=south, north=north)
        check_failed(failed)
        counts = (south.shape[-2], nj) if failed == "nan" else None
        make = partial(recorded, partial(self._nodes, nj=nj), counts=counts)
        return batched(make, (south, north), nj, device=self._device)

    def _nodes(self, south: Tensor, north: Tensor, nj: int) -> Tensor:
        edges = [torch.complex(edge[:, :-1, 0], -edge[:, :-1, 1]) for edge in (south, north)]
        bodies = _lifted(*edges)
        wall, far = (torch.stack([getattr(body, name) for body in bodies]) for name in ("wall", "far"))
        a, b = strip.modes(wall, torch), strip.modes(far, torch)
        c = strip.harmonic(a, b, across().eta, torch)
        if self._correction is not None:
            c = c + self._correction(a, b, torch.tensor([body.hand for body in bodies], device=self._device))
        if self._polish == "converged":
            c = Settled.apply(c)  # type: ignore[no-untyped-call]
        else:
            for _ in range(self._polish):
                c = picard(c)
        F = _evaluated(c, wall, far, nj)
        theta = _theta(F.shape[1], F)[:, None]
        planes = []
        for k, body in enumerate(bodies):
            w = F[k] + 1j * theta
            z = body.lift.to_plane(w + 1j * _nudge(body, c[k], w[:, 1], nj), torch)
            planes.append(torch.stack([z.real, -z.imag], -1))
        inner = torch.stack(planes).to(south)
        inner = torch.cat([inner, inner[:, :1]], 1)[:, :, 1:-1]
        return torch.cat([south[:, :, None], inner, north[:, :, None]], 2)


def conformal(south: Tensor, north: Tensor, nj: int, *, failed: Failed = "raise") -> Tensor:
    """Return the nodes (..., ni, nj, 2) of converged conformal O grids around airfoils.

    Gradients are derivatives of the converged solution; each backward pass solves one linear system.

    Parameters
    ----------
    south, north : (..., ni, 2) nodes of the bodies (south) and of their far fields (north), clockwise
        from the trailing edge; the last node repeats the first.
    nj : int
        Number of nodes from wall to far field.
    failed : {"raise", "nan"}
        With "nan", bodies without a grid get NaN nodes in place of SolverError.

    Raises
    ------
    InputError
        Tensors of wrong shape, with unequal node counts or of different dtypes; `nj` below 2.
    SolverError
        A body has no conformal map, its coordinates are not finite, or its equations do not converge.
        The message and the attribute ``members`` list the indices of such bodies in the batch.
    """
    return AirfoilGrids("base", "converged", str(south.device))(south, north, nj, failed=failed)


def _lifted(bodies: Tensor, fars: Tensor) -> list[TorchWalls]:
    """Return the walls in the strip. Raises MemberError, with the bodies without a conformal lift."""
    walls, reasons = [], {}
    for member, (z, far) in enumerate(zip(bodies, fars, strict=True)):
        if not bool((z != z[0]).any()):
            reasons[member] = "the body is a point", "leave it out"
            continue
        try:
            walls.append(torch_walls(z, far))
        except InputError as error:
            reasons[member] = error.problem, error.remedy
    if reasons:
        raise MemberError(reasons)
    return walls


class _Correction:
    """`StripOperator.residual` in torch: modes of Winslow - harmonic from modes of walls (batch, modes)."""

    def __init__(self, operator: StripOperator, device: str) -> None:
        weights = {name: torch.tensor(array, device=device) for name, array in operator.weights.items()}
        self._network = StripNetwork(weights, torch)
        self._basis = torch.tensor(operator.basis, device=device)
        self._scale = operator.scale

    def __call__(self, wall: Tensor, far: Tensor, hand: Tensor) -> Tensor:
        """Return the residual; negative `hand`: by way of the mirror image; 0: the mean of both."""
        flip, even = (hand < 0)[:, None], hand == 0
        answer = self._answer(*(torch.where(flip, side.conj(), side) for side in (wall, far)))
        answer = torch.where(flip[..., None], answer.conj(), answer)
        if even.any():
            image = torch.zeros_like(answer)
            image[even] = self._answer(wall[even].conj(), far[even].conj()).conj()
            answer = torch.where(even[:, None, None], 0.5 * (answer + image), answer)
        return answer * torch.as_tensor(np.array(across().smooth), device=answer.device)[:, None]

    def _answer(self, wall: Tensor, far: Tensor) -> Tensor:
        channels, scalars, size = encode(wall, far, torch)
        modes: Tensor = decode(self._network(channels, scalars), self._basis, self._scale, size, torch)
        return modes


def _evaluated(c: Tensor, wall: Tensor, far: Tensor, nj: int) -> Tensor:
    """Return F (batch, n, nj) at the nodes by all modes of the walls; those above `MODES` are harmonic."""
    n, eta = wall.shape[1], np.linspace(0.0, 1.0, nj)
    theta = _theta(n, wall)[:, None]
    low = c @ torch.as_tensor(np.array(strip.interpolation(eta.tobytes())), device=c.device).to(c.dtype)
    F = torch.exp(1j * theta * wavenumbers(wall, torch)) @ low
    beyond = np.arange(MODES + 1, n // 2 + 1)
    if not len(beyond):
        return F
    height = (far.real.mean(1) - wall.real.mean(1))[:, None, None]
    k = torch.as_tensor(np.concatenate([beyond, -beyond[: len(beyond) - (n % 2 == 0)]]), device=c.device)
    for edge, depth in ((wall, eta), (far, 1.0 - eta)):
        high = (torch.fft.fft(edge) / n)[:, k % n, None]
        fade = torch.exp(-height * torch.abs(k)[:, None] * torch.as_tensor(depth, device=c.device))
        F = F + torch.exp(1j * theta * k) @ (high * fade)
    return F


def _nudge(body: TorchWalls, c: Tensor, first: Tensor, nj: int) -> Tensor:
    """Return the change of phi (n, nj) with which the first grid lines from corners bisect their angles."""
    n, corners = len(first), list(body.corners)
    eta = np.linspace(0.0, 1.0, nj)
    if not corners or nj < 4:
        return torch.zeros((), dtype=torch.float64, device=c.device)
    grid = StripGrid(as_numpy(c), as_numpy(body.wall), as_numpy(body.far), eta)
    reach, shift = shifts(grid, body.numpy, as_numpy(body.z), body.corners)
    pull = torch.as_tensor(reach[corners], device=c.device)
    start = torch.as_tensor(shift, device=c.device)
    corner = body.z[corners]
    ahead, behind = body.z[[(k + 1) % n for k in corners]], body.z[[k - 1 for k in corners]]

    def unequal(w: Tensor) -> Tensor:
        line = body.lift.to_plane(w, torch) - corner
        return torch.angle((behind - corner) / line) - torch.angle(line / (ahead - corner))

    w = first[corners] + 1j * (pull @ start)
    off = unequal(w)
    with torch.enable_grad():
        moved = (pull @ start).detach().requires_grad_()
        slope = torch.autograd.grad(unequal(first[corners].detach() + 1j * moved).sum(), moved)[0]
    turned = torch.remainder(off.detach() + np.pi, 2.0 * np.pi) - np.pi
    free = (torch.abs(turned) < CLOSED) & (torch.abs(start) < LARGEST * 2.0 * np.pi / n)
    jacobian = torch.where(free[:, None], slope.detach()[:, None] * pull, torch.eye(len(corners)).to(pull))
    change = torch.linalg.solve(jacobian, torch.where(free, off - off.detach(), torch.zeros_like(off)))
    along = torch.as_tensor(reach, device=c.device) @ (start - change)
    return along[:, None] * torch.as_tensor(fading(eta, float(eta[1])), device=c.device)


def _theta(n: int, like: Tensor) -> Tensor:
    return torch.as_tensor(2.0 * np.pi * np.arange(n) / n, device=like.device)
