"""Closed curves out of drawings and vector geometry."""
