"""Reports of results, as JSON and as text."""
