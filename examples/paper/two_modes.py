"""Undulations of a mesh whose vertices also flow within the surface.

A bulge u_lm stretches the mesh by 2 u_lm and a compression s_lm (see `displacements.py`) by
−n s_lm, n = l (l+1). With M/4π = N m r0²/4π as the inertia of u and n times that of s, in which all
lengths are in r0,

    E = ½ [κ (l+2)(l+1) l (l−1) u² + K r0² (2u − n s)² + μ r0² n (n−2) s²]

are two coupled oscillators. The paper's theory of one mode is that of s at rest in its minimum. It
is right for l so large that bending is much stiffer than the mesh, N kBT ≪ κ l⁴; below, u moves
with two frequencies, which looks like damping.
"""

import numpy as np
from fluctuations import MASS, RADIUS, RIGIDITY, SOFTNESS
from openmmhelfrich.vesicle import KBT
from scipy.linalg import expm

# The moduli of density and of shear over N kBT at each Ξ, as `fig06b_shear.py` measures them.
MODULI = {0.037: (0.14, 0.06), 0.15: (0.21, 0.10), 0.33: (0.37, 0.23), 0.59: (1.4, 0.93)}


def two_mode_autocorrelation(
    times, l, num_vertices, friction, integrator="langevin", softness=SOFTNESS[0]
):
    """⟨u(t) u(0)⟩ / ⟨u²⟩ of the two coupled oscillators, κ = 20 kBT, r0 = 1000 nm.

    Parameters
    ----------
    times : array_like
        At equal intervals from 0, ps.
    l : int
        2 or more.
    num_vertices : int
        N.
    friction : float
        γ of the thermostat, 1/ps; 0 for none.
    integrator : str
        "brownian" for motion without inertia.
    softness : float
        Ξ, one of MODULI.

    Returns
    -------
    ndarray
        Shape of the times.
    """
    n = l * (l + 1)
    bending = RIGIDITY * (l + 2) * (l + 1) * l * (l - 1)
    area, shear = (modulus * num_vertices for modulus in MODULI[softness])
    stiffness = KBT * np.array(
        [
            [bending + 4 * area, -2 * n * area],
            [-2 * n * area, n**2 * area + n * (n - 2) * shear],
        ]
    )
    inertia = num_vertices * MASS * RADIUS**2 / (4 * np.pi) * np.diag([1, n])
    acceleration = -np.linalg.solve(inertia, stiffness)
    if integrator == "brownian":
        generator = acceleration / friction
    else:
        zero, one = np.zeros((2, 2)), np.eye(2)
        generator = np.block([[zero, one], [acceleration, -friction * one]])
    covariance = np.linalg.inv(stiffness)
    # The regression theorem: correlations follow the equations of motion, velocities start with 0.
    state = np.zeros((len(generator), 1))
    state[:2] = covariance[:, :1] / covariance[0, 0]
    propagator = expm(generator * (times[1] - times[0]))
    result = np.empty(len(times))
    for index in range(len(times)):
        result[index] = state[0, 0]
        state = propagator @ state
    return result
