"""What has become of the Custom forces of a System."""

from __future__ import annotations

from dataclasses import dataclass, field

from .recognise.fixed import Fixed

__all__ = ["Left", "Replaced", "Report"]


@dataclass(frozen=True)
class Replaced:
    """Custom forces that one of ours took the place of.

    indices, names: of the forces in the given System; force_class: the class of ours;
    num_triangles: of its surface; description: its parameters, in words; fixed: the global
    parameters of the Custom forces that have become numbers or multiples of others.
    """

    indices: tuple[int, ...]
    names: tuple[str, ...]
    force_class: str
    num_triangles: int
    description: str
    fixed: tuple[Fixed, ...] = ()


@dataclass(frozen=True)
class Left:
    """A force that stays, and why.

    freeze: the global parameters that `accelerate` must be told to freeze to replace it; empty if
    that does not help.
    """

    index: int
    name: str
    reason: str
    freeze: tuple[str, ...] = ()


@dataclass
class Report:
    """What `accelerate` replaced and what it left alone.

    Attributes
    ----------
    replaced : list of Replaced
    left : list of Left
    notes : list of str
        What else has changed.
    """

    replaced: list[Replaced] = field(default_factory=list)
    left: list[Left] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __str__(self) -> str:
        lines = [f"replaced {sum(len(r.indices) for r in self.replaced)} forces"]
        for r in self.replaced:
            names = ", ".join(sorted(set(r.names)))
            which = ", ".join(map(str, r.indices))
            lines.append(f"  {which} ({names}) -> {r.force_class}, {r.num_triangles} triangles")
            lines.append(f"      {r.description}")
            lines += [f"      fixed: {_fixed_in_words(fixed)}" for fixed in r.fixed]
        lines.append(f"left {len(self.left)} forces alone")
        lines += [f"  {r.index} ({r.name}): {r.reason}" for r in self.left]
        return "\n".join([*lines, *self.notes])


def _fixed_in_words(fixed: Fixed) -> str:
    if not fixed.base:
        return str(fixed)
    return (
        f"{fixed}, now {fixed.value:.9g}; it follows {fixed.base}, which it did not by itself in "
        "the given System"
    )
