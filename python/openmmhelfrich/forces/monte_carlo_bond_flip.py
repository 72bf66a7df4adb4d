"""MonteCarloBondFlip; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._movers import Flips
from .._proxies import make_on, number, own, proxy, whole
from .._types import Scalar
from ._surface_mover import _SurfaceMover

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class MonteCarloBondFlip(Flips, _SurfaceMover):
    """Makes a membrane fluid: now and then it tries to flip edges of the mesh, so that neighbours
    change during a simulation.

    The edge ij of two triangles (i, j, k) and (j, i, l) becomes kl, at fixed positions and momenta.
    An edge is chosen uniformly among all; the flip is refused if the edge is a border, if a vertex
    would have fewer neighbours than minDegree (one fewer on a border) or more than maxDegree, if kl
    would be longer than maxEdgeLength or exists already, or if a new triangle would have no area.
    Otherwise it is accepted with probability

        min(1, exp(-dE / kB T))

    where dE is the change of the energy of all membrane forces on these triangles whose force group
    is among the integrator's (Integrator.getIntegrationForceGroups()): N. Metropolis et al.,
    doi:10.1063/1.1699114. With a thermostat of the same temperature, positions, velocities and
    connectivity have their joint Boltzmann distribution. An edge that vertices have stretched
    beyond the longest that a new edge may be can flip, but not back: where that happens, long edges
    are rarer than in that distribution. Refused attempts count, by the first of these that they
    fail, as "refusedByBorder" (the edge has one triangle only), "refusedByDegree",
    "refusedByLength", "refusedByShape" (a triangle would have no area), "refusedByEnergy" and
    "refusedByEdge" (the new edge was there already). See G. Gompper and D. M. Kroll,
    doi:10.1088/0953-8984/9/42/001, and on the viscosity that the rate of flips sets H. Noguchi and
    G. Gompper, doi:10.1103/PhysRevE.72.011901.

    In a periodic box every edge must stay shorter than half of the least width of the box, or the
    simulation stops with an error. Flips make edges of up to 0.8 of that half, unless maxEdgeLength
    says otherwise, and leave the rest to the motion of vertices. Eight vertices around the box are
    enough for that; with six, at the softness 0.33 and above, let flips be frequent
    (attemptsPerEdge 1), so that edges that have grown are flipped in time.

    Without a thermostat, choose the ensemble Microcanonical: a demon (M. Creutz,
    doi:10.1103/PhysRevLett.50.1411), whose energy is never below zero, pays for flips and takes
    what they set free, so that the energy of the System and the demon together is conserved.

    Integrators that kick once a step (VerletIntegrator, LangevinMiddleIntegrator,
    LangevinIntegrator, NoseHooverIntegrator, DPDIntegrator, QTBIntegrator) keep velocities of half
    a step ago. There v changes by -dt (F_after - F_before) / 2m, so that flips come between two
    half kicks and leave no heat; that takes one more evaluation of the forces each time. With
    variable time steps each flip leaves a little heat, of second order.

    Like a barostat, this class has neither energy nor forces, and acts whenever an integrator
    updates the state of the Context: all integrators of OpenMM do, a CustomIntegrator where it has
    addUpdateContextState(). RPMDIntegrator, whose beads would share bonds, is refused. Forces must
    have the same triangles in the same order to be on the same surface; other forces may not act on
    a triangulation of the same particles. A surface has one MonteCarloBondFlip at most. Inside of a
    CustomCVForce, whose Context is never stepped, it does nothing. Particles of mass 0 stay where
    they are, but their bonds flip like others.

    Connectivity is part of the state of a Context, with positions and velocities, but OpenMM's
    State does not hold it; its checkpoints do on platform Helfrich only. A fingerprint of the
    triangles in a parameter of the Context (getConnectivityParameter(); 0 for those that the System
    has) tells when a State with other connectivity is loaded: the next step or evaluation is
    refused. Use saveConnectivity() and restoreConnectivity(), or in Python save_state() and
    load_state(). Context.reinitialize() that preserves the state preserves the connectivity on all
    platforms.

    On the platforms Reference, CPU and Helfrich, and where it computes parameters of the Context, a
    CustomIntegrator sets back what changes during its steps. So after them the fingerprint is that
    of the last evaluation between steps, until the next one sets it right: let States that shall be
    loaded elsewhere come with the energy. The old fingerprint is taken for the present one as long
    as time or number of steps go on; a State from the beginning of the very step in which bonds
    have flipped is therefore not refused. If both are set anew in the Context, ask for the energy
    before.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        temperature: Scalar,
        frequency: int = 10,
        attemptsPerEdge: Scalar = 0.1,
        minDegree: int = 3,
        maxDegree: int = 10,
        maxEdgeLength: Scalar = 0.0,
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
            Every how many time steps flips are tried; 0 for never.
        attemptsPerEdge : float or Quantity, default: 0.1
            How many flips are tried each time, for each edge of the mesh, from 0 to 1000; a
            fraction of an attempt is carried over to the next time.
        minDegree : int, default: 3
            The fewest neighbours of a vertex, 3 or more; of one on a border, one fewer.
        maxDegree : int, default: 10
            The most neighbours of a vertex.
        maxEdgeLength : float or Quantity, default: 0.0
            The longest that a new edge may be, nm; 0 for any length, or in a periodic box for
            0.8 of half of its least width.
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
            whole(self, "minDegree", minDegree),
            whole(self, "maxDegree", maxDegree),
            number(self, "maxEdgeLength", maxEdgeLength),
        )

    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature of the flips, K."""
        return _forces.MonteCarloBondFlip_Temperature()

    def getMinDegree(self) -> int:
        """Get the fewest neighbours of a vertex."""
        return _forces.MonteCarloBondFlip_getMinDegree(self)

    def setMinDegree(self, minDegree: int) -> None:
        """Set the fewest neighbours of a vertex, 3 or more."""
        _forces.MonteCarloBondFlip_setMinDegree(self, whole(self, "minDegree", minDegree))

    def getMaxDegree(self) -> int:
        """Get the most neighbours of a vertex."""
        return _forces.MonteCarloBondFlip_getMaxDegree(self)

    def setMaxDegree(self, maxDegree: int) -> None:
        """Set the most neighbours of a vertex, 3 or more."""
        _forces.MonteCarloBondFlip_setMaxDegree(self, whole(self, "maxDegree", maxDegree))

    def getMaxEdgeLength(self) -> float:
        """Get the longest that a new edge may be, nm; 0 for any length, or 0.8 of half of the width
        of a periodic box.
        """
        return _forces.MonteCarloBondFlip_getMaxEdgeLength(self)

    def setMaxEdgeLength(self, maxEdgeLength: Scalar) -> None:
        """Set the longest that a new edge may be, nm; 0 for any length, or 0.8 of half of the width
        of a periodic box.
        """
        _forces.MonteCarloBondFlip_setMaxEdgeLength(
            self, number(self, "maxEdgeLength", maxEdgeLength)
        )

    def getConnectivityParameter(self) -> str:
        """Get the name of the Context parameter that holds the fingerprint of the triangles:
        BondFlipConnectivity with the smallest index of a particle among them.

        It is not to be set.
        """
        return _forces.MonteCarloBondFlip_getConnectivityParameter(self)

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.MonteCarloBondFlip_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloBondFlip:
        """The same force as an object of this class."""
        return own(_forces.MonteCarloBondFlip_cast(force), force)
