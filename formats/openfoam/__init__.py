"""OpenFOAM's mesh of a case, ``constant/polyMesh``, of volumes or of planes one cell thick."""
