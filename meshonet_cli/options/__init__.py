"""Options that several commands share; each module contains a group of the help text.

A command accepts an option by its type (``res: o.Resolution = None``), or a block of options: a dataclass
whose fields become options (``layers: o.LayerOptions``, see `meshonet_cli.options.groups`).
"""

from meshonet_cli.options.boundary_layer import *  # noqa: F403
from meshonet_cli.options.checks import *  # noqa: F403
from meshonet_cli.options.domain import *  # noqa: F403
from meshonet_cli.options.grids import *  # noqa: F403  # noqa: F403
from meshonet_cli.options.groups import *  # noqa: F403
from meshonet_cli.options.io import *  # noqa: F403
from meshonet_cli.options.sampling import *  # noqa: F403
from meshonet_cli.options.volume import *  # noqa: F403
