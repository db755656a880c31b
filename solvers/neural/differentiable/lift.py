"""The lift of `meshonet.geometry.conformal.lift` in torch, with its decisions taken by the NumPy function."""

from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.conformal.lift import SECOND_PRONG, Corner, Lift, follow, lift_body, removable
from meshonet.geometry.polygon.mirror import farthest, handedness
from meshonet.solvers.neural.differentiable.arguments import as_numpy
from meshonet.solvers.neural.quad.unrolled import middles


@dataclass(frozen=True)
class TorchWalls:
    """Nodes of a body, `wall`, and of its far field, `far`, mapped conformally to a strip (`StripWalls`).

    `lift` has the coefficients of the conformal map as tensors, `numpy` has them as NumPy arrays.
    """

    lift: Lift
    numpy: Lift
    wall: Tensor
    far: Tensor
    z: Tensor
    corners: tuple[int, ...]
    hand: int


def torch_walls(z: Tensor, far: Tensor) -> TorchWalls:
    """Map a body `z` (n,) and its far field `far` (n,) conformally to a strip; return their images.

    Both curves are complex and counter-clockwise. Raises InputError if the body has no conformal map.
    """
    nodes, origin = z, z[0]
    hand, _ = handedness(as_numpy(z), as_numpy(far))
    z, far = z - origin, far - origin
    wall = as_numpy(z)
    known, _, corners = lift_body(wall, swap=hand < 0)
    sharp = corners == (0,)
    base = [] if sharp else list(corners)
    centre, quarter = _slit(z, sharp, base)
    zeta = _joukowski(z, centre, quarter)
    outside = as_numpy(zeta)
    true = follow(wall, known.centre, known.quarter)
    crossed = np.abs(true - outside) > np.abs(true - 1.0 / outside)
    zeta = torch.where(torch.as_tensor(crossed, device=z.device), 1.0 / zeta, zeta)
    zeta, removed, pole = _straightened(z, zeta, sharp, base[:: -1 if hand < 0 else 1])
    offset = zeta - pole
    psi, phi = torch.log(torch.abs(offset)), _unwrapped(torch.angle(offset))
    lift = Lift(centre + origin, quarter, tuple(removed), pole, phi[0])
    theta = 2.0 * np.pi * torch.arange(len(z), dtype=psi.dtype, device=z.device) / len(z)
    v = _joukowski(far, centre, quarter)
    for corner in removed:
        v = _remove(corner, v)
    above = _unwrapped(torch.angle(v - pole)) - phi[0]
    turns = round(float((above.detach() - (phi - phi[0]).detach()).mean()) / (2.0 * np.pi))
    away = torch.complex(torch.log(torch.abs(v - pole)), above - 2.0 * np.pi * turns - theta)
    known = replace(known, centre=known.centre + complex(origin.detach()))
    return TorchWalls(lift, known, torch.complex(psi, phi - phi[0] - theta), away, nodes, corners, hand)


def _straightened(
    z: Tensor, zeta: Tensor, sharp: bool, base: list[int]
) -> tuple[Tensor, list[Corner], Tensor]:
    """Return zeta without its trailing corners, the maps that remove them, and the pole inside the body."""
    turn = torch.angle((torch.roll(z, -1) - z) / (z - torch.roll(z, 1)))
    ends = [(i, 1.0 + turn[i] / np.pi) for i in base]
    if sharp:
        ends = [(0, 0.5 * (1.0 + turn[0] / np.pi))]
    removed, pole = [], middles(zeta[None], torch)[0]
    for i, k in ends:
        if removable(float(k.detach())):
            p = zeta[i]
            q = p + SECOND_PRONG * (pole - p)
            corner = Corner(p, q, p, p - (p - q) / k, k)
            straight = _remove(corner, zeta)
            if torch.isfinite(torch.view_as_real(straight)).all():
                removed.append(corner)
                zeta = straight
                pole = middles(zeta[None], torch)[0]
    return zeta, removed, pole


def _slit(z: Tensor, sharp: bool, base: list[int]) -> tuple[Tensor, Tensor]:
    first, last = farthest(as_numpy(z))
    nose = 0.5 * (z[first] + z[last])
    if sharp:
        tail = z[0]
    elif len(base) == 2:
        middle = 0.5 * (z[base[0]] + z[base[1]])
        tail = middle + 0.25 * torch.abs(z[base[0]] - z[base[1]]) * _unit(nose - middle)
    else:
        tail = _focus(z, 0, nose)
    head = 0.5 * (_focus(z, first, z[0]) + _focus(z, last, z[0]))
    if bool((torch.abs(tail - head) < 0.2 * torch.abs(nose - z[0])).detach()):
        middle, spread = 0.5 * (tail + head), 0.1 * (z[0] - nose)
        tail, head = middle + spread, middle - spread
    return 0.5 * (tail + head), 0.25 * (tail - head)


def _focus(z: Tensor, tip: int, far_end: Tensor) -> Tensor:
    chord = torch.abs(far_end - z[tip])
    apart = torch.abs(z.detach() - z[tip].detach()) > 0.004 * chord.detach()
    nearer = torch.arange(
        1, len(z) // 2, device=z.device
    )  # nodes ahead and behind, as kernels/conformal/lift.c
    ahead, behind = (int(torch.argmax(apart[(tip + way * nearer) % len(z)].int())) + 1 for way in (1, -1))
    a, b, c = z[(tip + ahead) % len(z)], z[tip], z[tip - behind]
    area = 0.5 * torch.abs(((a - b) * torch.conj(c - b)).imag)
    sides = torch.abs(a - b) * torch.abs(c - b) * torch.abs(a - c)
    radius = sides / (4.0 * area + 1e-12 * chord**2)
    ratio = torch.clamp(2.0 * radius / chord, 4e-4, 0.8)
    inwards = 1j * (a - c)
    if bool(((torch.conj(inwards) * (far_end - b)).real < 0.0).detach()):
        inwards = -inwards
    return b + _unit(inwards) * 0.5 * chord * (1.0 - torch.sqrt(1.0 - ratio))


def _joukowski(z: Tensor, centre: Tensor, quarter: Tensor) -> Tensor:
    Z = (z - centre) / quarter
    end = torch.abs(Z.detach() - 2.0) < 1e-13  # the branch point, whose root has no slope
    Z = torch.where(end, torch.full_like(Z, 2.0), Z)
    root = torch.sqrt(torch.where(end, torch.ones_like(Z), Z - 2.0)) * torch.sqrt(Z + 2.0)
    return 0.5 * (Z + torch.where(end, torch.zeros_like(Z), root))


def _remove(corner: Corner, v: Tensor) -> Tensor:
    p, q, P, Q = corner.p, corner.q, corner.P, corner.Q
    tip = v.detach() == p.detach()
    safe = torch.where(tip, (2.0 * p - q).expand_as(v), v)
    r = torch.exp(torch.log((safe - p) / (safe - q)) / corner.k)
    return torch.where(tip, P.expand_as(v), (Q * r - P) / (r - 1.0))


def _unwrapped(angle: Tensor) -> Tensor:
    values = as_numpy(angle)
    turns = torch.as_tensor(np.unwrap(values) - values, dtype=angle.dtype, device=angle.device)
    return angle + turns


def _unit(v: Tensor) -> Tensor:
    return v / torch.abs(v)
