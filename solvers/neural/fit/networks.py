"""The networks of `neural.strip.network` and `neural.quad.network` as torch modules."""

import math
from collections.abc import Mapping, Sequence

import torch
from torch import Tensor, nn
from torch.nn import functional

from meshonet.solvers.neural.quad import symmetry
from meshonet.solvers.neural.quad.encoding import HEADS
from meshonet.solvers.neural.quad.network import UNet, rim_factor
from meshonet.solvers.neural.quad.network import shapes as quad_shapes
from meshonet.solvers.neural.quad.symmetry import ELEMENTS, ORDER, SEEN
from meshonet.solvers.neural.strip.network import StripNetwork
from meshonet.solvers.neural.strip.network import shapes as strip_shapes


class NamedParameters(nn.Module):
    """A network with the parameters `arrays` by name; dots in names separate submodules."""

    def __init__(self, arrays: Mapping[str, Tensor]) -> None:
        super().__init__()
        for name, array in arrays.items():
            module: nn.Module = self
            *path, last = name.split(".")
            for part in path:
                if part not in dict(module.named_children()):
                    module.add_module(part, nn.Module())
                module = module.get_submodule(part)
            module.register_parameter(last, nn.Parameter(array))


class StripFNO(NamedParameters):
    """The network for airfoils (`StripNetwork`) as a torch module.

    The arguments are counts: `inputs` of input channels, `scalars` of scalar inputs, `outputs` of output
    channels, `width` of hidden channels, `modes` of Fourier modes, and `layers` of Fourier layers.
    """

    def __init__(
        self, inputs: int, scalars: int, outputs: int, width: int = 32, modes: int = 32, layers: int = 3
    ) -> None:
        wanted = strip_shapes(inputs + scalars, outputs, width, (modes,) * (layers + 1))
        super().__init__({name: _first_of_strip(name, shape, wanted) for name, shape in wanted.items()})

    def forward(self, channels: Tensor, scalars: Tensor) -> Tensor:
        """Return outputs (batch, outputs, columns) for `channels` (batch, inputs, columns) and `scalars`."""
        out: Tensor = StripNetwork(dict(self.named_parameters()), torch)(channels, scalars)
        return out


def _first_of_strip(name: str, shape: tuple[int, ...], shapes: dict[str, tuple[int, ...]]) -> Tensor:
    """Return initial values: normal ones, over the count of inputs, for spectral weights, else torch's."""
    if name.startswith("spectral"):
        return torch.randn(shape) / shape[1]
    _, inputs, taps = shapes[name.replace("bias", "weight")]
    return (2.0 * torch.rand(shape) - 1.0) / (inputs * taps) ** 0.5


class QuadUNet(NamedParameters, UNet[Tensor]):
    """The U-Net from features of grids to displacements of their nodes, as a torch module.

    `widths` has the number of channels of each level, divided by 8; the finest level comes first. Each level
    has half as many nodes per direction as the level before. `blocks` has the number of residual blocks of
    each level, equal on the way down and up. With `around`, grids are O grids, with features periodic in xi.
    """

    def __init__(self, widths: Sequence[int], blocks: Sequence[int], around: bool = False) -> None:
        wanted = quad_shapes(widths, blocks, len(HEADS))
        super().__init__({name: _first_of_quad(name, shape) for name, shape in wanted.items()})
        self.counts, self.around = tuple(blocks), around
        tables = {"seen": torch.tensor(SEEN, dtype=torch.float32)}
        tables |= {"elements": torch.tensor(ELEMENTS, dtype=torch.float32)}
        tables |= {f"places{size}": torch.from_numpy(symmetry.table(size)) for size in (1, 3)}
        for name, values in tables.items():
            self.register_buffer(name, values, persistent=False)

    def forward(self, features: Tensor) -> Tensor:
        """Return complex displacements (batch, heads, m, n) of nodes for `features` (batch, m, n, FEATURES).

        There is one head (output) for each of `encoding.HEADS`. Displacements are 0 on the boundary. In
        four-sided domains m must equal n. Around bodies m must be a multiple of 2^(levels - 1).
        """
        answer = self.through(features.movedim(-1, 1), self.counts)
        rim = torch.tensor(
            rim_factor(*answer.shape[-2:], self.around), dtype=answer.dtype, device=answer.device
        )
        answer = answer * rim
        answer = answer.to(torch.promote_types(answer.dtype, torch.float32))  # bfloat16 with --amp
        return torch.complex(answer[:, 0::2].contiguous(), answer[:, 1::2].contiguous())

    def layer(
        self,
        name: str,
        x: Tensor,
        stride: int = 1,
        add: Tensor | None = None,
        room: str = "",  # noqa: ARG002
    ) -> Tensor:
        """Return the convolution of padded `x` (batch, channels, m, n) by layer `name`; see `UNet.layer`."""
        if name == "lift":
            kernel = symmetry.lift(self.get_parameter("lift"), self.get_buffer("seen"))[..., None, None]
            bias = self.get_parameter("lift_bias").repeat_interleave(ORDER)
        elif name == "project":
            elements = self.get_buffer("elements")
            kernel = symmetry.projection(self.get_parameter("project"), elements, torch)[..., None, None]
            bias = None
        else:
            weight = self.get_parameter(f"{name}.weight")
            kernel = symmetry.convolution(weight, self.get_buffer(f"places{weight.shape[-1]}"), torch)
            bias = self.get_parameter(f"{name}.bias").repeat_interleave(ORDER)
        out = functional.conv2d(x, kernel, bias, stride=stride)
        return out if add is None else out + add

    def silu(self, x: Tensor, pad: int = 1) -> Tensor:
        """Return x / (1 + exp(-x)), padded with zeros, but periodically along xi of O grids."""
        x = functional.silu(x)
        if self.around and pad:
            return functional.pad(functional.pad(x, (0, 0, pad, pad), mode="circular"), (pad, pad))
        return functional.pad(x, (pad,) * 4)

    def finer(self, low: Tensor, skip: Tensor) -> Tensor:
        """Interpolate `low` linearly to the nodes of `skip`, and return the sum of both."""
        m, n = skip.shape[-2:]
        if self.around:
            low, m = torch.cat([low, low[:, :, :1]], 2), m + 1
        fine = functional.interpolate(low, size=(m, n), mode="bilinear", align_corners=True)
        return (fine[:, :, :-1] if self.around else fine) + skip


def _first_of_quad(name: str, shape: tuple[int, ...]) -> Tensor:
    """Return initial values: those of He et al., smaller in the second half of a residual block."""
    if name.endswith("bias"):
        return torch.zeros(shape)
    if name in ("lift", "project"):
        return (1.0 if name == "lift" else 0.1) * shape[-1] ** -0.5 * torch.randn(shape)
    gain = 0.3 if name.endswith(".b.weight") else 1.0
    return gain * (2.0 / math.prod(shape[1:])) ** 0.5 * torch.randn(shape)
