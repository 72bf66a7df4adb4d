"""Mesh: what it accepts and refuses, what it measures, and how it is transformed."""

import copy
import itertools
import pickle

import numpy as np
import openmm
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from openmm import unit
from openmmhelfrich.mesh import Mesh, MeshError
from scipy.spatial.transform import Rotation

properties = settings(max_examples=25, deadline=None)
coordinates = st.floats(-1e3, 1e3)
vectors = st.tuples(coordinates, coordinates, coordinates)
factors = st.floats(0.01, 100) | st.floats(-100, -0.01)
rotations = st.integers(0, 2**32 - 1).map(
    lambda seed: Rotation.from_quat(np.random.default_rng(seed).normal(size=4))
)

TETRAHEDRON = np.array([[0, 0, 0], [1.1, 0, 0], [0.2, 0.9, 0], [0.1, 0.3, 1.3]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
TETRAHEDRON_VOLUME = 1.1 * 0.9 * 1.3 / 6


# --- Reference numbers of physics.md --------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "scale", "area", "volume"),
    [
        ("USphere_1002d_r_s0", 1000, "12528245", "4.1658149e+09"),
        ("USphere_1002d_r_s0", (1320, 1320, 1320 * 0.26062), "12466022", "2.497063e+09"),
        ("1002d_s0_RBC_init", 1320, "12417638", "2.4880208e+09"),
    ],
)
def test_area_and_volume_of_the_papers_meshes(shared, name, scale, area, volume):
    mesh = Mesh.read(shared / "vcm" / f"{name}.ply").scaled(scale)
    assert f"{mesh.area:.0f}" == area
    digits = len(volume.split("e")[0]) - 2
    assert f"{mesh.volume:.{digits}e}" == volume


def test_deformed_sphere_of_the_reference(shared):
    sphere = Mesh.read(shared / "vcm" / "USphere_1002d_r_s0.ply").scaled(1000)
    mesh = sphere.deformed(2, 0, 0.3)
    assert f"{mesh.area:.2f}" == "12878961.28"
    assert f"{mesh.volume:.1f}" == "4254929094.8"


def test_half_of_the_faces_of_the_papers_mesh_are_turned(shared):
    """The file is not consistently oriented; the mesh is, and on a sphere that shows directly."""
    path = shared / "vcm" / "USphere_1002d_r_s0.ply"
    lines = path.read_text().splitlines()
    in_file = np.array([line.split()[1:] for line in lines[-2000:]], dtype=int)
    mesh = Mesh.read(path)

    def outward(triangles):
        a, b, c = np.moveaxis(mesh.vertices[triangles], 1, 0)
        return np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0

    assert 900 < outward(in_file).sum() < 1100
    assert outward(mesh.triangles).all()
    assert np.array_equal(np.sort(mesh.triangles), np.sort(in_file))


def test_softness_of_the_paper(shared):
    sphere = Mesh.read(shared / "vcm" / "USphere_1002d_r_s0.ply").scaled(1000)
    found = [sphere.softness(d) for d in (20, 40, 60, 80)]
    assert [f"{xi:.2g}" for xi in found] == ["0.037", "0.15", "0.33", "0.59"]


# --- Input ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "triangles",
    [
        FACES.tolist(),
        [tuple(face) for face in FACES.tolist()],
        FACES.astype(np.uint8),
        FACES.astype(np.int16),
        FACES.astype(np.uint64),
        np.asfortranarray(FACES),
        np.concatenate([FACES, FACES])[:4],
    ],
)
def test_triangles_of_any_integer_type(triangles):
    mesh = Mesh(TETRAHEDRON, triangles)
    assert mesh.triangles.dtype == np.int64
    assert np.array_equal(mesh.triangles, FACES)


@pytest.mark.parametrize(
    "vertices",
    [
        TETRAHEDRON * unit.nanometer,
        TETRAHEDRON * 10 * unit.angstrom,
        unit.Quantity([openmm.Vec3(*point) for point in TETRAHEDRON], unit.nanometer),
        [openmm.Vec3(*(point * 1e-3)) * unit.micrometer for point in TETRAHEDRON],
        TETRAHEDRON.tolist(),
    ],
)
def test_vertices_with_units(vertices):
    assert np.allclose(Mesh(vertices, FACES).vertices, TETRAHEDRON, rtol=1e-15)


@pytest.mark.parametrize("turned", list(itertools.product([False, True], repeat=4)))
def test_any_orientation_is_mended(turned):
    triangles = [
        face[::-1] if turn else face for face, turn in zip(FACES.tolist(), turned, strict=True)
    ]
    mesh = Mesh(TETRAHEDRON, triangles)
    assert mesh.volume == pytest.approx(TETRAHEDRON_VOLUME, rel=1e-14)
    directed = {(int(t[k]), int(t[k - 2])) for t in mesh.triangles for k in range(3)}
    assert len(directed) == 12


def test_the_callers_arrays_are_not_touched():
    vertices, triangles = TETRAHEDRON.copy(), FACES[:, ::-1].copy()
    mesh = Mesh(vertices, triangles)
    assert np.array_equal(triangles, FACES[:, ::-1])
    vertices[0] = 99
    assert np.array_equal(mesh.vertices, TETRAHEDRON)


def test_nested_components_both_face_outward():
    inner = 0.1 * TETRAHEDRON + [0.3, 0.2, 0.2]
    mesh = Mesh(np.concatenate([TETRAHEDRON, inner]), np.concatenate([FACES, FACES[:, ::-1] + 4]))
    assert mesh.num_components == 2
    assert mesh.volume == pytest.approx(1.001 * TETRAHEDRON_VOLUME, rel=1e-14)


def broken(vertices=TETRAHEDRON, triangles=FACES):
    """A copy of the tetrahedron's arrays, to be spoilt."""
    return np.array(vertices, dtype=float), np.array(triangles)


def moved(value):
    vertices, triangles = broken()
    vertices[2, 1] = value
    return vertices, triangles


def with_corner(value):
    vertices, triangles = broken()
    triangles[1, 2] = value
    return vertices, triangles


def two_tetrahedra(merge):
    """Two tetrahedra, of which the second one shares some corners {own number: number of it}."""
    number = [merge.get(k, 4 + k - sum(own < k for own in merge)) for k in range(4)]
    second = TETRAHEDRON * [1, -1, 1] if 1 in merge else -TETRAHEDRON
    kept = [k for k in range(4) if k not in merge]
    return np.concatenate([TETRAHEDRON, second[kept]]), np.concatenate(
        [FACES, np.array(number)[FACES]]
    )


def projective_plane():
    """The icosahedron with opposite points identified: closed, but with one side only."""
    sphere = Mesh.icosphere(1, 1.0)
    opposite = np.argmin(sphere.vertices @ sphere.vertices.T, axis=1)
    kept = np.unique(np.minimum(np.arange(12), opposite))
    number = np.searchsorted(kept, np.minimum(np.arange(12), opposite))
    triangles = np.unique(np.sort(number[sphere.triangles], axis=1), axis=0)
    return np.random.default_rng(3).normal(size=(6, 3)), triangles


def test_an_open_mesh_has_borders():
    ball = Mesh.icosphere(2, 3.0)
    kept = np.setdiff1d(np.arange(ball.num_triangles), [3, 40, 41])
    triangles = ball.triangles[kept]
    mixed = np.where((np.arange(len(kept)) % 3 == 1)[:, None], triangles[:, ::-1], triangles)
    mesh = Mesh(ball.vertices, mixed)
    # As the first triangle is turned.
    assert (np.sort(mesh.triangles, axis=1) == np.sort(triangles, axis=1)).all()
    assert _same_rotation(mesh.triangles, triangles)
    assert mesh.euler_characteristic == 2 - len(mesh.border_loops)
    sides = {tuple(t[[k, (k + 1) % 3]].tolist()) for t in mesh.triangles for k in range(3)}
    alone = {side for side in sides if side[::-1] not in sides}
    assert alone == {
        (int(a), int(b))
        for loop in mesh.border_loops
        for a, b in zip(loop, np.roll(loop, -1), strict=True)
    }
    turned = Mesh(ball.vertices, triangles[:, ::-1])
    assert _same_rotation(turned.triangles, triangles[:, ::-1])
    assert mesh.area == pytest.approx(turned.area, rel=1e-14)
    for name in ("volume", "reduced_volume"):
        with pytest.raises(MeshError, match=r"a border of \d edges through vertices \d+, \d+"):
            getattr(mesh, name)
    with pytest.raises(MeshError, match=r"^Mesh.oblate needs a closed surface"):
        mesh.oblate(0.5)
    assert " border" in repr(mesh)


def _same_rotation(one, two):
    first = np.argmin(one, axis=1), np.argmin(two, axis=1)
    rows = np.arange(len(one))[:, None]
    one, two = (
        t[rows, (k[:, None] + [0, 1, 2]) % 3] for t, k in zip((one, two), first, strict=True)
    )
    return np.array_equal(one, two)


INVALID = {
    "empty": (([], []), "no triangles"),
    "edge of four": (two_tetrahedra({0: 0, 1: 1}), r"edge \(0, 1\) is shared by 4 triangles"),
    "pinched": (two_tetrahedra({0: 0}), "vertex 0 form 2 separate fans"),
    "repeated index": (with_corner(0), r"triangle 1 \(0, 1, 0\) repeats vertex"),
    "duplicate": (broken(triangles=[*FACES, [2, 1, 0]]), "triangles 0 and 4 have the same corners"),
    "too large": (with_corner(4), "triangle 1 refers to index 4.*0 to 3"),
    "negative": (with_corner(-1), "triangle 1 refers to index -1"),
    "unused": (broken([*TETRAHEDRON, [5, 5, 5]]), "vertex 4 belongs to no triangle"),
    "nan": (moved(np.nan), "vertex 2 .*not finite"),
    "infinite": (moved(-np.inf), "vertex 2 .*not finite"),
    "repeated vertex": (broken(TETRAHEDRON[[0, 1, 2, 1]]), "vertices 1 and 3 are both at"),
    "no area": (broken([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 1]]), "triangle 0 .*no area"),
    "one-sided": (projective_plane, "not orientable"),
    "flat array": ((TETRAHEDRON.ravel(), FACES), r"shape \(num_vertices, 3\), got \(12,\)"),
    "two axes": ((TETRAHEDRON[:, :2], FACES), r"shape \(num_vertices, 3\), got \(4, 2\)"),
    "ragged vertices": (([[0, 0, 0], [1, 0]], FACES), "vertices must be a rectangular array"),
    "text": (([["a", "b", "c"]] * 4, FACES), "vertices must be real numbers"),
    "complex": ((TETRAHEDRON + 0j, FACES), "vertices must be real numbers, got dtype complex"),
    "quads": ((TETRAHEDRON, [[0, 1, 2, 3]]), r"shape \(num_triangles, 3\), got \(1, 4\)"),
    "ragged triangles": ((TETRAHEDRON, [[0, 1, 2], [0, 1]]), "rows of three vertex indices"),
    "float triangles": ((TETRAHEDRON, FACES.astype(float)), "must be integers, got dtype float64"),
    "bool triangles": ((TETRAHEDRON, FACES > 0), "must be integers, got dtype bool"),
    "huge index": ((TETRAHEDRON, FACES.astype(np.uint64) + 2**63), "which cannot exist"),
    "time": ((TETRAHEDRON * unit.picosecond, FACES), "must be a length, got a Quantity in pico"),
    "plain 1": ((TETRAHEDRON * unit.dimensionless, FACES), "must be a length"),
}


@pytest.mark.parametrize(("arrays", "message"), INVALID.values(), ids=INVALID.keys())
def test_invalid_meshes_are_refused_by_name(arrays, message):
    vertices, triangles = arrays() if callable(arrays) else arrays
    with pytest.raises(MeshError, match=f"^Mesh: .*{message}"):
        Mesh(vertices, triangles)


def test_mesh_errors_are_value_errors():
    with pytest.raises(ValueError, match=r"^Mesh: "):
        Mesh([], [])


# --- Measures -------------------------------------------------------------------------------------


def test_tetrahedron_by_hand():
    mesh = Mesh(TETRAHEDRON, FACES)
    a, b, c, d = TETRAHEDRON
    heron = 0.0
    for p, q, r in ((a, b, c), (a, b, d), (b, c, d), (c, a, d)):
        x, y, z = (np.linalg.norm(side) for side in (p - q, q - r, r - p))
        s = (x + y + z) / 2
        heron += np.sqrt(s * (s - x) * (s - y) * (s - z))
    assert mesh.area == pytest.approx(heron, rel=1e-13)
    assert mesh.volume == pytest.approx(TETRAHEDRON_VOLUME, rel=1e-14)
    ball = (heron / (4 * np.pi)) ** 1.5 * 4 * np.pi / 3
    assert mesh.reduced_volume == pytest.approx(TETRAHEDRON_VOLUME / ball, rel=1e-13)
    assert mesh.edges.tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert mesh.degrees.tolist() == [3, 3, 3, 3]
    assert (mesh.num_vertices, mesh.num_triangles, mesh.num_components) == (4, 4, 1)


def test_edges_and_degrees_of_an_irregular_mesh(shared):
    mesh = Mesh.read(shared / "vcm" / "USphere_1002d_r_s0.ply")
    pairs = itertools.chain.from_iterable(itertools.combinations(t, 2) for t in mesh.triangles)
    edges = sorted({tuple(sorted(map(int, pair))) for pair in pairs})
    assert mesh.edges.tolist() == [list(edge) for edge in edges]
    assert np.array_equal(mesh.degrees, np.bincount(np.array(edges).ravel()))
    assert np.bincount(mesh.degrees).tolist() == [0, 0, 0, 0, 0, 43, 928, 31]


def torus(major=3.0, minor=1.0, around=9, across=7):
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    u, v = 2 * np.pi * i / around, 2 * np.pi * (j + 0.3 * i) / across
    rho = major + minor * np.cos(v)
    vertices = np.stack([rho * np.cos(u), rho * np.sin(u), minor * np.sin(v)], axis=-1)

    def at(p, q):
        return (p % around) * across + q % across

    def near(p):
        # The twist of the grid does not close after one turn, so that the seam is shifted.
        return 0 if p + 1 < around else round(0.3 * around)

    triangles = []
    for p, q in itertools.product(range(around), range(across)):
        s = q + near(p)
        triangles += [
            (at(p, q), at(p + 1, s), at(p, q + 1)),
            (at(p, q + 1), at(p + 1, s), at(p + 1, s + 1)),
        ]
    return Mesh(vertices.reshape(-1, 3), triangles)


def test_euler_characteristic(lumpy, pair):
    assert lumpy.euler_characteristic == 2
    assert pair.euler_characteristic == 4
    assert torus().euler_characteristic == 0
    assert torus().num_components == 1


def test_components_add_up(lumpy, pair):
    assert pair.num_components == 2
    assert pair.area == pytest.approx(1.25 * lumpy.area, rel=1e-13)
    assert pair.volume == pytest.approx(1.125 * lumpy.volume, rel=1e-13)


def test_volume_survives_a_distant_origin(lumpy):
    # Rounding of the coordinates alone costs 1e5 · 2e-16 of 3; the volume must not lose more.
    assert lumpy.translated((1e5, -2e5, 3e5)).volume == pytest.approx(lumpy.volume, rel=1e-9)


def test_softness_and_its_inverse(lumpy):
    height = np.sqrt(np.sqrt(3) * lumpy.area / lumpy.num_triangles)
    assert lumpy.softness(height / 2) == pytest.approx(0.25, rel=1e-14)
    assert lumpy.min_height(0.25) == pytest.approx(height / 2, rel=1e-14)
    assert lumpy.softness(5 * unit.angstrom) == pytest.approx(lumpy.softness(0.5), rel=1e-14)
    assert lumpy.softness(0) == lumpy.min_height(0) == 0


# --- Transformations ------------------------------------------------------------------------------


@properties
@given(rotation=rotations, displacement=vectors)
def test_rigid_motions_keep_area_and_volume(pair, rotation, displacement):
    moved = pair.rotated(rotation).translated(displacement)
    assert moved.area == pytest.approx(pair.area, rel=1e-10)
    assert moved.volume == pytest.approx(pair.volume, rel=1e-10)
    assert np.array_equal(moved.triangles, pair.triangles)


@properties
@given(rotation=rotations, displacement=vectors)
def test_motions_act_as_written(lumpy, rotation, displacement):
    matrix = rotation.as_matrix()
    expected = [matrix @ point for point in lumpy.vertices]
    assert np.allclose(lumpy.rotated(matrix).vertices, expected, rtol=0, atol=1e-13)
    moved = lumpy.translated(displacement)
    assert np.array_equal(moved.vertices, lumpy.vertices + np.array(displacement))


def test_translation_with_units(lumpy):
    moved = lumpy.translated([10, 0, -20] * unit.angstrom)
    assert np.allclose(moved.vertices - lumpy.vertices, [1, 0, -2])


@properties
@given(factor=factors)
def test_area_and_volume_scale(pair, factor):
    mesh = pair.scaled(factor)
    assert mesh.area == pytest.approx(pair.area * factor**2, rel=1e-12)
    assert mesh.volume == pytest.approx(pair.volume * abs(factor) ** 3, rel=1e-12)
    assert mesh.reduced_volume == pytest.approx(pair.reduced_volume, rel=1e-12)
    assert np.array_equal(mesh.vertices, factor * pair.vertices)


@properties
@given(triple=st.tuples(factors, factors, factors))
def test_volume_scales_with_each_axis(pair, triple):
    mesh = pair.scaled(triple)
    assert mesh.volume == pytest.approx(pair.volume * abs(np.prod(triple)), rel=1e-11)
    # A mirror image has its triangles turned; otherwise they keep their sense of rotation.
    for before, after in zip(pair.triangles.tolist(), mesh.triangles.tolist(), strict=True):
        rotations_of = [before[k:] + before[:k] for k in range(3)]
        assert (after in rotations_of) == (np.prod(triple) > 0)


def test_deformation_by_each_harmonic():
    """Against the complex harmonics of scipy, which carry the Condon–Shortley phase (−1)^m."""
    from scipy import special

    mesh = Mesh.random_sphere(60, 2.0, seed=4).scaled((1.0, 1.4, 0.8))
    x, y, z = mesh.vertices.T
    r = np.linalg.norm(mesh.vertices, axis=1)
    theta, phi = np.arccos(z / r), np.arctan2(y, x)
    for l in range(5):
        for m in range(-l, l + 1):
            k = abs(m)
            norm = np.sqrt(
                (2 * l + 1) / (4 * np.pi) * special.factorial(l - k) / special.factorial(l + k)
            )
            legendre = norm * (-1) ** k * special.lpmv(k, l, np.cos(theta))
            angle = 1.0 if m == 0 else np.sqrt(2) * (np.cos(k * phi) if m > 0 else np.sin(k * phi))
            expected = mesh.vertices * (1 + 0.1 * legendre * angle)[:, np.newaxis]
            assert np.allclose(mesh.deformed(l, m, 0.1).vertices, expected, rtol=0, atol=1e-13)


def test_deformation_is_about_the_origin(lumpy):
    """A uniform mode scales the mesh, wherever its middle may be."""
    factor = 1 + 0.5 / np.sqrt(4 * np.pi)
    assert np.allclose(lumpy.deformed(0, 0, 0.5).vertices, factor * lumpy.vertices, rtol=1e-14)


@pytest.mark.parametrize("shape", ["oblate", "prolate"])
@pytest.mark.parametrize("target", [0.3, 0.59, 0.95])
def test_spheroids(shape, target):
    sphere = Mesh.random_sphere(252, 500.0, seed=2).translated((10, 20, 30))
    mesh = getattr(sphere, shape)(target)
    assert mesh.reduced_volume == pytest.approx(target, rel=1e-12)
    assert mesh.area == pytest.approx(sphere.area, rel=1e-12)
    # The map is affine about the centroid, with one factor along z and one across.
    before, after = (m.vertices - m.vertices.mean(axis=0) for m in (sphere, mesh))
    ratio = after / before
    assert np.allclose(mesh.vertices.mean(axis=0), sphere.vertices.mean(axis=0), rtol=1e-10)
    assert np.allclose(ratio[:, :2], ratio[0, 0], rtol=1e-9)
    assert np.allclose(ratio[:, 2], ratio[0, 2], rtol=1e-9)
    assert (ratio[0, 2] < 1 < ratio[0, 0]) == (shape == "oblate")


@pytest.mark.parametrize("shape", ["oblate", "prolate"])
def test_the_reduced_volume_that_a_mesh_has_leaves_its_shape(shape):
    for seed in range(8):
        mesh = Mesh.random_sphere(52 + 30 * seed, 100.0, seed).scaled((1, 1.2, 0.7))
        for target in (mesh.reduced_volume, np.nextafter(mesh.reduced_volume, 2)):
            assert np.array_equal(getattr(mesh, shape)(target).vertices, mesh.vertices)
    above = mesh.reduced_volume * (1 + 1e-9)
    with pytest.raises(MeshError, match=r"at most .*, that of the mesh") as refused:
        getattr(mesh, shape)(above)
    # The limit that the message names will do.
    limit = float(str(refused.value).split("at most ")[1].split(",")[0])
    assert np.array_equal(getattr(mesh, shape)(limit).vertices, mesh.vertices)


def test_oblate_agrees_with_the_spheroid():
    """A disk of v = 0.6: its aspect from the closed formulae of an oblate spheroid."""
    mesh = Mesh.icosphere(20, 1.0).oblate(0.6)
    x, y, z = np.abs(mesh.vertices).max(axis=0)
    e = np.sqrt(1 - (z / x) ** 2)
    area = 2 * np.pi * x**2 * (1 + (1 - e**2) / e * np.arctanh(e))
    volume = 4 * np.pi / 3 * x * x * z
    assert 6 * np.sqrt(np.pi) * volume / area**1.5 == pytest.approx(0.6, rel=3e-3)
    assert x == pytest.approx(y, rel=1e-2)


BAD_ARGUMENTS = [
    (lambda m: m.scaled(0), "Mesh.scaled: factor .*not 0, got 0"),
    (lambda m: m.scaled((1, 2)), "Mesh.scaled: factor must be one number or three"),
    (lambda m: m.scaled((1, np.nan, 1)), "Mesh.scaled: factor .*finite"),
    (lambda m: m.scaled("big"), "Mesh.scaled: factor must be numbers"),
    (lambda m: m.translated((1, 2)), "Mesh.translated: displacement must be three"),
    (lambda m: m.translated((1, 2, np.inf)), "Mesh.translated: displacement .*finite"),
    (lambda m: m.translated((1, 2, 3) * unit.kelvin), "Mesh.translated: displacement must be a le"),
    (lambda m: m.rotated(np.eye(2)), r"Mesh.rotated: .*shape \(3, 3\), got \(2, 2\)"),
    (lambda m: m.rotated(1.001 * np.eye(3)), "Mesh.rotated: .*orthogonal"),
    (lambda m: m.rotated(np.full((3, 3), np.nan)), "Mesh.rotated: .*orthogonal"),
    (lambda m: m.rotated(np.diag([1, 1, -1])), "Mesh.rotated: .*determinant"),
    (lambda m: m.deformed(-1, 0, 0.1), "Mesh.deformed: l must be 0 or more, got -1"),
    (lambda m: m.deformed(2, 3, 0.1), "Mesh.deformed: m must be 2 or less.*got 3"),
    (lambda m: m.deformed(2, -3, 0.1), "Mesh.deformed: m must be -2 or more, got -3"),
    (lambda m: m.deformed(2.5, 0, 0.1), "Mesh.deformed: l must be an integer, got 2.5"),
    (lambda m: m.deformed(2, 0, np.nan), "Mesh.deformed: amplitude .*finite"),
    (lambda m: m.deformed(2, 0, 9.0), "Mesh.deformed: amplitude 9.0 moves vertex [0-9]+ to"),
    (lambda m: m.translated(-m.vertices[5]).deformed(2, 0, 0.1), "vertex 5 lies at the origin"),
    (lambda m: m.oblate(0), "Mesh.oblate: reduced_volume must be above 0 and at most 0.9"),
    (lambda m: m.prolate(0.9999), "Mesh.prolate: reduced_volume .*got 0.9999"),
    (lambda m: m.prolate(np.nan), r"Mesh.prolate: reduced_volume .*at most 0\.9.*got nan"),
    (lambda m: m.oblate((0.5, 0.6)), "Mesh.oblate: reduced_volume must be one number"),
    (lambda m: m.softness(-1), "Mesh.softness: min_height must be .*0 or more, got -1"),
    (lambda m: m.softness(1 * unit.kelvin), "Mesh.softness: min_height must be a length"),
    (lambda m: m.softness(np.inf), "Mesh.softness: min_height must be finite"),
    (lambda m: m.min_height(-0.1), "Mesh.min_height: softness must be .*0 or more, got -0.1"),
    (lambda m: m.min_height(1 * unit.nanometer), "Mesh.min_height: softness must be numbers"),
]


@pytest.mark.parametrize(("call", "message"), BAD_ARGUMENTS)
def test_bad_arguments_are_refused_by_name(call, message):
    with pytest.raises(MeshError, match=message):
        call(Mesh.icosphere(3, 2.0))


# --- A mesh as an object --------------------------------------------------------------------------


def test_a_mesh_never_changes(lumpy):
    for name in ("vertices", "triangles", "edges", "degrees"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(lumpy, name)[0] = 0
    for name in ("vertices", "area", "edges", "colour"):
        with pytest.raises(AttributeError, match=f"cannot set {name}"):
            setattr(lumpy, name, 1)


def test_equality_and_copies(lumpy):
    twins = [copy.copy(lumpy), copy.deepcopy(lumpy), pickle.loads(pickle.dumps(lumpy))]
    for twin in twins:
        assert twin == lumpy
        assert hash(twin) == hash(lumpy)
        assert not twin.vertices.flags.writeable
    assert lumpy != lumpy.scaled(1 + 1e-15)
    assert lumpy != Mesh(lumpy.vertices, np.roll(lumpy.triangles, 1, axis=0))
    assert lumpy != "a mesh"
    assert len({lumpy, *twins}) == 1


def test_equal_meshes_have_equal_hashes_whatever_the_sign_of_zero():
    negative = TETRAHEDRON.copy()
    negative[negative == 0] = -0.0
    one, other = Mesh(TETRAHEDRON, FACES), Mesh(negative, FACES)
    assert one == other
    assert hash(one) == hash(other)


def test_repr(pair):
    text = repr(pair)
    assert text.startswith("Mesh(84 vertices, 160 triangles, 2 components, area=")
    assert "components" not in repr(Mesh(TETRAHEDRON, FACES))


# --- OpenMM ---------------------------------------------------------------------------------------


def test_topology(pair):
    topology = pair.topology()
    assert topology.getNumAtoms() == pair.num_vertices
    assert topology.getNumChains() == 1
    assert [(a.index, b.index) for a, b in topology.bonds()] == [tuple(e) for e in pair.edges]


def test_topology_goes_through_a_file(lumpy, tmp_path):
    path = tmp_path / "mesh.cif"
    with path.open("w") as file:
        openmm.app.PDBxFile.writeFile(lumpy.topology(), lumpy.vertices * unit.nanometer, file)
    again = openmm.app.PDBxFile(str(path))
    assert again.topology.getNumAtoms() == lumpy.num_vertices
    bonds = sorted(sorted((a.index, b.index)) for a, b in again.topology.bonds())
    assert bonds == lumpy.edges.tolist()
    found = again.getPositions(asNumpy=True).value_in_unit(unit.nanometer)
    assert np.allclose(found, lumpy.vertices, atol=1e-4)


def test_energy_of_a_force(lumpy):
    force = openmm.CustomBondForce("k*r^3")
    force.addGlobalParameter("k", 2.5)
    for i, j in lumpy.edges.tolist():
        force.addBond(i, j)
    lengths = np.linalg.norm(np.diff(lumpy.vertices[lumpy.edges], axis=1), axis=-1)
    expected = 2.5 * (lengths**3).sum()
    assert lumpy.energy(force) == pytest.approx(expected, rel=1e-12)
    # A force that belongs to a System can be asked too, and goes on belonging to it.
    system = openmm.System()
    system.addForce(force)
    assert lumpy.energy(system.getForce(0)) == pytest.approx(expected, rel=1e-12)
    assert system.getNumForces() == 1


def test_arrays_cannot_be_made_writeable():
    mesh = Mesh.icosphere(2, 10.0)
    for array in (mesh.vertices, mesh.triangles):
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.setflags(write=True)


def test_coordinates_beyond_all_areas_are_refused():
    mesh = Mesh.icosphere(2, 10.0)
    with pytest.raises(MeshError, match="beyond all numbers"):
        Mesh(mesh.vertices * 1e90, mesh.triangles)
    with pytest.raises(MeshError, match=r"vertex 0 is at .* below 1e100"):
        Mesh(mesh.vertices * 1e200, mesh.triangles)
