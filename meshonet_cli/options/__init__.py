"""Options that several commands share, each defined once: a module is a group of the help text.

A command takes an option by its type (``res: o.Resolution = None``), or a block of them, a dataclass whose
fields become options (``layers: o.LayerOptions``, see `meshonet_cli.options.groups`).
"""

from meshonet_cli.options.boundary_layer import *  # noqa: F403
from meshonet_cli.options.checks import *  # noqa: F403
from meshonet_cli.options.domain import *  # noqa: F403
from meshonet_cli.options.engine import *  # noqa: F403
from meshonet_cli.options.grids import GridOptions as GridOptions
from meshonet_cli.options.groups import BOUNDARY_LAYER as BOUNDARY_LAYER
from meshonet_cli.options.groups import CHECKS as CHECKS
from meshonet_cli.options.groups import DOMAIN as DOMAIN
from meshonet_cli.options.groups import IO as IO
from meshonet_cli.options.groups import METHOD as METHOD
from meshonet_cli.options.groups import SAMPLING as SAMPLING
from meshonet_cli.options.groups import VOLUME as VOLUME
from meshonet_cli.options.groups import bad_value as bad_value
from meshonet_cli.options.groups import expanded as expanded
from meshonet_cli.options.groups import numbers as numbers
from meshonet_cli.options.groups import only_with as only_with
from meshonet_cli.options.groups import option_of as option_of
from meshonet_cli.options.io import *  # noqa: F403
from meshonet_cli.options.method import *  # noqa: F403
from meshonet_cli.options.sampling import *  # noqa: F403
from meshonet_cli.options.volume import *  # noqa: F403
