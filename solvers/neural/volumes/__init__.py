"""Networks for volumes inside six faces."""
