"""The passage between the blades of a cascade."""
