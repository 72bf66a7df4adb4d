//! Bond flips: Monte Carlo moves of the connectivity at fixed positions.
//!
//! The edge ij of two triangles (i, j, k) and (j, i, l) becomes kl. An edge is chosen uniformly among all, with one of
//! two ways to turn it, which decides which triangle keeps which index; the number of edges never changes, so proposals
//! are symmetric. A flip is refused if it would leave a vertex with fewer neighbours than
//! allowed (on a border, one fewer) or give it more, if kl would be too long or exists already, or if a new triangle would have no area:
//! these limit the set of states, and a move out of it is a move that is not made. (An edge that vertices have stretched
//! beyond the longest may still flip, but not come back: at fixed positions it is outside of the set.) Otherwise it is accepted with
//! probability min(1, exp(−ΔE / kT)) (N. Metropolis et al., doi:10.1063/1.1699114), or, without a bath, if a demon can
//! pay for it (M. Creutz, doi:10.1103/PhysRevLett.50.1411). Either leaves the weight of positions, momenta and
//! connectivity in its ensemble unchanged; with a thermostat of the same temperature the joint Boltzmann
//! distribution is sampled. See D. R. Nelson, T. Piran, S. Weinberg (eds.), Statistical Mechanics of Membranes and
//! Surfaces, and G. Gompper, D. M. Kroll, doi:10.1088/0953-8984/9/42/001.

use super::draws::{BLOCK, Draw, draw};
use super::local::{Flipped, LocalEnergy};
use super::records::{FlipRules, FlipState};
use crate::contact::Contacts;
use crate::error::{Error, Result};
use crate::mesh::triangulation::{Quad, Turn};
use crate::mesh::{NONE, Triangulation};
use crate::potentials::Term;
use smallvec::SmallVec;

/// So many attempts one after the other, by some rules.
pub struct Round<'a> {
    /// What they may do.
    pub rules: &'a FlipRules,
    /// How many there are.
    pub attempts: u64,
    /// What they go on from, and leave.
    pub state: &'a mut FlipState,
}

impl FlipRules {
    /// Refuse rules that make no sense, and a mesh that they do not allow.
    ///
    /// # Errors
    /// Names the rule, or the vertex.
    pub fn check(&self, mesh: &Triangulation) -> Result<()> {
        let &Self { temperature, min_degree, max_degree, max_edge_length, .. } = self;
        let refuse = |message: String| Err(Error::Contract(message));
        if !(temperature > 0.0 && temperature.is_finite()) {
            return refuse(format!(
                "kT must be a finite number above zero, got {temperature} kJ/mol"
            ));
        }
        if min_degree < 3 {
            return refuse(format!("minDegree must be 3 or more, got {min_degree}"));
        }
        if max_degree < min_degree {
            return refuse(format!(
                "maxDegree must not be below minDegree, got {max_degree} and {min_degree}"
            ));
        }
        if !(max_edge_length >= 0.0 && max_edge_length.is_finite()) {
            return refuse(format!(
                "maxEdgeLength must be a finite number of nm, or 0 for any length, got {max_edge_length}"
            ));
        }
        let bad = |vertex: &usize| {
            let degree = mesh.degrees()[*vertex];
            degree < self.least(mesh, *vertex as u32) || degree > max_degree as u32
        };
        if let Some(vertex) = (0..mesh.num_vertices()).find(bad) {
            return refuse(format!(
                "particle {} has {} neighbours, but flips are to keep between minDegree = {min_degree} (one fewer at \
                 borders) and maxDegree = {max_degree}; widen these, or start from another mesh",
                mesh.particles()[vertex],
                mesh.degrees()[vertex]
            ));
        }
        Ok(())
    }

    /// The fewest neighbours that a vertex may have.
    #[inline(always)]
    fn least(&self, mesh: &Triangulation, vertex: u32) -> u32 {
        self.min_degree as u32 - u32::from(mesh.is_border(vertex))
    }
}

/// Contacts whose energy counts, ready for flips.
pub struct Touched<'a, 't> {
    /// The contacts,
    pub contacts: &'a mut Contacts,
    /// and what they are evaluated with, among other terms.
    pub terms: &'a [Term<'t>],
    /// Of all particles, nm, one after the other.
    pub positions: &'a [f64],
    /// The mesh that they are of, if it is not the one that flips but has its triangles among its own; it makes the same
    /// flips then.
    pub mesh: Option<&'a mut Triangulation>,
    /// The place of the half-edges there.
    pub first_half: u32,
}

impl Touched<'_, '_> {
    /// The quadrilateral of a half-edge, as these contacts see it.
    fn quad(&self, mesh: &Triangulation, half: u32) -> Quad {
        self.mesh.as_deref().unwrap_or(mesh).quad(half + self.first_half)
    }

    /// The most that a flip can gain, kJ/mol.
    fn most(&mut self, mesh: &Triangulation, half: u32) -> f64 {
        let quad = self.quad(mesh, half);
        let mesh = self.mesh.as_deref().unwrap_or(mesh);
        self.contacts.most(mesh, self.terms, self.positions, &quad)
    }

    /// The energy of all that a flip changes, before it or after it, kJ/mol.
    fn around(&mut self, mesh: &Triangulation, quad: &Quad) -> f64 {
        let mesh = self.mesh.as_deref().unwrap_or(mesh);
        self.contacts.around(mesh, self.terms, self.positions, quad)
    }

    fn flip(&mut self, quad: &Quad, turn: Turn) {
        if let Some(mesh) = &mut self.mesh {
            mesh.flip(quad, turn);
        }
    }
}

/// Flip an edge, on which contacts have a say: unless the energy, of which `difference` is known already, rises above the limit.
/// Returns its change if the flip is made.
// Apart, so that attempts without it stay short.
#[inline(never)]
fn flip_touched(
    mesh: &mut Triangulation,
    touched: &mut [Touched],
    half: u32,
    turn: Turn,
    (difference, limit): (f64, f64),
) -> Option<f64> {
    let quad = mesh.quad(half);
    let mut difference = difference;
    let quads: SmallVec<[Quad; 2]> = touched.iter().map(|one| one.quad(mesh, half)).collect();
    for (one, quad) in touched.iter_mut().zip(&quads) {
        difference -= one.around(mesh, quad);
        one.contacts.follow(quad);
    }
    mesh.flip(&quad, turn);
    let half = Triangulation::flipped(half, turn);
    let mut after: SmallVec<[f64; 2]> = SmallVec::new();
    for (one, quad) in touched.iter_mut().zip(&quads) {
        one.flip(quad, turn);
        let quad = one.quad(mesh, half);
        after.push(one.around(mesh, &quad));
    }
    difference += after.iter().sum::<f64>();
    if difference <= limit {
        for (one, _) in touched.iter_mut().zip(after).filter(|(_, energy)| *energy != 0.0) {
            one.contacts.note_new_pairs();
        }
        return Some(difference);
    }
    let back = turn.other();
    for one in touched {
        let quad = one.quad(mesh, half);
        one.contacts.follow(&quad);
        one.flip(&quad, back);
    }
    mesh.flip(&mesh.quad(half), back);
    None
}

/// Make a round of attempts. `local` is what [`LocalEnergy::fill`] made of the mesh; it is kept current. Returns how
/// many flips were made. Energies of contacts are those of `touched` only.
pub fn attempt(
    mesh: &mut Triangulation,
    local: &mut LocalEnergy,
    terms: &[Term],
    round: Round,
    touched: &mut [Touched],
) -> u64 {
    let Round { rules, attempts, state } = round;
    let half_edges = 3 * mesh.triangles().len();
    let before = state.accepted;
    let mut draws = [Draw::default(); BLOCK];
    let mut flipped = Flipped::default();
    let mut left = attempts;
    while left > 0 {
        let count = left.min(BLOCK as u64) as usize;
        draw(state.key, state.attempts, half_edges, &mut draws);
        for (n, draw) in draws[..count].iter().enumerate() {
            // What later attempts will read is on its way meanwhile; wherever other flips have changed what they
            // will read, this is for nothing, but no more.
            if let Some(later) = draws[..count].get(n + 12) {
                local.fetch_triangle(mesh, later.place);
            }
            if let Some(later) = draws[..count].get(n + 8) {
                local.fetch_quad(mesh, later.place);
            }
            if let Some(later) = draws[..count].get(n + 4) {
                local.fetch_rest(mesh, later.place);
            }
            one(mesh, local, terms, rules, draw, state, &mut flipped, touched);
        }
        left -= count as u64;
    }
    state.accepted - before
}

/// Try one flip.
#[allow(clippy::too_many_arguments, reason = "they are what a round of flips has at hand")]
fn one(
    mesh: &mut Triangulation,
    local: &mut LocalEnergy,
    terms: &[Term],
    rules: &FlipRules,
    draw: &Draw,
    state: &mut FlipState,
    flipped: &mut Flipped,
    touched: &mut [Touched],
) {
    state.attempts += 1;
    if mesh.twin(draw.place) == NONE {
        state.by_border += 1;
        return;
    }
    let quad = mesh.quad(draw.place);
    let [i, j, k, l] = quad.vertices;
    // Either half-edge of an edge stands for one of the two ways to turn it.
    let turn = if draw.place < quad.halves[1] { Turn::Left } else { Turn::Right };
    let degree = |vertex: u32| mesh.degrees()[vertex as usize];
    let (least, most) = (rules.min_degree as u32, rules.max_degree as u32);
    let too_few = match mesh.is_closed() {
        true => degree(i).min(degree(j)) <= least,
        false => [i, j].iter().any(|vertex| degree(*vertex) <= rules.least(mesh, *vertex)),
    };
    if too_few || degree(k).max(degree(l)) >= most {
        state.by_degree += 1;
        return;
    }
    let longest = local.longest(rules.max_edge_length);
    if longest > 0.0 && local.new_length_squared(mesh, &quad) >= longest * longest {
        state.by_length += 1;
        return;
    }
    // exp(−ΔE / kT) is above the random number up to here; the logarithm of 0 sets no limit.
    let limit =
        if rules.demon != 0 { state.demon_energy } else { -rules.temperature * draw.uniform.ln() };
    let gain: f64 = touched.iter_mut().map(|one| one.most(mesh, draw.place)).sum();
    let mut difference = local.flipped(mesh, terms, &quad, turn, limit + gain, flipped);
    if !difference.is_finite() {
        state.by_shape += 1;
        return;
    }
    if difference > limit + gain {
        state.by_energy += 1;
        return;
    }
    if mesh.are_joined(k, l) {
        state.by_edge += 1;
        return;
    }
    if touched.is_empty() {
        mesh.flip(&quad, turn);
    } else if let Some(all) = flip_touched(mesh, touched, draw.place, turn, (difference, limit)) {
        difference = all;
    } else {
        state.by_energy += 1;
        return;
    }
    local.apply(mesh, &quad, flipped);
    state.accepted += 1;
    if rules.demon != 0 {
        state.demon_energy -= difference;
    }
}
