"""The one table of keys: what each is called, how it is read, its default and its meaning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..forces import BendingForce, DihedralForce, MonteCarloMembraneTension
from ..simulation.frames import FRAMES
from .values import (
    Reader,
    area_difference,
    boolean,
    box,
    choice,
    choices,
    counts,
    energy,
    flips,
    integer,
    mode,
    number,
    osmotic,
    scale,
    signed_energy,
    skeleton,
    text,
    vector,
    viscosity,
)

__all__ = ["KEYS", "REQUIRED", "Key", "keys_of"]

#: The default of a key that must be given.
REQUIRED = object()
_SCHEMES = {
    name: getattr(BendingForce, name)
    for name in (
        "Julicher",
        "GompperKroll",
        "GompperKrollBarycentric",
        "JulicherVoronoi",
        "Espriu",
    )
}
_FORMS = {
    name: getattr(DihedralForce, name)
    for name in ("Quartic", "Cosine", "Exp", "SmoothExp", "SmoothExp46")
}
#: Text outputs, by VCM's name of each.
_TEXTS = {
    "psf": "PSF",
    "xyz": "XYZ",
    "pdb": "PDB",
    "velocities": "VEL",
    "forces": "FORCE",
    "curvatures": "CURVE",
}
_AXES = {
    name: getattr(MonteCarloMembraneTension, name)
    for name in ("XYIsotropic", "XYIndependent", "XYConstantArea", "ZOnly")
}
_INTEGRATORS = ("Verlet", "LangevinMiddle", "Langevin", "Brownian")
_MAX_SEED = 2**31 - 1


@dataclass(frozen=True)
class Key:
    """One key of the format.

    table: the table that it belongs to; name; read: from the TOML value to what is meant; default:
    what is meant without it, None for "as described", `REQUIRED` if it must be given; meaning: for
    the documentation, with the unit.
    """

    table: str
    name: str
    read: Reader
    default: Any
    meaning: str


KEYS: tuple[Key, ...] = (
    Key("simulation", "name", text, None,
        "Name of the output files, and of their folder. Default: that of the file."),
    Key("simulation", "duration", number(least=0), REQUIRED, "How long to simulate, ps."),
    Key("simulation", "seed", integer(0, _MAX_SEED), 0,
        "Of all random numbers; 0 draws one, which is printed and kept."),
    Key("simulation", "platform", text, None,
        "OpenMM platform, unless --platform names another. Default: the fastest."),
    Key("simulation", "minimise", boolean, False,
        "Minimise the energy before the first step, until forces are 0.01 kJ/mol/nm (rms)."),
    Key("simulation", "thermal_velocities", boolean, True,
        "Draw the first velocities at the temperature; otherwise they are zero."),
    Key("integrator", "kind", choice(_INTEGRATORS), "LangevinMiddle",
        "One of " + ", ".join(f"`{name}`" for name in _INTEGRATORS) + "."),
    Key("integrator", "time_step", number(above=0), 0.2, "Δt, ps."),
    Key("integrator", "temperature", number(above=0), 300.0,
        "T, K, also that of \"… kT\" and of the first velocities."),
    Key("integrator", "friction", number(least=0), 0.01, "γ, 1/ps; Verlet has none."),
    Key("output", "interval", number(above=0), 100.0, "Time between frames, ps, in whole steps."),
    Key("output", "xtc", boolean, True, "Write a trajectory `<name>.xtc`."),
    Key("output", "frames", choice(FRAMES), "none",
        "Write a mesh per vesicle and frame: `\"ply\"`, `\"obj\"`, `\"stl\"` or `\"vtk\"`, or one "
        "file of all: `\"vtkhdf\"` for ParaView, `\"gsd\"` for HOOMD and OVITO, `\"extxyz\"` for "
        "OVITO and ASE. All but OBJ and STL have the vertices' mean curvatures and areas."),
    Key("output", "ply", boolean, False, "Short for `frames = \"ply\"`."),
    Key("output", "text", choices(_TEXTS), (),
        "Text files: an array of " + ", ".join(f"`\"{name}\"`" for name in _TEXTS) + "."),
    Key("box", "vectors", box, REQUIRED,
        "Periodic box of everything, nm: `[x, y, z]`, or three vectors `[[ax, 0, 0], [bx, by, 0], "
        "[cx, cy, cz]]`. Without the table: that of the meshes, if they have one."),
    Key("vesicle", "name", text, None, "Label in file names and tables. Default: its number."),
    Key("vesicle", "rigidity", energy, None, "Bending rigidity κ, kJ/mol. Default: 20 kBT, 300 K."),
    Key("vesicle", "scheme", choice(_SCHEMES), None,
        "Discretization of bending: " + ", ".join(f"`{name}`" for name in _SCHEMES)
        + ". Default: `Julicher`."),
    Key("vesicle", "spontaneous_curvature", number(), None,
        "C0, 1/nm, positive to bulge outward. Default: 0."),
    Key("vesicle", "unsigned_spontaneous_curvature", boolean, None,
        "VCM's magnitude of the curvature in the linear term of C0. Default: false."),
    Key("vesicle", "area_modulus", number(least=0), None, "kA, kJ/mol/nm². Default: 1.3."),
    Key("vesicle", "volume_modulus", number(least=0), None, "kV, kJ/mol/nm³; 0 for meshes with "
        "borders, or that span the box. Default: 0.04."),
    Key("vesicle", "area", number(above=0), None, "A0, nm². Default: that of the mesh."),
    Key("vesicle", "volume", number(above=0), None, "V0, nm³. Default: that of the mesh."),
    Key("vesicle", "reduced_volume", number(above=0, most=1), None,
        "V0 as a multiple of the volume of the sphere of area A0, in place of `volume`."),
    Key("vesicle", "softness", number(least=0), None,
        "Ξ, which fixes the least triangle height. Default: 0.037."),
    Key("vesicle", "epsilon", energy, None,
        "ε of the triangle heights, kJ/mol. Default: 4 kBT, 300 K."),
    Key("vesicle", "mass", number(above=0), None, "Mass of every vertex, amu. Default: 50."),
    Key("vesicle", "dihedral_stiffness", energy, None,
        "K of a dihedral potential, kJ/mol. Default: 0, none."),
    Key("vesicle", "dihedral_form", choice(_FORMS), None,
        "Its form: " + ", ".join(f"`{name}`" for name in _FORMS) + ". Default: `Quartic`."),
    Key("vesicle", "triangle_area_modulus", number(least=0), None,
        "Modulus that keeps each triangle near its first area, kJ/mol/nm². Default: 0, none."),
    Key("vesicle", "plaquette_stiffness", energy, None,
        "Stiffness that keeps vertex areas equal, kJ/mol. Default: 0, none."),
    Key("vesicle", "min_triangle_area", number(least=0), None,
        "Triangle area below which triangles repel, nm². Default: 0, none."),
    Key("vesicle", "edge_tension", number(), None,
        "γ, energy per length of borders, kJ/mol/nm. Default: 0, none."),
    Key("vesicle", "gaussian_modulus", signed_energy, None,
        "κ_G, kJ/mol, which acts at borders. Default: 0, none."),
    Key("vesicle", "pressure", number(), None,
        "p, inside less outside, kJ/mol/nm³. Default: 0, none."),
    Key("vesicle", "surface_tension", number(), None,
        "σ, energy per area, kJ/mol/nm². Default: 0, none."),
    Key("vesicle", "osmotic", osmotic, None,
        "Solutes that cannot pass: `{ solutes = 1e6, concentration = 0.06 }`, their number inside "
        "and 1/nm³ outside; `thermal_energy`, kJ/mol, is that of the integrator's temperature. "
        "Default: none."),
    Key("vesicle", "area_difference", area_difference, None,
        "Area-difference elasticity: `{ alpha = 1.4, delta_a0 = 1.1 }`, for `rigidity` and `area`, "
        "or `{ modulus = …, target = … }`, kJ/mol/nm² and nm; see [energies.md](energies.md). "
        "Default: none."),
    Key("vesicle", "skeleton", skeleton, None,
        "Elasticity against the mesh: `{ law = \"Skalak\", shear_modulus = 0.004, "
        "area_modulus = 0.01 }`, kJ/mol/nm², or the laws `NeoHookean` and `LinearElastic`, or "
        "`{ law = \"Spring\", stiffness = 0.01, form = \"WLCPower\", ratio = 0.45 }`; see "
        "[energies.md](energies.md). Default: none."),
    Key("vesicle", "flips", flips, None,
        "Flip bonds, so that the membrane is fluid: attempts per edge and step, such as 0.01, or a "
        "table `{ attempts_per_edge = 0.1, frequency = 10, min_degree = 3, max_degree = 10, "
        "max_edge_length = 0, temperature = 300 }`; see [flips.md](flips.md). Default: none."),
    Key("vesicle", "viscosity", viscosity, None,
        "Make the membrane viscous: the surface shear viscosity η of a regular mesh, amu/ps, or a "
        "table `{ friction = 20, frequency = 1, temperature = 300 }` with the friction of each "
        "edge; see [viscosity.md](viscosity.md). Default: none."),
    Key("vesicle.mesh", "file", text, None,
        "A mesh file, beside the configuration: PLY, OBJ, STL, OFF, VTK, VTP, VTU, Gmsh."),
    Key("vesicle.mesh", "triangulate", boolean, False,
        "Split the file's faces of more than three corners."),
    Key("vesicle.mesh", "merge", number(least=0), None,
        "Join the file's vertices at most so far apart, in its numbers."),
    Key("vesicle.mesh", "drop_unused", boolean, False,
        "Leave out the file's vertices that belong to no triangle."),
    Key("vesicle.mesh", "icosphere", integer(1), None,
        "In place of a file: a regular sphere, each side of the icosahedron in n parts, "
        "N = 10 n² + 2."),
    Key("vesicle.mesh", "random", integer(12), None,
        "In place of a file: an irregular sphere of so many vertices."),
    Key("vesicle.mesh", "sheet", counts(2), None,
        "In place of a file: a flat sheet of `[nx, ny]` vertices, see `Mesh.sheet`."),
    Key("vesicle.mesh", "tube", counts(2), None,
        "In place of a file: a tube of `[n_around, n_along]` vertices, see `Mesh.tube`."),
    Key("vesicle.mesh", "disk", integer(1), None,
        "In place of a file: a flat disk of so many rings, see `Mesh.disk`."),
    Key("vesicle.mesh", "spacing", number(above=0), None,
        "Length of the edges of `sheet`, nm; it needs it."),
    Key("vesicle.mesh", "length", number(above=0), None, "Length of `tube`, nm; it needs it."),
    Key("vesicle.mesh", "periodic", boolean, False,
        "`sheet` and `tube` span a periodic box, which is made with them."),
    Key("vesicle.mesh", "radius", number(above=0), None,
        "Radius of `icosphere`, `random`, `tube` and `disk`, nm; they need it."),
    Key("vesicle.mesh", "seed", integer(0, _MAX_SEED), None, "Of `random`. Default: 0."),
    Key("vesicle.mesh", "scale", scale, None, "Factor of the coordinates, or three of them."),
    Key("vesicle.mesh", "deform", mode, None,
        "r → r (1 + u Y_lm): `{ l = 2, m = 0, amplitude = 0.1 }`."),
    Key("vesicle.mesh", "oblate", number(above=0), None,
        "Flatten along z to this reduced volume, at constant area."),
    Key("vesicle.mesh", "prolate", number(above=0), None,
        "Stretch along z to this reduced volume, at constant area."),
    Key("vesicle.mesh", "rotate", vector, None,
        "Rotation vector about the origin, degrees: `[0, 0, 90]` is a quarter turn about z."),
    Key("vesicle.mesh", "translate", vector, None, "Displacement, nm."),
    Key("tension", "tension", number(), 0.0,
        "Of the frame, kJ/mol/nm²; see `MonteCarloMembraneTension`, which changes the box."),
    Key("tension", "pulling_force", number(), 0.0, "Along z, kJ/mol/nm; only with `ZOnly`."),
    Key("tension", "axes", choice(_AXES), None,
        "What changes: " + ", ".join(f"`{name}`" for name in _AXES) + ". Default: `XYIsotropic`."),
    Key("tension", "frequency", integer(1), 25, "Steps between moves."),
    Key("watch", "max_temperature", number(above=0), None,
        "K: a run whose particles are hotter counts as broken down, and says why. Default: none."),
    Key("watch", "min_height", number(above=0), None,
        "nm: so does one in which a triangle is less high. Default: none."),
    Key("watch", "max_fold", number(above=0, most=180), None,
        "Degrees: so does one in which an edge is bent by more, 0 where it is flat, 180 where its "
        "triangles lie upon each other. Default: none."),
    Key("repulsion", "strength", energy, REQUIRED,
        "ε, kJ/mol, of ε ((D/d)⁶ − 1)² at a distance d; see `SurfaceRepulsionForce`."),
    Key("repulsion", "distance", number(above=0), REQUIRED, "D, nm, beyond which there is none."),
    Key("repulsion", "within", boolean, False,
        "Let it act within each vesicle, too; D must be less than its triangles are high."),
)  # fmt: skip


def keys_of(table: str) -> dict[str, Key]:
    """The keys of a table by name."""
    return {key.name: key for key in KEYS if key.table == table}
