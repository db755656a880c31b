"""What a stage of the decomposition says when it cannot go on."""

from meshonet.geometry.errors import SolverError


class BlockingError(SolverError):
    """A stage failed for one triangulation of a domain; another triangulation may do."""
