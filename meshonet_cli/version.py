"""The version, readable without the package metadata, whose look-up costs more than a small grid."""

import meshonet

VERSION = meshonet.__version__
