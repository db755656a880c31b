"""Operators for four-sided domains and for bodies: one network, equivariant under relabellings."""
