"""``meshonet sample-boundary``."""

from __future__ import annotations

from meshonet_cli import options as o

EXAMPLES = (
    "meshonet sample-boundary airfoil.dat --res 200x100 --te-spacing 0.001 -o boundary.h5",
    "meshonet sample-boundary naca:2412 -o - | meshonet tfi - -o - | meshonet quality -",
)


def sample_boundary(
    source: o.Boundaries,
    output: o.Output,
    res: o.Resolution = None,
    topology: o.TopologyOption = "auto",
    spacing: o.SpacingOption = "auto",
    le_spacing: o.LeSpacing = None,
    te_spacing: o.TeSpacing = None,
    far_field: o.FarField = 15.0,
    corners: o.Corners = "auto",
    normalise: o.Normalise = False,
    from_format: o.From = None,
    to_format: o.To = None,
    skip_existing: o.SkipExisting = False,
    jobs: o.Jobs = 1,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
    debug: o.Debug = False,
) -> int:
    """Turn geometry into boundaries of four edges."""
    from meshonet_cli.batch import Destination
    from meshonet_cli.bounding import sample_shapes
    from meshonet_cli.session import Session

    lengths = {"le_spacing": le_spacing, "te_spacing": te_spacing, "far_field": far_field}
    sampling = o.sampling(res, topology, spacing, corners, normalise=normalise, **lengths)
    session = Session(quiet=quiet, as_json=as_json, debug=debug)
    destination = Destination(output, to_format, "boundaries")
    return sample_shapes(
        source, sampling, destination, session, fmt=from_format, skip_existing=skip_existing, jobs=jobs
    )
