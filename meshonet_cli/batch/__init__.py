"""Batches: many inputs, one output file per input or one for all, in one process or several."""
