"""What the Custom forces of a System mean, found from their values.

Each module knows one kind of stencil. It evaluates a given expression at random places, writes it
as a sum of known quantities by least squares, and accepts only what agrees to `fit.TOLERANCE` at
places that the fit has not seen, on both sides of every branch of the expression. How the
expression is written does not matter; only its values do.

- `source`: the bonds of a Custom force as arrays
- `fit`: random places, least squares, values as functions of global parameters
- `rings`: bending energies, over a vertex and its neighbours
- `triangles`: areas, volumes, heights, over one triangle, a pair, or a triangle and an apex
- `edges`: dihedral energies, over two neighbouring triangles
- `surface`: closed surfaces of the triangles that turned up, and which side is outside
- `constraints`, `local`, `bending`: whole potentials (`term`) from the bonds' energies
- `reader`: all forces of a System read and put together
- `fixed`, `conditions`: global parameters that must be numbers, or follow others, for a force to be
  ours
"""
