"""Options that several commands share; each module is a group of the help text.

A command takes an option by its type, or a block of options: a dataclass whose fields are options.
"""

from meshonet_cli.options.boundary_layer import *  # noqa: F403
from meshonet_cli.options.checks import *  # noqa: F403
from meshonet_cli.options.domain import *  # noqa: F403
from meshonet_cli.options.grids import *  # noqa: F403
from meshonet_cli.options.groups import *  # noqa: F403
from meshonet_cli.options.io import *  # noqa: F403
from meshonet_cli.options.sampling import *  # noqa: F403
from meshonet_cli.options.volume import *  # noqa: F403
