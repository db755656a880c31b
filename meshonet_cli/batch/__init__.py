"""Batches: records in, one file each or one for all, in one process or in several."""
