"""The rooms behind `openmmhelfrich.mesh`: geometry, generators, and one file per file format.

`Mesh` alone is public. These modules pass plain arrays: vertices, float64 of shape
(num_vertices, 3) in nm, and triangles, int64 of shape (num_triangles, 3).
"""
