"""Aircraft: bodies and the wings on them."""
