"""What ``openmm-helfrich info`` says of the machine: GPUs, and what "auto" would choose."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

__all__ = ["WORDS", "lines_of", "machine"]

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


def machine() -> dict[str, Any]:
    """Versions, platforms, adapters and the choice of a backend, measured now if it is not yet."""
    import dataclasses

    import openmm

    from .. import __version__, backend
    from ..platforms import names

    adapters = backend.adapters()
    has_gpu = any(adapter.kind != "software" for adapter in adapters)
    if has_gpu:
        _measure()
    timings = [
        {
            "machine": timing.machine,
            "num_vertices": timing.vertices,
            "cpu_s": timing.cpu,
            "gpu_s": timing.gpu,
            "choice": "gpu" if timing.gpu < timing.cpu else "cpu",
        }
        for timing in (backend.timings() if has_gpu else [])
    ]
    return {
        "version": __version__,
        "openmm_version": openmm.Platform.getOpenMMVersion(),
        "platforms": names(),
        "default_platforms": _defaults(),
        "backend": backend.get_backend(),
        "gpus": [dataclasses.asdict(adapter) for adapter in adapters],
        "computed_on_platforms": _natively(),
        "auto": {"least_vertices": backend.LEAST_VERTICES, "timings": timings},
    }


def _defaults() -> list[dict[str, Any]]:
    """What simulations get that name no platform."""
    import openmm

    from .. import Mesh, Vesicle
    from ..platforms import LEAST_FOR_GPU, choose

    vesicle = Vesicle(Mesh.icosphere(2, 100.0))
    mixed = vesicle.system()
    mixed.addForce(openmm.CustomNonbondedForce("1/r"))
    large = openmm.XmlSerializer.clone(mixed)
    while large.getNumParticles() < LEAST_FOR_GPU:
        large.addParticle(50)
    found = []
    for subject, system in (
        ("membranes", vesicle.system()),
        ("with pairs of particles", mixed),
        (f"with pairs, from {LEAST_FOR_GPU} particles on", large),
    ):
        name, reason = choose(system, openmm.VerletIntegrator(0.1))
        found.append({"of": subject, "name": name, "reason": reason})
    return found


def _natively() -> list[dict[str, Any]]:
    """What would compute membranes on those of OpenMM's GPU platforms that are there."""
    from .. import Mesh, Vesicle
    from ..platforms import ON_DEVICES, evaluators, names

    system = Vesicle(Mesh.icosphere(2, 100.0)).system()
    found = []
    for name in ON_DEVICES:
        if name in names():
            [(who, reason)] = evaluators(system, name)
            found.append({"platform": name, "by": who, "reason": reason})
    return found


def lines_of(found: dict[str, Any]) -> Iterator[str]:
    """What `machine` found, for people."""
    from ..platforms import ON_DEVICES

    yield f"openmm-helfrich {found['version']}, OpenMM {found['openmm_version']}"
    yield f"OpenMM's platforms: {', '.join(found['platforms'])}; where none is named:"
    for choice in found["default_platforms"]:
        yield f"  {choice['of']}: {choice['name']}, for {choice['reason']}"
    yield ""
    yield f"Backend: {found['backend']}"
    yield ""
    if not found["gpus"]:
        yield "No GPU, nor any driver of one."
    for gpu in found["gpus"]:
        yield f"GPU {gpu['index']}: {gpu['name']}, {gpu['kind']}"
        yield f"  {gpu['interface']}, {gpu['driver']}"
        double = "single and double precision" if gpu["double"] else "single precision only"
        yield f"  {double}, {'with' if gpu['timestamps'] else 'without'} timestamps"
    yield ""
    yield "What computes membranes on OpenMM's GPU platforms:"
    if not found["computed_on_platforms"]:
        yield f"  this OpenMM has none of {', '.join(ON_DEVICES)}"
    for one in found["computed_on_platforms"]:
        yield f"  {one['platform']}: {WORDS[one['by']]}, for {one['reason']}"
    yield ""
    yield 'What "auto" chooses on other platforms:'
    yield f"  below {found['auto']['least_vertices']} vertices the processor"
    if all(gpu["kind"] == "software" for gpu in found["gpus"]):
        reason = "is no GPU" if not found["gpus"] else "is no GPU but in software"
        yield f"  above, too, for there {reason}"
    else:
        yield from _timing_lines(found["auto"]["timings"])


def _timing_lines(timings: list[dict[str, Any]]) -> Iterator[str]:
    """The measurements behind the choice."""
    yield "  above, by the time of an evaluation (paper's four forces, or what was simulated):"
    for machine in sorted({timing["machine"] for timing in timings}):
        yield f"  {machine.replace('|', ', ')}"
        yield "    vertices   processor         GPU  choice"
        for timing in timings:
            if timing["machine"] == machine:
                choice = "GPU" if timing["choice"] == "gpu" else "processor"
                yield (
                    f"    {timing['num_vertices']:8d}  {timing['cpu_s'] * 1e3:7.2f} ms  "
                    f"{timing['gpu_s'] * 1e3:7.2f} ms  {choice}"
                )


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
