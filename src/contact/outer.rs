//! The outer list, from spheres in boxes.

use super::grid::bounds;
use super::inner::INNER;
use super::lists::{Cost, Far, Lists, Made, Pair, Scratch, ascending, lowest_first, usual};
use super::rough::Rough;
use super::spheres::{ROUNDING, Search, Sphere};
use crate::error::{Error, Result};
use crate::mesh::closest::{difference, in_one_piece};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::next;
use crate::mesh::{Cell, Triangulation};
use crate::team::{Parts, Team};

/// How far vertices may stray, in median edges: at first, at least and at most.
const OUTER: [f64; 3] = [0.1, 0.03, 0.5];

/// The longest way that vertices are expected to go, in median edges.
const LONGEST: f64 = 0.5;

/// The largest extent of a surface, nm: squares of distances are numbers in single precision.
const FARTHEST: f64 = 1e15;

/// The cost of making the outer list, for each triangle or edge; an evaluation of a pair costs 1.
const MAKING: f64 = 4.0;

impl Lists {
    /// Make the outer list of the present positions.
    pub(super) fn make(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        (reach, between_parts): (f64, bool),
        team: &mut Team,
    ) -> Result<Made> {
        self.triangles.clear();
        self.triangles.extend_from_slice(mesh.triangles());
        if !between_parts {
            self.parts.clear();
        } else if self.parts.is_empty() {
            self.parts = mesh.parts();
        }
        let ends = |half| ascending(mesh.origin(half), mesh.origin(next(half)));
        let length = |[a, b]: [u32; 2]| {
            let [a, b] = [a, b].map(|end| &self.positions[end as usize]);
            difference(cell, b, a).norm()
        };
        let lengths = || mesh.edges().map(ends).map(length);
        let largest = lengths().fold(0.0, f64::max);
        // The mean would be as long as the edges of a vertex that has flown away.
        let median = median(lengths());
        // Where edges are short, half of the reach is the length to go by.
        let mut size = median.max(0.5 * reach);
        if cell.is_none() {
            self.check_extent(mesh, size)?;
        }
        if let Some([outer, _]) = &mut self.shares {
            let elements = (mesh.num_edges() + self.triangles.len()) as f64;
            let spent = self.cost.all + self.cost.looking + self.cost.choosing;
            *outer *= if MAKING * elements > spent { 1.25 } else { 0.8 };
            *outer = outer.clamp(OUTER[1], OUTER[2]);
            self.lives[0] = usual(self.lives[0], self.age);
        }
        self.age = 0;
        let [outer, _] = *self.shares.get_or_insert([OUTER[0], INNER[0]]);
        self.cost = Cost::default();
        if let Some(cell) = cell {
            // A triangle lies within its longest edge around its middle.
            let room = cell.half_width() - reach - 1.5 * largest;
            if room <= 0.0 {
                return Err(Error::Contract(format!(
                    "the repulsion reaches {reach} nm, which with the size of a triangle is more than half of the periodic \
                     box; make the distance smaller or the box larger"
                )));
            }
            // An edge may be longer by twice the way of its ends.
            size = size.min(room / (4.0 * (OUTER[2] + 2.0 * LONGEST)));
        }
        let (last, life) = ((&self.last[..], self.since), self.lives[0]);
        self.outer.aim(&self.positions, last, life, (outer * size, LONGEST * size));
        let room = self.outer.largest();
        let range = reach + 2.0 * room;
        let neighbours = self.neighbours(cell, range);
        let mut all = std::mem::take(&mut self.all);
        all.clear();
        all.extend(mesh.edges().map(|half| self.edge_sphere(cell, ends(half))));
        neighbours.retain(&mut all, reach + room);
        self.edges.fill(cell, range + 1.5 * median, &all);
        all.clear();
        all.extend((0..self.positions.len() as u32).map(|vertex| {
            let room = self.outer.rooms[vertex as usize];
            Sphere::of_vertex(&self.outer.middles, vertex, self.part(vertex), room)
        }));
        neighbours.retain(&mut all, reach + room);
        self.vertices.fill(cell, range + median, &all);
        self.all = all;
        let (cell, fingerprint) = (cell.copied(), mesh.fingerprint());
        let made = Made { reach, between_parts, cell, fingerprint, size, median };
        self.find_pairs(&made, team);
        Ok(made)
    }

    /// Refuse what has flown away: where rounding in single precision is no longer small beside a size, all is near to all.
    fn check_extent(&self, mesh: &Triangulation, size: f64) -> Result<()> {
        let [low, high] = bounds(&self.positions);
        let extent = (high - low).norm();
        if extent < FARTHEST && ROUNDING * extent < size {
            return Ok(());
        }
        let middle = Vec3::from([0, 1, 2].map(|k| median(self.positions.iter().map(|at| at[k]))));
        let far = |vertex: &usize| (self.positions[*vertex] - middle).amax();
        let farther = |one: &usize, other: &usize| far(one).total_cmp(&far(other));
        let vertex = (0..self.positions.len()).max_by(farther).unwrap_or(0);
        let position = self.positions[vertex].into();
        Err(Error::LostPosition { particle: mesh.particles()[vertex], position })
    }

    /// An edge at the outer reference.
    pub(super) fn edge_sphere(&self, cell: Option<&Cell>, ends: [u32; 2]) -> Sphere {
        let room = self.outer.room_of(ends);
        Sphere::of_edge(cell, &self.outer.middles, ends, self.part(ends[0]), room)
    }

    fn find_pairs(&mut self, made: &Made, team: &mut Team) {
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.resize_with(team.size().max(scratch.len()), Default::default);
        let places = Parts::new(&mut scratch);
        let (this, size) = (&*self, team.size());
        // Those of a box one after another.
        let boxes = self
            .triangles
            .iter()
            .map(|[a, ..]| self.vertices.home(&self.outer.middles[*a as usize]));
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
        let cell = made.cell.as_ref();
        let (reach, slack) = limits(made.reach, self.vertices.slack());
        let mut rough = Rough::<Pair, false>::new([0; 4]);
        let mut note = |pair, least| pairs.push(Far { pair, distance: least - slack });
        search.forget();
        for corners in triangles {
            let (points, middle, radius) = triangle_sphere(cell, &self.outer.middles, corners);
            let [a, b, c] = corners;
            let room = self.outer.room_of([a, b]).max(self.outer.room_of([b, c]));
            let around = (&middle, radius + f64::from(room));
            let part = self.own_part(corners[0]);
            let middle_here = self.vertices.find(around, made.reach, corners, part, search);
            let single = |way: Vec3| -> [f32; 3] { way.map(|x| x as f32).into() };
            let from_a = single(middle - points[0]);
            let sides = [single(points[1] - points[0]), single(points[2] - points[0])];
            for place in &search.found {
                let [vertex, _] = self.vertices.ends(*place as usize);
                let at = self.vertices.middle(*place as usize);
                let way = self.vertices.between(middle_here, at);
                let point = [0, 1, 2].map(|k| way[k] + from_a[k]);
                let most = reach + room + self.outer.rooms[vertex as usize];
                rough.push([vertex, a, b, c], [point, sides[0], sides[1]], most, &mut note);
            }
        }
        rough.find(note);
    }

    /// Add the pairs of edges at some places with smaller ones at the outer reference.
    fn pair_edges(
        &self,
        made: &Made,
        places: std::ops::Range<usize>,
        search: &mut Search,
        pairs: &mut Vec<Far>,
    ) {
        let (reach, slack) = limits(made.reach, self.edges.slack());
        let mut rough = Rough::<Pair, true>::new([0; 4]);
        let mut note = |pair, least| pairs.push(Far { pair, distance: least - slack });
        search.forget();
        for place in places {
            self.edges.find_smaller(place, made.reach, made.between_parts, search);
            let one = self.edges.edge(place);
            let room = reach + self.outer.room_of(one.ends);
            for other in &search.found {
                let other = self.edges.edge(*other as usize);
                let arms = self.edges.arms(&one, &other);
                let most = room + self.outer.room_of(other.ends);
                rough.push(both(one.ends, other.ends), arms, most, &mut note);
            }
        }
        rough.find(note);
    }

    /// Which parts may be near which; none where that does not matter, and in a periodic box, where parts may lie across the
    /// faces.
    fn neighbours(&self, cell: Option<&Cell>, range: f64) -> Neighbours {
        if self.parts.is_empty() || cell.is_some() {
            return Neighbours::default();
        }
        let count = self.parts.iter().max().map_or(0, |last| *last as usize + 1);
        let mut bricks = vec![bounds([]); count];
        for (position, part) in self.outer.middles.iter().zip(&self.parts) {
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

/// The median of some numbers, one at least.
fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = numbers.collect();
    let middle = all.len() / 2;
    *all.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn are_near([a, b]: &[Vec3; 2], [c, d]: &[Vec3; 2], range: f64) -> bool {
    (0..3).all(|k| a[k] - range < d[k] && c[k] - range < b[k])
}

/// The least distance that is left if positions are off by some slack, and the slack.
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
    let points = in_one_piece(cell, corners.map(|corner| &positions[corner as usize]));
    let middle = (points[0] + points[1] + points[2]) / 3.0;
    let radius = points.iter().fold(0.0, |most: f64, p| most.max((p - middle).norm_squared()));
    (points, middle, radius.sqrt())
}
