"""Requests from the keyword parameters of the public functions."""

from dataclasses import fields
from typing import Any

from meshonet.geometry.errors import meant
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.choose_method import method_of
from meshonet.solvers.pipeline.named import UnknownSettingError
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.uses import COUNTED, Counts, counted


def grid_request(method: str = "best", *, res: Counts | None = None, **parameters: Any) -> GridRequest:
    """Return a request, which contains all options of a grid, from keyword parameters.

    Parameters
    ----------
    method : str, optional
        Name of the method, as in `GridRequest`.
    res : int or tuple of int, optional
        Numbers of nodes along xi, eta and, for volumes, zeta. A single number applies to all directions, but
        only to xi if ``growth`` determines the number of rows.
    **parameters
        Fields of `Sampling` and `GridRequest`, and settings of the method. Settings that are None are
        ignored. ``wall_spacing`` is another name of ``first_cell``.

    Returns
    -------
    GridRequest
        The validated request.

    Raises
    ------
    InputError
        As for `GridRequest`; also a parameter that the method does not have.

    Examples
    --------
    >>> request = grid_request("winslow", res=(80, 40), topology="o", tol=1e-8)
    >>> request.sampling.ni, request.sampling.topology, request.settings
    (80, 'o', {'tol': 1e-08})
    """
    if "wall_spacing" in parameters:
        parameters["first_cell"] = parameters.pop("wall_spacing")
    sampling = sampling_of(res, parameters)
    of_request = {name: parameters.pop(name) for name in REQUESTED if name in parameters}
    settings = {name: value for name, value in parameters.items() if value is not None}
    request = GridRequest(sampling, method, settings, **of_request)
    if settings:
        try:
            method_of(request)
        except UnknownSettingError as error:
            error.remedy = meant(error.setting, ("res", *SAMPLED, *REQUESTED), _LIKENESS) + error.remedy
            raise
    return request


def sampling_of(res: Counts | None, parameters: dict[str, Any]) -> Sampling:
    """Return the sampling with node counts `res`; its other fields are taken out of `parameters`."""
    counts = counted(res, parameters)
    return Sampling(**counts, **{name: parameters.pop(name) for name in SAMPLED if name in parameters})


SAMPLED = tuple(each.name for each in fields(Sampling) if each.name not in (*COUNTED, "viscous"))
"""Parameters of the sampling, without node counts and without fields that follow from first cells."""
_LIKENESS = 0.75
"""Least similarity of a suggested name: ``polish`` is a setting of other methods, and not ``poles``."""
REQUESTED = tuple(
    each.name for each in fields(GridRequest) if each.name not in ("sampling", "method", "settings")
)
"""Parameters of the request; all others are settings of the method."""
