"""What is printed: reports of what is done, as JSON and for people, and errors in a line."""

from meshonet_cli.report.errors import explained as explained
from meshonet_cli.report.errors import option as option
from meshonet_cli.report.errors import with_options as with_options
from meshonet_cli.report.grid import Report as Report
from meshonet_cli.report.timed import Timed as Timed
