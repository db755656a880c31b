"""What goes wrong in decomposing a domain."""

from meshonet.geometry.errors import SolverError


class BlockingError(SolverError):
    """A stage of the decomposition did not come to an end that is of use; another triangulation may help."""
