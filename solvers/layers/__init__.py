"""First cells of given height at walls, and wall nodes that slide."""
