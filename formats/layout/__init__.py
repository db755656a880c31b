"""Block layouts as JSON: the loops of a domain, vertices, edges with their curves, and four-sided faces.

::

    {"format": "meshonet-layout", "version": 1, "name": "step",
     "loops":    [{"points": [[0, 0], ...], "corners": [0, 1, 2], "names": ["outer"], "straight": true}],
     "vertices": [{"at": [0.5, 0.5]}, {"at": [0, 0], "loop": 0, "place": 2.0, "cells": 1}],
     "edges":    [{"vertices": [0, 1], "cells": 4, "points": [[0.2, 0.1], ...]},
                  {"vertices": [1, 3], "cells": 2, "loop": 0, "places": [2.5]}],
     "faces":    [{"south": [0], "east": [2], "north": [-2], "west": [3], "cells": [4, 2],
                   "points": [[0.1, 0.1], ...], "layers": 0}]}

A place on a loop is the number of a corner and, behind the point, the part of the way to the next one; on a
loop without corners it is the part of its length from the first point. Loops have the domain on their left,
the outer one first; ``straight`` is true for polygons, else a list of the intervals that are, and ``kinks``
are the points where a smooth curve may bend. A loop that is no wall but the front of layers, which a grid has
around the wall, has ``"front": true``. Points and places of edges are those of the nodes between the
ends; points of a face are the nodes inside, j fastest. The sides of a face run along i or j; an edge that is
run through backwards has the number -1 - k, as arcs have in TopoJSON (https://github.com/topojson). Vertices
and edges on a periodic side may name their ``partner``, and the layout has ``periodic``: for each pair of
stretches of the outer loop the arc lengths of both, the shift and the names.
"""
