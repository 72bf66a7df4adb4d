"""The one table of all keys of VCM's configuration files that concern membranes.

A row says where a key belongs, how its value is read, what it is if the file does not give it, and
what it means. The reader, its messages, the documentation and the tests go through this table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..forces import BendingForce, DihedralForce
from . import parsers as p
from .grammar import GENERAL, MEMBRANE

__all__ = ["KEYS", "Key", "NotDone", "keys_of"]


@dataclass(frozen=True)
class NotDone:
    """A value that VCM knows and this package does not do, and why; refused where it matters."""

    name: str
    reason: str


@dataclass(frozen=True)
class Key:
    """One key.

    section: the kind of section that it belongs to
    name: as written in the file
    parse: from words to the value, see `parsers`
    default: the words of a file that does not have the key
    doc: what it means, with its unit
    """

    section: str
    name: str
    parse: p.Parser
    default: str
    doc: str

    def value(self, words: tuple[str, ...]) -> Any:
        """The value of the words after the key; ValueError says what is wrong with them."""
        return self.parse(words)


_FORMULA = "its formula is not documented, and a guess would be other physics"
_INTEGRATORS = {"V": "Verlet", "B": "Brownian", "L": "Langevin", "LM": "LangevinMiddle"}
_SPRINGS = {
    "N": "",
    "H": "harmonic",
    **{name: NotDone(name, f"{_FORMULA}; use H, or N for none") for name in ("KG", "G", "A")},
}
_DIHEDRALS = {
    "cosine": DihedralForce.Cosine,
    "smoothTheta4": DihedralForce.Quartic,
    "exp": DihedralForce.Exp,
    "smoothExp": DihedralForce.SmoothExp,
    "smoothExp46": DihedralForce.SmoothExp46,
    "N": None,
}
_CURVATURES = {
    "N": None,
    "Julicher1996": BendingForce.Julicher,
    "Itzykson1986": BendingForce.GompperKroll,
    "ItzyksonBarycentric": BendingForce.GompperKrollBarycentric,
    "JulicherVoronoi": BendingForce.JulicherVoronoi,
    "Espiru1987": BendingForce.Espriu,
}


def _integrator(words: tuple[str, ...]) -> str:
    known = p.choice(_INTEGRATORS)
    name = words[0] if len(words) == 1 else ""
    if name.startswith(("GJF", "Global")) or name.endswith("MultiT"):
        raise ValueError(
            f"VCM's integrator {name} is not done here; use one of {', '.join(_INTEGRATORS)}"
        )
    return known(words)


_ZERO_UP, _POSITIVE, _ANY = p.number(0), p.number(0, zero=False), p.number()
_MODULUS_OF = "0 switches the potential off."

KEYS: tuple[Key, ...] = (
    Key(GENERAL, "ProjectName", p.one_word, "VCProject", "The name of the output files."),
    Key(GENERAL, "SimulationTimeInPs", _ZERO_UP, "10", "How long to simulate, ps."),
    Key(GENERAL, "StepSizeInFs", _POSITIVE, "10", "Time step, fs."),
    Key(
        GENERAL,
        "ReportIntervalInFs",
        p.interval,
        "1000",
        "Time between outputs, fs. `EXP x`: at the steps 1, x, x², …; `EXP Step n`: n outputs in "
        "geometric progression from the first step to the last.",
    ),
    Key(
        GENERAL,
        "Integrator",
        _integrator,
        "V",
        "V Verlet, B Brownian, L Langevin, LM Langevin with the middle scheme (what OpenMM's "
        "Langevin is too).",
    ),
    Key(GENERAL, "FrictionIninvertPs", _ZERO_UP, "5", "Friction of B, L and LM, 1/ps."),
    Key(GENERAL, "TemperatureinKelvin", _ZERO_UP, "310", "T of integrator and potentials, K."),
    Key(
        GENERAL,
        "setVelocitiesToTemperature",
        p.boolean,
        "false",
        "Draw the first velocities at T; otherwise they are zero.",
    ),
    Key(GENERAL, "Seed", p.integer(), "0", "Of all random numbers; 0 draws one, which is printed."),
    Key(GENERAL, "EpsilonH", _ZERO_UP, "4", "ε of the repulsions of heights and areas, kBT."),
    Key(GENERAL, "Minimise", p.boolean, "false", "Minimise the energy before the first step."),
    Key(GENERAL, "MinimiseTolerance", _POSITIVE, "10", "Root mean square force left, kJ/mol/nm."),
    Key(GENERAL, "MinimiseMaxIterations", p.integer(), "0", "0 for as many as it takes."),
    Key(GENERAL, "MCBarostatPressure", _ANY, "0", "Isotropic barostat, bar; 0 for none."),
    Key(GENERAL, "MCBarostatTemperature", _ZERO_UP, "0", "Its temperature, K; 0 for T."),
    Key(GENERAL, "MCBarostatFrequency", p.integer(), "0", "Steps between its moves; 0 for 25."),
    Key(
        GENERAL,
        "MCAnisoBarostatPressure",
        p.pressure,
        "0",
        "Anisotropic barostat, bar, one number or one per axis; 0 for none.",
    ),
    Key(GENERAL, "MCAnisoBarostatTemperature", _ZERO_UP, "0", "Its temperature, K; 0 for T."),
    Key(GENERAL, "MCAnisoBarostatFrequency", p.integer(), "0", "Steps between moves; 0 for 25."),
    Key(GENERAL, "CMMotionRemoverStep", p.integer(), "0", "Steps between removals; 0 for none."),
    Key(GENERAL, "ReportEnergy", p.boolean, "true", "Write the energy of each term to the log."),
    Key(GENERAL, "SimulationBoxLength", _ZERO_UP, "0", "Side of a periodic cube, nm; 0: none."),
    Key(
        GENERAL,
        "MinimumForceDecleration",
        p.flag_and_number,
        "false",
        "Only `false`: VCM's optimisation is not documented, and not needed here.",
    ),
    Key(
        GENERAL,
        "bondCutoff",
        p.integer(),
        "0",
        "Vertices of one membrane that so many edges or fewer join do not interact through the "
        "interaction table.",
    ),
    Key(
        GENERAL,
        "TextOutputs",
        p.outputs("PSF", "XYZ", "PDB", "VEL", "FORCE", "CURVE"),
        "PSF XYZ",
        "Text files to write; N for none.",
    ),
    Key(
        GENERAL,
        "BinOutputs",
        p.outputs("XYZ", "VEL", "TPK"),
        "N",
        "Binary files to write; N for none.",
    ),
    Key(
        GENERAL,
        "Precision",
        p.choice({name: name for name in ("single", "mixed", "double")}),
        "single",
        "Of the GPU platforms, and of the numbers in binary files (double, or else single).",
    ),
    Key(
        MEMBRANE,
        "MeshFile",
        p.one_word,
        "",
        "The mesh, beside the configuration: PLY, msh, OBJ; not one in a periodic box.",
    ),
    Key(MEMBRANE, "NodeMass", _POSITIVE, "1", "Mass of a vertex, amu."),
    Key(
        MEMBRANE,
        "NodeRadius",
        p.value_or("Av", "Au"),
        "Av",
        "Radius for the interaction table, nm: Av half the mean edge, Au half the mean of the "
        "vertex's own edges.",
    ),
    Key(MEMBRANE, "Scale", p.number(0, zero=False), "1", "Factor of all coordinates."),
    Key(MEMBRANE, "XYZscale", p.vector(zero=False), "1 1 1", "Factors of x, y, z, after Scale."),
    Key(MEMBRANE, "CoordinateTranslateVector", p.vector(), "0 0 0", "Displacement, nm."),
    Key(MEMBRANE, "VelocityShiftVector", p.vector(), "0 0 0", "Added to all velocities, nm/ps."),
    Key(
        MEMBRANE,
        "InitRandomRotation",
        p.boolean,
        "false",
        "Rotate at random about the origin, before the displacement.",
    ),
    Key(
        MEMBRANE,
        "XYZinMembrane",
        p.vector(),
        "0 0 0",
        "Accepted and not needed: triangles are turned outward by their neighbours.",
    ),
    Key(
        MEMBRANE,
        "SpringModel",
        p.choice(_SPRINGS),
        "H",
        "H ½k(r−r0)² on every edge; N none. KG, G and A are refused.",
    ),
    Key(MEMBRANE, "SpringCoeff", _ZERO_UP, "0", f"k, kJ/mol/nm². {_MODULUS_OF}"),
    Key(
        MEMBRANE,
        "NominalLengthInNm",
        p.value_or("Av", "Au", zero=True),
        "Av",
        "r0, nm: Av the mean edge, Au each edge's own length.",
    ),
    Key(
        MEMBRANE,
        "DihedralBendingModel",
        p.choice(_DIHEDRALS),
        "cosine",
        "Potential of the angle φ between neighbouring triangles: cosine, smoothTheta4, exp, "
        "smoothExp, smoothExp46; N none.",
    ),
    Key(MEMBRANE, "DihedralBendingCoeff", _ZERO_UP, "0", f"K, kJ/mol. {_MODULUS_OF}"),
    Key(
        MEMBRANE,
        "SpontaneousTriangleBendingAngleInDegrees",
        p.value_or("Au", "Av"),
        "180",
        "Angle between neighbouring triangles measured inside, degrees, 180 if flat: Au each "
        "edge's own, Av their mean.",
    ),
    Key(
        MEMBRANE,
        "MeanCurvatureModel",
        p.choice(_CURVATURES),
        "N",
        "Bending energy: Julicher1996, Itzykson1986, ItzyksonBarycentric, JulicherVoronoi, "
        "Espiru1987; N none.",
    ),
    Key(MEMBRANE, "MeanCurvatureCoeff", _ZERO_UP, "0", f"κ, kJ/mol. {_MODULUS_OF}"),
    Key(MEMBRANE, "MeanspontaneousCurvature", _ANY, "0", "C0, 1/nm, positive to bulge outward."),
    Key(
        MEMBRANE,
        "SurfaceConstraint",
        p.surface,
        "N",
        "G area of all, L of each triangle; GWCAH d, LWCAH d, WCAH d also (or only) repel heights "
        "below d nm; GWCA a, WCA a areas of triangles below a nm²; N none.",
    ),
    Key(MEMBRANE, "SurfaceConstraintCoeff", _ZERO_UP, "0", f"kA, kJ/mol/nm². {_MODULUS_OF}"),
    Key(
        MEMBRANE,
        "SurfaceConstraintValue",
        p.value_or("Au"),
        "Au",
        "A0, nm²: of the membrane for G, of a triangle for L; Au the mesh's own.",
    ),
    Key(MEMBRANE, "SurfaceConstraintRatio", _POSITIVE, "1", "Factor of A0."),
    Key(
        MEMBRANE,
        "VolumeConstraint",
        p.choice({"N": "", "G": "global"}),
        "N",
        "G enclosed volume, N none.",
    ),
    Key(MEMBRANE, "VolumeConstraintCoeff", _ZERO_UP, "0", f"kV, kJ/mol/nm³. {_MODULUS_OF}"),
    Key(MEMBRANE, "VolumeConstraintValue", p.value_or("Au"), "Au", "V0, nm³; Au the mesh's own."),
    Key(MEMBRANE, "VolumeConstraintRatio", _POSITIVE, "1", "Factor of V0."),
    Key(
        MEMBRANE,
        "LockOnPotential",
        p.lock_on,
        "N",
        "Hold vertices on a surface about the origin by ½k(r − R(θ))²: Sphere R, ULM2_0 u "
        "R(1 + u Y20). Ellipsoid is refused.",
    ),
    Key(MEMBRANE, "LockOnRigidity", _ZERO_UP, "0", f"k, kJ/mol/nm². {_MODULUS_OF}"),
    Key(MEMBRANE, "LockOnCoordinate", _ZERO_UP, "0", "R, nm."),
    Key(
        MEMBRANE,
        "Sticky",
        p.boolean,
        "false",
        "Bind every vertex to those of other membranes at the same place.",
    ),
    Key(MEMBRANE, "FreezeSubLattice", p.boolean, "false", "Vertices do not move (mass 0)."),
    Key(MEMBRANE, "ULM", p.deformation, "0 0 0", "u l m: r → r(1 + u Y_lm), after the scaling."),
    Key(
        MEMBRANE,
        "NUL",
        p.random_deformation,
        "0 0 2",
        "n u lmax: n random harmonics of 2 ≤ l ≤ lmax with amplitude u, after the scaling.",
    ),
    Key(
        MEMBRANE,
        "LJepsilon",
        p.value_or("kbt", zero=True),
        "kbt",
        "ε of LJ in the interaction table, kJ/mol; kbt for kBT.",
    ),
    Key(
        MEMBRANE,
        "LJsigma",
        p.value_or("NodeRadius"),
        "NodeRadius",
        "Radius for LJ in the interaction table, nm.",
    ),
)


def keys_of(section: str) -> dict[str, Key]:
    """The keys of a kind of section, by name."""
    return {key.name: key for key in KEYS if key.section == section}
