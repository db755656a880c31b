"""The cross field on a triangulated surface, and the seamless map aligned with it."""
