"""Notes on what checkMesh of OpenFOAM would find fault with."""

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.report import quality_report

_BEYOND = "beyond the limits of OpenFOAM's checkMesh"


def with_checkmesh_notes(notes: tuple[str, ...], grid: object) -> tuple[str, ...]:
    """Return `notes`, with those of `checkmesh_notes` on a grid unless they are there."""
    if not isinstance(grid, Grid) or any(note.startswith(_BEYOND) for note in notes):
        return notes
    return (*notes, *checkmesh_notes(grid))


def checkmesh_notes(grid: Grid, coarsened: int = 1) -> tuple[str, ...]:
    """Return a note on exceeded limits of checkMesh, if any, of a grid `coarsened` by a factor."""
    judged = quality_report(grid, "openfoam").profile
    exceeded = judged.beyond() if judged else []
    if not exceeded:
        return ()
    cause = f"; growth ratios are those of the fine grid to the power {coarsened}" if coarsened > 1 else ""
    return (f"{_BEYOND}: {', '.join(exceeded)}{cause}",)
