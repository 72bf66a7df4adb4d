# .ci/stubs.py writes this file, from the classes of forces.py.

from typing import Any, ClassVar, TypeAlias

import numpy as np
import openmm
from numpy.typing import ArrayLike, NDArray

from ._types import Quantity
from .mesh import Mesh

_Scalar: TypeAlias = float | Quantity
_Values: TypeAlias = ArrayLike | Quantity
_Triangles: TypeAlias = Mesh | ArrayLike

__all__ = [
    "MembraneForce",
    "MonteCarloBondFlip",
    "MonteCarloDomainSwap",
    "MonteCarloMembraneTension",
    "SurfaceViscosityThermostat",
    "TriangulatedForce",
    "AreaDifferenceForce",
    "BendingForce",
    "DihedralForce",
    "EdgeTensionForce",
    "EnclosedVolumeForce",
    "GaussianCurvatureForce",
    "LimForce",
    "LineTensionForce",
    "LinearElasticForce",
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
    "TriangleAreaForce",
    "TriangleAreaRepulsionForce",
    "TriangleHeightForce",
    "VariableMassVerletIntegrator",
    "VariableMassLangevinIntegrator",
]

class _HelfrichForce(openmm.Force):
    """An OpenMM Force of this plugin, which knows its class and has its implementation made by the
    library.
    """

    def getTypeName(self) -> str:
        """Get the name of the class, as messages and XML have it."""

class TriangulatedForce(_HelfrichForce):
    """What acts on a triangulated surface of particles."""

    def addTriangle(self, particle1: int, particle2: int, particle3: int) -> int:
        """Add a triangle."""
    def getNumTriangles(self) -> int:
        """Get the number of triangles."""
    def getTriangle(self, index: int) -> list[int]:
        """Get the corners of a triangle."""
    def addTriangles(self, given: _Triangles, *, offset: int = 0) -> None:
        """Add many triangles."""
    def getPermutationInContext(self, context: openmm.Context) -> NDArray[np.int64]:
        """Whose values the vertices of the surface have in a Context now."""
    def setPermutationInContext(self, context: openmm.Context, permutation: ArrayLike) -> None:
        """Let the vertices of a surface have each other's values, in all forces on its triangles.
        """
    def getTrianglesInContext(self, context: openmm.Context) -> NDArray[np.int64]:
        """The triangles as they are in a Context now."""
    def setTrianglesInContext(
        self, context: openmm.Context, given: _Triangles, *, offset: int = 0
    ) -> None:
        """Connect the particles of a Context in another way, for all forces on the same triangles.
        """

class _TriangulatedMover(TriangulatedForce):
    """What makes random moves now and then, at the temperature of a bath: what all such classes
    have in common. Base is a HelfrichForce.
    """

    def getDefaultTemperature(self) -> float:
        """Get the default temperature, K."""
    def setDefaultTemperature(self, temperature: float, /) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
    def getFrequency(self) -> int:
        """Get every how many time steps there are moves."""
    def setFrequency(self, frequency: int, /) -> None:
        """Set every how many time steps there are moves; 0 for never."""
    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. The same seed
        gives the same moves, on any number of threads. With 0, the default, each Context gets a
        seed of its own.
        """

class _Mover(_HelfrichForce):
    """What makes random moves now and then, at the temperature of a bath: what all such classes
    have in common. Base is a HelfrichForce.
    """

    def getDefaultTemperature(self) -> float:
        """Get the default temperature, K."""
    def setDefaultTemperature(self, temperature: float, /) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
    def getFrequency(self) -> int:
        """Get every how many time steps there are moves."""
    def setFrequency(self, frequency: int, /) -> None:
        """Set every how many time steps there are moves; 0 for never."""
    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. The same seed
        gives the same moves, on any number of threads. With 0, the default, each Context gets a
        seed of its own.
        """

class _SurfaceMover(_TriangulatedMover):
    """What tries Monte Carlo moves of the edges of a surface now and then, each by the change of
    the energy of all membrane forces on it: what all such classes have in common.
    """

    Canonical: ClassVar[int]
    Microcanonical: ClassVar[int]
    def getAttemptsPerEdge(self) -> float:
        """Get how many moves are tried each time, for each edge."""
    def setAttemptsPerEdge(self, attemptsPerEdge: float, /) -> None:
        """Set how many moves are tried each time, for each edge, from 0 to 1000."""
    def getEnsemble(self) -> int:
        """Get who pays for moves."""
    def setEnsemble(self, ensemble: int, /) -> None:
        """Set who pays for moves: Canonical, a bath, or Microcanonical, a demon."""
    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy the values of this object to a Context, except for the seed. The temperature is a
        parameter of the Context; changed triangles are refused (use Context::reinitialize()).
        """
    def usesPeriodicBoundaryConditions(self) -> bool:
        """Positions are taken as they are, without periodic boundary conditions."""

class MembraneForce(TriangulatedForce):
    """The common part of all forces on a membrane: a triangulated surface, and named scalars."""

    def getNumParameters(self) -> int:
        """Get the number of scalar parameters."""
    def getParameterName(self, index: int) -> str:
        """Get the name of a scalar parameter, as setContextParameter() takes it."""
    def getParameterValue(self, name: str) -> float:
        """Get the value of a scalar parameter in OpenMM's units (nm, kJ/mol)."""
    def getElementValues(self, name: str) -> tuple[float, ...]:
        """Get the values of a parameter for each vertex, triangle, edge or particle, empty if it is
        a scalar.
        """
    def setContextParameter(self, parameter: str, name: str) -> None:
        """Let a parameter of the Context take the place of a scalar, so that
        Context::setParameter() changes it during a simulation. Its initial value is that of the
        scalar. Several forces may share a parameter of the Context if their initial values agree.
        """
    def getContextParameter(self, parameter: str) -> str:
        """Get the name of the Context parameter that stands in for a scalar, empty if there is
        none.
        """
    def addEnergyParameterDerivative(self, name: str) -> None:
        """Ask for the derivative of the energy with respect to a Context parameter, which
        Context::getState() then returns; on OpenCL, CUDA and HIP not of what the processor
        computes, as contacts. Asking twice changes nothing.
        """
    def getNumEnergyParameterDerivatives(self) -> int:
        """Get the number of Context parameters whose derivatives are asked for."""
    def getEnergyParameterDerivativeName(self, index: int) -> str:
        """Get the name of a Context parameter whose derivative is asked for."""
    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy scalars, values of elements, form and switches of this object to a Context. What is
        a Context parameter stays as it is there (use Context::setParameter()); changed triangles
        are refused (use Context::reinitialize()).
        """
    def setBackend(self, backend: str, /) -> None:
        """Choose what computes the force in Contexts that are made from now on: the processor or a
        GPU. Forces on the same triangles of one Context are computed together, so those of them
        that have a choice of their own must have the same one; the others follow.
        """
    def getBackend(self) -> str:
        """Get what the force has chosen, empty if it follows the process."""
    def setUsesPeriodicBoundaryConditions(self, periodic: bool, /) -> None:
        """Set whether the surface lives in the periodic box of the Context, which may be triclinic.
        Each edge then connects nearest images, so positions may be wrapped into the box or not: the
        result has the same bits. A surface may cross faces of the box, or span it: a sheet, a tube,
        a surface that goes on in three directions. Every edge must be shorter than half of the
        least distance between opposite faces; the evaluation throws an OpenMMException that names
        one which is not.
        """
    def usesPeriodicBoundaryConditions(self) -> bool:
        """Get whether the surface lives in the periodic box of the Context."""
    def getForm(self) -> int:
        """Get which form of the potential is computed, 0 if there are none."""
    def setForm(self, form: int, /) -> None:
        """Choose the form of the potential."""
    def getSwitch(self, name: str) -> bool:
        """Get whether something is switched on."""
    def setSwitch(self, name: str, on: bool) -> None:
        """Switch something on or off. updateParametersInContext() tells existing Contexts."""
    def getSwitches(self) -> int:
        """Get the state of all switches, one bit for each in the core's order."""

class AreaDifferenceForce(MembraneForce):
    """Area-difference elasticity: the two monolayers of a closed membrane cannot exchange lipids,
    and resist changes of the difference in their areas.
    """

    def __init__(
        self, triangles: _Triangles, modulus: _Scalar, target: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getModulus(self) -> float:
        """Get the modulus m, kJ/mol/nm^2."""
    def setModulus(self, modulus: _Scalar, /) -> None:
        """Set the modulus m, kJ/mol/nm^2, zero or above."""
    def getTarget(self) -> float:
        """Get the target M0 of the integral of mean curvature, nm."""
    def setTarget(self, target: _Scalar, /) -> None:
        """Set the target M0 of the integral of mean curvature, nm, of either sign."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> AreaDifferenceForce:
        """The same force as an object of this class."""

class BendingForce(MembraneForce):
    """Bending energy of a fluid membrane (Helfrich), with spontaneous curvature, in five
    discretisations:
    """

    Julicher: ClassVar[int]
    GompperKroll: ClassVar[int]
    GompperKrollBarycentric: ClassVar[int]
    JulicherVoronoi: ClassVar[int]
    Espriu: ClassVar[int]
    def __init__(
        self,
        triangles: _Triangles,
        rigidity: _Scalar | ArrayLike,
        spontaneousCurvature: _Scalar | ArrayLike = 0.0,
        scheme: int | str = 0,
        *,
        offset: int = 0,
    ) -> None: ...
    def getRigidity(self) -> float:
        """Get the bending rigidity kappa, kJ/mol."""
    def setRigidity(self, rigidity: _Scalar, /) -> None:
        """Set the bending rigidity kappa, kJ/mol, zero or above. Values of single vertices are
        given up.
        """
    def getSpontaneousCurvature(self) -> float:
        """Get the spontaneous curvature C0, 1/nm, positive for bulging outward."""
    def setSpontaneousCurvature(self, spontaneousCurvature: _Scalar, /) -> None:
        """Set the spontaneous curvature C0, 1/nm, positive for bulging outward. Values of single
        vertices are given up.
        """
    def getScheme(self) -> int:
        """Get the discretisation."""
    def setScheme(self, scheme: int | str, /) -> None:
        """Set the discretisation. updateParametersInContext() tells existing Contexts."""
    def getUnsignedSpontaneousCurvature(self) -> bool:
        """Get whether the linear term of the spontaneous curvature takes |c|."""
    def setUnsignedSpontaneousCurvature(self, isUnsigned: bool, /) -> None:
        """Choose whether the linear term of the spontaneous curvature takes |c| (VCM) instead of
        n.c.
        """
    def getVertexRigidity(self) -> tuple[float, ...]:
        """Get the bending rigidity of each vertex, kJ/mol; empty if all have the same."""
    def setVertexRigidity(self, values: _Values, /) -> None:
        """Give each vertex its own bending rigidity, which replaces the scalar: domains."""
    def getVertexSpontaneousCurvature(self) -> tuple[float, ...]:
        """Get the spontaneous curvature of each vertex, 1/nm; empty if all have the same."""
    def setVertexSpontaneousCurvature(self, values: _Values, /) -> None:
        """Give each vertex its own spontaneous curvature, which replaces the scalar: domains."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> BendingForce:
        """The same force as an object of this class."""

class DihedralForce(MembraneForce):
    """Stiff hinges between neighbouring triangles:"""

    Quartic: ClassVar[int]
    Cosine: ClassVar[int]
    Exp: ClassVar[int]
    SmoothExp: ClassVar[int]
    SmoothExp46: ClassVar[int]
    def __init__(
        self,
        triangles: _Triangles,
        stiffness: _Scalar | ArrayLike,
        form: int | str = 0,
        restAngle: _Scalar | ArrayLike = 0.0,
        *,
        offset: int = 0,
    ) -> None: ...
    def getStiffness(self) -> float:
        """Get the stiffness K, kJ/mol."""
    def setStiffness(self, stiffness: _Scalar, /) -> None:
        """Set the stiffness K, kJ/mol, zero or above. Values of single edges are given up."""
    def getRestAngle(self) -> float:
        """Get the angle phi0 at rest."""
    def setRestAngle(self, restAngle: _Scalar, /) -> None:
        """Set the angle phi0 at rest, from -pi to pi, positive for convex edges. Values of single
        edges are given up.
        """
    def getEdgeStiffness(self) -> tuple[float, ...]:
        """Get the stiffness of each edge, kJ/mol; empty if all have the same."""
    def setEdgeStiffness(self, values: _Values, /) -> None:
        """Give each edge its own stiffness, which replaces the scalar."""
    def getEdgeRestAngle(self) -> tuple[float, ...]:
        """Get the angle at rest of each edge; empty if all have the same."""
    def setEdgeRestAngle(self, values: _Values, /) -> None:
        """Give each edge its own angle at rest, which replaces the scalar."""
    def getForm(self) -> int:
        """Get the function of the angle."""
    def setForm(self, form: int | str, /) -> None:
        """Set the function of the angle. updateParametersInContext() tells existing Contexts."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> DihedralForce:
        """The same force as an object of this class."""

class EdgeTensionForce(MembraneForce):
    """The line tension of a membrane's borders:"""

    def __init__(self, triangles: _Triangles, tension: _Scalar, *, offset: int = 0) -> None: ...
    def getTension(self) -> float:
        """Get the energy per length, kJ/mol/nm."""
    def setTension(self, tension: _Scalar, /) -> None:
        """Set the energy per length, kJ/mol/nm."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> EdgeTensionForce:
        """The same force as an object of this class."""

class EnclosedVolumeForce(MembraneForce):
    """Keeps the volume V that a membrane encloses near a target V0:"""

    def __init__(
        self, triangles: _Triangles, modulus: _Scalar, target: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getModulus(self) -> float:
        """Get the volume modulus kV, kJ/mol/nm^3."""
    def setModulus(self, modulus: _Scalar, /) -> None:
        """Set the volume modulus kV, kJ/mol/nm^3, zero or above."""
    def getTarget(self) -> float:
        """Get the target volume V0, nm^3."""
    def setTarget(self, target: _Scalar, /) -> None:
        """Set the target volume V0, nm^3, above zero."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> EnclosedVolumeForce:
        """The same force as an object of this class."""

class GaussianCurvatureForce(MembraneForce):
    """The elasticity of Gaussian curvature:"""

    def __init__(
        self, triangles: _Triangles, modulus: _Scalar | ArrayLike, *, offset: int = 0
    ) -> None: ...
    def getModulus(self) -> float:
        """Get the modulus kappa_G, kJ/mol."""
    def setModulus(self, modulus: _Scalar, /) -> None:
        """Set the modulus kappa_G, kJ/mol. Values of single vertices are given up."""
    def getVertexModulus(self) -> tuple[float, ...]:
        """Get the modulus of each vertex, kJ/mol; empty if all have the same."""
    def setVertexModulus(self, values: _Values, /) -> None:
        """Give each vertex its own modulus, which replaces the scalar."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> GaussianCurvatureForce:
        """The same force as an object of this class."""

class LimForce(MembraneForce):
    """Elasticity of the skeleton of a red blood cell, which hardens, against a reference shape:"""

    Lim2002: ClassVar[int]
    Amoudruz2023: ClassVar[int]
    def __init__(
        self,
        triangles: _Triangles,
        shearModulus: _Scalar,
        areaModulus: _Scalar,
        reference: Mesh | _Values,
        coefficients: int | str = 0,
        *,
        offset: int = 0,
    ) -> None: ...
    def getCoefficients(self) -> int:
        """Get the set of coefficients."""
    def setCoefficients(self, coefficients: int | str, /) -> None:
        """Set the set of coefficients. updateParametersInContext() tells existing Contexts."""
    def getShearModulus(self) -> float:
        """Get the modulus mu, kJ/mol/nm^2."""
    def setShearModulus(self, shearModulus: _Scalar, /) -> None:
        """Set the modulus mu, kJ/mol/nm^2, zero or above."""
    def getAreaModulus(self) -> float:
        """Get the modulus K, kJ/mol/nm^2."""
    def setAreaModulus(self, areaModulus: _Scalar, /) -> None:
        """Set the modulus K, kJ/mol/nm^2, zero or above."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> LimForce:
        """The same force as an object of this class."""
    def setReference(self, reference: Mesh | _Values, /) -> None:
        """Set where the vertices are at rest. Tell Contexts by updateParametersInContext()."""
    def getReference(self) -> NDArray[np.float64]:
        """Where the vertices are at rest, shape (num_vertices, 3), nm."""
    def setReferenceBox(self, box: _Values | None, /) -> None:
        """Say in which periodic box the reference is: its sides are nearest images in this box."""
    def getReferenceBox(self) -> NDArray[np.float64] | None:
        """The periodic box in which the reference is, shape (3, 3), nm, or None."""

class LineTensionForce(MembraneForce):
    """The tension of the line between domains of a membrane:"""

    def __init__(
        self, triangles: _Triangles, tension: _Scalar, domains: ArrayLike, *, offset: int = 0
    ) -> None: ...
    def getTension(self) -> float:
        """Get the energy per length, kJ/mol/nm."""
    def setTension(self, tension: _Scalar, /) -> None:
        """Set the energy per length, kJ/mol/nm."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> LineTensionForce:
        """The same force as an object of this class."""
    def setDomains(self, domains: ArrayLike, /) -> None:
        """Say to which domain each vertex belongs. Tell Contexts by updateParametersInContext()."""
    def getDomains(self) -> NDArray[np.int64]:
        """The domain of each vertex in ascending order of particle index, (num_vertices,), int."""
    def getDomainsInContext(self, context: openmm.Context) -> NDArray[np.int64]:
        """The domain of each vertex as it is in a Context now, where neighbours may exchange them.
        """

class LinearElasticForce(MembraneForce):
    """The simplest elasticity against a reference shape, quadratic in Green's strain e of each
    triangle:
    """

    def __init__(
        self,
        triangles: _Triangles,
        shearModulus: _Scalar,
        areaModulus: _Scalar,
        reference: Mesh | _Values,
        *,
        offset: int = 0,
    ) -> None: ...
    def getShearModulus(self) -> float:
        """Get the shear modulus mu, kJ/mol/nm^2."""
    def setShearModulus(self, shearModulus: _Scalar, /) -> None:
        """Set the shear modulus mu, kJ/mol/nm^2, zero or above."""
    def getAreaModulus(self) -> float:
        """Get the area modulus K, kJ/mol/nm^2."""
    def setAreaModulus(self, areaModulus: _Scalar, /) -> None:
        """Set the area modulus K, kJ/mol/nm^2, zero or above."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> LinearElasticForce:
        """The same force as an object of this class."""
    def setReference(self, reference: Mesh | _Values, /) -> None:
        """Set where the vertices are at rest. Tell Contexts by updateParametersInContext()."""
    def getReference(self) -> NDArray[np.float64]:
        """Where the vertices are at rest, shape (num_vertices, 3), nm."""
    def setReferenceBox(self, box: _Values | None, /) -> None:
        """Say in which periodic box the reference is: its sides are nearest images in this box."""
    def getReferenceBox(self) -> NDArray[np.float64] | None:
        """The periodic box in which the reference is, shape (3, 3), nm, or None."""

class NeoHookeanForce(MembraneForce):
    """Elasticity of a rubber-like membrane against a reference shape:"""

    def __init__(
        self,
        triangles: _Triangles,
        shearModulus: _Scalar,
        areaModulus: _Scalar,
        reference: Mesh | _Values,
        *,
        offset: int = 0,
    ) -> None: ...
    def getShearModulus(self) -> float:
        """Get the shear modulus mu, kJ/mol/nm^2."""
    def setShearModulus(self, shearModulus: _Scalar, /) -> None:
        """Set the shear modulus mu, kJ/mol/nm^2, zero or above."""
    def getAreaModulus(self) -> float:
        """Get the area modulus K, kJ/mol/nm^2."""
    def setAreaModulus(self, areaModulus: _Scalar, /) -> None:
        """Set the area modulus K, kJ/mol/nm^2, zero or above."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> NeoHookeanForce:
        """The same force as an object of this class."""
    def setReference(self, reference: Mesh | _Values, /) -> None:
        """Set where the vertices are at rest. Tell Contexts by updateParametersInContext()."""
    def getReference(self) -> NDArray[np.float64]:
        """Where the vertices are at rest, shape (num_vertices, 3), nm."""
    def setReferenceBox(self, box: _Values | None, /) -> None:
        """Say in which periodic box the reference is: its sides are nearest images in this box."""
    def getReferenceBox(self) -> NDArray[np.float64] | None:
        """The periodic box in which the reference is, shape (3, 3), nm, or None."""

class OsmoticPressureForce(MembraneForce):
    """The osmotic pressure of solutes that cannot pass a membrane, which water can:"""

    def __init__(
        self,
        triangles: _Triangles,
        solutes: _Scalar,
        concentration: _Scalar,
        thermalEnergy: _Scalar,
        *,
        offset: int = 0,
    ) -> None: ...
    def getSolutes(self) -> float:
        """Get the number n of solutes inside."""
    def setSolutes(self, solutes: _Scalar, /) -> None:
        """Set the number n of solutes inside, above zero."""
    def getConcentration(self) -> float:
        """Get the concentration c of solutes outside, 1/nm^3."""
    def setConcentration(self, concentration: _Scalar, /) -> None:
        """Set the concentration c of solutes outside, 1/nm^3, above zero."""
    def getThermalEnergy(self) -> float:
        """Get the thermal energy kT, kJ/mol."""
    def setThermalEnergy(self, thermalEnergy: _Scalar, /) -> None:
        """Set the thermal energy kT, kJ/mol, above zero."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> OsmoticPressureForce:
        """The same force as an object of this class."""

class ParticleSurfaceForce(MembraneForce):
    """A surface that other particles cannot pass, and may adhere to. With the gap g = d - R between
    a particle of radius R and a triangle, whose nearest point is at the distance d from the
    particle's middle,
    """

    WCA: ClassVar[int]
    LennardJones: ClassVar[int]
    NineThree: ClassVar[int]
    def __init__(
        self,
        triangles: _Triangles,
        particles: ArrayLike,
        distance: _Scalar,
        epsilon: _Scalar,
        adhesion: _Scalar = 0.0,
        radius: _Scalar | ArrayLike = 0.0,
        attraction: int | str = 0,
        *,
        offset: int = 0,
    ) -> None: ...
    def getDistance(self) -> float:
        """Get the gap D below which there is a repulsion, nm."""
    def setDistance(self, distance: _Scalar, /) -> None:
        """Set the gap D below which there is a repulsion, nm, above zero."""
    def getEpsilon(self) -> float:
        """Get the strength of the repulsion, kJ/mol."""
    def setEpsilon(self, epsilon: _Scalar, /) -> None:
        """Set the strength of the repulsion, kJ/mol, zero or above."""
    def getAdhesion(self) -> float:
        """Get the energy by area w of what touches, kJ/mol/nm^2."""
    def setAdhesion(self, adhesion: _Scalar, /) -> None:
        """Set the energy by area w of what touches, kJ/mol/nm^2, zero or above."""
    def getRadius(self) -> float:
        """Get the radius R of all particles, nm."""
    def setRadius(self, radius: _Scalar, /) -> None:
        """Set the radius R of all particles, nm, zero or above. Values of single particles are
        given up.
        """
    def getParticleRadius(self) -> tuple[float, ...]:
        """Get the radius of each particle, nm; empty if all have the same."""
    def setParticleRadius(self, values: _Values, /) -> None:
        """Give each particle its own radius, which replaces the scalar."""
    def getAttraction(self) -> int:
        """Get what attracts particles."""
    def setAttraction(self, attraction: int | str, /) -> None:
        """Set what attracts particles. updateParametersInContext() tells existing Contexts."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> ParticleSurfaceForce:
        """The same force as an object of this class."""
    def setParticles(self, given: ArrayLike, /) -> None:
        """Set the particles that the surface acts on."""
    def getParticles(self) -> NDArray[np.int64]:
        """The indices of the particles that the surface acts on, shape (num_particles,)."""

class PlaquetteAreaForce(MembraneForce):
    """Keeps the plaquettes of all N vertices alike:"""

    def __init__(
        self, triangles: _Triangles, stiffness: _Scalar, target: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getStiffness(self) -> float:
        """Get the stiffness k, (3/2) kB T in the paper, kJ/mol."""
    def setStiffness(self, stiffness: _Scalar, /) -> None:
        """Set the stiffness k, (3/2) kB T in the paper, kJ/mol, zero or above."""
    def getTarget(self) -> float:
        """Get the target A0 of the total area, nm^2."""
    def setTarget(self, target: _Scalar, /) -> None:
        """Set the target A0 of the total area, nm^2, above zero."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> PlaquetteAreaForce:
        """The same force as an object of this class."""

class PressureForce(MembraneForce):
    """A pressure difference across a membrane that encloses the volume V:"""

    def __init__(self, triangles: _Triangles, pressure: _Scalar, *, offset: int = 0) -> None: ...
    def getPressure(self) -> float:
        """Get the pressure difference p, inside less outside, kJ/mol/nm^3."""
    def setPressure(self, pressure: _Scalar, /) -> None:
        """Set the pressure difference p, inside less outside, kJ/mol/nm^3 (1.66 MPa, 16.6 bar)."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> PressureForce:
        """The same force as an object of this class."""

class SkalakForce(MembraneForce):
    """Elasticity of a membrane with a skeleton, such as that of a red blood cell, against a
    reference shape:
    """

    def __init__(
        self,
        triangles: _Triangles,
        shearModulus: _Scalar,
        areaModulus: _Scalar,
        reference: Mesh | _Values,
        *,
        offset: int = 0,
    ) -> None: ...
    def getShearModulus(self) -> float:
        """Get the modulus mu, kJ/mol/nm^2."""
    def setShearModulus(self, shearModulus: _Scalar, /) -> None:
        """Set the modulus mu, kJ/mol/nm^2, zero or above."""
    def getAreaModulus(self) -> float:
        """Get the modulus K, kJ/mol/nm^2."""
    def setAreaModulus(self, areaModulus: _Scalar, /) -> None:
        """Set the modulus K, kJ/mol/nm^2, zero or above."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> SkalakForce:
        """The same force as an object of this class."""
    def setReference(self, reference: Mesh | _Values, /) -> None:
        """Set where the vertices are at rest. Tell Contexts by updateParametersInContext()."""
    def getReference(self) -> NDArray[np.float64]:
        """Where the vertices are at rest, shape (num_vertices, 3), nm."""
    def setReferenceBox(self, box: _Values | None, /) -> None:
        """Say in which periodic box the reference is: its sides are nearest images in this box."""
    def getReferenceBox(self) -> NDArray[np.float64] | None:
        """The periodic box in which the reference is, shape (3, 3), nm, or None."""

class SpringForce(MembraneForce):
    """Springs along the edges, a network such as the spectrin skeleton of a red blood cell:"""

    Harmonic: ClassVar[int]
    WLCPower: ClassVar[int]
    def __init__(
        self,
        triangles: _Triangles,
        stiffness: _Scalar,
        reference: Mesh | _Values,
        ratio: _Scalar = 0.45454545454545453,
        form: int | str = 0,
        *,
        offset: int = 0,
    ) -> None: ...
    def getStiffness(self) -> float:
        """Get the stiffness k of all springs at rest, kJ/mol/nm^2."""
    def setStiffness(self, stiffness: _Scalar, /) -> None:
        """Set the stiffness k of all springs at rest, kJ/mol/nm^2, zero or above."""
    def getRatio(self) -> float:
        """Get the length at rest as a share of the longest, l0/lmax."""
    def setRatio(self, ratio: _Scalar, /) -> None:
        """Set the length at rest as a share of the longest, l0/lmax, above zero and below one."""
    def getForm(self) -> int:
        """Get the function of the length."""
    def setForm(self, form: int | str, /) -> None:
        """Set the function of the length. updateParametersInContext() tells existing Contexts."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> SpringForce:
        """The same force as an object of this class."""
    def setReference(self, reference: Mesh | _Values, /) -> None:
        """Set where the vertices are at rest. Tell Contexts by updateParametersInContext()."""
    def getReference(self) -> NDArray[np.float64]:
        """Where the vertices are at rest, shape (num_vertices, 3), nm."""
    def setReferenceBox(self, box: _Values | None, /) -> None:
        """Say in which periodic box the reference is: its sides are nearest images in this box."""
    def getReferenceBox(self) -> NDArray[np.float64] | None:
        """The periodic box in which the reference is, shape (3, 3), nm, or None."""

class SurfaceAreaForce(MembraneForce):
    """Keeps the total area A of a membrane near a target A0:"""

    def __init__(
        self, triangles: _Triangles, modulus: _Scalar, target: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getModulus(self) -> float:
        """Get the area modulus kA, kJ/mol/nm^2."""
    def setModulus(self, modulus: _Scalar, /) -> None:
        """Set the area modulus kA, kJ/mol/nm^2, zero or above."""
    def getTarget(self) -> float:
        """Get the target area A0, nm^2."""
    def setTarget(self, target: _Scalar, /) -> None:
        """Set the target area A0, nm^2, above zero."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> SurfaceAreaForce:
        """The same force as an object of this class."""

class SurfaceRepulsionForce(MembraneForce):
    """Keeps surfaces from passing through themselves and each other, by a repulsion of vertices and
    triangles and of edges:
    """

    def __init__(
        self, triangles: _Triangles, distance: _Scalar, epsilon: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getDistance(self) -> float:
        """Get the distance D below which there is a repulsion, nm."""
    def setDistance(self, distance: _Scalar, /) -> None:
        """Set the distance D below which there is a repulsion, nm, above zero."""
    def getEpsilon(self) -> float:
        """Get the strength, kJ/mol."""
    def setEpsilon(self, epsilon: _Scalar, /) -> None:
        """Set the strength, kJ/mol, zero or above."""
    def getOnlyBetweenParts(self) -> bool:
        """Get whether only different connected parts of the triangles repel each other."""
    def setOnlyBetweenParts(self, only: bool, /) -> None:
        """Choose whether only different connected parts of the triangles repel each other."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> SurfaceRepulsionForce:
        """The same force as an object of this class."""

class SurfaceTensionForce(MembraneForce):
    """A surface tension on the total area A of a membrane:"""

    def __init__(self, triangles: _Triangles, tension: _Scalar, *, offset: int = 0) -> None: ...
    def getTension(self) -> float:
        """Get the tension sigma, kJ/mol/nm^2."""
    def setTension(self, tension: _Scalar, /) -> None:
        """Set the tension sigma, kJ/mol/nm^2 (1.66 mN/m), of either sign."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> SurfaceTensionForce:
        """The same force as an object of this class."""

class TriangleAreaForce(MembraneForce):
    """Keeps the area a of each triangle near a target a0:"""

    def __init__(
        self,
        triangles: _Triangles,
        modulus: _Scalar,
        target: _Scalar | ArrayLike,
        *,
        offset: int = 0,
    ) -> None: ...
    def getModulus(self) -> float:
        """Get the area modulus kA, kJ/mol/nm^2."""
    def setModulus(self, modulus: _Scalar, /) -> None:
        """Set the area modulus kA, kJ/mol/nm^2, zero or above."""
    def getTarget(self) -> float:
        """Get the target area a0 of each triangle, nm^2."""
    def setTarget(self, target: _Scalar, /) -> None:
        """Set the target area a0 of each triangle, nm^2, above zero. Values of single triangles are
        given up.
        """
    def getTriangleTargets(self) -> tuple[float, ...]:
        """Get the target area of each triangle, nm^2; empty if all have the same."""
    def setTriangleTargets(self, values: _Values, /) -> None:
        """Give each triangle its own target area, which replaces the scalar."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> TriangleAreaForce:
        """The same force as an object of this class."""

class TriangleAreaRepulsionForce(MembraneForce):
    """Keeps triangles from vanishing by a repulsion at small areas:"""

    def __init__(
        self, triangles: _Triangles, minArea: _Scalar, epsilon: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getMinArea(self) -> float:
        """Get the area a_m below which the repulsion is strong, nm^2."""
    def setMinArea(self, minArea: _Scalar, /) -> None:
        """Set the area a_m below which the repulsion is strong, nm^2, zero or above."""
    def getEpsilon(self) -> float:
        """Get the strength, kJ/mol."""
    def setEpsilon(self, epsilon: _Scalar, /) -> None:
        """Set the strength, kJ/mol, zero or above."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> TriangleAreaRepulsionForce:
        """The same force as an object of this class."""

class TriangleHeightForce(MembraneForce):
    """Keeps triangles from degenerating by a repulsion at small heights:"""

    def __init__(
        self, triangles: _Triangles, minHeight: _Scalar, epsilon: _Scalar, *, offset: int = 0
    ) -> None: ...
    def getMinHeight(self) -> float:
        """Get the height d, nm."""
    def setMinHeight(self, minHeight: _Scalar, /) -> None:
        """Set the height d, nm, zero or above."""
    def getEpsilon(self) -> float:
        """Get the strength epsilon, kJ/mol."""
    def setEpsilon(self, epsilon: _Scalar, /) -> None:
        """Set the strength epsilon, kJ/mol, zero or above."""
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> TriangleHeightForce:
        """The same force as an object of this class."""

class MonteCarloBondFlip(_SurfaceMover):
    """Makes a membrane fluid: now and then it tries to flip edges of the mesh, so that neighbours
    change during a simulation.
    """

    def __init__(
        self,
        triangles: _Triangles,
        temperature: _Scalar,
        frequency: int = 10,
        attemptsPerEdge: _Scalar = 0.1,
        minDegree: int = 3,
        maxDegree: int = 10,
        maxEdgeLength: _Scalar = 0.0,
        *,
        offset: int = 0,
    ) -> None: ...
    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature of the flips, K."""
    def getMinDegree(self) -> int:
        """Get the fewest neighbours of a vertex."""
    def setMinDegree(self, minDegree: int, /) -> None:
        """Set the fewest neighbours of a vertex, 3 or more."""
    def getMaxDegree(self) -> int:
        """Get the most neighbours of a vertex."""
    def setMaxDegree(self, maxDegree: int, /) -> None:
        """Set the most neighbours of a vertex, 3 or more."""
    def getMaxEdgeLength(self) -> float:
        """Get the longest that a new edge may be, nm; 0 for any length, or 0.8 of half of the width
        of a periodic box.
        """
    def setMaxEdgeLength(self, maxEdgeLength: _Scalar, /) -> None:
        """Set the longest that a new edge may be, nm; 0 for any length, or 0.8 of half of the width
        of a periodic box.
        """
    def getConnectivityParameter(self) -> str:
        """Get the name of the Context parameter that holds the fingerprint of the triangles:
        BondFlipConnectivity with the smallest index of a particle among them. It is not to be set.
        """
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloBondFlip:
        """The same force as an object of this class."""
    def setDefaultTemperature(self, temperature: _Scalar, /) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
    def setAttemptsPerEdge(self, attemptsPerEdge: _Scalar, /) -> None:
        """Set how many moves are tried each time, for each edge, from 0 to 1000."""
    def setFrequency(self, frequency: int, /) -> None:
        """Set every how many time steps there are moves; 0 for never."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. The same seed
        gives the same moves, on any number of threads. With 0, the default, each Context gets a
        seed of its own.
        """
    def setEnsemble(self, ensemble: int | str, /) -> None:
        """Set who pays for moves: Canonical, a bath, or Microcanonical, a demon."""
    def getStatistics(self, context: openmm.Context) -> dict[str, Any]:
        """What has come of the flips that were tried in a Context since it was made."""

class MonteCarloDomainSwap(_SurfaceMover):
    """Makes the components of a membrane diffuse: now and then it lets neighbouring vertices
    exchange what they are, so that domains form, coarsen and bud during a simulation. The
    composition never changes.
    """

    def __init__(
        self,
        triangles: _Triangles,
        temperature: _Scalar,
        frequency: int = 10,
        attemptsPerEdge: _Scalar = 0.1,
        *,
        offset: int = 0,
    ) -> None: ...
    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature of the exchanges, K."""
    def getPermutationParameter(self) -> str:
        """Get the name of the Context parameter that holds the fingerprint of the permutation:
        DomainSwapPermutation with the smallest index of a particle among the triangles. It is not
        to be set.
        """
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloDomainSwap:
        """The same force as an object of this class."""
    def setDefaultTemperature(self, temperature: _Scalar, /) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
    def setAttemptsPerEdge(self, attemptsPerEdge: _Scalar, /) -> None:
        """Set how many moves are tried each time, for each edge, from 0 to 1000."""
    def setFrequency(self, frequency: int, /) -> None:
        """Set every how many time steps there are moves; 0 for never."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. The same seed
        gives the same moves, on any number of threads. With 0, the default, each Context gets a
        seed of its own.
        """
    def setEnsemble(self, ensemble: int | str, /) -> None:
        """Set who pays for moves: Canonical, a bath, or Microcanonical, a demon."""
    def getStatistics(self, context: openmm.Context) -> dict[str, Any]:
        """What has come of the exchanges that were tried in a Context since it was made."""

class MonteCarloMembraneTension(_Mover):
    """Keeps a membrane that spans the periodic box at constant tension: now and then it tries to
    change the box, and all positions with it, so that the frame of the membrane breathes during a
    simulation. Without it the frame's area is constant.
    """

    XYIsotropic: ClassVar[int]
    XYIndependent: ClassVar[int]
    XYConstantArea: ClassVar[int]
    ZOnly: ClassVar[int]
    def __init__(
        self,
        temperature: _Scalar,
        tension: _Scalar = 0.0,
        frequency: int = 25,
        axes: int | str = 0,
        pullingForce: _Scalar = 0.0,
    ) -> None: ...
    @staticmethod
    def Tension() -> str:
        """The name of the Context parameter that holds the tension, kJ/mol/nm^2; with
        XYConstantArea and ZOnly, which do not use it, there is none.
        """
    @staticmethod
    def PullingForce() -> str:
        """The name of the Context parameter that holds the pulling force along z, kJ/mol/nm."""
    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature of the moves, K."""
    def getDefaultTension(self) -> float:
        """Get the default tension, kJ/mol/nm^2."""
    def setDefaultTension(self, tension: _Scalar, /) -> None:
        """Set the default tension, kJ/mol/nm^2, of Contexts that are made from now on; in others it
        is the parameter Tension().
        """
    def getDefaultPullingForce(self) -> float:
        """Get the default pulling force along z, kJ/mol/nm."""
    def setDefaultPullingForce(self, pullingForce: _Scalar, /) -> None:
        """Set the default pulling force along z, kJ/mol/nm, of Contexts that are made from now on;
        in others it is the parameter PullingForce().
        """
    def getAxes(self) -> int:
        """Get which edges of the box change."""
    def setAxes(self, axes: int | str, /) -> None:
        """Set which edges of the box change, in Contexts that are made from now on."""
    def getScaleMoleculesAsRigid(self) -> bool:
        """Get whether molecules other than membranes with periodic boundary conditions are moved by
        their centres.
        """
    def setScaleMoleculesAsRigid(self, rigid: bool, /) -> None:
        """Set whether molecules other than membranes with periodic boundary conditions are moved by
        their centres, or every particle is scaled by itself, in Contexts that are made from now on.
        """
    def getAdaptiveMoves(self) -> int:
        """Get how many moves adapt their width, since a Context was made."""
    def setAdaptiveMoves(self, moves: int, /) -> None:
        """Set how many moves adapt their width, since a Context was made. What is sampled before is
        not to be used.
        """
    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy frequency and adaptiveMoves of this object to a Context. Temperature, tension and
        pulling force are parameters of the Context; all else needs Context::reinitialize().
        """
    def usesPeriodicBoundaryConditions(self) -> bool:
        """Like OpenMM's barostats, this class has neither energy nor forces, and does not make a
        System periodic.
        """
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> MonteCarloMembraneTension:
        """The same force as an object of this class."""
    def setDefaultTemperature(self, temperature: _Scalar, /) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
    def setFrequency(self, frequency: int, /) -> None:
        """Set every how many time steps there are moves; 0 for never."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. The same seed
        gives the same moves, on any number of threads. With 0, the default, each Context gets a
        seed of its own.
        """
    def getStatistics(self, context: openmm.Context) -> dict[str, Any]:
        """What has come of the moves that were tried in a Context since it was made."""

class SurfaceViscosityThermostat(_TriangulatedMover):
    """Makes a membrane viscous: friction along the edges of the mesh against relative motion of
    their ends, with the noise that belongs to it.
    """

    def __init__(
        self,
        triangles: _Triangles,
        friction: _Scalar,
        temperature: _Scalar,
        frequency: int = 1,
        *,
        offset: int = 0,
    ) -> None: ...
    @staticmethod
    def Friction() -> str:
        """The name of the Context parameter that holds the friction, amu/ps, unless
        setFrictionParameter() names another.
        """
    @staticmethod
    def Temperature() -> str:
        """The name of the Context parameter that holds the temperature, K, for all objects of this
        class.
        """
    def getDefaultFriction(self) -> float:
        """Get the default friction of each edge, amu/ps."""
    def setDefaultFriction(self, friction: _Scalar, /) -> None:
        """Set the default friction of each edge, amu/ps, 0 or more, of Contexts that are made from
        now on; in others it is the parameter getFrictionParameter().
        """
    def getFrictionParameter(self) -> str:
        """Get the name of the Context parameter that holds the friction."""
    def setFrictionParameter(self, name: str, /) -> None:
        """Set the name of the Context parameter that holds the friction, in Contexts that are made
        from now on. Objects of different frictions in one System need different names.
        """
    def updateParametersInContext(self, context: openmm.Context) -> None:
        """Copy the frequency of this object to a Context. Friction and temperature are parameters
        of the Context; changed triangles are refused (use Context::reinitialize()).
        """
    def usesPeriodicBoundaryConditions(self) -> bool:
        """Like MonteCarloBondFlip, this class follows the forces on the same triangles, and does
        not make a System periodic.
        """
    @staticmethod
    def isinstance(force: openmm.Force) -> bool:
        """Whether a force of OpenMM is of this class."""
    @staticmethod
    def cast(force: openmm.Force) -> SurfaceViscosityThermostat:
        """The same force as an object of this class."""
    def setDefaultTemperature(self, temperature: _Scalar, /) -> None:
        """Set the default temperature, K, above zero, of Contexts that are made from now on; in
        others it is the parameter Temperature().
        """
    def setFrequency(self, frequency: int, /) -> None:
        """Set every how many time steps there are moves; 0 for never."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. The same seed
        gives the same moves, on any number of threads. With 0, the default, each Context gets a
        seed of its own.
        """

class VariableMassIntegrator(openmm.Integrator):
    """What VariableMassVerletIntegrator and VariableMassLangevinIntegrator have in common: the
    masses of vertices follow the areas of their plaquettes.
    """

    def getDensity(self) -> float:
        """Get the mass per area of surfaces, amu/nm^2, or 0 if each surface keeps its mass."""
    def setDensity(self, density: float, /) -> None:
        """Set the mass per area of surfaces, amu/nm^2, for Contexts that are made from now on: a
        vertex has the mass density times its area. With 0 each connected surface keeps the mass M
        that its vertices have in the System together, and a vertex has M times its share of the
        area.
        """
    def step(self, steps: int) -> None:
        """Advance a simulation through time by taking a series of time steps."""
    def getTypeName(self) -> str:
        """Get the name of the class, as messages and XML have it."""

class VariableMassVerletIntegrator(VariableMassIntegrator):
    """Hamiltonian dynamics of membranes whose vertices carry the mass of their plaquettes: O.
    Farnudi, M. R. Ejtehadi and R. Everaers, Phys. Rev. E 108, 015301 (2023), Sec. II.B,
    doi:10.1103/PhysRevE.108.015301.
    """

    def __init__(self, stepSize: _Scalar, density: _Scalar = 0.0) -> None: ...
    @staticmethod
    def isinstance(integrator: openmm.Integrator) -> bool:
        """Whether a integrator of OpenMM is of this class."""
    @staticmethod
    def cast(integrator: openmm.Integrator) -> VariableMassVerletIntegrator:
        """The same integrator as an object of this class."""
    def setDensity(self, density: _Scalar, /) -> None:
        """Set the mass per area of surfaces, amu/nm^2, for Contexts that are made from now on: a
        vertex has the mass density times its area. With 0 each connected surface keeps the mass M
        that its vertices have in the System together, and a vertex has M times its share of the
        area.
        """
    def getMasses(self) -> NDArray[np.float64]:
        """The masses of all particles at the present positions of the Context."""

class VariableMassLangevinIntegrator(VariableMassIntegrator):
    """VariableMassVerletIntegrator in a bath: before and after the leapfrog, momenta take half a
    step of
    """

    def __init__(
        self,
        temperature: _Scalar,
        frictionCoeff: _Scalar,
        stepSize: _Scalar,
        density: _Scalar = 0.0,
    ) -> None: ...
    def getTemperature(self) -> float:
        """Get the temperature of the bath, K."""
    def setTemperature(self, temperature: _Scalar, /) -> None:
        """Set the temperature of the bath, K."""
    def getFriction(self) -> float:
        """Get what couples the momenta to the bath, 1/ps."""
    def setFriction(self, friction: _Scalar, /) -> None:
        """Set what couples the momenta to the bath, 1/ps."""
    def getRandomNumberSeed(self) -> int:
        """Get the seed of the random numbers."""
    def setRandomNumberSeed(self, seed: int, /) -> None:
        """Set the seed of the random numbers, for Contexts that are made from now on. With 0, the
        default, each Context gets a seed of its own.
        """
    @staticmethod
    def isinstance(integrator: openmm.Integrator) -> bool:
        """Whether a integrator of OpenMM is of this class."""
    @staticmethod
    def cast(integrator: openmm.Integrator) -> VariableMassLangevinIntegrator:
        """The same integrator as an object of this class."""
    def setDensity(self, density: _Scalar, /) -> None:
        """Set the mass per area of surfaces, amu/nm^2, for Contexts that are made from now on: a
        vertex has the mass density times its area. With 0 each connected surface keeps the mass M
        that its vertices have in the System together, and a vertex has M times its share of the
        area.
        """
    def getMasses(self) -> NDArray[np.float64]:
        """The masses of all particles at the present positions of the Context."""

def _why_not_helfrich(system: openmm.System, integrator: openmm.Integrator) -> str: ...
