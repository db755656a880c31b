"""What is asked of a deformed grid besides its walls."""

from dataclasses import dataclass


@dataclass(frozen=True)
class DeformRequest:
    """Settings of `meshonet.deform`."""

    allow_invalid: bool = False
    """Return a grid with folded cells too."""
    percentiles: bool = False
    """Measure these as well."""
    threads: int | None = None
    """Of kernels; None is one a core."""
