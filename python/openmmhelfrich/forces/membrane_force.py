"""MembraneForce; .ci/forces.py writes this file, from the header of C++."""

from __future__ import annotations

from typing import TYPE_CHECKING

import openmm

from .. import _forces
from .._proxies import proxy
from .triangulated_force import TriangulatedForce

if TYPE_CHECKING:
    pass


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
