"""`Vesicle.tau_2` and its like: the times that a vesicle's parameters set."""

import math

import numpy as np

from .analysis import theory

__all__ = ["TimeScales"]


class TimeScales:
    """What `Vesicle` has for choosing time steps and lengths of runs.

    Numbers in brackets are equations of doi:10.1103/PhysRevE.108.015301.
    """

    @property
    def tau_2(self) -> float:
        """Period of the slowest mode, l = 2, without friction, ps: τ_2 = 2π/ω_2 (A30)."""
        return theory.mode_period(
            2, float(np.mean(self.rigidity)), self.mass, self.mesh.num_vertices, self.radius
        )

    @property
    def tau_fastest(self) -> float:
        """Period of the fastest mode that the mesh has, ps.

        (A30) in the limit of large l at l = √N: τ_2 √24 / N.
        """
        return self.tau_2 * math.sqrt(24) / self.mesh.num_vertices

    @property
    def tau_heights(self) -> float:
        """Time in which triangle heights relax, ps: τ_h = d √(m/ε)."""
        return self.min_height * math.sqrt(self.mass / self.epsilon)

    @property
    def max_time_step(self) -> float:
        """Largest time step with which the paper's runs last, ps: 0.1 √Ξ τ_fastest (Fig. 5).

        It is a rule of thumb for the defaults of the other moduli, not a proof of stability. The
        repulsion of the heights gets no softer with the rigidity: below 20 kBT take the value of 20
        kBT. Brownian steps, which have no inertia, need to be some twenty times shorter.
        """
        return 0.1 * math.sqrt(self.softness) * self.tau_fastest
