"""The public functions, one module per command."""
