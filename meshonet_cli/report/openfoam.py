"""Notes on what checkMesh of OpenFOAM would find fault with."""

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.report import quality_report


def checkmesh_notes(grid: Grid, coarsened: int = 1) -> tuple[str, ...]:
    """Return a note on the limits of checkMesh that a grid exceeds; none if it exceeds none.

    `coarsened` is the factor by which the grid was coarsened.
    """
    judged = quality_report(grid, "openfoam").profile
    exceeded = judged.beyond() if judged else []
    if not exceeded:
        return ()
    cause = f"; growth ratios are those of the fine grid to the power {coarsened}" if coarsened > 1 else ""
    return (f"beyond the limits of OpenFOAM's checkMesh: {', '.join(exceeded)}{cause}",)
