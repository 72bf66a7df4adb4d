"""The classes of forces, movers, thermostats and integrators.

.ci/forces.py writes this file, from the headers of C++.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm
from numpy.typing import ArrayLike

from . import _forces
from ._movers import Flips, Masses, Swaps, Tension, Viscosity
from ._proxies import constant, elements, make, make_on, number, own, proxy, start, whole
from ._surfaces import Domains, Particles, Reference, Triangulated
from ._types import Scalar, Values

if TYPE_CHECKING:
    from .mesh import Mesh

__all__ = [
    "AreaDifferenceForce",
    "BendingForce",
    "DihedralForce",
    "EdgeTensionForce",
    "EnclosedVolumeForce",
    "GaussianCurvatureForce",
    "LimForce",
    "LineTensionForce",
    "LinearElasticForce",
    "MembraneForce",
    "MonteCarloBondFlip",
    "MonteCarloDomainSwap",
    "MonteCarloMembraneTension",
    "NeoHookeanForce",
    "OsmoticPressureForce",
    "ParticleSurfaceForce",
    "PlaquetteAreaForce",
    "PressureForce",
    "SkalakForce",
    "SpringForce",
    "SurfaceAreaForce",
    "SurfaceRepulsionForce",
    "SurfaceTensionForce",
    "SurfaceViscosityThermostat",
    "TriangleAreaForce",
    "TriangleAreaRepulsionForce",
    "TriangleHeightForce",
    "TriangulatedForce",
    "VariableMassLangevinIntegrator",
    "VariableMassVerletIntegrator",
]


@proxy
class _HelfrichForce(openmm.Force):
    """An OpenMM Force of this plugin, which knows its class and has its implementation made by the
    library.
    """

    def getTypeName(self) -> str:
        """Get the name of the class, as messages and XML have it."""
        return _forces._HelfrichForce_getTypeName(self)


@proxy
class TriangulatedForce(Triangulated, _HelfrichForce):
    """What acts on a triangulated surface of particles.

    The triangles are those that a Context begins with, and they tell which forces act on the same
    surface. Bond flips (MonteCarloBondFlip) and setTrianglesInContext() change which particles are
    connected in a Context, for all forces on the same triangles at once; triangles keep their
    numbers.
    """

    def getNumTriangles(self) -> int:
        """Get the number of triangles."""
        return _forces.TriangulatedForce_getNumTriangles(self)

    def getTriangle(self, index: int) -> list[int]:
        """Get the corners of a triangle.

        Parameters
        ----------
        index : int
            The index of the triangle.
        """
        return _forces.TriangulatedForce_getTriangle(self, index)


@proxy
class _TriangulatedMover(TriangulatedForce):
    """What makes random moves now and then, at the temperature of a bath: what all such classes
    have in common.

    Base is a HelfrichForce.
    """

    def getDefaultTemperature(self) -> float:
        """Get the default temperature, K."""
        return _forces._TriangulatedMover_getDefaultTemperature(self)

    def setDefaultTemperature(self, temperature: Scalar) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
        _forces._TriangulatedMover_setDefaultTemperature(
            self, number(self, "temperature", temperature)
        )

    def getFrequency(self) -> int:
        """Get every how many time steps there are moves."""
        return _forces._TriangulatedMover_getFrequency(self)

    def setFrequency(self, frequency: int) -> None:
        """Set every how many time steps there are moves; 0 for never."""
        _forces._TriangulatedMover_setFrequency(self, whole(self, "frequency", frequency))

    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
        return _forces._TriangulatedMover_getRandomNumberSeed(self)

    def setRandomNumberSeed(self, seed: int) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on.

        The same seed gives the same moves, on any number of threads. With 0, the default, each
        Context gets a seed of its own.
        """
        _forces._TriangulatedMover_setRandomNumberSeed(self, whole(self, "randomNumberSeed", seed))


@proxy
class _SurfaceMover(_TriangulatedMover):
    """What tries Monte Carlo moves of the edges of a surface now and then, each by the change of
    the energy of all membrane forces on it: what all such classes have in common.
    """

    Canonical = 0
    """A bath of a temperature."""

    Microcanonical = 1
    """A demon, which has no energy when a Context is made.

    The temperature is not used.
    """

    def getAttemptsPerEdge(self) -> float:
        """Get how many moves are tried each time, for each edge."""
        return _forces._SurfaceMover_getAttemptsPerEdge(self)

    def setAttemptsPerEdge(self, attemptsPerEdge: Scalar) -> None:
        """Set how many moves are tried each time, for each edge, from 0 to 1000."""
        _forces._SurfaceMover_setAttemptsPerEdge(
            self, number(self, "attemptsPerEdge", attemptsPerEdge)
        )

    def getEnsemble(self) -> int:
        """Get who pays for moves."""
        return _forces._SurfaceMover_getEnsemble(self)

    def setEnsemble(self, ensemble: int | str) -> None:
        """Set who pays for moves: Canonical, a bath, or Microcanonical, a demon."""
        _forces._SurfaceMover_setEnsemble(self, constant(self, "ensemble", ensemble))

    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy the values of this object to a Context, except for the seed.

        The temperature is a parameter of the Context; changed triangles are refused (use
        Context.reinitialize()).

        Parameters
        ----------
        context : openmm.Context
            The Context to update.
        """
        _forces._SurfaceMover_updateParametersInContext(self, context)

    def usesPeriodicBoundaryConditions(self) -> bool:
        """Positions are taken as they are, without periodic boundary conditions.

        Returns
        -------
        bool
            False.
        """
        return _forces._SurfaceMover_usesPeriodicBoundaryConditions(self)


@proxy
class MembraneForce(TriangulatedForce):
    """The common part of all forces on a membrane: a triangulated surface, and named scalars.

    The triangles refer to particles of the System. They must form one or several oriented
    2-manifold surfaces, of any genus, closed or with borders, each triangle counter-clockwise seen
    from outside; that neighbours agree is checked when a Context is created. If all run clockwise,
    forces on the volume refuse them, and to others the inside is the outside. Particles that no
    triangle mentions feel no force. A border is pinned where its particles have no mass.

    Forces on the same triangles in one Context share one evaluation of the geometry. If a triangle
    loses all its area during a simulation, its normal and with it the energy's gradient are
    undefined; the evaluation then throws an OpenMMException that names the triangle, as it does for
    a particle at a position that is not finite. The Context stays usable with other positions.
    """

    def getNumParameters(self) -> int:
        """Get the number of scalar parameters."""
        return _forces.MembraneForce_getNumParameters(self)

    def getParameterName(self, index: int) -> str:
        """Get the name of a scalar parameter, as setContextParameter() takes it.

        Parameters
        ----------
        index : int
            The index of the parameter.
        """
        return _forces.MembraneForce_getParameterName(self, index)

    def getParameterValue(self, name: str) -> float:
        """Get the value of a scalar parameter in OpenMM's units (nm, kJ/mol).

        Parameters
        ----------
        name : str
            The name of the parameter.
        """
        return _forces.MembraneForce_getParameterValue(self, name)

    def getElementValues(self, name: str) -> tuple[float, ...]:
        """Get the values of a parameter for each vertex, triangle, edge or particle, empty if it is
        a scalar.

        Parameters
        ----------
        name : str
            The name of the parameter.
        """
        return _forces.MembraneForce_getElementValues(self, name)

    def setContextParameter(self, parameter: str, name: str) -> None:
        """Let a parameter of the Context take the place of a scalar, so that Context.setParameter()
        changes it during a simulation.

        Its initial value is that of the scalar. Several forces may share a parameter of the Context
        if their initial values agree.

        Parameters
        ----------
        parameter : str
            The name of the scalar, for example "target".
        name : str
            The name of the Context parameter; empty to go back to the scalar itself.
        """
        _forces.MembraneForce_setContextParameter(self, parameter, name)

    def getContextParameter(self, parameter: str) -> str:
        """Get the name of the Context parameter that stands in for a scalar, empty if there is
        none.

        Parameters
        ----------
        parameter : str
            The name of the scalar.
        """
        return _forces.MembraneForce_getContextParameter(self, parameter)

    def addEnergyParameterDerivative(self, name: str) -> None:
        """Ask for the derivative of the energy with respect to a Context parameter, which
        Context.getState() then returns; on OpenCL, CUDA and HIP not of what the processor computes,
        as contacts.

        Asking twice changes nothing.

        Parameters
        ----------
        name : str
            The name of the Context parameter, given to setContextParameter() before.
        """
        _forces.MembraneForce_addEnergyParameterDerivative(self, name)

    def getNumEnergyParameterDerivatives(self) -> int:
        """Get the number of Context parameters whose derivatives are asked for."""
        return _forces.MembraneForce_getNumEnergyParameterDerivatives(self)

    def getEnergyParameterDerivativeName(self, index: int) -> str:
        """Get the name of a Context parameter whose derivative is asked for.

        Parameters
        ----------
        index : int
            The index of the derivative.
        """
        return _forces.MembraneForce_getEnergyParameterDerivativeName(self, index)

    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy scalars, values of elements, form and switches of this object to a Context.

        What is a Context parameter stays as it is there (use Context.setParameter()); changed
        triangles are refused (use Context.reinitialize()).

        Parameters
        ----------
        context : openmm.Context
            The Context to update.
        """
        _forces.MembraneForce_updateParametersInContext(self, context)

    def setBackend(self, backend: str) -> None:
        """Choose what computes the force in Contexts that are made from now on: the processor or a
        GPU.

        Forces on the same triangles of one Context are computed together, so those of them that
        have a choice of their own must have the same one; the others follow.

        Parameters
        ----------
        backend : str
            "cpu"; "native", OpenMM's platform OpenCL, CUDA or HIP itself; "gpu", or with a
            precision "gpu:single" or "gpu:double"; "auto", which is native on these platforms
            where the device is a GPU, and elsewhere takes the GPU for large meshes if it is
            faster and the processor if the GPU fails; or empty, the default, for what has been
            chosen for the whole process. "gpu@1" names an adapter. Contacts, and on "gpu" a
            surface that spans a periodic box, are computed on the processor in any case.
        """
        _forces.MembraneForce_setBackend(self, backend)

    def getBackend(self) -> str:
        """Get what the force has chosen, empty if it follows the process."""
        return _forces.MembraneForce_getBackend(self)

    def setUsesPeriodicBoundaryConditions(self, periodic: bool) -> None:
        """Set whether the surface lives in the periodic box of the Context, which may be triclinic.

        Each edge then connects nearest images, so positions may be wrapped into the box or not: the
        result has the same bits. A surface may cross faces of the box, or span it: a sheet, a tube,
        a surface that goes on in three directions. Every edge must be shorter than half of the
        least distance between opposite faces; the evaluation throws an OpenMMException that names
        one which is not.

        Forces on the same triangles must agree. It is not periodic unless this is called or, in
        Python, the force is made of a Mesh that has a box; triangles alone say nothing of a box.
        Without it a surface that crosses the box is taken with edges that go all the way back
        through it, and its energy is wrong without an error. Existing Contexts do not change.

        Parameters
        ----------
        periodic : bool
            Whether it is periodic.
        """
        _forces.MembraneForce_setUsesPeriodicBoundaryConditions(self, periodic)

    def usesPeriodicBoundaryConditions(self) -> bool:
        """Get whether the surface lives in the periodic box of the Context."""
        return _forces.MembraneForce_usesPeriodicBoundaryConditions(self)

    def getForm(self) -> int:
        """Get which form of the potential is computed, 0 if there are none."""
        return _forces.MembraneForce_getForm(self)

    def setForm(self, form: int) -> None:
        """Choose the form of the potential.

        Parameters
        ----------
        form : int
            The number of the form.
        """
        _forces.MembraneForce_setForm(self, form)

    def getSwitch(self, name: str) -> bool:
        """Get whether something is switched on.

        Parameters
        ----------
        name : str
            The name of the switch.
        """
        return _forces.MembraneForce_getSwitch(self, name)

    def setSwitch(self, name: str, on: bool) -> None:
        """Switch something on or off.

        updateParametersInContext() tells existing Contexts.

        Parameters
        ----------
        name : str
            The name of the switch.
        on : bool
            Whether it shall be on.
        """
        _forces.MembraneForce_setSwitch(self, name, on)

    def getSwitches(self) -> int:
        """Get the state of all switches, one bit for each in the core's order."""
        return _forces.MembraneForce_getSwitches(self)


@proxy
class AreaDifferenceForce(MembraneForce):
    """Area-difference elasticity: the two monolayers of a closed membrane cannot exchange lipids,
    and resist changes of the difference in their areas.

        E = 1/2 m (M - M0)^2,   M = sum over edges of 1/2 l phi

    M is the integral of the mean curvature (C1 + C2) / 2 over the surface, nm, with l the length of
    an edge and phi the dihedral angle there, positive where the surface is convex: 4 pi r on a
    sphere, pi L on a tube of length L, 2 pi^2 R on a torus whose tube has its middle at R. It is
    half the sum of the curvatures J of BendingForce's scheme Julicher.

    With D the distance of the monolayers' neutral surfaces, their areas differ by dA = 2 D M, and

        E = alpha kappa pi / (2 A D^2) (dA - dA0)^2

    in Miao, Seifert, Wortis and Dobereiner, Phys. Rev. E 49, 5389 (1994),
    doi:10.1103/PhysRevE.49.5389, and in Seifert, Adv. Phys. 46, 13 (1997),
    doi:10.1080/00018739700101488. So m = 4 pi alpha kappa / A and M0 = dA0 / 2 D = 4 pi RA da0,
    where da0 is the reduced difference dA0 / (8 pi D RA) and A = 4 pi RA^2 the area of the relaxed
    membrane, a number here. D itself drops out. Python's area_difference_parameters() makes m and
    M0 of kappa, alpha, A and da0. To the bending energy, which a BendingForce without spontaneous
    curvature gives, this adds the rest of the ADE model.

    Edges at borders have no dihedral angle and do not count; there lipids can go round, and the
    energy means little. A fold that goes on through 180 degrees lets M jump, as in BendingForce.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, modulus: Scalar, target: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity
            The modulus m, kJ/mol/nm^2, zero or above.
        target : float or Quantity
            The target M0 of the integral of mean curvature, nm, of either sign.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the modulus m, kJ/mol/nm^2."""
        return _forces.AreaDifferenceForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the modulus m, kJ/mol/nm^2, zero or above."""
        _forces.AreaDifferenceForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target M0 of the integral of mean curvature, nm."""
        return _forces.AreaDifferenceForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target M0 of the integral of mean curvature, nm, of either sign."""
        _forces.AreaDifferenceForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.AreaDifferenceForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> AreaDifferenceForce:
        """The same force as an object of this class."""
        return own(_forces.AreaDifferenceForce_cast(force), force)


@proxy
class BendingForce(MembraneForce):
    """Bending energy of a fluid membrane (Helfrich), with spontaneous curvature, in five
    discretisations:

        E = 1/2 kappa sum_i [ c_i^2 / a_i - 2 C0 c_i + C0^2 a_i ]

    over the vertices i, with an integrated curvature c_i and an area a_i that the scheme chooses.
    kappa multiplies half the square of the sum of the principal curvatures less C0: a sphere of
    radius R has E = 8 pi kappa (1 - C0 R / 2)^2 up to the error of the mesh.

    Where c is a vector, c^2 is its square and the linear term takes n.c, with n the mean of the
    normals of the triangles at the vertex weighted by their angles (B9);
    setUnsignedSpontaneousCurvature() chooses |c| instead, as VCM does, which cannot tell a bulge
    from a dent.

    Borders are free, as in Capovilla, Guven and Santiago, Phys. Rev. E 66, 021607 (2002),
    doi:10.1103/PhysRevE.66.021607, without tension of their own: no scheme has curvature at a
    vertex on a border, which is left out of the sum, and a border edge has no angle. An inner edge
    that ends at a border counts for its inner end.

    The Voronoi area of the schemes GompperKroll and JulicherVoronoi goes through zero where
    triangles are obtuse. The energy then has pits and poles, as the formula has; it is not clamped.

    Source: Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301.
    """

    Julicher = 0
    """c = J = sum_j l_ij phi_ij / 2 over the edges, with phi the angle between the normals of their
    two triangles, positive where the surface is convex; a is barycentric (B13).
    """

    GompperKroll = 1
    """c = S = sum_j (cot theta_1 + cot theta_2)(r_i - r_j) / 2 with the two angles opposite the
    edge; a is Voronoi's, sum_j l_ij^2 (cot theta_1 + cot theta_2) / 8 (B10).
    """

    GompperKrollBarycentric = 2
    """c = S; a is barycentric, a third of the area of the triangles at the vertex (B15)."""

    JulicherVoronoi = 3
    """c = J; a is Voronoi's (B16)."""

    Espriu = 4
    """c = sum_j (r_i - r_j) / sqrt(3), as S if all triangles were equilateral; a is barycentric.

    At C0 = 0 this is VCM's Espiru1987, kappa sum_i |sum_j r_j - n_i r_i|^2 / (6 a_i).
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        rigidity: Scalar | ArrayLike,
        spontaneousCurvature: Scalar | ArrayLike = 0.0,
        scheme: int | str = 0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        rigidity : float or Quantity, or one for each element
            The bending rigidity kappa, kJ/mol, zero or above.
        spontaneousCurvature : float or Quantity, or one for each element, default: 0.0
            The spontaneous curvature C0, 1/nm, positive for bulging outward.
        scheme : int or str, a constant of the class or its name, default: 0
            The discretisation.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            rigidity=rigidity,
            spontaneousCurvature=spontaneousCurvature,
            scheme=scheme,
        )

    def getRigidity(self) -> float:
        """Get the bending rigidity kappa, kJ/mol."""
        return _forces.BendingForce_getRigidity(self)

    def setRigidity(self, rigidity: Scalar) -> None:
        """Set the bending rigidity kappa, kJ/mol, zero or above.

        Values of single vertices are given up.
        """
        _forces.BendingForce_setRigidity(self, number(self, "rigidity", rigidity))

    def getSpontaneousCurvature(self) -> float:
        """Get the spontaneous curvature C0, 1/nm, positive for bulging outward."""
        return _forces.BendingForce_getSpontaneousCurvature(self)

    def setSpontaneousCurvature(self, spontaneousCurvature: Scalar) -> None:
        """Set the spontaneous curvature C0, 1/nm, positive for bulging outward.

        Values of single vertices are given up.
        """
        _forces.BendingForce_setSpontaneousCurvature(
            self, number(self, "spontaneousCurvature", spontaneousCurvature)
        )

    def getScheme(self) -> int:
        """Get the discretisation."""
        return _forces.BendingForce_getScheme(self)

    def setScheme(self, scheme: int | str) -> None:
        """Set the discretisation.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.BendingForce_setScheme(self, constant(self, "scheme", scheme))

    def getUnsignedSpontaneousCurvature(self) -> bool:
        """Get whether the linear term of the spontaneous curvature takes |c|."""
        return _forces.BendingForce_getUnsignedSpontaneousCurvature(self)

    def setUnsignedSpontaneousCurvature(self, isUnsigned: bool) -> None:
        """Choose whether the linear term of the spontaneous curvature takes |c| (VCM) instead of
        n.c.

        Parameters
        ----------
        isUnsigned : bool
            True for |c|; False, the default, for n.c.
        """
        _forces.BendingForce_setUnsignedSpontaneousCurvature(self, isUnsigned)

    def getVertexRigidity(self) -> tuple[float, ...]:
        """Get the bending rigidity of each vertex, kJ/mol; empty if all have the same."""
        return _forces.BendingForce_getVertexRigidity(self)

    def setVertexRigidity(self, values: Values) -> None:
        """Give each vertex its own bending rigidity, which replaces the scalar: domains.

        Parameters
        ----------
        values : array_like or Quantity
            One for each vertex, in ascending order of particle index, kJ/mol; empty to go back.
        """
        _forces.BendingForce_setVertexRigidity(self, elements(self, "rigidity", values))

    def getVertexSpontaneousCurvature(self) -> tuple[float, ...]:
        """Get the spontaneous curvature of each vertex, 1/nm; empty if all have the same."""
        return _forces.BendingForce_getVertexSpontaneousCurvature(self)

    def setVertexSpontaneousCurvature(self, values: Values) -> None:
        """Give each vertex its own spontaneous curvature, which replaces the scalar: domains.

        Parameters
        ----------
        values : array_like or Quantity
            One for each vertex, in ascending order of particle index, 1/nm; empty to go back.
        """
        _forces.BendingForce_setVertexSpontaneousCurvature(
            self, elements(self, "spontaneousCurvature", values)
        )

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.BendingForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> BendingForce:
        """The same force as an object of this class."""
        return own(_forces.BendingForce_cast(force), force)


@proxy
class DihedralForce(MembraneForce):
    """Stiff hinges between neighbouring triangles:

        E = K sum over edges of f(phi - phi0)

    with phi the angle between the normals of the two triangles of an edge, 0 when flat and positive
    at a convex edge, and phi0 the angle at rest. Unlike BendingForce its effect depends on the
    mesh. K and phi0 can be given for each edge of its own; edges are in lexicographic order of the
    particles at their ends, the lower one first (in Python Mesh.edges), those on borders among
    them, which have no angle and no energy. Such values do not follow bond flips, which are refused
    then.

    Sources: (B5) and the potential of fourth order of Farnudi, Ejtehadi and Everaers, Phys. Rev. E
    108, 015301 (2023), doi:10.1103/PhysRevE.108.015301. Angles at rest: Kantor and Nelson, Phys.
    Rev. Lett. 58, 2774 (1987), doi:10.1103/PhysRevLett.58.2774; for red cells (6) of Fedosov,
    Caswell and Karniadakis, Biophys. J. 98, 2215 (2010), doi:10.1016/j.bpj.2010.02.002, with the
    form Cosine.
    """

    Quartic = 0
    """f = c^2, about x^4 / 4: the paper's potential (VCM smoothTheta4)."""

    Cosine = 1
    """f = c, about x^2 / 2: Kantor and Nelson (B5) (VCM cosine)."""

    Exp = 2
    """f = 1/2 (exp(2c) - 1) (VCM exp)."""

    SmoothExp = 3
    """f = 0.04 (exp(10c) - 1) (VCM smoothExp)."""

    SmoothExp46 = 4
    """f = 1/2 (exp(2c) - 1 - x^2) (VCM smoothExp46)."""

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        stiffness: Scalar | ArrayLike,
        form: int | str = 0,
        restAngle: Scalar | ArrayLike = 0.0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        stiffness : float or Quantity, or one for each element
            The stiffness K, kJ/mol, zero or above.
        form : int or str, a constant of the class or its name, default: 0
            The function f.
        restAngle : float or Quantity, or one for each element, default: 0.0
            The angle phi0 at rest, from -pi to pi, radians.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, stiffness=stiffness, form=form, restAngle=restAngle)

    def getStiffness(self) -> float:
        """Get the stiffness K, kJ/mol."""
        return _forces.DihedralForce_getStiffness(self)

    def setStiffness(self, stiffness: Scalar) -> None:
        """Set the stiffness K, kJ/mol, zero or above.

        Values of single edges are given up.
        """
        _forces.DihedralForce_setStiffness(self, number(self, "stiffness", stiffness))

    def getRestAngle(self) -> float:
        """Get the angle phi0 at rest."""
        return _forces.DihedralForce_getRestAngle(self)

    def setRestAngle(self, restAngle: Scalar) -> None:
        """Set the angle phi0 at rest, from -pi to pi, positive for convex edges.

        Values of single edges are given up.
        """
        _forces.DihedralForce_setRestAngle(self, number(self, "restAngle", restAngle))

    def getEdgeStiffness(self) -> tuple[float, ...]:
        """Get the stiffness of each edge, kJ/mol; empty if all have the same."""
        return _forces.DihedralForce_getEdgeStiffness(self)

    def setEdgeStiffness(self, values: Values) -> None:
        """Give each edge its own stiffness, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each edge, in lexicographic order, kJ/mol; empty to go back.
        """
        _forces.DihedralForce_setEdgeStiffness(self, elements(self, "stiffness", values))

    def getEdgeRestAngle(self) -> tuple[float, ...]:
        """Get the angle at rest of each edge; empty if all have the same."""
        return _forces.DihedralForce_getEdgeRestAngle(self)

    def setEdgeRestAngle(self, values: Values) -> None:
        """Give each edge its own angle at rest, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each edge, in lexicographic order; empty to go back.
        """
        _forces.DihedralForce_setEdgeRestAngle(self, elements(self, "restAngle", values))

    def getForm(self) -> int:
        """Get the function of the angle."""
        return _forces.DihedralForce_getForm(self)

    def setForm(self, form: int | str) -> None:
        """Set the function of the angle.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.DihedralForce_setForm(self, constant(self, "form", form))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.DihedralForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> DihedralForce:
        """The same force as an object of this class."""
        return own(_forces.DihedralForce_cast(force), force)


@proxy
class EdgeTensionForce(MembraneForce):
    """The line tension of a membrane's borders:

        E = gamma L

    with L the length of all borders, the edges that belong to one triangle. There is no energy on a
    closed surface. A disk closes to a vesicle where that costs less (Helfrich, Phys. Lett. A 50,
    115 (1974), doi:10.1016/0375-9601(74)90899-8). GaussianCurvatureForce is the other energy that
    borders have, and says what keeps free borders from folding over.
    """

    def __init__(self, triangles: Mesh | ArrayLike, tension: Scalar, *, offset: int = 0) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        tension : float or Quantity
            The energy gamma per length, kJ/mol/nm; below zero, borders grow.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, tension=tension)

    def getTension(self) -> float:
        """Get the energy per length, kJ/mol/nm."""
        return _forces.EdgeTensionForce_getTension(self)

    def setTension(self, tension: Scalar) -> None:
        """Set the energy per length, kJ/mol/nm."""
        _forces.EdgeTensionForce_setTension(self, number(self, "tension", tension))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.EdgeTensionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> EdgeTensionForce:
        """The same force as an object of this class."""
        return own(_forces.EdgeTensionForce_cast(force), force)


@proxy
class EnclosedVolumeForce(MembraneForce):
    """Keeps the volume V that a membrane encloses near a target V0:

        E = 1/2 kV (V - V0)^2 / V0

    Equation (2) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301. V is positive for outward triangles, the sum over all
    components of the surface, and does not depend on the origin.

    A surface with a border encloses nothing: creating a Context throws an exception that names the
    border.

    Triangles must run counter-clockwise seen from outside. Where V is below zero when a Context
    first evaluates the force, it throws an exception: swap two corners of each triangle. Of several
    surfaces some may face inward, as the inner wall of a shell does, if V as a whole is above zero,
    and a flat surface (|V| below a thousandth of a sphere's of the same area) may start. A shape
    that turns inside out or crosses itself later is not refused; the formula holds for V of either
    sign.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, modulus: Scalar, target: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity
            The volume modulus kV, kJ/mol/nm^3, zero or above.
        target : float or Quantity
            The target volume V0, nm^3, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the volume modulus kV, kJ/mol/nm^3."""
        return _forces.EnclosedVolumeForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the volume modulus kV, kJ/mol/nm^3, zero or above."""
        _forces.EnclosedVolumeForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target volume V0, nm^3."""
        return _forces.EnclosedVolumeForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target volume V0, nm^3, above zero."""
        _forces.EnclosedVolumeForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.EnclosedVolumeForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> EnclosedVolumeForce:
        """The same force as an object of this class."""
        return own(_forces.EnclosedVolumeForce_cast(force), force)


@proxy
class GaussianCurvatureForce(MembraneForce):
    """The elasticity of Gaussian curvature:

        E = kappa_G [ sum over vertices on no border of (2 pi - sum of theta) ]
          = kappa_G [ 2 pi chi - sum over vertices on borders of (pi - sum of theta) ]

    with theta the angles of the triangles at a vertex (Meyer et al., in Visualization and
    Mathematics III, 35 (2003), doi:10.1007/978-3-662-05105-4_2) and chi the number of vertices less
    that of edges plus that of triangles. The two are equal by the theorem of Gauss and Bonnet, in
    which the second sum is the integrated geodesic curvature of the borders; forces act on the
    triangles at borders only. On a closed surface E is the constant 2 pi chi kappa_G, 4 pi kappa_G
    on a sphere, and there are no forces.

    The modulus can have a value for each vertex, so that domains may differ. Then

        E = sum over vertices on no border of kappa_G,i (2 pi - sum of theta)

    has forces on closed surfaces, too: those of the line between domains, by its geodesic curvature
    (F. Juelicher and R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993),
    doi:10.1103/PhysRevLett.70.2964; LineTensionForce is the line's tension).

    With kappa_G below zero and bond flips, meshes with borders may crumple: where the dihedral
    angles at a vertex cancel, BendingForce's scheme Julicher sees no curvature however the surface
    zigzags, and folds at a border gain energy. A DihedralForce of the stiffness of the membrane's
    rigidity prevents that for kappa_G down to minus the rigidity; at -1.5 of it borders ruffle
    nevertheless. Free borders also fold over and heat up at low friction, with or without this
    force; a DihedralForce of 0.2 of the rigidity keeps them from it. docs/surfaces.md has the
    measurements.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, modulus: Scalar | ArrayLike, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity, or one for each element
            The modulus kappa_G, kJ/mol; of lipid membranes it is below zero, about -rigidity.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus)

    def getModulus(self) -> float:
        """Get the modulus kappa_G, kJ/mol."""
        return _forces.GaussianCurvatureForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the modulus kappa_G, kJ/mol.

        Values of single vertices are given up.
        """
        _forces.GaussianCurvatureForce_setModulus(self, number(self, "modulus", modulus))

    def getVertexModulus(self) -> tuple[float, ...]:
        """Get the modulus of each vertex, kJ/mol; empty if all have the same."""
        return _forces.GaussianCurvatureForce_getVertexModulus(self)

    def setVertexModulus(self, values: Values) -> None:
        """Give each vertex its own modulus, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each vertex, in ascending order of particle index, kJ/mol; empty to go back
            to the scalar.
        """
        _forces.GaussianCurvatureForce_setVertexModulus(self, elements(self, "modulus", values))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.GaussianCurvatureForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> GaussianCurvatureForce:
        """The same force as an object of this class."""
        return own(_forces.GaussianCurvatureForce_cast(force), force)


@proxy
class LimForce(Reference, MembraneForce):
    """Elasticity of the skeleton of a red blood cell, which hardens, against a reference shape:

        E = sum over triangles of A0 [ K/2 (a^2 + a3 a^3 + a4 a^4) + mu (b + b1 a b + b2 b^2) ]

    with a = l1 l2 - 1 and b = (l1 - l2)^2 / (2 l1 l2) of the principal stretches l1, l2 of a
    triangle, whose area in the reference is A0. It has no energy in the reference, and none of
    bending. At small strains the shear modulus is mu and the area modulus K. a3 = -2, a4 = 8, b1 =
    0.7, and b2 is chosen among those of the literature.

    Sources: Lim, Wortis and Mukhopadhyay, PNAS 99, 16766 (2002), doi:10.1073/pnas.202617299, and in
    Soft Matter 4 (Wiley, 2008), doi:10.1002/9783527623372.ch2a; Amoudruz et al., Biophys. J. 122,
    1517 (2023), doi:10.1016/j.bpj.2023.03.019.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; one whose corners are in one line there is never
    made.
    """

    Lim2002 = 0
    """b2 = 0.75: Lim, Wortis and Mukhopadhyay."""

    Amoudruz2023 = 1
    """b2 = 1.84: Amoudruz et al., from experiments."""

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        shearModulus: Scalar,
        areaModulus: Scalar,
        reference: Mesh | Values,
        coefficients: int | str = 0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        shearModulus : float or Quantity
            The modulus mu, kJ/mol/nm^2, zero or above.
        areaModulus : float or Quantity
            The modulus K, kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        coefficients : int or str, a constant of the class or its name, default: 0
            The set of coefficients.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            shearModulus=shearModulus,
            areaModulus=areaModulus,
            reference=reference,
            coefficients=coefficients,
        )

    def getCoefficients(self) -> int:
        """Get the set of coefficients."""
        return _forces.LimForce_getCoefficients(self)

    def setCoefficients(self, coefficients: int | str) -> None:
        """Set the set of coefficients.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.LimForce_setCoefficients(self, constant(self, "coefficients", coefficients))

    def getShearModulus(self) -> float:
        """Get the modulus mu, kJ/mol/nm^2."""
        return _forces.LimForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.LimForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the modulus K, kJ/mol/nm^2."""
        return _forces.LimForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the modulus K, kJ/mol/nm^2, zero or above."""
        _forces.LimForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.LimForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> LimForce:
        """The same force as an object of this class."""
        return own(_forces.LimForce_cast(force), force)


@proxy
class LineTensionForce(Domains, MembraneForce):
    """The tension of the line between domains of a membrane:

        E = gamma L

    with the length L of the line that separates vertices of different domains. In a triangle with
    two corners in one domain and the third in another it joins the middles of the two mixed sides,
    and in a triangle of three domains it leads from the middles of all sides to the centroid. There
    may be any number of domains. BendingForce can have a rigidity and a spontaneous curvature for
    each vertex, and so for each domain.

    The smooth counterpart is F. Juelicher and R. Lipowsky, Phys. Rev. Lett. 70, 2964 (1993),
    doi:10.1103/PhysRevLett.70.2964. A line through a mesh goes in zigzag and is longer than a
    smooth one, however fine the mesh is: on equilateral triangles by 1 along their edges, 2/sqrt(3)
    at 30 degrees to these and 2 sqrt(3)/pi = 1.103 on average, on random meshes by 1.107. So gamma
    is to be the energy of a smooth line by length, divided by this.

    Domains belong to the vertices: bond flips take a vertex along with its domain, so that domains
    mix and sort on a membrane that flows. With a MonteCarloDomainSwap neighbours exchange them.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, tension: Scalar, domains: ArrayLike, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        tension : float or Quantity
            The energy gamma per length, kJ/mol/nm; below zero, domains mix.
        domains : array_like of int
            The number of each vertex' domain, in ascending order of particle index.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, tension=tension, domains=domains)

    def getTension(self) -> float:
        """Get the energy per length, kJ/mol/nm."""
        return _forces.LineTensionForce_getTension(self)

    def setTension(self, tension: Scalar) -> None:
        """Set the energy per length, kJ/mol/nm."""
        _forces.LineTensionForce_setTension(self, number(self, "tension", tension))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.LineTensionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> LineTensionForce:
        """The same force as an object of this class."""
        return own(_forces.LineTensionForce_cast(force), force)


@proxy
class LinearElasticForce(Reference, MembraneForce):
    """The simplest elasticity against a reference shape, quadratic in Green's strain e of each
    triangle:

        E = sum over triangles of A0 [ K/2 (e1 + e2)^2 + mu/2 (e1 - e2)^2 ]

    with the principal strains e = (l^2 - 1)/2 of the principal stretches l1, l2 and the area A0 of
    the triangle in the reference. mu is the shear and K the area modulus at small strains. This is
    the law of de Saint-Venant and Kirchhoff (P. G. Ciarlet, Mathematical Elasticity I, North-
    Holland 1988). It is for small strains: a triangle that is compressed to nothing has a finite
    energy, and resists less and less on the way there.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; see SkalakForce.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        shearModulus: Scalar,
        areaModulus: Scalar,
        reference: Mesh | Values,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        shearModulus : float or Quantity
            The shear modulus mu, kJ/mol/nm^2, zero or above.
        areaModulus : float or Quantity
            The area modulus K, kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            shearModulus=shearModulus,
            areaModulus=areaModulus,
            reference=reference,
        )

    def getShearModulus(self) -> float:
        """Get the shear modulus mu, kJ/mol/nm^2."""
        return _forces.LinearElasticForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the shear modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.LinearElasticForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the area modulus K, kJ/mol/nm^2."""
        return _forces.LinearElasticForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the area modulus K, kJ/mol/nm^2, zero or above."""
        _forces.LinearElasticForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.LinearElasticForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> LinearElasticForce:
        """The same force as an object of this class."""
        return own(_forces.LinearElasticForce_cast(force), force)


@proxy
class NeoHookeanForce(Reference, MembraneForce):
    """Elasticity of a rubber-like membrane against a reference shape:

        E = sum over triangles of A0 [ mu/2 (l1/l2 + l2/l1 - 2) + K/2 (l1 l2 - 1)^2 ]

    with the principal stretches l1, l2 of a triangle, whose area in the reference is A0. Shear at
    fixed area costs mu and growth K only, however large they are; at small strains mu is the shear
    and K the area modulus.

    It is the first-order material of E. A. Evans and R. Skalak, Mechanics and Thermodynamics of
    Biomembranes (CRC Press, 1980), mu beta + K/2 alpha^2 with alpha = l1 l2 - 1 and beta = (l1^2 +
    l2^2)/(2 l1 l2) - 1, to which G. Lim, M. Wortis and R. Mukhopadhyay (doi:10.1073/pnas.202617299)
    add terms of higher order.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; see SkalakForce.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        shearModulus: Scalar,
        areaModulus: Scalar,
        reference: Mesh | Values,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        shearModulus : float or Quantity
            The shear modulus mu, kJ/mol/nm^2, zero or above.
        areaModulus : float or Quantity
            The area modulus K, kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            shearModulus=shearModulus,
            areaModulus=areaModulus,
            reference=reference,
        )

    def getShearModulus(self) -> float:
        """Get the shear modulus mu, kJ/mol/nm^2."""
        return _forces.NeoHookeanForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the shear modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.NeoHookeanForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the area modulus K, kJ/mol/nm^2."""
        return _forces.NeoHookeanForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the area modulus K, kJ/mol/nm^2, zero or above."""
        _forces.NeoHookeanForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.NeoHookeanForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> NeoHookeanForce:
        """The same force as an object of this class."""
        return own(_forces.NeoHookeanForce_cast(force), force)


@proxy
class OsmoticPressureForce(MembraneForce):
    """The osmotic pressure of solutes that cannot pass a membrane, which water can:

        E = n kT (x - 1 - ln x),   x = c V / n

    with n the number of solutes inside, c their concentration outside and V the enclosed volume.
    The solutions are ideal (van 't Hoff, Z. Phys. Chem. 1, 481 (1887), doi:10.1515/zpch-1887-0151),
    and the one outside is large: E is the work against the pressure difference

        -dE/dV = kT (n / V - c)

    It is zero, and least, at V = n / c, where its stiffness is that of an EnclosedVolumeForce of
    modulus kT c; for the few bars of real solutions that is a fixed volume. E is infinite at V = 0.
    A shape without a volume, as one that has turned inside out, is refused by an exception.

    Numbers are counted in molecules: a concentration of 1 mol/l is 0.602214 / nm^3. In Python,
    thermalEnergy may be unit.MOLAR_GAS_CONSTANT_R * 300 * unit.kelvin.

    Triangles must run counter-clockwise seen from outside, and a surface with a border is refused,
    as EnclosedVolumeForce says.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        solutes: Scalar,
        concentration: Scalar,
        thermalEnergy: Scalar,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        solutes : float or Quantity
            The number n of solutes inside, above zero.
        concentration : float or Quantity
            The concentration c of solutes outside, 1/nm^3, above zero.
        thermalEnergy : float or Quantity
            The thermal energy kT, kJ/mol, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            solutes=solutes,
            concentration=concentration,
            thermalEnergy=thermalEnergy,
        )

    def getSolutes(self) -> float:
        """Get the number n of solutes inside."""
        return _forces.OsmoticPressureForce_getSolutes(self)

    def setSolutes(self, solutes: Scalar) -> None:
        """Set the number n of solutes inside, above zero."""
        _forces.OsmoticPressureForce_setSolutes(self, number(self, "solutes", solutes))

    def getConcentration(self) -> float:
        """Get the concentration c of solutes outside, 1/nm^3."""
        return _forces.OsmoticPressureForce_getConcentration(self)

    def setConcentration(self, concentration: Scalar) -> None:
        """Set the concentration c of solutes outside, 1/nm^3, above zero."""
        _forces.OsmoticPressureForce_setConcentration(
            self, number(self, "concentration", concentration)
        )

    def getThermalEnergy(self) -> float:
        """Get the thermal energy kT, kJ/mol."""
        return _forces.OsmoticPressureForce_getThermalEnergy(self)

    def setThermalEnergy(self, thermalEnergy: Scalar) -> None:
        """Set the thermal energy kT, kJ/mol, above zero."""
        _forces.OsmoticPressureForce_setThermalEnergy(
            self, number(self, "thermalEnergy", thermalEnergy)
        )

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.OsmoticPressureForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> OsmoticPressureForce:
        """The same force as an object of this class."""
        return own(_forces.OsmoticPressureForce_cast(force), force)


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
        """Whether a force of OpenMM is of this class."""
        return _forces.ParticleSurfaceForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> ParticleSurfaceForce:
        """The same force as an object of this class."""
        return own(_forces.ParticleSurfaceForce_cast(force), force)


@proxy
class PlaquetteAreaForce(MembraneForce):
    """Keeps the plaquettes of all N vertices alike:

        E = 1/2 k sum_i (N a_i / A0 - 1)^2

    with a_i the barycentric area of vertex i, a third of the area of its triangles.

    Source: equation (20) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301, with k = (3/2) kB T.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, stiffness: Scalar, target: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        stiffness : float or Quantity
            The stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above.
        target : float or Quantity
            The target A0 of the total area, nm^2, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, stiffness=stiffness, target=target)

    def getStiffness(self) -> float:
        """Get the stiffness k, (3/2) kB T in the paper, kJ/mol."""
        return _forces.PlaquetteAreaForce_getStiffness(self)

    def setStiffness(self, stiffness: Scalar) -> None:
        """Set the stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above."""
        _forces.PlaquetteAreaForce_setStiffness(self, number(self, "stiffness", stiffness))

    def getTarget(self) -> float:
        """Get the target A0 of the total area, nm^2."""
        return _forces.PlaquetteAreaForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target A0 of the total area, nm^2, above zero."""
        _forces.PlaquetteAreaForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.PlaquetteAreaForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> PlaquetteAreaForce:
        """The same force as an object of this class."""
        return own(_forces.PlaquetteAreaForce_cast(force), force)


@proxy
class PressureForce(MembraneForce):
    """A pressure difference across a membrane that encloses the volume V:

        E = -p V

    with p the pressure inside less that outside: above zero it blows the membrane up, below zero it
    sucks it in. The force on a vertex is p/3 times the sum of the area vectors of its triangles.
    Bending, a tension and a pressure together are the functional of Deuling and Helfrich, J. Phys.
    (Paris) 37, 1335 (1976), doi:10.1051/jphys:0197600370110133500, whose pressure difference has
    the other sign; see also Seifert, Adv. Phys. 46, 13 (1997), doi:10.1080/00018739700101488.

    E has no lower bound for p above zero: something else must keep the area finite, such as a
    SurfaceAreaForce. p can be a parameter of the Context, see setContextParameter(). Where the
    volume changes with osmotic pressure, take an OsmoticPressureForce.

    Triangles must run counter-clockwise seen from outside, and a surface with a border is refused,
    as EnclosedVolumeForce says.
    """

    def __init__(self, triangles: Mesh | ArrayLike, pressure: Scalar, *, offset: int = 0) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        pressure : float or Quantity
            The pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar).
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, pressure=pressure)

    def getPressure(self) -> float:
        """Get the pressure difference p, inside less outside, kJ/mol/nm^3."""
        return _forces.PressureForce_getPressure(self)

    def setPressure(self, pressure: Scalar) -> None:
        """Set the pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar)."""
        _forces.PressureForce_setPressure(self, number(self, "pressure", pressure))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.PressureForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> PressureForce:
        """The same force as an object of this class."""
        return own(_forces.PressureForce_cast(force), force)


@proxy
class SkalakForce(Reference, MembraneForce):
    """Elasticity of a membrane with a skeleton, such as that of a red blood cell, against a
    reference shape:

        E = sum over triangles of A0 [ mu/4 (1/2 I1^2 + I1 - I2) + K/8 I2^2 ]

    with I1 = l1^2 + l2^2 - 2 and I2 = l1^2 l2^2 - 1 of the principal stretches l1, l2 of a
    triangle, whose area in the reference is A0. It has no energy in the reference, and none of
    bending. The area term makes it stiffer the more it is stretched; for red cells K is some 1000
    mu at short times (a membrane whose area is kept) and of the order of mu for the skeleton alone.

    mu and K are B and C of R. Skalak, A. Tozeren, R. P. Zarda and S. Chien, Biophys. J. 13, 245
    (1973), doi:10.1016/S0006-3495(73)85983-1. At small strains the shear modulus is mu/2 and the
    area modulus K + mu/2. LinearElasticForce and NeoHookeanForce have these moduli themselves for
    arguments.

    The reference gives each vertex a position, so that a triangle which bond flips make has the
    shape at rest that its new corners have there; one whose corners are in one line there is never
    made.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        shearModulus: Scalar,
        areaModulus: Scalar,
        reference: Mesh | Values,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        shearModulus : float or Quantity
            The modulus mu, kJ/mol/nm^2, zero or above.
        areaModulus : float or Quantity
            The modulus K, kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            shearModulus=shearModulus,
            areaModulus=areaModulus,
            reference=reference,
        )

    def getShearModulus(self) -> float:
        """Get the modulus mu, kJ/mol/nm^2."""
        return _forces.SkalakForce_getShearModulus(self)

    def setShearModulus(self, shearModulus: Scalar) -> None:
        """Set the modulus mu, kJ/mol/nm^2, zero or above."""
        _forces.SkalakForce_setShearModulus(self, number(self, "shearModulus", shearModulus))

    def getAreaModulus(self) -> float:
        """Get the modulus K, kJ/mol/nm^2."""
        return _forces.SkalakForce_getAreaModulus(self)

    def setAreaModulus(self, areaModulus: Scalar) -> None:
        """Set the modulus K, kJ/mol/nm^2, zero or above."""
        _forces.SkalakForce_setAreaModulus(self, number(self, "areaModulus", areaModulus))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.SkalakForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SkalakForce:
        """The same force as an object of this class."""
        return own(_forces.SkalakForce_cast(force), force)


@proxy
class SpringForce(Reference, MembraneForce):
    """Springs along the edges, a network such as the spectrin skeleton of a red blood cell:

        E = sum over edges of f(l)

    with the length l of an edge. Each spring has its minimum, f = 0, at the length l0 that its edge
    has in the reference, and there the stiffness k = f'' that all have. A net of equilateral
    triangles without tension has the shear modulus sqrt(3)/4 k and the area modulus sqrt(3)/2 k.

    The reference gives each vertex a position, so that an edge which bond flips make is as long at
    rest as its ends are apart there.
    """

    Harmonic = 0
    """f = 1/2 k (l - l0)^2."""

    WLCPower = 1
    """f = A [g(x) - g(x0)] + p (1/l - 1/l0), a worm-like chain with g(x) = (3 x^2 - 2 x^3)/(1 - x),
    x = l/lmax, and a repulsion, of which l0 and k determine A and p: D.

    A. Fedosov, B. Caswell and G. E. Karniadakis, Biophys. J. 98, 2215 (2010),
    doi:10.1016/j.bpj.2010.02.002, with m = 2, p = k_p and A = kBT lmax/(4p) there. An edge of
    length lmax or more is an error that names it.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        stiffness: Scalar,
        reference: Mesh | Values,
        ratio: Scalar = 0.45454545454545453,
        form: int | str = 0,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        stiffness : float or Quantity
            The stiffness k = f''(l0), kJ/mol/nm^2, zero or above.
        reference : Mesh, array_like or Quantity, shape (num_vertices, 3)
            The positions of the vertices at rest, nm, three coordinates for each, in ascending
            order of particle index.
        ratio : float or Quantity, default: 0.45454545454545453
            The length at rest as a share of the longest, l0/lmax, above zero and below one; of
            WLCPower only.
        form : int or str, a constant of the class or its name, default: 0
            The function f.
        offset : int
            Added to all indices of the triangles.
        """
        start(
            self,
            triangles,
            offset,
            stiffness=stiffness,
            reference=reference,
            ratio=ratio,
            form=form,
        )

    def getStiffness(self) -> float:
        """Get the stiffness k of all springs at rest, kJ/mol/nm^2."""
        return _forces.SpringForce_getStiffness(self)

    def setStiffness(self, stiffness: Scalar) -> None:
        """Set the stiffness k of all springs at rest, kJ/mol/nm^2, zero or above."""
        _forces.SpringForce_setStiffness(self, number(self, "stiffness", stiffness))

    def getRatio(self) -> float:
        """Get the length at rest as a share of the longest, l0/lmax."""
        return _forces.SpringForce_getRatio(self)

    def setRatio(self, ratio: Scalar) -> None:
        """Set the length at rest as a share of the longest, l0/lmax, above zero and below one."""
        _forces.SpringForce_setRatio(self, number(self, "ratio", ratio))

    def getForm(self) -> int:
        """Get the function of the length."""
        return _forces.SpringForce_getForm(self)

    def setForm(self, form: int | str) -> None:
        """Set the function of the length.

        updateParametersInContext() tells existing Contexts.
        """
        _forces.SpringForce_setForm(self, constant(self, "form", form))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.SpringForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SpringForce:
        """The same force as an object of this class."""
        return own(_forces.SpringForce_cast(force), force)


@proxy
class SurfaceAreaForce(MembraneForce):
    """Keeps the total area A of a membrane near a target A0:

        E = 1/2 kA (A - A0)^2 / A0

    Equation (1) of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301. A is the sum over all triangles, of all components of the
    surface.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, modulus: Scalar, target: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity
            The area modulus kA, kJ/mol/nm^2, zero or above.
        target : float or Quantity
            The target area A0, nm^2, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the area modulus kA, kJ/mol/nm^2."""
        return _forces.SurfaceAreaForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the area modulus kA, kJ/mol/nm^2, zero or above."""
        _forces.SurfaceAreaForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target area A0, nm^2."""
        return _forces.SurfaceAreaForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target area A0, nm^2, above zero."""
        _forces.SurfaceAreaForce_setTarget(self, number(self, "target", target))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.SurfaceAreaForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceAreaForce:
        """The same force as an object of this class."""
        return own(_forces.SurfaceAreaForce_cast(force), force)


@proxy
class SurfaceRepulsionForce(MembraneForce):
    """Keeps surfaces from passing through themselves and each other, by a repulsion of vertices and
    triangles and of edges:

        E = sum over pairs at a distance d < D of m epsilon [ (D/d)^6 - 1 ]^2

    A pair is a vertex and a triangle, or two edges, that share no vertex; d is the distance of
    their nearest points. m is 1, but for edges at an angle theta with q = sin^2 theta / 0.01 < 1 it
    is q (2 - q): where edges become parallel their ends take over. Energy and force go to zero at D
    (Weeks, Chandler and Andersen, doi:10.1063/1.1674820).

    Two triangles without a common vertex can begin to cross only where a vertex meets a triangle or
    an edge meets an edge, at d = 0, where the energy is infinite. So nothing crosses that is not
    crossed at the beginning, whatever the lengths of edges, as long as no vertex moves by a good
    part of D in a step. Within a flat surface, pairs are as far apart as triangles are high: take a
    D below the least height, about a fifth of the mean edge, and epsilon of kT.

    The triangles may be of several surfaces. If bonds flip on some of them, give those of whole
    membranes one after another, each as its MonteCarloBondFlip and its other forces have them: the
    force follows their flips, and its energy counts in each. A flip does not look whether the
    quadrilateral that it turns sweeps over something.

    The processor computes it, whatever computes other forces.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, distance: Scalar, epsilon: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        distance : float or Quantity
            The distance D below which there is a repulsion, nm, above zero.
        epsilon : float or Quantity
            The strength, kJ/mol, zero or above.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, distance=distance, epsilon=epsilon)

    def getDistance(self) -> float:
        """Get the distance D below which there is a repulsion, nm."""
        return _forces.SurfaceRepulsionForce_getDistance(self)

    def setDistance(self, distance: Scalar) -> None:
        """Set the distance D below which there is a repulsion, nm, above zero."""
        _forces.SurfaceRepulsionForce_setDistance(self, number(self, "distance", distance))

    def getEpsilon(self) -> float:
        """Get the strength, kJ/mol."""
        return _forces.SurfaceRepulsionForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength, kJ/mol, zero or above."""
        _forces.SurfaceRepulsionForce_setEpsilon(self, number(self, "epsilon", epsilon))

    def getOnlyBetweenParts(self) -> bool:
        """Get whether only different connected parts of the triangles repel each other."""
        return _forces.SurfaceRepulsionForce_getOnlyBetweenParts(self)

    def setOnlyBetweenParts(self, only: bool) -> None:
        """Choose whether only different connected parts of the triangles repel each other.

        Parameters
        ----------
        only : bool
            True to leave out pairs within a part; False, the default, for all pairs.
        """
        _forces.SurfaceRepulsionForce_setOnlyBetweenParts(self, only)

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.SurfaceRepulsionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceRepulsionForce:
        """The same force as an object of this class."""
        return own(_forces.SurfaceRepulsionForce_cast(force), force)


@proxy
class SurfaceTensionForce(MembraneForce):
    """A surface tension on the total area A of a membrane:

        E = sigma A

    sigma is the energy per area of a membrane that exchanges area with a reservoir, the Lagrange
    multiplier of the area in Deuling and Helfrich, J. Phys. (Paris) 37, 1335 (1976),
    doi:10.1051/jphys:0197600370110133500, and in Seifert, Adv. Phys. 46, 13 (1997),
    doi:10.1080/00018739700101488. A is the sum over all triangles, of all components of the
    surface, closed or with borders.

    Vertices are not exchanged with the reservoir: triangles grow or shrink, and a
    TriangleHeightForce, say, must keep them from collapsing. A membrane under tension by the frame
    that it spans, at constant area, is another thing: MonteCarloMembraneTension.
    """

    def __init__(self, triangles: Mesh | ArrayLike, tension: Scalar, *, offset: int = 0) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        tension : float or Quantity
            The tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, tension=tension)

    def getTension(self) -> float:
        """Get the tension sigma, kJ/mol/nm^2."""
        return _forces.SurfaceTensionForce_getTension(self)

    def setTension(self, tension: Scalar) -> None:
        """Set the tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign."""
        _forces.SurfaceTensionForce_setTension(self, number(self, "tension", tension))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.SurfaceTensionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceTensionForce:
        """The same force as an object of this class."""
        return own(_forces.SurfaceTensionForce_cast(force), force)


@proxy
class TriangleAreaForce(MembraneForce):
    """Keeps the area a of each triangle near a target a0:

        E = sum over triangles of 1/2 kA (a - a0)^2 / a0

    which gives a membrane local resistance to changes of area, as VCM's SurfaceConstraint L. The
    target can be one value or one for each triangle. Compare SurfaceAreaForce, equation (1) of
    Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301, which keeps the sum.
    """

    def __init__(
        self,
        triangles: Mesh | ArrayLike,
        modulus: Scalar,
        target: Scalar | ArrayLike,
        *,
        offset: int = 0,
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        modulus : float or Quantity
            The area modulus kA, kJ/mol/nm^2, zero or above.
        target : float or Quantity, or one for each element
            The target area a0 of each triangle, nm^2, above zero.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, modulus=modulus, target=target)

    def getModulus(self) -> float:
        """Get the area modulus kA, kJ/mol/nm^2."""
        return _forces.TriangleAreaForce_getModulus(self)

    def setModulus(self, modulus: Scalar) -> None:
        """Set the area modulus kA, kJ/mol/nm^2, zero or above."""
        _forces.TriangleAreaForce_setModulus(self, number(self, "modulus", modulus))

    def getTarget(self) -> float:
        """Get the target area a0 of each triangle, nm^2."""
        return _forces.TriangleAreaForce_getTarget(self)

    def setTarget(self, target: Scalar) -> None:
        """Set the target area a0 of each triangle, nm^2, above zero.

        Values of single triangles are given up.
        """
        _forces.TriangleAreaForce_setTarget(self, number(self, "target", target))

    def getTriangleTargets(self) -> tuple[float, ...]:
        """Get the target area of each triangle, nm^2; empty if all have the same."""
        return _forces.TriangleAreaForce_getTriangleTargets(self)

    def setTriangleTargets(self, values: Values) -> None:
        """Give each triangle its own target area, which replaces the scalar.

        Parameters
        ----------
        values : array_like or Quantity
            One for each triangle, nm^2; empty to go back to the scalar.
        """
        _forces.TriangleAreaForce_setTriangleTargets(self, elements(self, "target", values))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.TriangleAreaForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> TriangleAreaForce:
        """The same force as an object of this class."""
        return own(_forces.TriangleAreaForce_cast(force), force)


@proxy
class TriangleAreaRepulsionForce(MembraneForce):
    """Keeps triangles from vanishing by a repulsion at small areas:

        E = sum over triangles with area a < 2^(1/4) a_m of epsilon [ (a_m/a)^8 - (a_m/a)^4 + 1/4 ]

    The form of TriangleHeightForce on areas, VCM's SurfaceConstraint WCA and GWCA; energy and force
    go to zero at the cutoff, where VCM's are discontinuous. A triangle can still degenerate to a
    long needle; the paper (Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301) prefers heights.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, minArea: Scalar, epsilon: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        minArea : float or Quantity
            The area a_m below which the repulsion is strong, nm^2, zero or above.
        epsilon : float or Quantity
            The strength, kJ/mol, zero or above.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, minArea=minArea, epsilon=epsilon)

    def getMinArea(self) -> float:
        """Get the area a_m below which the repulsion is strong, nm^2."""
        return _forces.TriangleAreaRepulsionForce_getMinArea(self)

    def setMinArea(self, minArea: Scalar) -> None:
        """Set the area a_m below which the repulsion is strong, nm^2, zero or above."""
        _forces.TriangleAreaRepulsionForce_setMinArea(self, number(self, "minArea", minArea))

    def getEpsilon(self) -> float:
        """Get the strength, kJ/mol."""
        return _forces.TriangleAreaRepulsionForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength, kJ/mol, zero or above."""
        _forces.TriangleAreaRepulsionForce_setEpsilon(self, number(self, "epsilon", epsilon))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.TriangleAreaRepulsionForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> TriangleAreaRepulsionForce:
        """The same force as an object of this class."""
        return own(_forces.TriangleAreaRepulsionForce_cast(force), force)


@proxy
class TriangleHeightForce(MembraneForce):
    """Keeps triangles from degenerating by a repulsion at small heights:

        E = sum over triangles, sum over their three heights h < 2^(1/4) d of
            epsilon [ (d/h)^8 - (d/h)^4 + 1/4 ]

    The auxiliary potential of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
    doi:10.1103/PhysRevE.108.015301. Energy and force go to zero at h = 2^(1/4) d.
    """

    def __init__(
        self, triangles: Mesh | ArrayLike, minHeight: Scalar, epsilon: Scalar, *, offset: int = 0
    ) -> None:
        """Make the force.

        Parameters
        ----------
        triangles : Mesh or array_like of int, shape (num_triangles, 3)
            The particle indices of the corners, three for each triangle.
        minHeight : float or Quantity
            The height d below which the repulsion is strong, nm, zero or above.
        epsilon : float or Quantity
            The strength, kJ/mol, zero or above.
        offset : int
            Added to all indices of the triangles.
        """
        start(self, triangles, offset, minHeight=minHeight, epsilon=epsilon)

    def getMinHeight(self) -> float:
        """Get the height d, nm."""
        return _forces.TriangleHeightForce_getMinHeight(self)

    def setMinHeight(self, minHeight: Scalar) -> None:
        """Set the height d, nm, zero or above."""
        _forces.TriangleHeightForce_setMinHeight(self, number(self, "minHeight", minHeight))

    def getEpsilon(self) -> float:
        """Get the strength epsilon, kJ/mol."""
        return _forces.TriangleHeightForce_getEpsilon(self)

    def setEpsilon(self, epsilon: Scalar) -> None:
        """Set the strength epsilon, kJ/mol, zero or above."""
        _forces.TriangleHeightForce_setEpsilon(self, number(self, "epsilon", epsilon))

    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
        return _forces.TriangleHeightForce_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> TriangleHeightForce:
        """The same force as an object of this class."""
        return own(_forces.TriangleHeightForce_cast(force), force)


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
        """Whether a force of OpenMM is of this class."""
        return _forces.MonteCarloBondFlip_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloBondFlip:
        """The same force as an object of this class."""
        return own(_forces.MonteCarloBondFlip_cast(force), force)


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
        """Whether a force of OpenMM is of this class."""
        return _forces.MonteCarloDomainSwap_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloDomainSwap:
        """The same force as an object of this class."""
        return own(_forces.MonteCarloDomainSwap_cast(force), force)


@proxy
class _Mover(_HelfrichForce):
    """What makes random moves now and then, at the temperature of a bath: what all such classes
    have in common.

    Base is a HelfrichForce.
    """

    def getDefaultTemperature(self) -> float:
        """Get the default temperature, K."""
        return _forces._Mover_getDefaultTemperature(self)

    def setDefaultTemperature(self, temperature: Scalar) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
        _forces._Mover_setDefaultTemperature(self, number(self, "temperature", temperature))

    def getFrequency(self) -> int:
        """Get every how many time steps there are moves."""
        return _forces._Mover_getFrequency(self)

    def setFrequency(self, frequency: int) -> None:
        """Set every how many time steps there are moves; 0 for never."""
        _forces._Mover_setFrequency(self, whole(self, "frequency", frequency))

    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
        return _forces._Mover_getRandomNumberSeed(self)

    def setRandomNumberSeed(self, seed: int) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on.

        The same seed gives the same moves, on any number of threads. With 0, the default, each
        Context gets a seed of its own.
        """
        _forces._Mover_setRandomNumberSeed(self, whole(self, "randomNumberSeed", seed))


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
        """Whether a force of OpenMM is of this class."""
        return _forces.MonteCarloMembraneTension_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloMembraneTension:
        """The same force as an object of this class."""
        return own(_forces.MonteCarloMembraneTension_cast(force), force)


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
        """Whether a force of OpenMM is of this class."""
        return _forces.SurfaceViscosityThermostat_isinstance(force)

    @staticmethod
    def cast(force: openmm.Force) -> SurfaceViscosityThermostat:
        """The same force as an object of this class."""
        return own(_forces.SurfaceViscosityThermostat_cast(force), force)


@proxy
class VariableMassIntegrator(Masses, openmm.Integrator):
    """What VariableMassVerletIntegrator and VariableMassLangevinIntegrator have in common: the
    masses of vertices follow the areas of their plaquettes.
    """

    def getDensity(self) -> float:
        """Get the mass per area of surfaces, amu/nm^2, or 0 if each surface keeps its mass."""
        return _forces.VariableMassIntegrator_getDensity(self)

    def setDensity(self, density: Scalar) -> None:
        """Set the mass per area of surfaces, amu/nm^2, for Contexts that are made from now on: a
        vertex has the mass density times its area.

        With 0 each connected surface keeps the mass M that its vertices have in the System
        together, and a vertex has M times its share of the area.
        """
        _forces.VariableMassIntegrator_setDensity(self, number(self, "density", density))

    def step(self, steps: int) -> None:
        """Advance a simulation through time by taking a series of time steps.

        Parameters
        ----------
        steps : int
            The number of time steps to take.
        """
        _forces.VariableMassIntegrator_step(self, steps)

    def getTypeName(self) -> str:
        """Get the name of the class, as messages and XML have it."""
        return _forces.VariableMassIntegrator_getTypeName(self)


@proxy
class VariableMassLangevinIntegrator(VariableMassIntegrator):
    """VariableMassVerletIntegrator in a bath: before and after the leapfrog, momenta take half a
    step of

        dp_i = -gamma p_i dt + sqrt(2 gamma m_i(q) kB T) dW

    at constant positions, which is solved exactly. For small steps positions and momenta have the
    weight exp(-H(p, q) / kB T).

    The random numbers are functions of the seed and the number of the step: the same seed gives the
    same bits on any number of threads. Checkpoints have where they are.
    """

    def __init__(
        self, temperature: Scalar, frictionCoeff: Scalar, stepSize: Scalar, density: Scalar = 0.0
    ) -> None:
        """Make the integrator.

        Parameters
        ----------
        temperature : float or Quantity
            The temperature of the bath, K.
        frictionCoeff : float or Quantity
            Gamma, what couples the momenta to the bath, 1/ps.
        stepSize : float or Quantity
            The step size, ps.
        density : float or Quantity, default: 0.0
            The mass per area, amu/nm^2, or 0 for surfaces of constant mass.
        """
        make(
            self,
            number(self, "temperature", temperature),
            number(self, "frictionCoeff", frictionCoeff),
            number(self, "stepSize", stepSize),
            number(self, "density", density),
        )

    def getTemperature(self) -> float:
        """Get the temperature of the bath, K."""
        return _forces.VariableMassLangevinIntegrator_getTemperature(self)

    def setTemperature(self, temperature: Scalar) -> None:
        """Set the temperature of the bath, K."""
        _forces.VariableMassLangevinIntegrator_setTemperature(
            self, number(self, "temperature", temperature)
        )

    def getFriction(self) -> float:
        """Get what couples the momenta to the bath, 1/ps."""
        return _forces.VariableMassLangevinIntegrator_getFriction(self)

    def setFriction(self, friction: Scalar) -> None:
        """Set what couples the momenta to the bath, 1/ps."""
        _forces.VariableMassLangevinIntegrator_setFriction(self, number(self, "friction", friction))

    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
        return _forces.VariableMassLangevinIntegrator_getRandomNumberSeed(self)

    def setRandomNumberSeed(self, seed: int) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on.

        With 0, the default, each Context gets a seed of its own.
        """
        _forces.VariableMassLangevinIntegrator_setRandomNumberSeed(
            self, whole(self, "randomNumberSeed", seed)
        )

    @staticmethod
    def isinstance(integrator: openmm.Integrator) -> bool:
        """Whether an integrator of OpenMM is of this class."""
        return _forces.VariableMassLangevinIntegrator_isinstance(integrator)

    @staticmethod
    def cast(integrator: openmm.Integrator) -> VariableMassLangevinIntegrator:
        """The same integrator as an object of this class."""
        return own(_forces.VariableMassLangevinIntegrator_cast(integrator), integrator)


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
        """Whether an integrator of OpenMM is of this class."""
        return _forces.VariableMassVerletIntegrator_isinstance(integrator)

    @staticmethod
    def cast(integrator: openmm.Integrator) -> VariableMassVerletIntegrator:
        """The same integrator as an object of this class."""
        return own(_forces.VariableMassVerletIntegrator_cast(integrator), integrator)


def why_not_helfrich(system: openmm.System, integrator: openmm.Integrator) -> str:
    """Why a System is not one for the platform Helfrich, or an empty text."""
    return _forces._why_not_helfrich(system, integrator)
