//! How potentials see elements of the mesh: a formula for one triangle, edge or vertex. [`super::runs`] applies it to many.
//!
//! A formula is generic over [`Real`], so it is written once for lanes and for single numbers. Those of dihedral angles,
//! with their sines and exponentials, take one number at a time.

use super::{CONSTANTS, Constants, Needs, Term};
use crate::mesh::geometry::{TrianglePartials, VertexGeometry};
use crate::mesh::vertex_vectors::VertexVectors;
use crate::real::Real;

/// The most scalars of a potential that lives on elements.
const SCALARS: usize = 2;

/// What potentials may know of a triangle.
#[derive(Clone, Copy)]
pub struct Triangle<R> {
    /// |N|, nm².
    pub twice_area: R,
    /// At each corner the scalar product of the two sides that leave it, nm².
    pub dots: [R; 3],
}

impl<R: Real> Triangle<R> {
    /// Area, nm².
    #[inline(always)]
    pub fn area(&self) -> R {
        self.twice_area * 0.5
    }

    /// Squared length of side `k`, from corner `k` to corner `k + 1`, nm².
    #[inline(always)]
    pub fn length_squared(&self, k: usize) -> R {
        self.dots[k] + self.dots[(k + 1) % 3]
    }
}

/// What potentials may know of a vertex; fields are as in [`VertexGeometry`] and [`VertexVectors`]. The
/// derivatives of the energy with respect to it have the same shape.
#[derive(Clone, Copy)]
pub struct Vertex<R> {
    /// Barycentric area, nm².
    pub area: R,
    /// Voronoi's area, nm².
    pub voronoi_area: R,
    /// Jülicher's integrated curvature, nm.
    pub curvature: R,
    /// Curvature vector of Gompper and Kroll, nm.
    pub cotangent: [R; 3],
    /// Curvature vector of Espriu, nm.
    pub umbrella: [R; 3],
    /// Sum of the triangles' normals, each times its angle.
    pub normal_sum: [R; 3],
}

/// An energy and its derivatives with respect to the scalars.
#[derive(Clone, Copy)]
pub struct Sums<R> {
    /// kJ/mol.
    pub energy: R,
    /// In the order of the potential's parameters.
    pub by_parameter: [R; SCALARS],
}

/// Which elements a formula is being applied to.
#[derive(Clone, Copy)]
pub struct Place<'a> {
    /// The term that the formula belongs to.
    pub term: &'a Term<'a>,
    /// The indices in the mesh, one for each lane; lanes beyond the last element have none.
    pub ids: &'a [u32],
    constants: &'a [Constants],
    /// Where among the constants those of the lanes are.
    places: &'a [u32],
}

impl<'a> Place<'a> {
    /// Elements of the mesh as it is.
    #[inline(always)]
    pub fn new(term: &'a Term<'a>, ids: &'a [u32]) -> Self {
        Self { term, ids, constants: &term.constants.values, places: ids }
    }

    /// A triangle that has constants of its own, if any.
    #[inline(always)]
    pub fn alone(term: &'a Term<'a>, id: &'a u32, constants: Option<&'a Constants>) -> Self {
        let constants = constants.map_or(&[][..], std::slice::from_ref);
        Self { term, ids: std::slice::from_ref(id), constants, places: &[0] }
    }

    /// The constants of the triangles there; `like` only says how many lanes there are.
    #[inline(always)]
    pub fn constants<R: Real>(&self, like: R) -> [R; CONSTANTS] {
        like.gather(self.constants, self.places)
    }

    /// The value of a parameter there; `like` only says how many lanes there are.
    #[inline(always)]
    pub fn value<R: Real>(&self, parameter: usize, like: R) -> R {
        let field = self.term.fields[parameter];
        if field.is_empty() {
            return like.of(self.term.values[parameter]);
        }
        let mut lane = 0;
        like.map(|_| {
            // Lanes beyond the last element repeat it.
            let id = self.ids[lane.min(self.ids.len() - 1)];
            lane += 1;
            field[id as usize]
        })
    }
}

/// A formula for the energy of a triangle; adds to the partials.
pub trait TriangleFormula {
    /// Whether the energy and its derivatives vanish, in all lanes: the formula is not applied then.
    #[inline(always)]
    fn vanishes<R: Real>(&self, _: &Triangle<R>) -> bool {
        false
    }

    /// Apply it.
    fn apply<R: Real>(
        &self,
        place: Place,
        triangle: &Triangle<R>,
        partials: &mut TrianglePartials<R>,
    ) -> Sums<R>;
}

/// A formula for the energy of an edge with a dihedral angle φ: the energy, and its derivatives by the scalars,
/// and the derivative with respect to φ.
pub trait EdgeFormula {
    /// Apply it; `edge` is the place of the edge among the values of edges, where these are asked for.
    fn apply(&self, edge: u32, angle: f64) -> (Sums<f64>, f64);
}

/// A formula for the energy of a vertex; adds to the partials.
pub trait VertexFormula {
    /// What it uses beyond the area: curvatures, vectors (which brings the Voronoi area), normals.
    const USES: Needs;

    /// Apply it.
    fn apply<R: Real>(&self, place: Place, vertex: &Vertex<R>, partials: &mut Vertex<R>)
    -> Sums<R>;
}

impl Vertex<f64> {
    pub(super) fn plain(scalars: VertexGeometry, vectors: Option<&VertexVectors>) -> Self {
        let VertexGeometry { area, voronoi_area, curvature } = scalars;
        let vectors = vectors.copied().unwrap_or_default();
        let [cotangent, umbrella, normal_sum] =
            [vectors.cotangent, vectors.umbrella, vectors.normal_sum].map(Into::into);
        Self { area, voronoi_area, curvature, cotangent, umbrella, normal_sum }
    }
}
