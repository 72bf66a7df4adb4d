//! Bond flips: Monte Carlo moves of the connectivity at fixed positions.
//!
//! The edge ij of two triangles (i, j, k) and (j, i, l) becomes kl. An edge is chosen uniformly among all, with one of
//! two ways to turn it, which decides which triangle keeps which index; the number of edges never changes, so proposals
//! are symmetric. A flip is refused if it would leave a vertex with fewer neighbours than
//! allowed (on a border, one fewer) or give it more, if kl would be too long or exists already, or if a new triangle would have no area: all of
//! these limit the set of states, and a move out of it is a move that is not made. Otherwise it is accepted with
//! probability min(1, exp(−ΔE / kT)) (N. Metropolis et al., doi:10.1063/1.1699114), or, without a bath, if a demon can
//! pay for it (M. Creutz, doi:10.1103/PhysRevLett.50.1411). Either leaves the weight of positions, momenta and
//! connectivity in its ensemble unchanged; with a thermostat of the same temperature the joint Boltzmann
//! distribution is sampled. See D. R. Nelson, T. Piran, S. Weinberg (eds.), Statistical Mechanics of Membranes and
//! Surfaces, and G. Gompper, D. M. Kroll, doi:10.1088/0953-8984/9/42/001.

use super::local::{Flipped, LocalEnergy};
use super::records::{FlipRules, FlipState};
use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::dynamics::random;
use crate::error::{Error, Result};
use crate::mesh::triangulation::Turn;
use crate::mesh::{NONE, Triangulation};
use crate::potentials::Term;

/// Attempts whose random numbers are made together.
const BLOCK: usize = 64;

/// One attempt's random numbers.
#[derive(Clone, Copy, Default)]
pub struct Draw {
    /// The half-edge.
    half: u32,
    /// Uniform in [0, 1).
    uniform: f64,
}

impl FlipState {
    /// The random numbers of the next attempts, for so many half-edges.
    fn draw(&self, half_edges: usize, draws: &mut [Draw; BLOCK]) {
        struct Fill<'a>(&'a FlipState, f64, &'a mut [Draw; BLOCK]);
        impl Kernel for Fill<'_> {
            #[inline(always)]
            fn execute<A: Arithmetic>(self) {
                let Self(state, half_edges, draws) = self;
                for (place, draw) in draws.iter_mut().enumerate() {
                    let [first, second] = random::bits(state.key, state.attempts + place as u64);
                    // Uniform to one part in 2⁵² / (number of half-edges); the product stays below that number.
                    draw.half = ((first >> 12) as f64 / (1u64 << 52) as f64 * half_edges) as u32;
                    draw.uniform = (second >> 11) as f64 / (1u64 << 53) as f64;
                }
            }
        }
        run(Fill(self, half_edges as f64, draws));
    }
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

/// Try to flip so many edges. `local` is what [`LocalEnergy::fill`] made of the mesh; it is kept current. Returns how
/// many flips were made.
pub fn attempt(
    mesh: &mut Triangulation,
    local: &mut LocalEnergy,
    terms: &[Term],
    rules: &FlipRules,
    attempts: u64,
    state: &mut FlipState,
) -> u64 {
    let half_edges = 3 * mesh.triangles().len();
    let before = state.accepted;
    let mut draws = [Draw::default(); BLOCK];
    let mut flipped = Flipped::default();
    let mut left = attempts;
    while left > 0 {
        let count = left.min(BLOCK as u64) as usize;
        state.draw(half_edges, &mut draws);
        for (n, draw) in draws[..count].iter().enumerate() {
            // What later attempts will read is on its way meanwhile; wherever other flips have changed what they
            // will read, this is for nothing, but no more.
            if let Some(later) = draws[..count].get(n + 12) {
                local.fetch_triangle(mesh, later.half);
            }
            if let Some(later) = draws[..count].get(n + 8) {
                local.fetch_quad(mesh, later.half);
            }
            if let Some(later) = draws[..count].get(n + 4) {
                local.fetch_rest(mesh, later.half);
            }
            one(mesh, local, terms, rules, draw, state, &mut flipped);
        }
        left -= count as u64;
    }
    state.accepted - before
}

/// Try one flip.
fn one(
    mesh: &mut Triangulation,
    local: &mut LocalEnergy,
    terms: &[Term],
    rules: &FlipRules,
    draw: &Draw,
    state: &mut FlipState,
    flipped: &mut Flipped,
) {
    state.attempts += 1;
    if mesh.twin(draw.half) == NONE {
        state.by_border += 1;
        return;
    }
    let quad = mesh.quad(draw.half);
    let [i, j, k, l] = quad.vertices;
    // Either half-edge of an edge stands for one of the two ways to turn it.
    let turn = if draw.half < quad.halves[1] { Turn::Left } else { Turn::Right };
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
    let longest = rules.max_edge_length;
    if longest > 0.0 && local.new_length_squared(&quad) > longest * longest {
        state.by_length += 1;
        return;
    }
    // exp(−ΔE / kT) is above the random number up to here; the logarithm of 0 sets no limit.
    let limit =
        if rules.demon != 0 { state.demon_energy } else { -rules.temperature * draw.uniform.ln() };
    let difference = local.flipped(mesh, terms, &quad, turn, limit, flipped);
    if !difference.is_finite() {
        state.by_shape += 1;
        return;
    }
    if difference > limit {
        state.by_energy += 1;
        return;
    }
    if mesh.are_joined(k, l) {
        state.by_edge += 1;
        return;
    }
    mesh.flip(&quad, turn);
    local.apply(mesh, &quad, flipped);
    state.accepted += 1;
    if rules.demon != 0 {
        state.demon_energy -= difference;
    }
}
