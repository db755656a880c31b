"""How many cells the blocks of a layout have, and how long these are."""
