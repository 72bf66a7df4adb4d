"""SurfaceViscosityThermostat; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._movers import Viscosity
from .._proxies import make_on, number, own, proxy, whole
from .._types import Scalar
from ._triangulated_mover import _TriangulatedMover

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class SurfaceViscosityThermostat(Viscosity, _TriangulatedMover):
    """Makes a membrane viscous: friction along the edges of the mesh against relative motion of
    their ends, with the noise that belongs to it.

    For the edge of vertices i and j let e be the unit vector from j to i and u = (v_i - v_j) . e.
    In continuous time the force on i is

        -gamma u e + sqrt(2 gamma kB T) xi(t) e

    and the opposite one acts on j: the dissipative and random forces along edges of D. A. Fedosov,
    B. Caswell and G. E. Karniadakis, doi:10.1016/j.bpj.2010.02.002, with their Gamma^T = 0 and
    Gamma^C = gamma. Every `frequency` steps each edge in turn gets the exact solution over the time
    dt of these steps, with the reduced mass mu of the two ends and a standard normal xi, at fixed
    positions:

        u -> u exp(-gamma dt / mu) + sqrt(kB T / mu (1 - exp(-2 gamma dt / mu))) xi

    This conserves momentum and angular momentum and leaves the Boltzmann distribution of the
    temperature T unchanged, for any friction and time step (T. Shardlow,
    doi:10.1137/S1064827501392879; E. A. J. F. Peters, doi:10.1209/epl/i2004-10010-4). Edges are
    those of the present triangles, which MonteCarloBondFlip changes; in a periodic box they connect
    nearest images, as they do for the membrane forces on the same triangles, or where there are
    none, for the System.

    A regular triangular net has the surface shear viscosity sqrt(3) / 4 gamma, amu/ps, and twice
    that for dilation; see docs/viscosity.md. Rigid motions are not damped, nor are motions that
    change no edge's length: a flat membrane moves freely along its normal. Together with
    VerletIntegrator this is a thermostat of its own that conserves momentum; with
    LangevinMiddleIntegrator of little friction it leaves to that what it does not reach.

    Integrators that kick once a step (VerletIntegrator, LangevinMiddleIntegrator,
    LangevinIntegrator, NoseHooverIntegrator, DPDIntegrator, and those with variable steps) keep
    velocities of half a step ago when they update the state of the Context. Friction on these at
    the present positions would push forces in as much as gamma dt / 2 m, and configurations would
    be too cold by that. So the vertices go back by half a step there, to where they had these
    velocities, and on with the new ones: the middle scheme (Z. Zhang et al.,
    doi:10.1021/acs.jpca.9b02771), which takes no forces and whose error is of second order, as that
    of the integrators. A CustomIntegrator is taken to have velocities of the present moment, as it
    has with half a kick at each end of a step. BrownianIntegrator, which has no velocities,
    QTBIntegrator, whose velocities have no one temperature, RPMDIntegrator, whose beads have
    velocities of their own, and integrators that are not OpenMM's are refused.

    Like AndersenThermostat, this class has neither energy nor forces, and acts whenever an
    integrator updates the state of the Context: a CustomIntegrator where it has
    addUpdateContextState(). Vertices of mass 0 stay where they are and count as infinitely heavy.
    Vertices with constraints and virtual sites as vertices are refused. On Reference, CPU and
    Helfrich it works in OpenMM's own arrays; on OpenCL, CUDA and HIP velocities, and positions,
    travel to the processor and back each time. A sweep over the edges is one thread's work, so that
    results are the same on any number of threads. Checkpoints of platform Helfrich hold the place
    in the sequence of random numbers, as the files of Python's save_state() do.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        friction: Scalar,
        temperature: Scalar,
        frequency: int = 1,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        friction : float or Quantity
            The default friction gamma of each edge, amu/ps: force for a relative velocity.
        temperature : float or Quantity
            The default temperature, K, above zero.
        frequency : int, default: 1
            Every how many time steps friction and noise act, for the time of all these steps; 0
            for never.
        offset : int
            Added to all indices of the triangles.
        """
        make_on(
            self,
            triangles,
            offset,
            number(self, "friction", friction),
            number(self, "temperature", temperature),
            whole(self, "frequency", frequency),
        )

    @staticmethod
    def Friction() -> str:
        """The name of the Context parameter that holds the friction, amu/ps, unless
        setFrictionParameter() names another.
        """
        return _forces.SurfaceViscosityThermostat_Friction()

    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature, K, for all objects of this
        class.
        """
        return _forces.SurfaceViscosityThermostat_Temperature()

    def getDefaultFriction(self) -> float:
        """Get the default friction of each edge, amu/ps."""
        return _forces.SurfaceViscosityThermostat_getDefaultFriction(self)

    def setDefaultFriction(self, friction: Scalar) -> None:
        """Set the default friction of each edge, amu/ps, 0 or more, of Contexts that are made from
        now on; in others it is the parameter getFrictionParameter().
        """
        _forces.SurfaceViscosityThermostat_setDefaultFriction(
            self, number(self, "friction", friction)
        )

    def getFrictionParameter(self) -> str:
        """Get the name of the Context parameter that holds the friction."""
        return _forces.SurfaceViscosityThermostat_getFrictionParameter(self)

    def setFrictionParameter(self, name: str) -> None:
        """Set the name of the Context parameter that holds the friction, in Contexts that are made
        from now on.

        Objects of different frictions in one System need different names.
        """
        _forces.SurfaceViscosityThermostat_setFrictionParameter(self, name)

    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy the frequency of this object to a Context.

        Friction and temperature are parameters of the Context; changed triangles are refused (use
        Context.reinitialize()).

        Parameters
        ----------
        context : openmm.Context
            The Context to update.
        """
        _forces.SurfaceViscosityThermostat_updateParametersInContext(self, context)

    def usesPeriodicBoundaryConditions(self) -> bool:
        """Like MonteCarloBondFlip, this class follows the forces on the same triangles, and does
        not make a System periodic.

        Returns
        -------
        bool
            False.
        """
        return _forces.SurfaceViscosityThermostat_usesPeriodicBoundaryConditions(self)

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.SurfaceViscosityThermostat_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceViscosityThermostat:
        """The same force as an object of this class."""
        return own(_forces.SurfaceViscosityThermostat_cast(force), force)
