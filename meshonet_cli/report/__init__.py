"""Reports of what is done, as JSON and for people."""
