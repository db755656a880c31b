"""The operator for four-sided domains: a network on a small grid that knows the symmetries of a quad."""
