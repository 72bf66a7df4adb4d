"""What ``openmm-helfrich info`` says of the machine: GPUs, and what "auto" would choose."""

from __future__ import annotations

__all__ = ["machine"]

#: What `platforms.evaluators` finds, for people.
WORDS = {
    "native": "the platform itself",
    "cpu": "the processor",
    "gpu": "a GPU beside the platform",
    "auto": "a GPU beside the platform or the processor, whichever is faster",
    "none": "nothing: a Context is an error",
}

# Subdivisions of the icospheres that are measured where nothing is known yet: N = 10 n² + 2.
_MEASURED = (48, 96, 192)


def machine() -> list[str]:
    """Lines about versions, adapters and the choice of a backend."""
    import openmm

    from .. import __version__, backend

    found = backend.adapters()
    lines = [
        f"openmm-helfrich {__version__}, OpenMM {openmm.Platform.getOpenMMVersion()}",
        *_platforms(),
        f"Backend: {backend.get_backend()}",
        "",
    ]
    if not found:
        lines.append("No GPU, nor any driver of one.")
    for adapter in found:
        lines.append(f"GPU {adapter.index}: {adapter.name}, {adapter.kind}")
        lines.append(f"  {adapter.interface}, {adapter.driver}")
        double = "single and double precision" if adapter.double else "single precision only"
        clock = "with" if adapter.timestamps else "without"
        lines.append(f"  {double}, {clock} timestamps")
    lines += ["", *_natively(), "", 'What "auto" chooses on other platforms:']
    lines.append(f"  below {backend.LEAST_VERTICES} vertices the processor")
    if all(adapter.kind == "software" for adapter in found):
        reason = "is no GPU" if not found else "is no GPU but in software"
        return [*lines, f"  above, too, for there {reason}"]
    return lines + _timings()


def _platforms() -> list[str]:
    """What OpenMM has, and what simulations get that name none."""
    import openmm

    from .. import Mesh, Vesicle
    from ..platforms import LEAST_FOR_GPU, choose, names

    vesicle = Vesicle(Mesh.icosphere(2, 100.0))
    mixed = vesicle.system()
    mixed.addForce(openmm.CustomNonbondedForce("1/r"))
    large = openmm.XmlSerializer.clone(mixed)
    while large.getNumParticles() < LEAST_FOR_GPU:
        large.addParticle(50)
    lines = [f"OpenMM's platforms: {', '.join(names())}; where none is named:"]
    for subject, system in (
        ("membranes", vesicle.system()),
        ("with pairs of particles", mixed),
        (f"with pairs, from {LEAST_FOR_GPU} particles on", large),
    ):
        name, reason = choose(system, openmm.VerletIntegrator(0.1))
        lines.append(f"  {subject}: {name}, for {reason}")
    return [*lines, ""]


def _natively() -> list[str]:
    """Whether OpenMM's GPU platforms would compute membranes themselves."""
    from .. import Mesh, Vesicle
    from ..platforms import ON_DEVICES, evaluators, names

    system = Vesicle(Mesh.icosphere(2, 100.0)).system()
    lines = ["What computes membranes on OpenMM's GPU platforms:"]
    present = [name for name in ON_DEVICES if name in names()]
    if not present:
        return [*lines, f"  this OpenMM has none of {', '.join(ON_DEVICES)}"]
    for name in present:
        [(who, reason)] = evaluators(system, name)
        lines.append(f"  {name}: {WORDS[who]}, for {reason}")
    return lines


def _timings() -> list[str]:
    """The measurements behind the choice, made now where there are none yet."""
    from .. import backend

    _measure()
    known = backend.timings()
    lines = ["  above, by the time of an evaluation (paper's four forces, or what was simulated):"]
    for machine in sorted({timing.machine for timing in known}):
        lines.append(f"  {machine.replace('|', ', ')}")
        lines.append("    vertices   processor         GPU  choice")
        for timing in known:
            if timing.machine == machine:
                choice = "GPU" if timing.gpu < timing.cpu else "processor"
                lines.append(
                    f"    {timing.vertices:8d}  {timing.cpu * 1e3:7.2f} ms  "
                    f"{timing.gpu * 1e3:7.2f} ms  {choice}"
                )
    return lines


def _measure() -> None:
    """Let "auto" measure the paper's forces; it does so for sizes that it does not know."""
    import openmm

    from .. import Mesh, Vesicle
    from ..platforms import membranes_of

    for divisions in _MEASURED:
        mesh = Mesh.icosphere(divisions, 1000.0)
        system = Vesicle(mesh).system()
        for force in membranes_of(system):
            force.setBackend("auto")
        reference = openmm.Platform.getPlatformByName("Reference")
        context = openmm.Context(system, openmm.VerletIntegrator(0.1), reference)
        context.setPositions(mesh.vertices)
        context.getState(forces=True)
