"""The version, readable without the package metadata, whose look-up costs more than a small grid."""

VERSION = "0.1.0"
