"""Closed curves from drawings and vector geometry."""
