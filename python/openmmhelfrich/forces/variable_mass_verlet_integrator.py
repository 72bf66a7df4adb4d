"""VariableMassVerletIntegrator; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._proxies import make, number, own, proxy
from .._types import Scalar
from .variable_mass_integrator import VariableMassIntegrator

if TYPE_CHECKING:
    pass


@proxy
class VariableMassVerletIntegrator(VariableMassIntegrator):
    """Hamiltonian dynamics of membranes whose vertices carry the mass of their plaquettes: O.

    Farnudi, M. R. Ejtehadi and R. Everaers, Phys. Rev. E 108, 015301 (2023), Sec. II.B,
    doi:10.1103/PhysRevE.108.015301.

        H(p, q) = sum_i p_i^2 / (2 m_i(q)) + U(q),    m_i(q) = sigma a_i(q)

    where a_i is the barycentric area of vertex i, a third of the area of the triangles around.
    sigma is the density, if it is above zero; otherwise it is M / A for each connected surface,
    with its area A(q) and the mass M that its vertices have in the System together. The kinetic
    energy depends on the positions, so that areas feel a force of it; in equilibrium the momenta's
    integral leaves them the weight prod_i m_i^(3/2), see docs/variable_mass.md.

    A surface is what the triangles of all membrane forces of the System make up; what several of
    them have counts once. It may be open, and in the periodic box. Vertices of mass 0 in the System
    stay where they are and have no momentum. Particles that are no vertices keep their masses.

    A time step h is the generalised leapfrog (E. Hairer, C. Lubich and G. Wanner, Geometric
    Numerical Integration, VI.3, doi:10.1007/3-540-30666-8):

        p' = p - h/2 dH/dq(p', q)
        q' = q + h/2 (p' / m(q) + p' / m(q'))
        p" = p' - h/2 dH/dq(p', q')

    The first two are implicit and solved to rounding, by iterations that do not evaluate U; so a
    step costs one evaluation of U, and is symplectic and reversible. A step size with which they do
    not converge is an error. Positions and velocities p / m(q) are those of the same time, kinetic
    energies have the masses m(q), and Context.setVelocitiesToTemperature() draws momenta for them.

    Platforms Reference and Helfrich have it. Refused are constraints; virtual sites that are
    vertices; what would change the masses otherwise than by time steps, MonteCarloBondFlip,
    MonteCarloMembraneTension and barostats that scale single particles; and what takes the System's
    masses for those of vertices, AndersenThermostat and CMMotionRemover.
    """

    def __init__(self, stepSize: Scalar, density: Scalar = 0.0) -> None:
        """Make the integrator.

        Parameters
        ----------
        stepSize : float or Quantity
            The step size, ps.
        density : float or Quantity, default: 0.0
            The mass per area, amu/nm^2, or 0 for surfaces of constant mass.
        """
        make(self, number(self, "stepSize", stepSize), number(self, "density", density))

    @staticmethod
    def isinstance(integrator: openmm.Integrator) -> bool:
        """Whether some integrator of OpenMM is of this class."""
        return _forces.VariableMassVerletIntegrator_isinstance(integrator)

    @staticmethod
    def cast(integrator: openmm.Integrator) -> VariableMassVerletIntegrator:
        """The same integrator as an object of this class."""
        return own(_forces.VariableMassVerletIntegrator_cast(integrator), integrator)
