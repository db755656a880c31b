"""Cells of given heights at the walls of any grid."""
