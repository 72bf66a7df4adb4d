"""ParticleSurfaceForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from .. import _forces
from .._proxies import constant, elements, number, own, proxy, start
from .._surfaces import Particles
from .._types import Scalar, Values
from .membrane_force import MembraneForce

if TYPE_CHECKING:
    from ..mesh import Mesh


@proxy
class ParticleSurfaceForce(Particles, MembraneForce):
    """A surface that other particles cannot pass, and may adhere to.

    With the gap g = d - R between a particle of radius R and a triangle, whose nearest point is at
    the distance d from the particle's middle,

        E = sum over pairs with g < D of epsilon [ (D/g)^6 - 1 ]^2
            - adhesion * sum over pairs of the integral of phi((|x - r| - R)/D) over the triangle

    phi(x) = 1 for x <= 1; beyond that it is 2/x^6 - 1/x^12 (LennardJones) or (3/x^3 - 1/x^9)/2
    (NineThree, for a particle of many Lennard-Jones particles), which the factor 1 - 10 y^3 + 15
    y^4 - 6 y^5, y = x - 2, takes to zero from x = 2 to 3. So `adhesion` is the energy by area, w,
    of what touches, on any mesh that is fine enough: edges up to about D. A bead of radius R is
    wrapped at w (R + D)^2 > 2 kappa (M. Deserno, doi:10.1103/PhysRevE.69.031903). The attraction
    WCA, the default, is none.

    The core acts on whole triangles, so nothing slips between vertices while steps are short
    against D: a particle that moves farther than D in one step is not seen.

    Particles that are vertices of the same triangles are refused: SurfaceRepulsionForce is for
    those. The triangles may be of several membranes, also where bonds flip; see there. The
    processor computes the force, whatever computes others.
    """

    WCA = 0
    """Nothing does."""

    LennardJones = 1
    """The tail of a Lennard-Jones potential."""

    NineThree = 2
    """The tail of its integral over a half-space."""

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        particles: ArrayLike,
        distance: Scalar,
        epsilon: Scalar,
        adhesion: Scalar = 0.0,
        radius: Scalar | ArrayLike = 0.0,
        attraction: int | str = 0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        particles : array_like of int
            The indices of the particles that the surface acts on, none of them a corner.
        distance : float or Quantity
            The gap D below which there is a repulsion, nm, above zero.
        epsilon : float or Quantity
            The strength of the repulsion, kJ/mol, zero or above.
        adhesion : float or Quantity, default: 0.0
            The energy by area w of what touches, kJ/mol/nm^2, zero or above.
        radius : float or Quantity, or one for each element, default: 0.0
            The radius R of all particles, nm, zero or above.
        attraction : int or str, a constant of the class or its name, default: 0
            What attracts them.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            particles=particles,
            distance=distance,
            epsilon=epsilon,
            adhesion=adhesion,
            radius=radius,
            attraction=attraction,
        )

    def getDistance(self) -> float:
        """Get the gap D below which there is a repulsion, nm."""
        return _forces.ParticleSurfaceForce_getDistance(self)

    def setDistance(self, distance: Scalar) -> None:
        """Set the gap D below which there is a repulsion, nm, above zero."""
        _forces.ParticleSurfaceForce_setDistance(self, number(self, "distance", distance))

    def getEpsilon(self) -> float:
        """Get the strength of the repulsion, kJ/mol."""
        return _forces.ParticleSurfaceForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength of the repulsion, kJ/mol, zero or above."""
        _forces.ParticleSurfaceForce_setEpsilon(self, number(self, "epsilon", epsilon))

    def getAdhesion(self) -> float:
        """Get the energy by area w of what touches, kJ/mol/nm^2."""
        return _forces.ParticleSurfaceForce_getAdhesion(self)

    def setAdhesion(self, adhesion: Scalar) -> None:
        """Set the energy by area w of what touches, kJ/mol/nm^2, zero or above."""
        _forces.ParticleSurfaceForce_setAdhesion(self, number(self, "adhesion", adhesion))

    def getRadius(self) -> float:
        """Get the radius R of all particles, nm."""
        return _forces.ParticleSurfaceForce_getRadius(self)

    def setRadius(self, radius: Scalar) -> None:
        """Set the radius R of all particles, nm, zero or above.

        Values of single particles are given up.
        """
        _forces.ParticleSurfaceForce_setRadius(self, number(self, "radius", radius))

    def getParticleRadius(self) -> tuple[float, ...]:
        """Get the radius of each particle, nm; empty if all have the same."""
        return _forces.ParticleSurfaceForce_getParticleRadius(self)

    def setParticleRadius(self, values: Values) -> None:
        """Give each particle its own radius, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each particle, in the order of getParticles(), nm; empty to go back.
        """
        _forces.ParticleSurfaceForce_setParticleRadius(self, elements(self, "radius", values))

    def getAttraction(self) -> int:
        """Get what attracts particles."""
        return _forces.ParticleSurfaceForce_getAttraction(self)

    def setAttraction(self, attraction: int | str) -> None:
        """Set what attracts particles.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.ParticleSurfaceForce_setAttraction(self, constant(self, "attraction", attraction))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether some force of OpenMM is of this class."""
        return _forces.ParticleSurfaceForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> ParticleSurfaceForce:
        """The same force as an object of this class."""
        return own(_forces.ParticleSurfaceForce_cast(force), force)
