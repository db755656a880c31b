"""The channel of Schaefer and Turek's benchmark 2D-1 as GeoJSON: python channel.py > channel.geojson."""

import json
import math

POINTS = 360
box = [(0.0, 0.0), (2.2, 0.0), (2.2, 0.41), (0.0, 0.41)]
turns = [2.0 * math.pi * k / POINTS for k in range(POINTS)]
circle = [(0.2 + 0.05 * math.cos(turn), 0.2 + 0.05 * math.sin(turn)) for turn in turns]
names = [["floor", "outlet", "ceiling", "inlet"], "cylinder"]
rings = [[*ring, ring[0]] for ring in (box, circle)]
polygon = {"type": "Polygon", "coordinates": rings}
print(json.dumps({"type": "Feature", "properties": {"names": names}, "geometry": polygon}))
