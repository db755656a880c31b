"""Engines that distribute a batch: each returns a `concurrent.futures.Executor`."""
