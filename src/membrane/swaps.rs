//! Exchanges between neighbours of a membrane.

use super::Membrane;
use crate::error::Result;
use crate::mesh::Configuration;
use crate::moves::{SwapRound, swaps};
use crate::potentials::{MAX_PARAMETERS, MadeOf, Term, VertexNumbers};
use smallvec::SmallVec;

impl Membrane {
    /// Make a round of exchanges at the present positions, with the energy of some terms. Returns how many were made;
    /// the round's sources say whose values each vertex has then, and the caller puts them in order. If `force_change`
    /// (kJ/mol/nm, in the layout of the positions) is wanted, it gets by how much they have changed the forces; it is left
    /// alone if there were none. `version` is what terms will have for theirs that have been changed.
    ///
    /// # Errors
    /// A term as [`Self::evaluate`] refuses it, a mesh without geometry, a GPU that was asked for and fails: the round's
    /// state is as it was, and the sources are to be forgotten.
    pub fn swap(
        &mut self,
        terms: &[Term],
        at: Configuration,
        round: SwapRound,
        version: u64,
        force_change: Option<&mut [f64]>,
    ) -> Result<u64> {
        self.look_around(terms, at, force_change.is_some())?;
        let SwapRound { rules, attempts, state, kinds, sources } = round;
        let before = *state;
        let round =
            SwapRound { rules, attempts, state: &mut *state, kinds, sources: &mut *sources };
        let made = swaps::attempt(&self.surface.mesh, &self.local, terms, round);
        if let (true, Some(change)) = (made > 0, force_change) {
            let moved: Vec<_> =
                terms.iter().map(|term| Moved::new(term, sources, version)).collect();
            let pairs = terms.iter().zip(&moved);
            let terms: SmallVec<[Term; 8]> = pairs.map(|(term, moved)| moved.apply(term)).collect();
            self.compare_forces(&terms, at, change).inspect_err(|_| *state = before)?;
        }
        Ok(made)
    }
}

/// What a term has of each vertex, in another order; empty where it has nothing.
struct Moved {
    fields: [Vec<f64>; MAX_PARAMETERS],
    /// With their version, if anything has changed.
    numbers: Option<VertexNumbers>,
}

impl Moved {
    fn new(term: &Term, sources: &[u32], version: u64) -> Self {
        let moved =
            |values: &[f64]| sources.iter().map(|source| values[*source as usize]).collect();
        let made_of = term.potential.constants(term);
        let has_kinds = matches!(made_of, Some(MadeOf::Domains(_)));
        let fields = std::array::from_fn(|k| match term.is_of_vertices(k) {
            true => moved(term.fields[k]),
            false => Vec::new(),
        });
        let before = term.numbers;
        let has_changed = has_kinds || fields.iter().any(|field| !field.is_empty());
        let numbers = has_changed.then(|| VertexNumbers {
            values: if has_kinds { moved(&before.values) } else { before.values.clone() },
            version,
            ..*before
        });
        Self { fields, numbers }
    }

    fn apply<'a>(&'a self, term: &Term<'a>) -> Term<'a> {
        let mut term = *term;
        for (field, moved) in term.fields.iter_mut().zip(&self.fields) {
            if !moved.is_empty() {
                *field = moved;
            }
        }
        if let Some(numbers) = &self.numbers {
            term.numbers = numbers;
        }
        term
    }
}
