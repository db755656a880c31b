"""Engines that work on members of a batch: each gives a `concurrent.futures.Executor`."""
