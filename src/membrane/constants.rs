//! The constants of triangles that terms have on a membrane, made anew where something has changed.

use crate::error::{Error, Result};
use crate::mesh::{Cell, NONE, Triangulation};
use crate::potentials::{CONSTANTS, Constants, Corners, Flaw, MadeOf, Term, TriangleConstants};
use smallvec::SmallVec;
use std::sync::atomic::{AtomicU64, Ordering};

/// Some terms, each with its constants.
pub type Equipped<'a> = SmallVec<[Term<'a>; 8]>;

/// The constants of all terms that a membrane has been evaluated with, by the objects that have their numbers.
#[derive(Default)]
pub struct Workshop {
    all: Vec<Made>,
}

/// Constants, and what they are of.
#[derive(Default)]
struct Made {
    potential: &'static str,
    owner: u64,
    version: u64,
    /// How often the connectivity had changed.
    generation: u64,
    /// The triangles that they are of; empty if they do not hold any more.
    triangles: Vec<[u32; 3]>,
    values: Vec<Constants>,
    share: f64,
    /// No other constants have the same number.
    number: u64,
}

/// Whether terms have to be equipped: if none has constants, they are what they are.
#[inline]
pub fn need_constants(terms: &[Term]) -> bool {
    terms.iter().any(|term| term.potential.constants(term).is_some())
}

impl Workshop {
    /// Terms with their constants on a mesh, of which `generation` changes with the connectivity.
    ///
    /// # Errors
    /// A triangle that has no shape at rest; names it.
    pub fn equip<'a>(
        &'a mut self,
        mesh: &Triangulation,
        generation: u64,
        terms: &[Term<'a>],
    ) -> Result<Equipped<'a>> {
        for term in terms {
            if let Some(made_of) = term.potential.constants(term) {
                self.make(mesh, generation, term, made_of)?;
            }
        }
        Ok(terms.iter().map(|term| Term { constants: self.find(term), ..*term }).collect())
    }

    fn make(
        &mut self,
        mesh: &Triangulation,
        generation: u64,
        term: &Term,
        made_of: MadeOf,
    ) -> Result<()> {
        let (potential, version) = (term.potential.name(), term.numbers.version);
        debug_assert!(term.numbers.owner != 0, "{potential}: who has the numbers?");
        let place = self.all.iter().position(|made| made.is_of(term)).unwrap_or_else(|| {
            let owner = term.numbers.owner;
            self.all.push(Made { potential, owner, ..Made::default() });
            self.all.len() - 1
        });
        let made = &mut self.all[place];
        if made.version != version {
            made.triangles.clear();
        }
        if made.triangles.is_empty() || made.generation != generation {
            made.fill(mesh, term, made_of)?;
            (made.version, made.generation) = (version, generation);
        }
        Ok(())
    }

    fn find(&self, term: &Term) -> TriangleConstants<'_> {
        match self.all.iter().find(|made| made.is_of(term)) {
            Some(made) => {
                let Made { values, share, number, .. } = made;
                TriangleConstants { values, share: *share, version: *number }
            }
            None => TriangleConstants::default(),
        }
    }
}

impl Made {
    fn is_of(&self, term: &Term) -> bool {
        self.owner == term.numbers.owner && self.potential == term.potential.name()
    }

    /// Of other corners only, since the same ones have the same constants: no flip changes which edges and vertices are
    /// borders, nor what all triangles share.
    fn fill(&mut self, mesh: &Triangulation, term: &Term, made_of: MadeOf) -> Result<()> {
        static LAST: AtomicU64 = AtomicU64::new(0);
        // If this fails, nothing is known.
        let mut known = std::mem::take(&mut self.triangles);
        self.values.resize(mesh.triangles().len(), [0.0; CONSTANTS]);
        self.share = made_of.share(term, mesh);
        for (triangle, vertices) in mesh.triangles().iter().enumerate() {
            if known.get(triangle) == Some(vertices) {
                continue;
            }
            let corners = Corners {
                vertices: *vertices,
                are_outer: vertices.map(|vertex| mesh.is_border(vertex)),
                on_border: mesh.twins()[triangle].map(|twin| twin == NONE),
            };
            self.values[triangle] = made_of
                .constants(term, &corners, self.share)
                .map_err(|flaw| named(flaw, mesh, term, triangle))?;
        }
        known.clear();
        known.extend_from_slice(mesh.triangles());
        self.triangles = known;
        self.number = LAST.fetch_add(1, Ordering::Relaxed) + 1;
        Ok(())
    }
}

/// What is wrong with a triangle of a reference.
fn named(flaw: Flaw, mesh: &Triangulation, term: &Term, triangle: usize) -> Error {
    let (force, corners) = (term.potential.name(), mesh.particles_of(triangle));
    match flaw {
        Flaw::Flat => Error::FlatReference { force, triangle, corners },
        Flaw::Long { side, length } => Error::LongReference {
            force,
            edge: [corners[side], corners[(side + 1) % 3]],
            length,
            limit: term.numbers.cell.as_ref().map_or(0.0, Cell::half_width),
        },
    }
}
