"""Curves through points: splines by arc length, limited where they would overshoot."""
