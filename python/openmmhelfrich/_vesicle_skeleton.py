"""`Vesicle(skeleton=)`: what it may be, and the force that comes of it."""

from collections.abc import Mapping

from .forces import LinearElasticForce, NeoHookeanForce, SkalakForce, SpringForce

#: The laws by name; their arguments are those of the classes.
LAWS = {
    "Skalak": SkalakForce,
    "NeoHookean": NeoHookeanForce,
    "LinearElastic": LinearElasticForce,
    "Spring": SpringForce,
}


def checked_skeleton(skeleton):
    """The law and the arguments of its force by name."""
    if not isinstance(skeleton, Mapping):
        raise TypeError(f"Vesicle: skeleton needs a mapping of names to values, got {skeleton!r}")
    law = skeleton.get("law", "Skalak")
    if law not in LAWS:
        known = ", ".join(LAWS)
        raise ValueError(f"Vesicle: skeleton has no law {law!r}; known are {known}")
    return {**skeleton, "law": law}


def skeleton_of(skeleton, mesh, offset):
    """The force on a mesh whose particles start at `offset`; at rest it is the mesh by default."""
    arguments = {"reference": mesh, **skeleton}
    return LAWS[arguments.pop("law")](mesh, **arguments, offset=offset)
