//! The outer list, from spheres in boxes.

use super::closest::difference;
use super::grid::bounds;
use super::inner::INNER;
use super::lists::{Cost, Far, Lists, Made, Pair, Scratch, ascending, lowest_first};
use super::rough::Rough;
use super::spheres::{Search, Sphere};
use crate::error::{Error, Result};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::next;
use crate::mesh::{Cell, Triangulation};
use crate::team::{Parts, Team};

/// The outer skin in mean edges: at first, at least and at most.
const OUTER: [f64; 3] = [0.4, 0.1, 1.0];

/// What it costs to make the outer list, by triangle or edge, in looks at a pair.
const MAKING: f64 = 10.0;

impl Lists {
    /// Make the outer list of the present positions.
    pub(super) fn make(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        (reach, between_parts): (f64, bool),
        team: &mut Team,
    ) -> Result<Made> {
        self.outer.clone_from(&self.positions);
        self.moved.clear();
        self.moved.resize(self.outer.len(), 0.0);
        self.triangles.clear();
        self.triangles.extend_from_slice(mesh.triangles());
        if !between_parts {
            self.parts.clear();
        } else if self.parts.is_empty() {
            self.parts = mesh.parts();
        }
        let mut all = std::mem::take(&mut self.all);
        all.clear();
        all.extend(mesh.edges().map(|half| {
            let ends = ascending(mesh.origin(half), mesh.origin(next(half)));
            Sphere::of_edge(cell, &self.outer, ends, self.part(ends[0]))
        }));
        let (mut total, mut largest) = (0.0, 0.0_f64);
        for edge in &all {
            (total, largest) = (total + 2.0 * edge.radius(), largest.max(edge.radius()));
        }
        let mean = total / all.len() as f64;
        if let Some([outer, _]) = &mut self.shares {
            let elements = (all.len() + self.triangles.len()) as f64;
            let spent = self.cost.all + self.cost.looking + self.cost.choosing;
            *outer *= if MAKING * elements > spent { 1.25 } else { 0.8 };
            *outer = outer.clamp(OUTER[1], OUTER[2]);
        }
        let [outer, inner] = *self.shares.get_or_insert([OUTER[0], INNER[0]]);
        self.cost = Cost::default();
        let mut outer_skin = outer * mean.max(0.5 * reach);
        if let Some(cell) = cell {
            // A triangle is not farther around its middle than its longest edge.
            let room = cell.half_width() - reach - 3.0 * largest;
            if room <= 0.0 {
                return Err(Error::Contract(format!(
                    "the repulsion reaches {reach} nm, which with the size of a triangle is more than half of the periodic \
                     box; make the distance smaller or the box larger"
                )));
            }
            outer_skin = outer_skin.min(room);
        }
        let range = reach + outer_skin;
        let neighbours = self.neighbours(cell, range);
        neighbours.retain(&mut all, range);
        self.edges.fill(cell, range + 1.5 * mean, &all);
        all.clear();
        let numbers = 0..self.outer.len() as u32;
        all.extend(numbers.map(|v| Sphere::of_vertex(&self.outer, v, self.part(v))));
        neighbours.retain(&mut all, range);
        self.vertices.fill(cell, range + mean, &all);
        self.all = all;
        let (fingerprint, inner_skin) = (mesh.fingerprint(), inner * outer_skin);
        let cell = cell.copied();
        let made = Made { reach, between_parts, cell, fingerprint, outer_skin, inner_skin, mean };
        self.find_pairs(&made, team);
        Ok(made)
    }

    fn find_pairs(&mut self, made: &Made, team: &mut Team) {
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.resize_with(team.size().max(scratch.len()), Default::default);
        let places = Parts::new(&mut scratch);
        let (this, size) = (&*self, team.size());
        // Those of a box one after another.
        let boxes =
            self.triangles.iter().map(|[a, ..]| self.vertices.home(&self.outer[*a as usize]));
        let mut order: Vec<(usize, u32)> = boxes.zip(0..).collect();
        order.sort_unstable();
        team.run(|member| {
            // SAFETY: each member has its own place.
            let Scratch { far: [vertices, edges], search, .. } =
                &mut unsafe { places.part(member.index()..member.index() + 1) }[0];
            vertices.clear();
            edges.clear();
            let triangles = order[member.share(order.len())].iter();
            let corners = triangles.map(|(_, index)| this.triangles[*index as usize]);
            this.pair_triangles(made, corners.map(lowest_first), search, vertices);
            this.pair_edges(made, member.share(this.edges.len()), search, edges);
        });
        for (kind, far) in self.far.iter_mut().enumerate() {
            far.clear();
            scratch[..size].iter().for_each(|found| far.extend_from_slice(&found.far[kind]));
        }
        self.scratch = scratch;
    }

    /// Add the pairs of triangles and vertices at the outer reference.
    pub(super) fn pair_triangles(
        &self,
        made: &Made,
        triangles: impl Iterator<Item = [u32; 3]>,
        search: &mut Search,
        pairs: &mut Vec<Far>,
    ) {
        let (cell, range) = (made.cell.as_ref(), made.reach + made.outer_skin);
        let (most, slack) = limits(range, self.vertices.slack());
        let mut rough = Rough::<Pair, false>::new([0; 4]);
        let mut note = |pair, least| pairs.push(Far { pair, distance: least - slack });
        search.forget();
        for corners in triangles {
            let (points, middle, radius) = triangle_sphere(cell, &self.outer, corners);
            let part = self.own_part(corners[0]);
            let middle_here = self.vertices.find((&middle, radius), range, corners, part, search);
            let single = |way: Vec3| -> [f32; 3] { way.map(|x| x as f32).into() };
            let from_a = single(middle - points[0]);
            let sides = [single(points[1] - points[0]), single(points[2] - points[0])];
            for place in &search.found {
                let [vertex, _] = self.vertices.ends(*place as usize);
                let at = self.vertices.middle(*place as usize);
                let way = self.vertices.between(middle_here, at);
                let point = [0, 1, 2].map(|k| way[k] + from_a[k]);
                let [a, b, c] = corners;
                rough.push([vertex, a, b, c], [point, sides[0], sides[1]], most, &mut note);
            }
        }
        rough.find(most, note);
    }

    /// Add the pairs of edges at some places with smaller ones at the outer reference.
    fn pair_edges(
        &self,
        made: &Made,
        places: std::ops::Range<usize>,
        search: &mut Search,
        pairs: &mut Vec<Far>,
    ) {
        let range = made.reach + made.outer_skin;
        let (most, slack) = limits(range, self.edges.slack());
        let mut rough = Rough::<Pair, true>::new([0; 4]);
        let mut note = |pair, least| pairs.push(Far { pair, distance: least - slack });
        search.forget();
        for place in places {
            self.edges.find_smaller(place, range, made.between_parts, search);
            let one = self.edges.edge(place);
            for other in &search.found {
                let other = self.edges.edge(*other as usize);
                let arms = self.edges.arms(&one, &other);
                rough.push(both(one.ends, other.ends), arms, most, &mut note);
            }
        }
        rough.find(most, note);
    }

    /// Which parts may be near which; none unless that matters, and in a periodic box, whose parts may lie across its faces.
    fn neighbours(&self, cell: Option<&Cell>, range: f64) -> Neighbours {
        if self.parts.is_empty() || cell.is_some() {
            return Neighbours::default();
        }
        let count = self.parts.iter().max().map_or(0, |last| *last as usize + 1);
        let mut bricks = vec![bounds([]); count];
        for (position, part) in self.outer.iter().zip(&self.parts) {
            let [low, high] = &mut bricks[*part as usize];
            (*low, *high) = (low.inf(position), high.sup(position));
        }
        let of = |one: usize| {
            let others = (0..count).filter(move |other| *other != one);
            others.filter(|other| are_near(&bricks[one], &bricks[*other], range)).collect()
        };
        let others = (0..count).map(of).collect();
        Neighbours { bricks, others }
    }
}

/// The bricks around parts, and which others each may be near.
#[derive(Default)]
struct Neighbours {
    bricks: Vec<[Vec3; 2]>,
    others: Vec<Vec<usize>>,
}

impl Neighbours {
    /// Leave out what is farther than `range` from the bricks around all other parts.
    fn retain(&self, all: &mut Vec<Sphere>, range: f64) {
        if self.bricks.is_empty() {
            return;
        }
        all.retain(|sphere| {
            let (point, range) = ([sphere.middle; 2], range + sphere.radius());
            let others = &self.others[sphere.part as usize];
            others.iter().any(|other| are_near(&point, &self.bricks[*other], range))
        });
    }
}

fn are_near([a, b]: &[Vec3; 2], [c, d]: &[Vec3; 2], range: f64) -> bool {
    (0..3).all(|k| a[k] - range < d[k] && c[k] - range < b[k])
}

/// What a least distance may be if positions are off by some slack, and the slack.
pub fn limits(range: f64, slack: f64) -> (f32, f32) {
    let more = 1.0 + 1e-6;
    ((range + slack) as f32 * more, slack as f32 * more)
}

/// Two edges, the lower one first.
#[inline]
pub fn both(one: [u32; 2], other: [u32; 2]) -> Pair {
    let [[a, b], [c, d]] = if one < other { [one, other] } else { [other, one] };
    [a, b, c, d]
}

/// The corners of a triangle as one piece, its middle and how far they are from it.
pub fn triangle_sphere(
    cell: Option<&Cell>,
    positions: &[Vec3],
    corners: [u32; 3],
) -> ([Vec3; 3], Vec3, f64) {
    let [a, b, c] = corners.map(|corner| &positions[corner as usize]);
    let points = [*a, a + difference(cell, b, a), a + difference(cell, c, a)];
    let middle = (points[0] + points[1] + points[2]) / 3.0;
    let radius = points.iter().fold(0.0, |most: f64, p| most.max((p - middle).norm_squared()));
    (points, middle, radius.sqrt())
}
