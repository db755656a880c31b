"""Positions of nodes along a curve: spacing laws, size fields, first cells."""
