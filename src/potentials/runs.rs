//! Runs of elements that formulas are applied to, each in three forms: the reference's, the lanes', and energies alone.

use super::{
    Constants, Contribution, EdgeFormula, Place, Sums, Term, Triangle, TriangleFormula, Vertex,
    VertexFormula,
};
use crate::lanes::tiles::{EdgeBlock, TriangleTile, VertexTile};
use crate::lanes::{BLOCK, Level};
use crate::mesh::NONE;
use crate::mesh::geometry::{
    EdgeGeometry, EdgePartials, TriangleGeometry, TrianglePartials, VertexGeometry, VertexPartials,
};
use crate::mesh::vertex_vectors::VertexVectors;

/// A run of triangles to apply a formula to.
///
/// Each kind of run has three forms: the reference's, the lanes', and energies alone, of any elements, for moves
/// that change a few of them.
pub enum Triangles<'a> {
    /// Only energies, which are added.
    Energies {
        /// Indices in the mesh.
        ids: &'a [u32],
        /// The triangles.
        geometry: &'a [TriangleGeometry],
        /// The constants of each; empty unless the potential has any.
        constants: &'a [Constants],
        /// One for each, kJ/mol.
        energies: &'a mut [f64],
    },
    /// One by one.
    Plain {
        /// Index of the first in the mesh.
        first: usize,
        /// The triangles.
        geometry: &'a [TriangleGeometry],
        /// To be added to.
        partials: &'a mut [TrianglePartials],
    },
    /// In lanes.
    Lanes {
        /// What the processor has.
        level: Level,
        /// Indices in the mesh of the triangles that the tile starts with.
        ids: &'a [u32],
        /// The triangles, and the partials to be added to.
        tile: &'a mut TriangleTile,
    },
}

/// A run of edges to apply a formula to.
pub enum Edges<'a> {
    /// Only energies, which are added.
    Energies {
        /// Their places among the values of edges, as below.
        names: &'a [u32],
        /// The edges.
        geometry: &'a [EdgeGeometry],
        /// One for each, kJ/mol.
        energies: &'a mut [f64],
    },
    /// Each edge once.
    Plain {
        /// Their places among the values of edges; [`NONE`] at borders.
        names: &'a [u32],
        /// The edges.
        geometry: &'a [EdgeGeometry],
        /// To be added to.
        partials: &'a mut [EdgePartials],
    },
    /// Each edge from both of its ends.
    Lanes(EdgeBlock<'a>),
}

/// A run of vertices to apply a formula to.
pub enum Vertices<'a> {
    /// Only energies, which are added.
    Energies {
        /// How many vertices the mesh has.
        total: usize,
        /// Indices in the mesh.
        ids: &'a [u32],
        /// Areas and curvatures.
        scalars: &'a [VertexGeometry],
        /// Curvature vectors and normals; empty unless the potential wants them.
        vectors: &'a [VertexVectors],
        /// One for each, kJ/mol.
        energies: &'a mut [f64],
    },
    /// One by one.
    Plain {
        /// Index of the first in the mesh.
        first: usize,
        /// How many vertices the mesh has.
        total: usize,
        /// Which of them to leave out; empty if none.
        left_out: &'a [bool],
        /// Areas and curvatures.
        scalars: &'a [VertexGeometry],
        /// Curvature vectors and normals; empty unless the potential wants them.
        vectors: &'a [VertexVectors],
        /// To be added to.
        scalar_partials: &'a mut [VertexPartials],
        /// To be added to; empty unless the potential wants them.
        vector_partials: &'a mut [VertexVectors],
    },
    /// In lanes.
    Lanes {
        /// What the processor has.
        level: Level,
        /// How many vertices the mesh has.
        total: usize,
        /// Indices in the mesh of the vertices that the tile starts with.
        ids: &'a [u32],
        /// The vertices, and the partials to be added to.
        tile: &'a mut VertexTile,
    },
}

impl From<Sums<f64>> for Contribution {
    fn from(sums: Sums<f64>) -> Self {
        let mut contribution = Self::default();
        contribution.add(sums);
        contribution
    }
}

impl Contribution {
    /// Add what a formula gave.
    pub fn add(&mut self, sums: Sums<f64>) {
        self.energy += sums.energy;
        for (sum, value) in self.by_parameter.iter_mut().zip(sums.by_parameter) {
            *sum += value;
        }
    }

    /// A field hides the scalar, on which nothing depends then.
    fn without_hidden(mut self, term: &Term) -> Self {
        for (parameter, derivative) in self.by_parameter.iter_mut().enumerate() {
            if !term.is_scalar(parameter) {
                *derivative = 0.0;
            }
        }
        self
    }
}

impl Triangles<'_> {
    /// Apply a formula to all; returns the sum.
    pub fn apply(self, term: &Term, formula: &impl TriangleFormula) -> Contribution {
        let sum = match self {
            Self::Energies { ids, geometry, constants, energies } => {
                for (n, ((id, known), energy)) in ids.iter().zip(geometry).zip(energies).enumerate()
                {
                    let triangle = Triangle { twice_area: known.twice_area, dots: known.dots };
                    if !formula.vanishes(&triangle) {
                        let mut unused = TrianglePartials { area: 0.0, length_squared: [0.0; 3] };
                        let place = Place::alone(term, id, constants.get(n));
                        *energy += formula.apply(place, &triangle, &mut unused).energy;
                    }
                }
                Contribution::default()
            }
            Self::Plain { first, geometry, partials } => {
                let mut sum = Contribution::default();
                for (index, (known, partial)) in geometry.iter().zip(partials).enumerate() {
                    let ids = &[(first + index) as u32];
                    let triangle = Triangle { twice_area: known.twice_area, dots: known.dots };
                    if formula.vanishes(&triangle) {
                        continue;
                    }
                    sum.add(formula.apply(Place::new(term, ids), &triangle, partial));
                }
                sum
            }
            Self::Lanes { level, ids, tile } => tile.apply(level, term, ids, formula),
        };
        sum.without_hidden(term)
    }
}

impl Edges<'_> {
    /// Apply a formula that asks for no edge by name to all; returns the sum. Its energy and derivatives are to be 0 at φ =
    /// 0, the angle of borders and the one that rings of vertices are filled up with.
    pub fn apply(self, formula: &impl EdgeFormula) -> Contribution {
        self.apply_where(formula, |_| Some(0), |_, _| Some(0))
    }

    /// Apply a formula to all edges with a dihedral angle, each by its name; returns the sum.
    pub fn apply_to_each(self, term: &Term, formula: &impl EdgeFormula) -> Contribution {
        let (names, in_lanes) = match &self {
            Self::Energies { names, .. } => (*names, None),
            Self::Plain { names, .. } => (*names, None),
            Self::Lanes(block) => (&[] as &[u32], Some((block.names)())),
        };
        let named = |name: u32| (name != NONE).then_some(name);
        let of_lane = |step: usize, lane: usize| named(in_lanes?[step][lane]);
        self.apply_where(formula, |index| named(names[index]), of_lane).without_hidden(term)
    }

    /// Apply a formula where edges have names.
    #[inline(always)]
    fn apply_where(
        self,
        formula: &impl EdgeFormula,
        name: impl Fn(usize) -> Option<u32>,
        name_in_lanes: impl Fn(usize, usize) -> Option<u32>,
    ) -> Contribution {
        let mut sum = Contribution::default();
        match self {
            Self::Energies { geometry, energies, .. } => {
                for (index, (edge, energy)) in geometry.iter().zip(energies).enumerate() {
                    let Some(name) = name(index) else { continue };
                    let angle = edge.bend * edge.length_squared.sqrt();
                    *energy += formula.apply(name, angle).0.energy;
                }
            }
            Self::Plain { geometry, partials, .. } => {
                for (index, (edge, partial)) in geometry.iter().zip(partials).enumerate() {
                    let Some(name) = name(index) else { continue };
                    let angle = edge.bend * edge.length_squared.sqrt();
                    let (sums, slope) = formula.apply(name, angle);
                    sum.add(sums);
                    partial.angle += slope;
                }
            }
            Self::Lanes(block) => {
                let known =
                    block.bends.as_flattened().iter().zip(block.lengths_squared.as_flattened());
                let moments = block.moments.as_flattened_mut();
                for (index, ((bend, length_squared), moment)) in known.zip(moments).enumerate() {
                    let (step, lane) = (index / BLOCK, index % BLOCK);
                    let Some(name) = name_in_lanes(step, lane) else { continue };
                    let length = length_squared.sqrt();
                    let (sums, slope) = formula.apply(name, bend * length);
                    *moment += slope / length;
                    if lane < block.lanes {
                        // The edge's other end adds the other half.
                        sum.add(Sums {
                            energy: 0.5 * sums.energy,
                            by_parameter: sums.by_parameter.map(|derivative| 0.5 * derivative),
                        });
                    }
                }
            }
        }
        sum
    }
}

impl Vertices<'_> {
    /// How many vertices the mesh has.
    pub fn total(&self) -> usize {
        match self {
            Self::Energies { total, .. }
            | Self::Plain { total, .. }
            | Self::Lanes { total, .. } => *total,
        }
    }

    /// Apply a formula to all; returns the sum.
    pub fn apply(self, term: &Term, formula: &impl VertexFormula) -> Contribution {
        let sum = match self {
            Self::Energies { ids, scalars, vectors, energies, .. } => {
                for (index, (known, energy)) in scalars.iter().zip(energies).enumerate() {
                    let vertex = Vertex::plain(*known, vectors.get(index));
                    let mut unused = Vertex::plain(VertexGeometry::default(), None);
                    let place = Place::new(term, &ids[index..=index]);
                    *energy += formula.apply(place, &vertex, &mut unused).energy;
                }
                Contribution::default()
            }
            Self::Plain {
                first,
                left_out,
                scalars,
                vectors,
                scalar_partials,
                vector_partials,
                ..
            } => {
                let mut sum = Contribution::default();
                for (index, (known, partial)) in scalars.iter().zip(scalar_partials).enumerate() {
                    if left_out.get(index) == Some(&true) {
                        continue;
                    }
                    let ids = &[(first + index) as u32];
                    let vertex = Vertex::plain(*known, vectors.get(index));
                    let mut partials = Vertex::plain(
                        VertexGeometry {
                            area: partial.area,
                            voronoi_area: partial.voronoi_area,
                            curvature: partial.curvature,
                        },
                        vector_partials.get(index),
                    );
                    sum.add(formula.apply(Place::new(term, ids), &vertex, &mut partials));
                    *partial = VertexPartials {
                        area: partials.area,
                        voronoi_area: partials.voronoi_area,
                        curvature: partials.curvature,
                    };
                    if let Some(partial) = vector_partials.get_mut(index) {
                        *partial = VertexVectors {
                            cotangent: partials.cotangent.into(),
                            umbrella: partials.umbrella.into(),
                            normal_sum: partials.normal_sum.into(),
                        };
                    }
                }
                sum
            }
            Self::Lanes { level, ids, tile, .. } => tile.apply(level, term, ids, formula),
        };
        sum.without_hidden(term)
    }
}
