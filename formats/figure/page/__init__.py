"""A grid as one interactive page: data, program and style in a single file that opens without a network."""
