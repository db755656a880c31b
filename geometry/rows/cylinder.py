"""Airfoils on cylinders: blade profiles that are given in the plane."""

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.rows.thick_edge import round_edged
from meshonet.geometry.sections.section import Section
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil


def on_cylinder(
    section: Section, about: tuple[float, float], stagger: float, x: float, theta: float
) -> tuple[Floats, tuple[str, ...]]:
    """Return the points (n, 3) of a section wrapped onto a cylinder, with a round trailing edge, and notes.

    Parameters
    ----------
    section : the airfoil with its chord; its z is the radius of the cylinder.
    about : a point of the section, (x, y) in chords from the leading edge.
    stagger : angle of the chord from the axis, towards growing theta, in radians.
    x, theta : where the point `about` lies on the cylinder around the x axis; theta = atan2(y, z) in radians.
    """
    origin, length = section.frame
    shape, notes = section.shape, section.shape.notes
    if isinstance(shape, Airfoil):
        shape, changes = round_edged(shape)
        notes += changes
    a, b = ((shape.curve.points - origin) / length - np.array(about)).T * section.chord
    c, s = math.cos(stagger), math.sin(stagger)
    angle = theta + (a * s + b * c) / section.z
    points = np.stack([x + a * c - b * s, section.z * sin(angle), section.z * cos(angle)], axis=1)
    return points, notes
