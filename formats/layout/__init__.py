"""Block layouts as JSON: the loops of a domain, vertices, edges with their curves, and four-sided faces.

::

    {"format": "meshonet-layout", "version": 1, "name": "step",
     "loops":    [{"points": [[0, 0], ...], "corners": [0, 1, 2], "names": ["outer"], "straight": true}],
     "vertices": [{"at": [0.5, 0.5]}, {"at": [0, 0], "loop": 0, "place": 2.0, "cells": 1}],
     "edges":    [{"vertices": [0, 1], "cells": 4, "points": [[0.2, 0.1], ...]},
                  {"vertices": [1, 3], "cells": 2, "loop": 0, "places": [2.5]}],
     "faces":    [{"south": [0], "east": [2], "north": [-2], "west": [3], "cells": [4, 2],
                   "points": [[0.1, 0.1], ...], "layers": 0}]}

- Loops: the domain is on their left, and the outer loop is the first. ``straight`` is true for polygons, else
  a list of the straight intervals. ``kinks`` are the points at which a smooth curve may bend. A loop with
  ``"front": true`` is not a wall but the outer front of layers; a grid has layers between it and the wall.
- A place on a loop is a number: the integer part is the index of a corner, the fraction the relative arc
  length from there to the next corner. On a loop without corners it is the relative arc length from the first
  point.
- Edges: points and places are those of the nodes between the two ends.
- Faces: points are those of the interior nodes, j fastest. Each side is a list of edges in the direction of i
  or j; an edge k that runs against this direction has the number -1 - k, like arcs in TopoJSON
  (https://github.com/topojson).
- Vertices and edges on a periodic side have their ``partner``. The layout then has ``periodic``: the arc
  lengths of both sides and the translation between them.
"""
