"""Trained arrays as parameters of torch under the names that they have in model files."""

from collections.abc import Mapping

from torch import Tensor, nn


class NamedParameters(nn.Module):
    """A network whose parameters are `arrays`; a dot in a name leads into a module of parameters."""

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
