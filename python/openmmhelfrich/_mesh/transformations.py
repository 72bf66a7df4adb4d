"""`Mesh.scaled` and its like: a new mesh of the same triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .._numbers import length_array
from .._types import Values
from ..errors import MeshError
from . import geometry
from .fluctuate import fluctuating
from .inputs import integer, numbers
from .spheroid import spheroid

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

    from ..mesh import Mesh

__all__ = ["LARGEST_L", "Transformations"]

# Waves that short need a million vertices.
LARGEST_L = 1000


class Transformations:
    """What `Mesh` has for moving its vertices; triangles stay connected as they are."""

    def scaled(self, factor: ArrayLike) -> Mesh:
        """The mesh with coordinates multiplied by a factor, x → s x, about the origin, and its box.

        Parameters
        ----------
        factor : float or sequence of 3 floats
            One factor s, or one per axis (s_x, s_y, s_z), not 0. Where the product is negative the
            mesh is mirrored, and its triangles are turned so that they face outward again.

        Raises
        ------
        MeshError
            If the factors are not finite numbers other than 0, or not one or three.
        """
        factors = numbers(factor, "Mesh.scaled", "factor")
        if factors.shape not in ((), (3,)) or not (np.isfinite(factors) & (factors != 0)).all():
            raise MeshError(
                "Mesh.scaled: factor must be one number or three (x, y, z), finite and not 0, "
                f"got {factor!r}"
            )
        box = self.box
        # What is not finite then is refused by name.
        with np.errstate(over="ignore"):
            if box is not None:
                # A box vector may point the other way; its own axis' component is to be above 0.
                box = box * factors * np.sign(factors * np.ones(3))[:, np.newaxis] + 0.0
            vertices = self.vertices * factors
        return self._with(vertices, box)

    def translated(self, displacement: Values) -> Mesh:
        """The mesh moved by a displacement.

        Parameters
        ----------
        displacement : array_like or Quantity
            Shape (3,), nm.

        Raises
        ------
        MeshError
            If the displacement is not three finite lengths.
        """
        vector = length_array(displacement, "Mesh.translated", "displacement")
        if vector.shape != (3,) or not np.isfinite(vector).all():
            raise MeshError(
                "Mesh.translated: displacement must be three finite lengths x, y, z, "
                f"got {displacement!r}"
            )
        return self._with(self.vertices + vector, self.box)

    def rotated(self, rotation: ArrayLike | Rotation) -> Mesh:
        """The mesh rotated about the origin, x → R x.

        Parameters
        ----------
        rotation : array_like or scipy.spatial.transform.Rotation
            R, shape (3, 3), orthogonal within 1e-8 and with determinant +1.

        Raises
        ------
        MeshError
            If R is not a rotation matrix, or the mesh has a periodic box, which cannot turn.
        """
        where = "Mesh.rotated"
        self._refuse_box(where)
        as_matrix = getattr(rotation, "as_matrix", None)
        matrix = numbers(as_matrix() if as_matrix else rotation, where, "rotation")
        if matrix.shape != (3, 3):
            raise MeshError(f"{where}: rotation must have shape (3, 3), got {matrix.shape}")
        if not np.abs(matrix @ matrix.T - np.eye(3)).max() < 1e-8:
            raise MeshError(f"{where}: rotation must be orthogonal, but R Rᵀ is not the identity")
        if np.linalg.det(matrix) < 0:
            raise MeshError(f"{where}: rotation has determinant −1; use scaled to mirror a mesh")
        return self._with(self.vertices @ matrix.T)

    def deformed(self, l: int, m: int, amplitude: float) -> Mesh:
        """The mesh with a spherical harmonic added to its radius, r → r (1 + u Y_lm(θ, φ)).

        r, θ and φ are spherical coordinates about the **origin**, θ from the z axis, φ from the
        x axis. Y_lm are real and orthonormal without the Condon–Shortley phase, as in
        `analysis.real_harmonics`: m > 0 goes with cos mφ, m < 0 with sin |m|φ.

        Parameters
        ----------
        l, m : int
            Mode, 0 ≤ l ≤ 1000 and −l ≤ m ≤ l.
        amplitude : float
            u, without unit.

        Raises
        ------
        MeshError
            If there is no such mode, the amplitude is not finite, a vertex lies at the origin, or
            the deformation would move a vertex to the origin or beyond; if the mesh has a box.
        """
        where = "Mesh.deformed"
        self._refuse_box(where)
        l = integer(l, where, "l", 0)
        if l > LARGEST_L:
            raise MeshError(f"{where}: l must be {LARGEST_L} or less, got {l}")
        m = integer(m, where, "m", -l)
        if m > l:
            raise MeshError(f"{where}: m must be {l} or less, as l is, got {m}")
        amplitude = numbers(amplitude, where, "amplitude")
        if amplitude.shape != () or not np.isfinite(amplitude):
            raise MeshError(f"{where}: amplitude must be one finite number, got {amplitude}")
        distance = np.linalg.norm(self.vertices, axis=1)
        if not distance.all():
            raise MeshError(
                f"{where}: vertex {np.argmin(distance)} lies at the origin, where no direction is "
                "defined; translate the mesh so that the origin is inside of it"
            )
        # Imported here, because a mesh is of use without the analysis of its fluctuations.
        from ..analysis.harmonics import one_harmonic

        directions = self.vertices / distance[:, np.newaxis]
        with np.errstate(over="ignore"):
            # What is beyond all numbers is refused below, or by the mesh.
            factor = 1 + amplitude * one_harmonic(directions, l, m)
        if not (factor > 0).all():
            raise MeshError(
                f"{where}: amplitude {amplitude} moves vertex {np.argmin(factor)} to the origin or "
                f"beyond (1 + u Y = {factor.min():.3g}); take a smaller one"
            )
        return self._with(self.vertices * factor[:, np.newaxis])

    def oblate(self, reduced_volume: float) -> Mesh:
        """The mesh flattened along z to a reduced volume, at unchanged total area.

        An affine deformation about the mean of the vertices, equal along x and y. Area and volume
        are those of the triangles, so that `area` and `reduced_volume` of the result are exact to
        rounding. Meant for spheres: the shape is then close to an oblate spheroid.

        Parameters
        ----------
        reduced_volume : float
            v = 6 √π V / A^{3/2}, above 0 and at most that of the mesh itself, for which the result
            has its shape.

        Raises
        ------
        MeshError
            If the reduced volume is out of this range, or the mesh is open or has a box.
        """
        return self._spheroid(reduced_volume, False, "Mesh.oblate")

    def prolate(self, reduced_volume: float) -> Mesh:
        """The mesh stretched along z to a reduced volume, at unchanged total area.

        The counterpart of `oblate`, which see for arguments and errors.
        """
        return self._spheroid(reduced_volume, True, "Mesh.prolate")

    def _spheroid(self, reduced_volume: float, prolate: bool, where: str) -> Mesh:
        self._refuse_box(where)
        geometry.check_closed(self.border_loops, where)
        return self._with(spheroid(self.vertices, self.triangles, reduced_volume, prolate, where))

    def fluctuating(self, softness: float, seed: int = 0, duration: float = 6.5) -> Mesh:
        """A sphere with the same triangles after its vertices have flowed for a short time.

        A run at 300 K with the potentials of area, volume and triangle heights only, from random
        velocities, with OpenMM's Verlet integrator; then the vertices are moved radially back on
        the sphere. With `icosphere` and `random_sphere` it gives the "fluctuating ordered" and
        "fluctuating random" meshes of the paper.

        Parameters
        ----------
        softness : float
            Ξ, which fixes the least height of the triangles, above 0. Softer meshes (smaller Ξ) get
            more irregular.
        seed : int
            Of the velocities. Equal seeds give equal meshes. Default 0.
        duration : float
            Length of the run in relaxation times τ_h = d √(m/ε) of the heights. Default 6.5, after
            which the paper finds the distribution of areas stationary.

        Raises
        ------
        MeshError
            If an argument is out of range; if the mesh is no sphere or has a box; if triangles
            folded over, as happens to large meshes (4002 vertices) at the paper's least softness,
            0.037.
        """
        self._refuse_box("Mesh.fluctuating")
        return self._with(fluctuating(self, softness, seed, duration))

    def _refuse_box(self, where: str) -> None:
        if self.box is not None:
            raise MeshError(
                f"{where}: the mesh has a periodic box; transform Mesh(*mesh.unfolded()), which "
                "has none"
            )
