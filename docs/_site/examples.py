"""An example for each class: what its page shows, with what it prints when the site is built.

A force without lines here has an example of its arguments.
"""

from __future__ import annotations

import contextlib
import inspect
import io

import openmmhelfrich as helfrich
from openmmhelfrich import _values

_SPHERE = "mesh = helfrich.Mesh.random_sphere(252, radius=100, seed=1)  # nm\n"
_STRETCHED = (
    "at_rest = helfrich.Mesh.random_sphere(252, radius=100, seed=1)  # nm\n"
    "mesh = at_rest.scaled((1.1, 0.95, 1))\n"
)
_ENERGY = 'print(f"{mesh.energy(force):.3f} kJ/mol")\n'


def _on(mesh: str, force: str) -> str:
    return f"{mesh}force = helfrich.{force}\n{_ENERGY}"


def _usual(name: str) -> str:
    """For a class that has no lines below: all that it asks for, with lengths of 20 nm."""
    others = {
        "reference": "reference=at_rest",
        "domains": "domains=(mesh.vertices[:, 2] > 0).astype(int)",
    }
    scalars = {scalar.name: scalar for scalar in _values.scalars_of(name)}
    arguments = ["mesh"]
    for parameter in inspect.signature(getattr(helfrich, name)).parameters.values():
        if parameter.name in scalars and parameter.default is parameter.empty:
            powers = {d.name: p for d, p in scalars[parameter.name].unit.iter_base_dimensions()}
            value = 1 if "mass" in powers else 20 ** int(powers.get("length", 0))
            arguments.append(f"{parameter.name}={value}")
        elif parameter.name in others:
            arguments.append(others[parameter.name])
    mesh = _STRETCHED if others["reference"] in arguments else _SPHERE
    return _on(mesh, f"{name}({', '.join(arguments)})")


#: The lines behind the import of the package, by class.
_LINES = {
    "SurfaceAreaForce": _on(
        _SPHERE, "SurfaceAreaForce(mesh, modulus=1.3, target=1.01 * mesh.area)"
    ),
    "EnclosedVolumeForce": _on(
        _SPHERE, "EnclosedVolumeForce(mesh, modulus=0.04, target=0.95 * mesh.volume)"
    ),
    "BendingForce": _on(_SPHERE, "BendingForce(mesh, rigidity=50, spontaneousCurvature=0.002)"),
    "TriangleHeightForce": _on(
        _SPHERE, "TriangleHeightForce(mesh, minHeight=mesh.min_height(0.5), epsilon=10)"
    ),
    "DihedralForce": _on(
        _SPHERE,
        "DihedralForce(\n    mesh, stiffness=50, form=helfrich.DihedralForce.Cosine\n)",
    ),
    "TriangleAreaForce": _on(
        _SPHERE,
        "TriangleAreaForce(mesh, modulus=1.3, target=mesh.area / mesh.num_triangles)",
    ),
    "PlaquetteAreaForce": _on(_SPHERE, "PlaquetteAreaForce(mesh, stiffness=10, target=mesh.area)"),
    "TriangleAreaRepulsionForce": _on(
        _SPHERE, "TriangleAreaRepulsionForce(mesh, minArea=200, epsilon=10)"
    ),
    "SurfaceRepulsionForce": (
        "import numpy as np\n\n"
        "one = helfrich.Mesh.random_sphere(252, radius=100, seed=1)  # nm\n"
        "other = one.translated((203, 0, 0))\n"
        "mesh = helfrich.Mesh(\n"
        "    np.vstack([one.vertices, other.vertices]),\n"
        "    np.vstack([one.triangles, other.triangles + one.num_vertices]),\n"
        ")\n"
        "force = helfrich.SurfaceRepulsionForce(mesh, distance=6, epsilon=2.5)\n" + _ENERGY
    ),
    "ParticleSurfaceForce": (
        "import openmm\n\n" + _SPHERE + "system = openmm.System()\n"
        "for _ in range(mesh.num_vertices + 1):\n    system.addParticle(50)  # amu\n"
        "bead = mesh.num_vertices  # the index of the last particle\n"
        "force = helfrich.ParticleSurfaceForce(\n"
        "    mesh, [bead], distance=3, epsilon=2.5, adhesion=0.3, radius=15,\n"
        "    attraction=helfrich.ParticleSurfaceForce.LennardJones,\n)\n"
        "system.addForce(force)\n"
        "context = openmm.Context(system, openmm.VerletIntegrator(0.1))\n"
        "context.setPositions([*mesh.vertices, [118, 0, 0]])\n"
        "print(context.getState(energy=True).getPotentialEnergy())\n"
    ),
    "EdgeTensionForce": _on(
        "mesh = helfrich.Mesh.disk(8, radius=100)  # nm\n", "EdgeTensionForce(mesh, tension=2)"
    ),
    "GaussianCurvatureForce": _on(_SPHERE, "GaussianCurvatureForce(mesh, modulus=-40)"),
    "SkalakForce": _on(
        _STRETCHED,
        "SkalakForce(mesh, shearModulus=0.004, areaModulus=0.01, reference=at_rest)",
    ),
    "NeoHookeanForce": _on(
        _STRETCHED,
        "NeoHookeanForce(mesh, shearModulus=0.004, areaModulus=0.01, reference=at_rest)",
    ),
    "LimForce": _on(
        _STRETCHED,
        "LimForce(mesh, shearModulus=0.004, areaModulus=0.01, reference=at_rest)",
    ),
    "LinearElasticForce": _on(
        _STRETCHED,
        "LinearElasticForce(mesh, shearModulus=0.004, areaModulus=0.01, reference=at_rest)",
    ),
    "SpringForce": _on(
        _STRETCHED,
        "SpringForce(\n    mesh, stiffness=0.01, reference=at_rest,\n"
        "    form=helfrich.SpringForce.WLCPower,\n)",
    ),
    "PressureForce": _on(_SPHERE, "PressureForce(mesh, pressure=0.001)"),
    "SurfaceTensionForce": _on(_SPHERE, "SurfaceTensionForce(mesh, tension=0.01)"),
    "OsmoticPressureForce": _on(
        "concentration = 0.0006  # 1/nm³, about 1 mmol/l\n" + _SPHERE,
        "OsmoticPressureForce(\n"
        "    mesh, solutes=concentration * mesh.volume, concentration=1.1 * concentration,\n"
        "    thermalEnergy=2.494,\n)",
    ),
    "AreaDifferenceForce": (
        _SPHERE + "modulus, target = helfrich.area_difference_parameters(\n"
        "    rigidity=50, alpha=1.4, area=mesh.area, delta_a0=1.1\n)\n"
        "force = helfrich.AreaDifferenceForce(mesh, modulus, target)\n" + _ENERGY
    ),
    "LineTensionForce": (
        _SPHERE + "domains = (mesh.vertices[:, 2] > 0).astype(int)  # a half of each kind\n"
        "force = helfrich.LineTensionForce(mesh, 0.5, domains)\n" + _ENERGY
    ),
    "MonteCarloBondFlip": (
        "import openmm\n\n" + _SPHERE + "vesicle = helfrich.Vesicle(mesh, softness=0.33)\n"
        "system = vesicle.system()\n"
        "flips = helfrich.MonteCarloBondFlip(mesh, temperature=300, frequency=10)\n"
        "flips.setRandomNumberSeed(1)\n"
        "system.addForce(flips)\n"
        "context = openmm.Context(system, openmm.LangevinMiddleIntegrator(300, 0.01, 1.0))\n"
        "context.setPositions(mesh.vertices)\n"
        "context.getIntegrator().step(200)\n"
        'print(flips.getStatistics(context)["attempts"])\n'
    ),
    "MonteCarloDomainSwap": (
        "import openmm\n\n" + _SPHERE + "domains = (mesh.vertices[:, 2] > 0).astype(int)\n"
        "system = helfrich.Vesicle(mesh).system()\n"
        "line = helfrich.LineTensionForce(mesh, 0.5, domains)\n"
        "system.addForce(line)\n"
        "system.addForce(helfrich.MonteCarloDomainSwap(mesh, temperature=300, frequency=10))\n"
        "context = openmm.Context(system, openmm.LangevinMiddleIntegrator(300, 0.01, 0.2))\n"
        "context.setPositions(mesh.vertices)\n"
        "context.getIntegrator().step(200)\n"
        "print(line.getDomainsInContext(context).sum(), domains.sum())  # what there is stays\n"
    ),
    "MonteCarloMembraneTension": (
        "import openmm\n\n"
        "mesh = helfrich.Mesh.sheet(12, 14, 10, periodic=True)  # nm\n"
        "vesicle = helfrich.Vesicle(mesh, volume_modulus=0)\n"
        "system = vesicle.system()\n"
        "mover = helfrich.MonteCarloMembraneTension(temperature=300, tension=0.01)\n"
        "system.addForce(mover)\n"
        "context = openmm.Context(system, openmm.LangevinMiddleIntegrator(300, 0.01, 0.2))\n"
        "context.setPositions(mesh.vertices)\n"
        "context.getIntegrator().step(200)\n"
        'print(mover.getStatistics(context)["attempts"])\n'
    ),
    "SurfaceViscosityThermostat": (
        "import openmm\n\n" + _SPHERE + "system = helfrich.Vesicle(mesh).system()\n"
        "system.addForce(\n"
        "    helfrich.SurfaceViscosityThermostat(mesh, friction=46, temperature=300)\n)\n"
        "context = openmm.Context(system, openmm.VerletIntegrator(0.2))\n"
        "context.setPositions(mesh.vertices)\n"
        "context.getIntegrator().step(200)\n"
        'print(context.getParameter("SurfaceViscosityFriction"))\n'
    ),
    "VariableMassVerletIntegrator": (
        "import openmm\n\n"
        + _SPHERE
        + "integrator = helfrich.VariableMassVerletIntegrator(0.2)  # ps\n"
        "simulation = helfrich.Vesicle(mesh).simulation(integrator)\n"
        "simulation.step(200)\n"
        "print(integrator.getMasses().sum().round(6))  # amu, as at the start\n"
    ),
    "VariableMassLangevinIntegrator": (
        "import openmm\n\n"
        + _SPHERE
        + "integrator = helfrich.VariableMassLangevinIntegrator(300, 0.01, 0.2)  # K, 1/ps, ps\n"
        "simulation = helfrich.Vesicle(mesh).simulation(integrator)\n"
        "simulation.step(200)\n"
        "print(integrator.getMasses().sum().round(6))  # amu, as at the start\n"
    ),
}


def code(name: str) -> str:
    """The example of a class."""
    lines = _LINES.get(name) or _usual(name)
    imports = "import openmmhelfrich as helfrich\n\n"
    for other in ("import openmm\n\n", "import numpy as np\n\n"):
        if lines.startswith(other):
            return other.strip() + "\n" + imports + lines.removeprefix(other)
    return imports + lines


def run(name: str) -> tuple[dict[str, object], str]:
    """What the example leaves, by name, and what it prints."""
    left: dict[str, object] = {}
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code(name), f"the example of {name}", "exec"), left)
    return left, printed.getvalue()


def output(name: str) -> str:
    """What the example prints."""
    return run(name)[1]
