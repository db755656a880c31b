"""Volumes marched from surfaces of many patches."""
