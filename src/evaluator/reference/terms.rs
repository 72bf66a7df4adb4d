//! What the terms make of the geometry: energies and partial derivatives.

use super::ReferenceEvaluator;
use crate::error::Result;
use crate::evaluator::checks::check_totals;
use crate::evaluator::passes::{fill, fill_pair};
use crate::mesh::geometry::{
    EdgePartials, TotalPartials, Totals, TrianglePartials, VertexPartials,
};
use crate::mesh::vertex_vectors::VertexVectors;
use crate::potentials::{Contribution, Edges, Needs, Term, Triangles, Vertices};

impl ReferenceEvaluator {
    /// Let every term add its energy and its partial derivatives.
    ///
    /// # Errors
    /// Derivatives with respect to totals that are not finite.
    pub(super) fn potentials(
        &mut self,
        terms: &[Term],
        needs: Needs,
        totals: &Totals,
        contributions: &mut [Contribution],
    ) -> Result<TotalPartials> {
        let mut total_partials = TotalPartials::default();
        if needs.contains(Needs::TRIANGLES) {
            self.triangle_partials.fill(TrianglePartials::default());
        }
        if needs.contains(Needs::EDGES) {
            self.edge_partials.fill(EdgePartials::default());
        }
        if needs.contains(Needs::VERTICES) {
            self.vertex_partials.fill(VertexPartials::default());
        }
        if needs.contains(Needs::VECTORS) {
            self.vector_partials.fill(VertexVectors::default());
        }
        for (term, contribution) in terms.iter().zip(contributions) {
            let (potential, needs) = (term.potential, term.potential.needs(term));
            *contribution = Contribution::default();
            if needs.contains(Needs::TOTALS) {
                *contribution += potential.totals(term, totals, &mut total_partials);
                check_totals(term, contribution, &total_partials)?;
            }
            if needs.contains(Needs::TRIANGLES) {
                let triangles = &self.triangles;
                *contribution +=
                    fill(self.parallel, &mut self.triangle_partials, |first, chunk| {
                        let geometry = &triangles[first..][..chunk.len()];
                        let partials = chunk;
                        potential.triangles(term, Triangles::Plain { first, geometry, partials })
                    });
            }
            if needs.contains(Needs::EDGES) {
                let (edges, names) = (&self.edges, &self.edge_names);
                *contribution += fill(self.parallel, &mut self.edge_partials, |first, chunk| {
                    let geometry = &edges[first..][..chunk.len()];
                    let names = &names[first..][..chunk.len()];
                    potential.edges(term, Edges::Plain { names, geometry, partials: chunk })
                });
            }
            if needs.contains(Needs::VERTICES) {
                *contribution += self.potential_of_vertices(term, needs);
            }
        }
        Ok(total_partials)
    }

    fn potential_of_vertices(&mut self, term: &Term, needs: Needs) -> Contribution {
        let (vertices, all_vectors) = (&self.vertices, &self.vectors);
        let wants_vectors = needs.contains(Needs::VECTORS);
        let left_out = if term.potential.acts_at_borders() { &[] } else { &self.on_border[..] };
        let beside: &mut [_] = if wants_vectors { &mut self.vector_partials } else { &mut [] };
        fill_pair(self.parallel, &mut self.vertex_partials, beside, |first, scalars, vectors| {
            let here = first..first + scalars.len();
            let known: &[_] = if wants_vectors { &all_vectors[here.clone()] } else { &[] };
            let run = Vertices::Plain {
                first,
                total: vertices.len(),
                left_out: left_out.get(here.clone()).unwrap_or_default(),
                scalars: &vertices[here],
                vectors: known,
                scalar_partials: scalars,
                vector_partials: vectors,
            };
            term.potential.vertices(term, run)
        })
    }
}
