"""`meshonet.layout`."""

from collections.abc import Sequence
from typing import Any

from meshonet.api.grid import AnyShape, domain_parameters, shape_of
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.pipeline.blocks import make_layout
from meshonet.solvers.pipeline.parameters import grid_request


def layout(shape: AnyShape | Sequence[AnyShape], *, assemble: bool = False, **parameters: Any) -> Layout:
    """Split a domain into blocks.

    Parameters
    ----------
    shape : str, Path, array, Grid, Boundary or Domain, or a list of these
        Shape, as for `grid`.
    assemble : bool, optional
        Combine all shapes in the list into one domain.
    **parameters
        The parameters ``cells``, ``cell_size``, ``count``, ``periodic``, ``layout`` and ``far_field`` of
        `meshonet.GridRequest` and `meshonet.Sampling`. With layers (``first_cell``, or ``y_plus`` and
        ``reynolds``, and optionally ``walls``) the result contains only the blocks outside the layers.

    Returns
    -------
    Layout
        The blocks and their nodes.

    Raises
    ------
    InputError
        A shape or parameter that cannot be used.
    SolverError
        The domain could not be divided into blocks.

    Examples
    --------
    >>> import numpy as np
    >>> step = np.array([[0, 1], [2, 1], [2, 0], [6, 0], [6, 2], [0, 2]])
    >>> len(layout(step).blocks)
    3
    """
    request = grid_request("best", **domain_parameters(parameters))
    return make_layout(shape_of(shape, assembled_by=request.sampling if assemble else None), request)[0]
