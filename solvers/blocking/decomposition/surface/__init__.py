"""The triangulated surface of a domain, and equations on it."""
