//! Exchanges between neighbours: Monte Carlo moves of what the vertices are, at fixed positions and connectivity.
//!
//! Vertices have values of their own, such as rigidities and the number of a domain. An edge is chosen uniformly among
//! all, and its ends exchange all these values with probability min(1, exp(−ΔE / kT)) (N. Metropolis et al.,
//! doi:10.1063/1.1699114), or, without a bath, if a demon can pay for it (M. Creutz, doi:10.1103/PhysRevLett.50.1411).
//! The way back begins with the same edge, so proposals are symmetric. Where both ends are alike there is nothing to
//! exchange. So the composition never changes, and domains diffuse: K. Kawasaki, doi:10.1103/PhysRev.145.224; on
//! membranes P. B. S. Kumar, G. Gompper, R. Lipowsky, doi:10.1103/PhysRevLett.86.3911.
//!
//! The geometry stays, so that ΔE comes of the two vertices and of those triangles around them that have constants of
//! domains. In a round no value is moved: it is noted whose values each vertex has, and formulas are asked for the
//! energy of a vertex with the values of another.

use super::draws::{BLOCK, Draw, draw};
use super::local::LocalEnergy;
use super::records::{SwapRules, SwapState};
use crate::mesh::geometry::TriangleGeometry;
use crate::mesh::triangulation::next;
use crate::mesh::{NONE, Triangulation};
use crate::potentials::{Common, Constants, Corners, MadeOf, Needs, Term, Triangles, Vertices};
use smallvec::SmallVec;

/// So many attempts one after the other, by some rules.
pub struct SwapRound<'a> {
    /// How they are accepted.
    pub rules: &'a SwapRules,
    /// How many there are.
    pub attempts: u64,
    /// What they go on from, and leave.
    pub state: &'a mut SwapState,
    /// A number for each vertex, the same for those whose values are.
    pub kinds: &'a [u32],
    /// For each vertex the one whose values it has: every one its own when the terms' values are what they say.
    pub sources: &'a mut [u32],
}

/// What depends on the kinds of vertices, of some terms.
struct Kinds<'a, 't> {
    mesh: &'a Triangulation,
    local: &'a LocalEnergy,
    /// The terms with values of vertices,
    of_vertices: SmallVec<[&'a Term<'t>; 8]>,
    /// and those whose constants of triangles come of domains.
    of_triangles: SmallVec<[(&'a Term<'t>, MadeOf); 4]>,
    /// The triangles around an edge,
    ids: Vec<u32>,
    geometry: Vec<TriangleGeometry>,
    /// and room for what is asked of them.
    constants: Vec<Constants>,
    energies: Vec<f64>,
    ring: Vec<u32>,
}

impl<'a, 't> Kinds<'a, 't> {
    fn new(mesh: &'a Triangulation, local: &'a LocalEnergy, terms: &'a [Term<'t>]) -> Self {
        let has_values = |term: &&Term| {
            term.potential.needs(term).contains(Needs::VERTICES)
                && (0..term.fields.len()).any(|parameter| term.is_of_vertices(parameter))
        };
        let made_of = |term: &'a Term<'t>| {
            let made_of = term.potential.constants(term).filter(|it| it.is_of_kinds())?;
            Some((term, made_of))
        };
        Self {
            mesh,
            local,
            of_vertices: terms.iter().filter(has_values).collect(),
            of_triangles: terms.iter().filter_map(made_of).collect(),
            ids: Vec::new(),
            geometry: Vec::new(),
            constants: Vec::new(),
            energies: Vec::new(),
            ring: Vec::new(),
        }
    }

    /// By how much the energy changes, kJ/mol, if two neighbours exchange what they are. They have done so then.
    fn exchange(&mut self, ends: [u32; 2], sources: &mut [u32]) -> f64 {
        self.gather(ends);
        let before = self.energy(ends, sources);
        sources.swap(ends[0] as usize, ends[1] as usize);
        self.energy(ends, sources) - before
    }

    /// Find the triangles around two neighbours, each once.
    fn gather(&mut self, [one, other]: [u32; 2]) {
        self.ids.clear();
        if self.of_triangles.is_empty() {
            return;
        }
        for vertex in [one, other] {
            self.mesh.ring(vertex, &mut self.ring);
            let triangles = self.ring.iter().map(|half| half / 3);
            let is_new =
                |t: &u32| vertex == one || !self.mesh.triangles()[*t as usize].contains(&one);
            self.ids.extend(triangles.filter(is_new));
        }
        let geometry = |t: &u32| self.local.survey.triangles[*t as usize].geometry;
        self.geometry.clear();
        self.geometry.extend(self.ids.iter().map(geometry));
    }

    /// The energy of what depends on the kinds of two neighbours, kJ/mol, with the values that vertices have now.
    fn energy(&mut self, ends: [u32; 2], sources: &[u32]) -> f64 {
        let of_ends: f64 = ends.iter().map(|end| self.of_vertex(*end, sources)).sum();
        of_ends + self.of_triangles_around(sources)
    }

    fn of_vertex(&self, vertex: u32, sources: &[u32]) -> f64 {
        let survey = &self.local.survey;
        let place = vertex as usize;
        let vectors = if survey.vectors.is_empty() { 0..0 } else { place..place + 1 };
        let mut energies = [0.0];
        for term in &self.of_vertices {
            if self.mesh.is_border(vertex) && !term.potential.acts_at_borders() {
                continue;
            }
            let run = Vertices::Energies {
                total: survey.vertices.len(),
                ids: &sources[place..=place],
                scalars: &[survey.vertices[place].scalars],
                vectors: &survey.vectors[vectors.clone()],
                energies: &mut energies,
            };
            term.potential.vertices(term, run);
        }
        // What triangles share of the whole surface is counted here, and not there.
        let shared = self.of_triangles.iter().map(|(term, made_of)| {
            let source = sources[place] as usize;
            if self.mesh.is_border(vertex) { 0.0 } else { made_of.part(term, source) }
        });
        energies[0] + shared.sum::<f64>()
    }

    /// The energy of the triangles that have been gathered; not a number where one cannot have any.
    fn of_triangles_around(&mut self, sources: &[u32]) -> f64 {
        self.energies.clear();
        self.energies.resize(self.ids.len(), 0.0);
        let none = Common::default();
        for (term, made_of) in &self.of_triangles {
            self.constants.clear();
            for triangle in self.ids.iter().map(|id| *id as usize) {
                let vertices = self.mesh.triangles()[triangle];
                let corners = Corners {
                    vertices: vertices.map(|vertex| sources[vertex as usize]),
                    are_outer: vertices.map(|vertex| self.mesh.is_border(vertex)),
                    on_border: self.mesh.twins()[triangle].map(|twin| twin == NONE),
                };
                match made_of.constants(term, &corners, &none) {
                    Ok(constants) => self.constants.push(constants),
                    Err(_) => return f64::NAN,
                }
            }
            let run = Triangles::Energies {
                ids: &self.ids,
                geometry: &self.geometry,
                constants: &self.constants,
                energies: &mut self.energies,
            };
            term.potential.triangles(term, run);
        }
        self.energies.iter().sum()
    }
}

/// Make a round of attempts. `local` is what [`LocalEnergy::fill`] made of the mesh. Returns how many exchanges were
/// made.
pub fn attempt(mesh: &Triangulation, local: &LocalEnergy, terms: &[Term], round: SwapRound) -> u64 {
    let SwapRound { rules, attempts, state, kinds, sources } = round;
    let edges: Vec<u32> = mesh.edges().collect();
    let mut around = Kinds::new(mesh, local, terms);
    let before = state.accepted;
    let mut draws = [Draw::default(); BLOCK];
    let mut left = attempts;
    while left > 0 {
        let count = left.min(BLOCK as u64) as usize;
        draw(state.key, state.attempts, edges.len(), &mut draws);
        for draw in &draws[..count] {
            state.attempts += 1;
            let half = edges[draw.place as usize];
            let ends = [mesh.origin(half), mesh.origin(next(half))];
            let [one, other] = ends.map(|end| kinds[sources[end as usize] as usize]);
            if one == other {
                state.by_kind += 1;
                continue;
            }
            // exp(−ΔE / kT) is above the random number up to here; the logarithm of 0 sets no limit.
            let limit = match rules.demon {
                0 => -rules.temperature * draw.uniform.ln(),
                _ => state.demon_energy,
            };
            let difference = around.exchange(ends, sources);
            // A difference that is NaN is refused, too.
            if !(difference.is_finite() && difference <= limit) {
                sources.swap(ends[0] as usize, ends[1] as usize);
                state.by_energy += 1;
                continue;
            }
            state.accepted += 1;
            if rules.demon != 0 {
                state.demon_energy -= difference;
            }
        }
        left -= count as u64;
    }
    state.accepted - before
}
