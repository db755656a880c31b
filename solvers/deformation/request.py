"""Settings of a deformation."""

from dataclasses import dataclass


@dataclass(frozen=True)
class DeformRequest:
    """Settings of `meshonet.deform`."""

    allow_invalid: bool = False
    """Return the grid even if cells are folded."""
    percentiles: bool = False
    """Compute percentiles of the quality measures too."""
    threads: int | None = None
    """Number of threads of the kernels; None stands for one per core."""
