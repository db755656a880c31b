"""OpenFOAM meshes, ``constant/polyMesh``, of volumes or of planar grids one cell thick."""
