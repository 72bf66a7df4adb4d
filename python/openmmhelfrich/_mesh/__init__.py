"""The rooms behind `openmmhelfrich.mesh`: what `Mesh` can do, and one file per file format.

`Mesh` alone is public. Its bases are in ``generators.py``, ``measures.py`` and
``transformations.py``. The other modules pass plain arrays: vertices, float64 of shape
(num_vertices, 3) in nm, and triangles, int64 of shape (num_triangles, 3).
"""
