//! The inner list, which is chosen from the outer one.

use super::lists::{Far, Lists, Made, Pair, Scratch, usual};
use super::rough::Rough;
use crate::mesh::Cell;
use crate::mesh::closest::{Arms, edge_arms};
use crate::mesh::geometry::Vec3;
use crate::team::{Parts, Team};

/// How far vertices may stray in the inner list, as a share of how far they may in the outer one: at first, at least and at
/// most.
pub const INNER: [f64; 3] = [0.2, 0.02, 0.6];

/// The cost of deciding whether a pair of the outer list goes into the inner one; an evaluation of a pair costs 1.
const CHOOSING: f64 = 0.15;

impl Lists {
    /// Let vertices stray farther in the inner list if making it has cost more than looking through it, else less far.
    pub(super) fn adapt_inner(&mut self) {
        let (looking, choosing) = (self.cost.looking, self.cost.choosing);
        self.cost.all += looking + choosing;
        (self.cost.looking, self.cost.choosing) = (0.0, 0.0);
        self.lives[1] = usual(self.lives[1], self.since);
        if let Some([_, inner]) = &mut self.shares {
            *inner *= if choosing > looking { 1.25 } else { 0.8 };
            *inner = inner.clamp(INNER[1], INNER[2]);
        }
    }

    /// Make the inner list of the outer one.
    pub(super) fn choose(&mut self, made: &Made, team: &mut Team) {
        let [outer, inner] = self.shares.unwrap_or_default();
        let room = outer * made.size;
        let (last, life) = ((&self.last[..], self.since), self.lives[1]);
        self.inner.aim(&self.positions, last, life, (inner * room, room));
        self.last.clone_from(&self.positions);
        self.since = 0;
        self.moved.clear();
        let references = self.inner.middles.iter().zip(&self.outer.middles);
        let pairs = references.zip(&self.inner.rooms);
        self.moved.extend(pairs.map(|((inner, outer), room)| {
            // A little more, for what is lost in rounding.
            ((inner - outer).norm() as f32 + room) * (1.0 + 1e-6)
        }));
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.resize_with(team.size().max(scratch.len()), Default::default);
        let places = Parts::new(&mut scratch);
        let (this, size) = (&*self, team.size());
        team.run(|member| {
            // SAFETY: each member has its own place.
            let Scratch { near: [vertices, edges], .. } =
                &mut unsafe { places.part(member.index()..member.index() + 1) }[0];
            vertices.clear();
            edges.clear();
            let [of_vertices, of_edges] = &this.far;
            let of_vertices = &of_vertices[member.share(of_vertices.len())];
            this.choose_some::<false>(made, of_vertices, vertices);
            let of_edges = &of_edges[member.share(of_edges.len())];
            this.choose_some::<true>(made, of_edges, edges);
        });
        for (kind, near) in self.near.iter_mut().enumerate() {
            near.clear();
            scratch[..size].iter().for_each(|found| near.extend_from_slice(&found.near[kind]));
            sort(near);
        }
        self.scratch = scratch;
        self.cost.choosing = CHOOSING * (self.far[0].len() + self.far[1].len()) as f64;
    }

    /// Add pairs that may be near at the inner reference.
    pub(super) fn choose_some<const EDGES: bool>(
        &self,
        made: &Made,
        all: &[Far],
        near: &mut Vec<Pair>,
    ) {
        let reach = made.reach as f32 * (1.0 + 1e-6);
        let cell = made.cell.as_ref();
        let mut rough = Rough::<_, EDGES>::new([0; 4]);
        for Far { pair, distance } in all {
            // A pair cannot have come nearer by more than its vertices have moved.
            if *distance <= reach + sum_of::<EDGES>(&self.moved, pair) {
                let arms = arms::<EDGES>(cell, &self.inner.middles, *pair);
                let single = arms.map(|arm| arm.map(|x| x as f32).into());
                let most = reach + sum_of::<EDGES>(&self.inner.rooms, pair) * (1.0 + 1e-6);
                rough.push(*pair, single, most, |pair, _| near.push(pair));
            }
        }
        rough.find(|pair, _| near.push(pair));
    }
}

/// The largest value at the vertices of one of the pair, plus the largest at those of the other.
#[inline(always)]
pub fn sum_of<const EDGES: bool>(values: &[f32], pair: &Pair) -> f32 {
    let [a, b, c, d] = pair.map(|vertex| values[vertex as usize]);
    if EDGES { a.max(b) + c.max(d) } else { a + b.max(c).max(d) }
}

/// Sort pairs in ascending order.
pub fn sort(pairs: &mut [Pair]) {
    pairs.sort_unstable_by_key(|pair| {
        pair.iter().fold(0_u128, |key, vertex| key << 32 | u128::from(*vertex))
    });
}

/// The vectors of a pair: from the first vertex of the second partner to that of the first, and along the sides.
#[inline]
pub fn arms<const EDGES: bool>(cell: Option<&Cell>, positions: &[Vec3], pair: Pair) -> [Vec3; 3] {
    let [p, a, b, c] = pair.map(|vertex| &positions[vertex as usize]);
    if EDGES {
        return edge_arms(cell, [p, a], [b, c]);
    }
    let Arms { point, sides: [u, v] } = Arms::new(cell, p, [a, b, c]);
    [point, u, v]
}
