"""Forces whose terms are evaluated together, in both orders, wherever they are computed.

`tests/rust/gpu.rs` has all pairs and triples; here are those that once went wrong, as users have
them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import openmmhelfrich as helfrich
import pytest
from platforms import ON_GPU, ON_OPENCL, REFERENCE, Target
from running import Running

SCHEMES = ["Julicher", "GompperKroll", "GompperKrollBarycentric", "JulicherVoronoi", "Espriu"]
ON_BOTH = [
    replace(opencl, name=f"{opencl}-{gpu}", tolerance=gpu.tolerance, backend=gpu.backend)
    for opencl, gpu in ((ON_OPENCL[0], ON_GPU[0]), (ON_OPENCL[2], ON_GPU[1]))
]


def rough_sphere() -> helfrich.Mesh:
    """N = 162, jittered."""
    mesh = helfrich.Mesh.icosphere(4, 100.0)
    noise = np.random.default_rng(20).normal(scale=2.0, size=mesh.vertices.shape)
    return helfrich.Mesh(mesh.vertices + noise, mesh.triangles)


CASES = [(target, scheme) for target in ON_GPU for scheme in SCHEMES]
CASES += [(target, "GompperKroll") for target in (*ON_OPENCL, *ON_BOTH)]


@pytest.mark.parametrize("bending_first", [True, False])
@pytest.mark.parametrize(("target", "scheme"), CASES, ids=str)
def test_bending_beside_the_area(target: Target, scheme: str, bending_first: bool):
    mesh = rough_sphere()

    def run(target: Target):
        forces = [
            helfrich.BendingForce(mesh, 50, scheme=scheme),
            helfrich.SurfaceAreaForce(mesh, 1.3, 0.97 * mesh.area),
        ]
        order = forces if bending_first else forces[::-1]
        return Running(order, mesh.num_vertices, target).evaluate(mesh.vertices)

    (energy, forces), expected = run(target), run(REFERENCE)
    assert energy == pytest.approx(expected[0], rel=target.tolerance)
    assert np.abs(forces - expected[1]).max() <= target.tolerance * np.abs(expected[1]).max()
