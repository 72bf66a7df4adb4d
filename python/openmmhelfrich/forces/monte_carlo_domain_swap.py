"""MonteCarloDomainSwap; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._movers import Swaps
from .._proxies import make_on, number, own, proxy, whole
from .._types import Scalar
from ._surface_mover import _SurfaceMover

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class MonteCarloDomainSwap(Swaps, _SurfaceMover):
    """Makes the components of a membrane diffuse: now and then it lets neighbouring vertices
    exchange what they are, so that domains form, coarsen and bud during a simulation.

    The composition never changes.

    An edge is chosen uniformly among all, and its ends exchange all that vertices are in the
    membrane forces on these triangles: values of vertices (rigidity and spontaneousCurvature of a
    BendingForce) and the domains of a LineTensionForce. Positions, velocities, masses and
    references stay. Where the ends are alike in all of this the attempt counts as "refusedByKind";
    otherwise it is accepted with probability

        min(1, exp(-dE / kB T))

    and else counts as "refusedByEnergy". dE is the change of the energy of those membrane forces on
    these triangles whose force group is among the integrator's
    (Integrator.getIntegrationForceGroups()): N. Metropolis et al., doi:10.1063/1.1699114. With a
    thermostat of the same temperature, positions, velocities and the arrangement of the components
    have their joint Boltzmann distribution. Such exchanges are K. Kawasaki's,
    doi:10.1103/PhysRev.145.224; on fluid vesicles P. B. S. Kumar, G. Gompper and R. Lipowsky,
    doi:10.1103/PhysRevLett.86.3911.

    It may act beside a MonteCarloBondFlip on the same triangles, in any order of the two, and like
    it: whenever an integrator updates the state of the Context; under integrators that kick once a
    step between two half kicks; in the ensemble Microcanonical with a demon that pays. A surface
    has one MonteCarloDomainSwap at most. Force objects keep the values that they were given, in the
    order of the vertices; in a Context these go through a permutation, which is part of its state:
    getPermutationInContext(), setPermutationInContext(). OpenMM's State does not hold it; its
    checkpoints do on platform Helfrich only. A fingerprint in a parameter of the Context
    (getPermutationParameter(); 0 where every vertex has its own values) tells when a State with
    another permutation is loaded: the next step or evaluation is refused. Use saveConnectivity()
    and restoreConnectivity(), or in Python save_state() and load_state(). Context.reinitialize()
    that preserves the state preserves the permutation on all platforms.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        temperature: Scalar,
        frequency: int = 10,
        attemptsPerEdge: Scalar = 0.1,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        temperature : float or Quantity
            The default temperature, K, above zero: that of the thermostat.
        frequency : int, default: 10
            Every how many time steps exchanges are tried; 0 for never.
        attemptsPerEdge : float or Quantity, default: 0.1
            How many exchanges are tried each time, for each edge of the mesh, from 0 to 1000; a
            fraction of an attempt is carried over to the next time.
        offset : int
            Added to all indices of the triangles.
        """
        make_on(
            self,
            triangles,
            offset,
            number(self, "temperature", temperature),
            whole(self, "frequency", frequency),
            number(self, "attemptsPerEdge", attemptsPerEdge),
        )

    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature of the exchanges, K."""
        return _forces.MonteCarloDomainSwap_Temperature()

    def getPermutationParameter(self) -> str:
        """Get the name of the Context parameter that holds the fingerprint of the permutation:
        DomainSwapPermutation with the smallest index of a particle among the triangles.

        It is not to be set.
        """
        return _forces.MonteCarloDomainSwap_getPermutationParameter(self)

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.MonteCarloDomainSwap_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloDomainSwap:
        """The same force as an object of this class."""
        return own(_forces.MonteCarloDomainSwap_cast(force), force)
