"""MonteCarloMembraneTension; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._movers import Tension
from .._proxies import constant, make, number, own, proxy, whole
from .._types import Scalar
from ._mover import _Mover

if TYPE_CHECKING:
    pass


@proxy
class MonteCarloMembraneTension(Tension, _Mover):
    """Keeps a membrane that spans the periodic box at constant tension: now and then it tries to
    change the box, and all positions with it, so that the frame of the membrane breathes during a
    simulation.

    Without it the frame's area is constant.

    OpenMM's barostats move molecules by their centres, and a membrane that spans the box is one
    molecule: the box would change and the membrane would not. Here the vertices of membranes with
    periodic boundary conditions are scaled one by one. All else moves by the centres of its
    molecules; a membrane without periodic boundary conditions, which cannot span the box, is one.
    (A molecule that is bound to such vertices is scaled by its own centre, without them;
    setScaleMoleculesAsRigid(False) scales every particle, also those of polymers that span the
    box.) Let N be the number of the bodies that are so scaled and move: A_p the area of the frame,
    which is the box seen along z, L_x L_y; E the potential energy of the force groups of the
    integrator (Integrator.getIntegrationForceGroups()), beta = 1 / kB T, tau the tension and f the
    pulling force. A positive tension stretches. With an integrator that keeps the temperature, each
    mode samples positions and box of the weight

        XYIsotropic       exp(-beta (E - tau A_p)) dA_p          x and y scaled alike, z fixed
        XYIndependent     exp(-beta (E - tau A_p)) dL_x dL_y     x or y, by chance
        XYConstantArea    exp(-beta E) d(ln L_x)                 x and 1 / y, at constant A_p
        ZOnly             exp(-beta (E - f L_z)) dL_z            z scaled, x and y fixed

    each times the volume element dr of the N bodies in the box. In fractions of the box it is A_p^N
    ds, L_x^N L_y^N ds, ds and L_z^N ds, since a scaling by s_x, s_y, s_z multiplies the volume of
    configurations by (s_x s_y s_z)^N. A new A_p, L or ln L_x is chosen uniformly within a width on
    both sides of the old one, so that a move is accepted with the probability

        min(1, exp(-beta (dE - tau dA_p) + N ln(A_p' / A_p)))

    in the first two modes, min(1, exp(-beta dE)) at constant area, and for ZOnly with f dL and L in
    place of tau dA_p and A_p: D. Frenkel and B. Smit, Understanding Molecular Simulation, chapter
    5, doi:10.1016/B978-0-12-267351-1.X5000-7. The tension is that of the frame, which is conjugate
    to A_p, not to the area of the membrane itself: see F. Schmid, doi:10.1209/0295-5075/95/28008.
    For XYIndependent and XYConstantArea nothing but the energy holds the ratio of L_x and L_y, so
    that the box of a fluid membrane becomes ever narrower; XYIsotropic keeps it. For a tube along
    z, f is the force that pulls it.

    The box vectors are scaled in the same way, each of their components with its coordinate, which
    keeps a triclinic box exactly what it was to the particles; L_x, L_y and L_z are its diagonal.
    Positions are scaled about the origin. Particles of mass 0 are scaled one by one and not counted
    in N; virtual sites follow. Constraints of vertices are refused. Like OpenMM's barostats, this
    class scales positions only: integrators that keep velocities of half a step ago take the new
    forces for the kick of the whole step, which leaves a little heat, of second order in the step.

    OpenMM's barostats adapt the width of their moves for ever, which disturbs the distribution a
    little. Here it is adapted during the first moves only (setAdaptiveMoves()), by their rule: from
    1 % of the box on, divided by 1.1 where of ten moves or more less than a quarter was accepted,
    multiplied by 1.1 where it was more than three quarters, up to 30 % of the box. From then on it
    is constant, and the distribution exact.

    A move costs two evaluations of the energy. It is tried whenever an integrator updates the state
    of the Context: all integrators of OpenMM do, a CustomIntegrator where it has
    addUpdateContextState(). RPMDIntegrator, whose beads have positions of their own, is refused,
    and so are OpenMM's barostats beside it and two of this class that change the same axis. Some
    force of the System must use periodic boundary conditions. Checkpoints of platform Helfrich hold
    widths, random numbers and statistics, as the files of Python's save_state() do.

    OpenMM's barostats are refused by themselves where a membrane spans the box, unless they scale
    every particle (setScaleMoleculesAsRigid(False)) or never act (frequency 0).
    """

    XYIsotropic = 0
    """x and y by the same factor."""

    XYIndependent = 1
    """x or y, by chance."""

    XYConstantArea = 2
    """x by a factor and y by its inverse.

    Neither the tension nor the pulling force is used.
    """

    ZOnly = 3
    """z, against the pulling force.

    The tension is not used.
    """

    def __init__(
        self,
        temperature: Scalar,
        tension: Scalar = 0.0,
        frequency: int = 25,
        axes: int | str = 0,
        pullingForce: Scalar = 0.0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        temperature : float or Quantity
            The default temperature, K, above zero: that of the thermostat.
        tension : float or Quantity, default: 0.0
            The default tension of the frame, kJ/mol/nm^2; positive stretches.
        frequency : int, default: 25
            Every how many time steps a move is tried; 0 for never.
        axes : int or str, a constant of the class or its name, default: 0
            Which edges of the box change.
        pullingForce : float or Quantity, default: 0.0
            The default force along z, kJ/mol/nm; positive stretches.
        """
        make(
            self,
            number(self, "temperature", temperature),
            number(self, "tension", tension),
            whole(self, "frequency", frequency),
            constant(self, "axes", axes),
            number(self, "pullingForce", pullingForce),
        )

    @staticmethod
    def Tension() -> str:
        """The name of the Context parameter that holds the tension, kJ/mol/nm^2; with
        XYConstantArea and ZOnly, which do not use it, there is none.
        """
        return _forces.MonteCarloMembraneTension_Tension()

    @staticmethod
    def PullingForce() -> str:
        """The name of the Context parameter that holds the pulling force along z, kJ/mol/nm."""
        return _forces.MonteCarloMembraneTension_PullingForce()

    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature of the moves, K."""
        return _forces.MonteCarloMembraneTension_Temperature()

    def getDefaultTension(self) -> float:
        """Get the default tension, kJ/mol/nm^2."""
        return _forces.MonteCarloMembraneTension_getDefaultTension(self)

    def setDefaultTension(self, tension: Scalar) -> None:
        """Set the default tension, kJ/mol/nm^2, of Contexts that are made from now on; in others it
        is the parameter Tension().
        """
        _forces.MonteCarloMembraneTension_setDefaultTension(self, number(self, "tension", tension))

    def getDefaultPullingForce(self) -> float:
        """Get the default pulling force along z, kJ/mol/nm."""
        return _forces.MonteCarloMembraneTension_getDefaultPullingForce(self)

    def setDefaultPullingForce(self, pullingForce: Scalar) -> None:
        """Set the default pulling force along z, kJ/mol/nm, of Contexts that are made from now on;
        in others it is the parameter PullingForce().
        """
        _forces.MonteCarloMembraneTension_setDefaultPullingForce(
            self, number(self, "pullingForce", pullingForce)
        )

    def getAxes(self) -> int:
        """Get which edges of the box change."""
        return _forces.MonteCarloMembraneTension_getAxes(self)

    def setAxes(self, axes: int | str) -> None:
        """Set which edges of the box change, in Contexts that are made from now on."""
        _forces.MonteCarloMembraneTension_setAxes(self, constant(self, "axes", axes))

    def getScaleMoleculesAsRigid(self) -> bool:
        """Get whether molecules other than membranes with periodic boundary conditions are moved by
        their centres.
        """
        return _forces.MonteCarloMembraneTension_getScaleMoleculesAsRigid(self)

    def setScaleMoleculesAsRigid(self, rigid: bool) -> None:
        """Set whether molecules other than membranes with periodic boundary conditions are moved by
        their centres, or every particle is scaled by itself, in Contexts that are made from now on.
        """
        _forces.MonteCarloMembraneTension_setScaleMoleculesAsRigid(self, rigid)

    def getAdaptiveMoves(self) -> int:
        """Get how many moves adapt their width, since a Context was made."""
        return _forces.MonteCarloMembraneTension_getAdaptiveMoves(self)

    def setAdaptiveMoves(self, moves: int) -> None:
        """Set how many moves adapt their width, since a Context was made.

        What is sampled before is not to be used.
        """
        _forces.MonteCarloMembraneTension_setAdaptiveMoves(self, whole(self, "moves", moves))

    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy frequency and adaptiveMoves of this object to a Context.

        Temperature, tension and pulling force are parameters of the Context; all else needs
        Context.reinitialize().

        Parameters
        ----------
        context : openmm.Context
            The Context to update.
        """
        _forces.MonteCarloMembraneTension_updateParametersInContext(self, context)

    def usesPeriodicBoundaryConditions(self) -> bool:
        """Like OpenMM's barostats, this class has neither energy nor forces, and does not make a
        System periodic.

        Returns
        -------
        bool
            False.
        """
        return _forces.MonteCarloMembraneTension_usesPeriodicBoundaryConditions(self)

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.MonteCarloMembraneTension_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloMembraneTension:
        """The same force as an object of this class."""
        return own(_forces.MonteCarloMembraneTension_cast(force), force)
