"""One measurement of jax-md, in a process of its own: `python jax_worker.py VESICLE.npz`.

The file has the mesh and the parameters of a vesicle (`jax_md.py` writes it). The energy is the
paper's in plain jax, compiled with jit and differentiated with grad, in double precision, or in
single precision if the environment variable JAX_ENABLE_X64 is 0; jax_md.simulate.nve moves the
vertices, many steps in one compiled loop. What is printed is one line of JSON with the energy at
the start, kJ/mol, the least time of a step, µs, and versions.

Two ways to write the energy are offered, because XLA's cost lies in how sums are gathered:
`edges` computes every edge and triangle once and adds them up at the vertices with segment_sum;
`rings` computes for each vertex all that it needs from its ring of neighbours, more arithmetic but
no scattered sums in the energy itself.
"""

import argparse
import json
import os
import time
from functools import partial

import jax

# jax_md asks for it when it is imported.
jax.config.update("jax_enable_x64", os.environ.get("JAX_ENABLE_X64") != "0")

import jax.numpy as jnp  # noqa: E402
import jax_md  # noqa: E402
import numpy as np  # noqa: E402

TIME_STEP = 0.1  # ps
KT = 2.494338785  # kJ/mol, at 300 K


def main():
    """Print one line of JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("vesicle", help="the file")
    parser.add_argument("--form", choices=sorted(FORMS), default="edges")
    parser.add_argument("--seconds", type=float, default=0.25, help="length of one run")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    with np.load(options.vesicle) as file:
        vesicle = {name: file[name] for name in file.files}
    energy = FORMS[options.form](vesicle)
    start, advance = simulation(energy, vesicle)
    print(json.dumps({
        "energy": float(jax.jit(energy)(jnp.asarray(vesicle["vertices"]))),
        "microseconds": measure(start, advance, options.seconds, options.repeats),
        "versions": {"jax": jax.__version__, "jax-md": _version()},
    }))  # fmt: skip


def simulation(energy, vesicle):
    """A state at 300 K, and a compiled function that makes many steps."""
    _, shift = jax_md.space.free()
    init, apply = jax_md.simulate.nve(energy, shift, TIME_STEP)
    state = init(
        jax.random.PRNGKey(1),
        jnp.asarray(vesicle["vertices"]),
        kT=KT,
        mass=float(vesicle["mass"]),
    )

    @jax.jit
    def advance(state, steps):
        return jax.lax.fori_loop(0, steps, lambda _, now: apply(now), state)

    return state, advance


def measure(state, advance, seconds, repeats):
    """Least microseconds of a step; the first call, which compiles, is not counted."""
    state = jax.block_until_ready(advance(state, 2))
    begin = time.perf_counter()
    state = jax.block_until_ready(advance(state, 5))
    steps = max(5, int(5 * seconds / (time.perf_counter() - begin)))
    best = np.inf
    for _ in range(repeats):
        begin = time.perf_counter()
        state = jax.block_until_ready(advance(state, steps))
        best = min(best, (time.perf_counter() - begin) / steps)
    if not np.isfinite(np.asarray(state.position)).all():
        raise SystemExit("jax_worker: the run broke down, a position is not finite")
    return 1e6 * best


# --- energies ------------------------------------------------------------------------------------


def edges(vesicle):
    """Every triangle and edge once; sums at the vertices with segment_sum."""
    triangles = jnp.asarray(vesicle["triangles"])
    a, b, left, right = (jnp.asarray(column) for column in vesicle["edges"].T)
    num_vertices = len(vesicle["vertices"])
    at_vertices = partial(jax.ops.segment_sum, num_segments=num_vertices)

    def energy(positions):
        corners = [positions[triangles[:, k]] for k in range(3)]
        normal = jnp.cross(corners[1] - corners[0], corners[2] - corners[0])
        areas = 0.5 * jnp.sqrt(_square(normal))
        spoke = positions[b] - positions[a]
        length = jnp.sqrt(_square(spoke))
        first, second = normal[left], normal[right]
        sine = jnp.sum(jnp.cross(first, second) * spoke, axis=-1) / length
        angle = jnp.arctan2(sine, jnp.sum(first * second, axis=-1))
        share = 0.5 * length * angle
        curvature = at_vertices(jnp.concatenate([share, share]), jnp.concatenate([a, b]))
        area = at_vertices(jnp.repeat(areas / 3, 3), triangles.ravel())
        bending = 0.5 * vesicle["rigidity"] * jnp.sum(curvature**2 / area)
        return bending + _constraints(vesicle, corners, areas) + _heights(vesicle, corners, areas)

    return energy


def rings(vesicle):
    """What each vertex needs, from the ring of its neighbours; vertices by equal degree."""
    triangles = jnp.asarray(vesicle["triangles"])
    groups = [jnp.asarray(vesicle[name]) for name in sorted(vesicle) if name.startswith("ring_of_")]

    def energy(positions):
        corners = [positions[triangles[:, k]] for k in range(3)]
        areas = 0.5 * jnp.sqrt(_square(jnp.cross(corners[1] - corners[0], corners[2] - corners[0])))
        bending = 0.0
        for group in groups:
            spokes = positions[group[:, 1:]] - positions[group[:, :1]]
            normal = jnp.cross(spokes, jnp.roll(spokes, -1, axis=1))
            before = jnp.roll(normal, 1, axis=1)
            length = jnp.sqrt(_square(spokes))
            sine = jnp.sum(jnp.cross(before, normal) * spokes, axis=-1) / length
            angle = jnp.arctan2(sine, jnp.sum(before * normal, axis=-1))
            curvature = 0.5 * jnp.sum(length * angle, axis=1)
            area = jnp.sum(jnp.sqrt(_square(normal)), axis=1) / 6
            bending += 0.5 * vesicle["rigidity"] * jnp.sum(curvature**2 / area)
        return bending + _constraints(vesicle, corners, areas) + _heights(vesicle, corners, areas)

    return energy


FORMS = {"edges": edges, "rings": rings}


def _constraints(vesicle, corners, areas):
    """½ kA (A − A0)²/A0 + ½ kV (V − V0)²/V0."""
    volume = jnp.sum(corners[0] * jnp.cross(corners[1], corners[2])) / 6
    result = 0.0
    for name, value in (("area", jnp.sum(areas)), ("volume", volume)):
        target = vesicle[f"{name}_target"]
        result += 0.5 * vesicle[f"{name}_modulus"] * (value - target) ** 2 / target
    return result


def _heights(vesicle, corners, areas):
    """Σ ε [(d/h)⁸ − (d/h)⁴ + ¼] over heights h < 2^¼ d, which is ε max((d/h)⁴ − ½, 0)²."""
    result = 0.0
    for k in range(3):
        side = _square(corners[(k + 1) % 3] - corners[k])
        inverse = vesicle["min_height"] ** 2 * side / (4 * areas**2)
        result += jnp.sum(jnp.maximum(inverse**2 - 0.5, 0) ** 2)
    return vesicle["epsilon"] * result


def _square(vectors):
    return jnp.sum(vectors * vectors, axis=-1)


def _version():
    from importlib import metadata

    return metadata.version("jax-md")


if __name__ == "__main__":
    main()
