"""Numbers that others have computed: VCM's golden file and the tables of physics.md.

The files are not part of the project; `folder()` says where they may be, and the `shared` fixture
skips what needs them.
"""

from __future__ import annotations

import gzip
import json
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import openmm as mm
import string_forces
from meshes import Membrane

# VCM's value, to the digits that it prints; the tables of physics.md are made with it too.
KB = 0.008314459920816468
KT = 300 * KB


def folder() -> Path:
    beside = Path(__file__).resolve().parents[3] / "shared"
    return Path(os.environ.get("HELFRICH_SHARED", beside))


# --- VCM's golden cases --------------------------------------------------------------------------


@cache
def _golden() -> dict[str, Any]:
    with gzip.open(folder() / "golden" / "vcm.json.gz", "rt", encoding="utf-8") as file:
        return json.load(file)["cases"]


@cache
def golden_membranes() -> tuple[Membrane, ...]:
    """The two meshes of the golden cases; none if the file is not here."""
    if not (folder() / "golden" / "vcm.json.gz").is_file():
        return ()
    membranes = []
    for name, case in (("g252", "g252_Julicher1996"), ("gold", "goldjul")):
        data = _golden()[case]
        positions = np.array(data["positions_nm"], dtype=float)
        membranes.append(Membrane(name, positions, np.array(data["triangles"], dtype=int)))
    return tuple(membranes)


@dataclass(frozen=True)
class GoldenTerm:
    """One term of one golden case: how to make it, and how closely VCM's digits can be met.

    VCM's area and volume are pairwise sums and its height constants have six decimals, hence
    their tolerances; its curvature energies are good to the last bits.
    """

    case: str
    term: str
    force: str
    tolerance: float
    variant: tuple[str, str] | None = None
    settings: dict[str, Any] = field(default_factory=dict, hash=False)

    def __str__(self) -> str:
        return f"{self.case}-{self.term}"

    @property
    def data(self) -> dict[str, Any]:
        return _golden()[self.case]

    @property
    def membrane(self) -> Membrane:
        prefix = self.case.split("_")[0][:4]
        (found,) = [m for m in golden_membranes() if m.name == prefix]
        return found

    @property
    def energy(self) -> float:
        return self.data["energy"][self.term]

    @property
    def forces(self) -> np.ndarray:
        return np.array(self.data["forces"][self.term])

    def arguments(self) -> dict[str, float]:
        data = self.data
        if self.force == "SurfaceAreaForce":
            return {"modulus": data["kA"], "target": float(data["A0"])}
        if self.force == "EnclosedVolumeForce":
            return {"modulus": data["kV"], "target": float(data["V0"])}
        if self.force == "TriangleHeightForce":
            return {"minHeight": data["d_h"], "epsilon": data["eps_h_over_kBT"] * KT}
        curvature = float(data["C0"] or 0)
        return {"rigidity": data["kappa"], "spontaneousCurvature": curvature}


def _golden_terms() -> list[GoldenTerm]:
    rows = []
    for case, term, scheme in (
        ("g252_Julicher1996", "Julicher", "Julicher"),
        ("goldjul", "Julicher", "Julicher"),
        ("g252_JulicherVoronoi", "JulicherVoronoi", "JulicherVoronoi"),
        ("g252_Itzykson1986", "Itzykson", "GompperKroll"),
        ("g252_ItzyksonBarycentric", "ItzyksonBarycentric", "GompperKrollBarycentric"),
        ("g252_ItzyksonBarycentric_c0", "ItzyksonBarycentric", "GompperKrollBarycentric"),
        ("goldgkb", "ItzyksonBarycentric", "GompperKrollBarycentric"),
    ):
        unsigned = {"setUnsignedSpontaneousCurvature": True} if case.endswith("_c0") else {}
        variant = ("scheme", scheme)
        rows.append(GoldenTerm(case, term, "BendingForce", 1e-9, variant, unsigned))
        rows.append(GoldenTerm(case, "WCAH", "TriangleHeightForce", 1e-6))
        # The meshes of 1002 vertices are at their own area and volume: rounding noise is all
        # there is to compare.
        if case.startswith("g252"):
            rows.append(GoldenTerm(case, "Area", "SurfaceAreaForce", 1e-8))
            rows.append(GoldenTerm(case, "Volume", "EnclosedVolumeForce", 1e-8))
    return rows


GOLDEN_TERMS = _golden_terms()


# --- the tables of physics.md --------------------------------------------------------------------


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of an ASCII PLY file of those of VCM, turned outward."""
    lines = path.read_text(encoding="utf-8").splitlines()
    end = lines.index("end_header")
    counts = [int(line.split()[2]) for line in lines[:end] if line.startswith("element")]
    body = lines[end + 1 :]
    vertices = np.array([[float(x) for x in line.split()[:3]] for line in body[: counts[0]]])
    rows = body[counts[0] : counts[0] + counts[1]]
    return vertices, oriented(vertices, [[int(x) for x in line.split()[1:4]] for line in rows])


def oriented(vertices: np.ndarray, triangles) -> np.ndarray:
    """The triangles of one closed surface, all turned to agree with each other and outward."""
    triangles = [list(row) for row in triangles]
    by_edge: dict[frozenset[int], list[int]] = {}
    for number, (a, b, c) in enumerate(triangles):
        for edge in ((a, b), (b, c), (c, a)):
            by_edge.setdefault(frozenset(edge), []).append(number)

    def runs(number: int, tail: int, head: int) -> bool:
        a, b, c = triangles[number]
        return (tail, head) in ((a, b), (b, c), (c, a))

    seen, stack = {0}, [0]
    while stack:
        number = stack.pop()
        a, b, c = triangles[number]
        for tail, head in ((a, b), (b, c), (c, a)):
            for other in by_edge[frozenset((tail, head))]:
                if other not in seen:
                    seen.add(other)
                    stack.append(other)
                    if runs(other, tail, head):
                        triangles[other].reverse()
    result = np.array(triangles)
    a, b, c = (vertices[column] for column in result.T)
    volume = np.einsum("ij,ij->", a, np.cross(b, c))
    return result if volume > 0 else result[:, ::-1].copy()


def deformed_y20(vertices: np.ndarray, amplitude: float) -> np.ndarray:
    """r → r (1 + u Y20)."""
    cosine = vertices[:, 2] / np.linalg.norm(vertices, axis=1)
    return vertices * (1 + amplitude * (5 / (16 * np.pi)) ** 0.5 * (3 * cosine**2 - 1))[:, None]


SPHERE = "USphere_1002d_r_s0.ply"
RED_CELL = "1002d_s0_RBC_init.ply"
LARGE_RED_CELL = "USphere_4002n_RBC_init.ply"

# How the meshes of the tables come from their files.
TABLE_MESHES: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
    "sphere": (SPHERE, lambda v: v * 1000),
    "oblate": (SPHERE, lambda v: v * 1320 * [1, 1, 0.26062]),
    "red cell": (RED_CELL, lambda v: v * 1320),
    "deformed": (SPHERE, lambda v: deformed_y20(v * 1000, 0.3)),
    "large red cell": (LARGE_RED_CELL, lambda v: v * 2640),
}


@cache
def table_mesh(name: str) -> Membrane:
    file, transform = TABLE_MESHES[name]
    vertices, triangles = read_ply(folder() / "vcm" / file)
    return Membrane(name, transform(vertices), triangles)


@dataclass(frozen=True)
class Printed:
    """A number of a table, as printed: what is to be met is every digit of it."""

    mesh: str
    quantity: str
    text: str
    scheme: str = ""
    arguments: dict[str, Any] = field(default_factory=dict, hash=False)

    def __str__(self) -> str:
        return f"{self.mesh}-{self.quantity}-{self.scheme}".rstrip("-")

    def assert_met_by(self, value: float) -> None:
        """Off by at most half a unit of the last printed digit."""
        mantissa, _, exponent = self.text.partition("e")
        decimals = len(mantissa.partition(".")[2])
        unit = 10.0 ** (int(exponent or 0) - decimals)
        assert abs(value - float(self.text)) <= 0.501 * unit, (
            f"{self}: printed {self.text}, got {value!r}"
        )


_SCHEMES = ("GompperKroll", "GompperKrollBarycentric", "Julicher", "JulicherVoronoi")


def _printed() -> list[Printed]:
    rows = []
    # E at this rigidity; the sphere's energies are printed over the rigidity.
    for mesh, rigidity, area, volume, energies in (
        (
            "sphere",
            1.0,
            "12528245",
            "4.1658149e9",
            "25.05653520 25.09523046 25.19700130 25.15822673",
        ),
        ("oblate", 50.0, "12466022", "2.497063e9", "4440.634 3742.431 3798.342 4509.617"),
        ("red cell", 120.0, "12417638", "2.4880208e9", "8492.910 8314.340 8729.965 8921.826"),
        (
            "deformed",
            50.0,
            "12878961.28",
            "4254929094.8",
            "1301.7539 1303.5494 1310.2674 1308.4691",
        ),
    ):
        rows.append(Printed(mesh, "area", area))
        rows.append(Printed(mesh, "volume", volume))
        for scheme, text in zip(_SCHEMES, energies.split(), strict=True):
            rows.append(Printed(mesh, "bending", text, scheme, {"rigidity": rigidity}))
    for height, text in ((20, "0"), (40, "0"), (60, "0.0665527"), (80, "221.996796")):
        scalars = {"minHeight": float(height), "epsilon": 4 * KT}
        rows.append(Printed("sphere", f"heights {height}", text, arguments=scalars))
    rows.append(Printed("sphere", "dihedrals", "0.0199758080", arguments={"stiffness": 1.0}))
    rows.append(Printed("deformed", "area energy", "6381.686"))
    rows.append(Printed("deformed", "volume energy", "38126.221"))
    scalars = {"rigidity": 120.0, "spontaneousCurvature": 0.006}
    barycentric = "GompperKrollBarycentric"
    rows.append(Printed("large red cell", "bending unsigned", "78464.14", barycentric, scalars))
    rows.append(Printed("large red cell", "bending", "78465.07", barycentric, scalars))
    return rows


PRINTED = _printed()


def string_golden(term: GoldenTerm, style: str) -> list[mm.Force] | None:
    """The golden term by string forces; None for bending, which goes through the oracle."""
    a, triangles = term.arguments(), term.membrane.triangles
    if term.force == "SurfaceAreaForce":
        return string_forces.global_area(triangles, a["modulus"], a["target"], style)
    if term.force == "EnclosedVolumeForce":
        return string_forces.global_volume(triangles, a["modulus"], a["target"], style)
    if term.force == "TriangleHeightForce":
        return string_forces.triangle_heights(triangles, a["minHeight"], a["epsilon"], style)
    return None
