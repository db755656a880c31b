"""Airfoil O-grids in torch: gradients from every node back to the nodes of the boundary, on any device.

The arithmetic of `meshonet.solvers.neural.operator` once more, on tensors, without the guard: lift, harmonic base,
network, a given number of Picard steps, halved corners, and the sum of all modes at the nodes.
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.conformal.bisector import LARGEST, fading, shifts
from meshonet.solvers.conformal.evaluate import StripGrid
from meshonet.solvers.conformal.strip import COLUMNS, MODES, across, interpolation, smoothing, wavenumbers
from meshonet.solvers.neural.encoding import DEPTHS, SLOPE
from meshonet.solvers.neural.lifted import Lifted, lifted
from meshonet.solvers.neural.models.strip_fno import StripFNO
from meshonet.solvers.neural.tensors import check_sides
from meshonet.solvers.neural.weights import load_model

CLOSED = 1e-2  # what is left of an angle's difference (radians) where a corner counts as halved


class AirfoilGrids:
    """The airfoil operator as a differentiable function.

    Parameters
    ----------
    model : name of a shipped strip model, path of a file, or ``base`` for the harmonic base with no network.
    polish : Picard steps after it.
    device : torch's name of where to compute; the lifts of the bodies are computed there too.

    Raises
    ------
    InputError
        no such model, or one that cannot be read.
    """

    def __init__(self, model: str = "airfoil-o", polish: int = 2, device: str = "cpu") -> None:
        self._answer = None if model == "base" else _Answer(model, device)
        self._polish = polish
        self._device = device

    def __call__(self, south: Tensor, north: Tensor, nj: int) -> Tensor:
        """Return the nodes (batch, ni, nj, 2) of O grids around bodies.

        Parameters
        ----------
        south, north : (batch, ni, 2) nodes of the bodies and of the far fields, float64, clockwise from the
            trailing edge, the last one the first.
        nj : nodes from wall to far field.

        Raises
        ------
        InputError
            a body that cannot be lifted; tensors of other shapes or not float64; fewer than 2 nodes away.
        """
        check_sides(torch.float64, 4, south=south, north=north)
        if nj < 2:
            raise InputError(f"nj is {nj} nodes", "use at least 2")
        walls = [torch.complex(edge[:, :-1, 0], -edge[:, :-1, 1]).to(self._device) for edge in (south, north)]
        found = [lifted(z, far) for z, far in zip(*walls, strict=True)]
        wall, far = (torch.stack([getattr(one, name) for one in found]) for name in ("wall", "far"))
        a, b = _modes(wall), _modes(far)
        c = _harmonic(a, b, across().eta)
        if self._answer is not None:
            c = c + self._answer(a, b, torch.tensor([one.hand for one in found], device=self._device))
        for _ in range(self._polish):
            c = _picard(c)
        F = _evaluated(c, wall, far, nj)
        rows = []
        for k, one in enumerate(found):
            theta = _theta(F.shape[1], F)[:, None]
            w = F[k] + 1j * theta + 1j * _nudge(one, c[k], F[k, :, 1] + 1j * theta[:, 0], nj)
            z = one.lift.to_plane(w)
            rows.append(torch.stack([z.real, -z.imag], -1))
        inner = torch.stack(rows).to(south)
        inner = torch.cat([inner, inner[:, :1]], 1)[:, :, 1:-1]
        return torch.cat([south[:, :, None], inner, north[:, :, None]], 2)


class _Answer:
    """The network with its encoding: modes of the walls (batch, modes) to those of Winslow - harmonic."""

    def __init__(self, model: str, device: str) -> None:
        held = load_model(model)
        weights = held.weights
        width, modes = weights["project.weight"].shape[1], len(weights["spectral.0.weight"])
        layers = sum(name.startswith("conv.") for name in weights) // 2
        outputs, inputs = weights["project.weight"].shape[0], weights["lift.weight"].shape[1]
        self._network = StripFNO(inputs - 3, 3, outputs, width, modes, layers)
        self._network.load_state_dict({name: torch.tensor(one) for name, one in weights.items()})
        self._network.to(device=device, dtype=torch.float64).requires_grad_(False)
        self._basis = torch.tensor(held.basis, device=device)
        self._scale = held.scale

    def __call__(self, wall: Tensor, far: Tensor, hand: Tensor) -> Tensor:
        """Return the answer to bodies: to the mirror image, and mirrored, where `hand` is negative.

        A body that is its own mirror image (0) has the mean of both, whose slopes are symmetric too.
        """
        flip, even = (hand < 0)[:, None], hand == 0
        answer = self._told(*(torch.where(flip, one.conj(), one) for one in (wall, far)))
        answer = torch.where(flip[..., None], answer.conj(), answer)
        if even.any():
            image = torch.zeros_like(answer)
            image[even] = self._told(wall[even].conj(), far[even].conj()).conj()
            answer = torch.where(even[:, None, None], 0.5 * (answer + image), answer)
        return answer * torch.as_tensor(smoothing(), device=answer.device)[:, None]

    def _told(self, a: Tensor, b: Tensor) -> Tensor:
        mean = (b - a)[:, 0]
        a, b = (torch.cat([torch.zeros_like(one[:, :1]), one[:, 1:]], 1) for one in (a, b))
        size = torch.sqrt((torch.abs(a) ** 2 + torch.abs(b) ** 2).sum(1).clamp(min=1e-24))
        near, away = _decay(mean.real, DEPTHS)
        h = (a[:, :, None] * near + b[:, :, None] * away).mT / size[:, None, None]
        k = _wavenumbers(h)
        value, slope = _columns(h), SLOPE * _columns(1j * k * h)
        channels = torch.stack([value.real, value.imag, slope.real, slope.imag], 2).flatten(1, 2)
        scalars = torch.stack([torch.log(size) + 2.5, mean.real - 4.0, mean.imag], 1)
        told = self._network(channels, scalars)
        q = len(self._basis)
        kept = _kept(torch.fft.fft(torch.complex(told[:, :q], told[:, q:])) / COLUMNS)
        inner = (kept.mT @ self._basis.to(kept.dtype)) * (self._scale * size**2)[:, None, None]
        return torch.nn.functional.pad(inner, (1, 1))


def _modes(F: Tensor) -> Tensor:
    n = F.shape[1]
    c, keep = torch.fft.fft(F) / n, min(MODES, (n - 1) // 2)
    none = torch.zeros_like(c[:, :1]).expand(-1, 2 * (MODES - keep))
    return torch.cat([c[:, : keep + 1], none, c[:, n - keep :]], 1)


def _decay(height: Tensor, eta: Floats) -> tuple[Tensor, Tensor]:
    """Return `strip.decay` for a batch of heights: two (batch, modes, eta)."""
    k = torch.abs(_wavenumbers(height))
    e = torch.as_tensor(eta, device=height.device)
    kT = torch.where(k == 0, torch.ones_like(k), k * height[:, None])[:, :, None]
    whole = 1.0 - torch.exp(-2.0 * kT)
    near = (torch.exp(-kT * e) - torch.exp(-kT * (2.0 - e))) / whole
    away = (torch.exp(-kT * (1.0 - e)) - torch.exp(-kT * (1.0 + e))) / whole
    flat = (k == 0)[:, None]
    return torch.where(flat, 1.0 - e, near), torch.where(flat, e, away)


def _harmonic(wall: Tensor, far: Tensor, eta: Floats) -> Tensor:
    near, away = _decay((far - wall)[:, 0].real, eta)
    return wall[:, :, None] * near + far[:, :, None] * away


def _picard(c: Tensor) -> Tensor:
    """Return the modes (batch, modes, LEVELS) after a step; see `strip.picard`."""
    grid = across()
    d1, d2, vectors, inverse = (
        torch.as_tensor(m, device=c.device).to(c.dtype)
        for m in (grid.d1, grid.d2, grid.vectors, grid.inverse)
    )
    levels, k = c.mT, _wavenumbers(c)
    T = (levels[:, -1, 0] - levels[:, 0, 0]).real[:, None, None]
    stiffness = torch.as_tensor(grid.eigenvalues, device=c.device)[:, None] - (k * T) ** 2
    smooth = torch.as_tensor(smoothing(), device=c.device) / stiffness
    ce = d1 @ levels
    parts = (1j * k * levels, -(k**2) * levels, ce, 1j * k * ce, d2 @ levels)
    Wt, Wtt, We, Wte, Wee = (_columns(part)[:, 1:-1] for part in parts)
    Wt = Wt + 1j
    alpha, gamma = torch.abs(We) ** 2, torch.abs(Wt) ** 2
    beta = (torch.conj(Wt) * We).real
    residual = (alpha * Wtt - 2.0 * beta * Wte + gamma * Wee) * (2.0 / (alpha / (T * T) + gamma))
    update = vectors @ ((inverse @ _kept(torch.fft.fft(residual, norm="forward"))) * smooth)
    return (levels - torch.nn.functional.pad(update, (0, 0, 1, 1))).mT


def _evaluated(c: Tensor, wall: Tensor, far: Tensor, nj: int) -> Tensor:
    """Return F (batch, n, nj) at the nodes by all modes of the walls; those above `MODES` stay at theirs."""
    n, eta = wall.shape[1], np.linspace(0.0, 1.0, nj)
    theta = _theta(n, wall)[:, None]
    low = c @ torch.as_tensor(interpolation(eta), device=c.device).to(c.dtype)
    F = torch.exp(1j * theta * _wavenumbers(wall)) @ low
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


def _nudge(one: Lifted, c: Tensor, first: Tensor, nj: int) -> Tensor:
    """Return what is added to phi (n, nj), so that the first lines off the corners halve their angles.

    The shifts are those that `bisector` finds; their slopes are those of the equations they solve.
    """
    n, corners = len(first), list(one.corners)
    eta = np.linspace(0.0, 1.0, nj)
    if not corners or nj < 4:
        return torch.zeros((), dtype=torch.float64, device=c.device)
    modes, wall, far, z = (value.detach().cpu().numpy() for value in (c, one.wall, one.far, one.z))
    reach, shift = shifts(StripGrid(modes, wall, far, eta), one.numpy, z, one.corners)
    pull = torch.as_tensor(reach[corners], device=c.device)
    start = torch.as_tensor(shift, device=c.device)

    def unequal(w: Tensor) -> Tensor:
        corner = one.z[corners]
        ahead, behind = one.z[[(k + 1) % n for k in corners]], one.z[[k - 1 for k in corners]]
        line = one.lift.to_plane(w) - corner
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


def _columns(c: Tensor) -> Tensor:
    """Return samples at `COLUMNS` steps of theta of functions whose modes lie along the last axis."""
    none = torch.zeros_like(c[..., :1]).expand(*c.shape[:-1], COLUMNS - 2 * MODES - 1)
    full = torch.cat([c[..., : MODES + 1], none, c[..., MODES + 1 :]], -1)
    return torch.fft.ifft(full, norm="forward")


def _kept(spectrum: Tensor) -> Tensor:
    return torch.cat([spectrum[..., : MODES + 1], spectrum[..., -MODES:]], -1)


def _wavenumbers(like: Tensor) -> Tensor:
    return torch.as_tensor(wavenumbers(), device=like.device)


def _theta(n: int, like: Tensor) -> Tensor:
    return torch.as_tensor(2.0 * np.pi * np.arange(n) / n, device=like.device)
