"""Settings of a deformation."""

from dataclasses import dataclass


@dataclass(frozen=True)
class DeformRequest:
    """Settings of `meshonet.deform`."""

    allow_invalid: bool = False  # return the grid even if cells are folded
    percentiles: bool = False  # compute percentiles of the quality measures too
    threads: int | None = None  # number of threads of the kernels; None stands for one per core
