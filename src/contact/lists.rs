//! Which vertices may touch which triangles of a surface, and which edges which edges.
//!
//! Two lists, one within the other, have the pairs that were nearer than reach + skin at the positions of a **reference**,
//! but for those that share a vertex. Each is good until a vertex has moved by half of its skin. The outer one has a thick skin
//! and comes from grids; the inner one has a thin skin and comes from the outer one, and is what evaluations look at.
//! Pairs are known by their vertices, and the inner list is in ascending order of these, so that nothing depends
//! on when lists were made. After flips, pairs of what is gone are taken out and those of what is new are added.

use super::block::Block;
use super::closest::{Arms, crossing, difference, edge_arms};
use super::grid::{Grid, bounds};
use crate::error::{Error, Result};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::{Quad, next};
use crate::mesh::{Cell, Triangulation};
use crate::team::{Parts, Team};

/// The outer skin in mean edges: at first, at least and at most.
const OUTER: [f64; 3] = [0.4, 0.1, 1.0];

/// The inner skin as a share of the outer one: at first, at least and at most.
const INNER: [f64; 3] = [0.2, 0.02, 0.6];

/// What it costs to make the outer list, by triangle or edge, in looks at a pair.
const MAKING: f64 = 30.0;

/// After so many flips the edges are sorted into boxes anew.
const MOST_NEW: usize = 200;

/// When more than one in so many triangles is new, lists are made anew.
const FEW: usize = 4;

/// The vertices of a pair: a vertex and the corners of a triangle from the lowest on, or the ends of two edges, the lower end
/// of each and the lower edge first.
pub type Pair = [u32; 4];

/// A pair of the outer list, and the distance at its reference, or less, nm.
#[derive(Clone, Copy)]
struct Far {
    pair: Pair,
    distance: f32,
}

/// Lists for one mesh.
#[derive(Default)]
pub struct Lists {
    made_for: Option<Made>,
    /// All vertices as they are now.
    positions: Vec<Vec3>,
    /// The references of the outer and the inner list.
    outer: Vec<Vec3>,
    inner: Vec<Vec3>,
    /// How far each vertex was from its outer reference at the inner one, nm.
    moved: Vec<f32>,
    /// The outer skin in mean edges, the inner one as a share of it; none before the first lists.
    shares: Option<[f64; 2]>,
    /// The triangles that the lists are of.
    triangles: Vec<[u32; 3]>,
    /// For each vertex the connected part that it is on; empty unless that matters.
    parts: Vec<u32>,
    /// The vertices and the edges of the outer reference; what is near no other part is left out.
    vertices: Spheres,
    edges: Spheres,
    /// Edges that flips have taken away since they were sorted, and that they have made.
    gone: Vec<[u32; 2]>,
    new: Vec<[u32; 2]>,
    /// Of vertices with triangles, and of edges, in any order.
    far: [Vec<Far>; 2],
    /// Those of the inner list, ascending.
    near: [Vec<Pair>; 2],
    /// Kept for their memory, one for each thread.
    scratch: Vec<Scratch>,
    cost: Cost,
}

#[derive(Default)]
struct Scratch {
    far: [Vec<Far>; 2],
    near: [Vec<Pair>; 2],
    found: Vec<u32>,
}

/// Looks at pairs since lists were made.
#[derive(Default)]
struct Cost {
    /// In evaluations with the present inner list.
    looking: f64,
    /// To make the present inner list.
    choosing: f64,
    /// All of both with the present outer list.
    all: f64,
}

/// What lists depend on, beside the reference and the triangles.
#[derive(Clone, Copy)]
struct Made {
    reach: f64,
    between_parts: bool,
    cell: Option<Cell>,
    fingerprint: u64,
    /// nm.
    outer_skin: f64,
    inner_skin: f64,
    /// The mean edge, nm.
    mean: f64,
}

/// Vertices or edges by their middles, sorted into boxes.
#[derive(Default)]
struct Spheres {
    grid: Grid,
    /// In the order of the boxes.
    sorted: Vec<Sphere>,
    /// Before they are sorted.
    all: Vec<Sphere>,
    largest: f64,
}

/// What is around an edge, or a vertex of no size.
#[derive(Clone, Copy)]
struct Sphere {
    middle: Vec3,
    radius: f64,
    /// The ends; a vertex twice.
    ends: [u32; 2],
}

impl Spheres {
    /// Sort what `all` has into boxes.
    fn sort(&mut self, cell: Option<&Cell>, size: f64) {
        let around = bounds(self.all.iter().map(|sphere| &sphere.middle));
        self.grid.set_up(cell, around, size, 8 * self.all.len());
        self.largest = 0.0;
        for (item, sphere) in self.all.iter().enumerate() {
            self.grid.add(item as u32, &sphere.middle);
            self.largest = self.largest.max(sphere.radius);
        }
        self.grid.seal();
        self.sorted.clear();
        self.sorted.extend(self.grid.all_items().iter().map(|item| self.all[*item as usize]));
    }

    /// The places among `sorted` of what is no larger than `largest` and may be nearer than `range` to a sphere.
    #[inline]
    fn near(
        &self,
        cell: Option<&Cell>,
        (middle, radius): (&Vec3, f64),
        range: f64,
        largest: f64,
        found: &mut Vec<u32>,
    ) {
        found.clear();
        let own = range + radius;
        let sizes = [own, largest];
        self.grid.runs(std::slice::from_ref(middle), own + largest, |run| {
            let start = found.len();
            found.resize(start + run.len(), 0);
            let (first, spheres) = (run.start as u32, &self.sorted[run]);
            let into = &mut found[start..];
            let count = match cell {
                None => sift(spheres, sizes, first, into, |at| at - middle),
                Some(_) => sift(spheres, sizes, first, into, |at| difference(cell, at, middle)),
            };
            found.truncate(start + count);
        });
    }
}

/// Put the places of spheres that are near enough into a list; returns how many there are.
#[inline(always)]
fn sift(
    spheres: &[Sphere],
    [own, largest]: [f64; 2],
    first: u32,
    into: &mut [u32],
    from: impl Fn(&Vec3) -> Vec3,
) -> usize {
    let mut count = 0;
    for (place, sphere) in (first..).zip(spheres) {
        let most = own + sphere.radius;
        // Without a branch, as none could be foretold.
        into[count] = place;
        let near = from(&sphere.middle).norm_squared() < most * most;
        count += usize::from(near & (sphere.radius <= largest));
    }
    count
}

impl Lists {
    /// Be good for pairs up to `reach` at some positions of all particles; with `between_parts` only for those of
    /// different parts of the surface.
    ///
    /// # Errors
    /// A position that is not finite; a box that is too small.
    pub fn refresh(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        positions: &[f64],
        (reach, between_parts): (f64, bool),
        team: &mut Team,
    ) -> Result<()> {
        let at =
            |particle: &u32| Vec3::from_column_slice(&positions[3 * *particle as usize..][..3]);
        self.positions.clear();
        self.positions.extend(mesh.particles().iter().map(at));
        // Lists of a longer reach are good, too: force groups may take turns.
        let good = self.made_for.filter(|made| {
            made.reach >= reach && made.between_parts <= between_parts && made.cell.as_ref() == cell
        });
        if let Some(mut made) = good
            && self.is_within(&self.outer, made.outer_skin)
        {
            let few = made.fingerprint == mesh.fingerprint() || self.follow_flips(mesh, &made);
            if few {
                made.fingerprint = mesh.fingerprint();
                if !self.is_within(&self.inner, made.inner_skin) {
                    self.adapt_inner(&mut made);
                    self.choose(&made, team);
                }
                self.made_for = Some(made);
                self.cost.looking += self.work() as f64;
                return Ok(());
            }
        }
        self.made_for = None;
        for (position, particle) in self.positions.iter().zip(mesh.particles()) {
            if !position.iter().all(|x| x.is_finite()) {
                let (particle, position) = (*particle, (*position).into());
                return Err(Error::NonFinitePosition { particle, position });
            }
        }
        let made = self.make(mesh, cell, (reach, between_parts), team)?;
        self.made_for = Some(made);
        self.choose(&made, team);
        self.cost.looking = self.work() as f64;
        Ok(())
    }

    /// Know nothing.
    pub fn forget(&mut self) {
        self.made_for = None;
    }

    /// All vertices at the last refresh.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Pairs of a vertex and a triangle, and of edges, that may be within reach.
    pub fn pairs(&self) -> &[Vec<Pair>; 2] {
        &self.near
    }

    /// How many pairs that are.
    pub fn work(&self) -> usize {
        self.near[0].len() + self.near[1].len()
    }

    /// Whether no vertex is farther than half of a skin from where it was.
    fn is_within(&self, reference: &[Vec3], skin: f64) -> bool {
        let farthest =
            self.positions.iter().zip(reference).fold(0.0, |farthest: f64, (now, then)| {
                let moved = (now - then).norm_squared();
                // What is no number counts as far.
                if moved <= farthest { farthest } else { moved }
            });
        farthest < 0.25 * skin * skin
    }

    /// Whether two vertices are on the same part; false unless lists are between parts.
    #[inline]
    fn are_one_part(&self, one: u32, other: u32) -> bool {
        !self.parts.is_empty() && self.parts[one as usize] == self.parts[other as usize]
    }

    /// What costs less from now on than it did.
    fn adapt_inner(&mut self, made: &mut Made) {
        let Cost { looking, choosing, .. } = self.cost;
        self.cost.all += looking + choosing;
        (self.cost.looking, self.cost.choosing) = (0.0, 0.0);
        if let Some([_, inner]) = &mut self.shares {
            *inner *= if choosing > looking { 1.25 } else { 0.8 };
            *inner = inner.clamp(INNER[1], INNER[2]);
            made.inner_skin = *inner * made.outer_skin;
        }
    }

    fn make(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        (reach, between_parts): (f64, bool),
        team: &mut Team,
    ) -> Result<Made> {
        self.outer.clone_from(&self.positions);
        self.triangles.clear();
        self.triangles.extend_from_slice(mesh.triangles());
        if !between_parts {
            self.parts.clear();
        } else if self.parts.is_empty() {
            self.parts = mesh.parts();
        }
        self.collect_edges(mesh, cell);
        let total: f64 = self.edges.all.iter().map(|edge| 2.0 * edge.radius).sum();
        let mean = total / self.edges.all.len() as f64;
        let elements = (self.edges.all.len() + self.triangles.len()) as f64;
        if let Some([outer, _]) = &mut self.shares {
            let all = self.cost.all + self.cost.looking + self.cost.choosing;
            *outer *= if MAKING * elements > all { 1.25 } else { 0.8 };
            *outer = outer.clamp(OUTER[1], OUTER[2]);
        }
        let [outer, inner] = *self.shares.get_or_insert([OUTER[0], INNER[0]]);
        self.cost = Cost::default();
        let mut outer_skin = outer * mean.max(0.5 * reach);
        if let Some(cell) = cell {
            // A triangle is not farther around its middle than its longest edge.
            let largest = self.edges.all.iter().fold(0.0, |most: f64, edge| most.max(edge.radius));
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
        self.leave_out_what_is_far(cell, range);
        self.vertices.sort(cell, range + 0.5 * mean);
        self.edges.sort(cell, range + mean);
        let mut scratch = std::mem::take(&mut self.scratch);
        scratch.resize_with(team.size().max(scratch.len()), Default::default);
        let places = Parts::new(&mut scratch);
        let (this, size) = (&*self, team.size());
        team.run(|member| {
            // SAFETY: each member has its own place.
            let Scratch { far: [vertices, edges], found, .. } =
                &mut unsafe { places.part(member.index()..member.index() + 1) }[0];
            vertices.clear();
            edges.clear();
            let mut block = Block::new([0; 4]);
            for triangle in &this.triangles[member.share(this.triangles.len())] {
                this.pair_triangle(
                    cell,
                    range,
                    lowest_first(*triangle),
                    found,
                    &mut block,
                    vertices,
                );
            }
            note(&mut block, range, vertices);
            let mut block = Block::new([0; 4]);
            for place in member.share(this.edges.sorted.len()) {
                let edge = &this.edges.sorted[place];
                this.edges.near(cell, (&edge.middle, edge.radius), range, edge.radius, found);
                for other in found.iter().map(|other| *other as usize) {
                    let it = &this.edges.sorted[other];
                    // The larger one finds the smaller one.
                    if it.radius < edge.radius || (it.radius == edge.radius && other < place) {
                        this.pair_edges(cell, range, edge.ends, it.ends, &mut block, edges);
                    }
                }
            }
            note(&mut block, range, edges);
        });
        for (kind, far) in self.far.iter_mut().enumerate() {
            far.clear();
            scratch[..size].iter().for_each(|found| far.extend_from_slice(&found.far[kind]));
        }
        self.scratch = scratch;
        let (cell, fingerprint) = (cell.copied(), mesh.fingerprint());
        let inner_skin = inner * outer_skin;
        Ok(Made { reach, between_parts, cell, fingerprint, outer_skin, inner_skin, mean })
    }

    /// All vertices and edges at the outer reference.
    fn collect_edges(&mut self, mesh: &Triangulation, cell: Option<&Cell>) {
        let reference = &self.outer;
        self.vertices.all.clear();
        self.vertices.all.extend(reference.iter().zip(0..).map(|(middle, vertex)| Sphere {
            middle: *middle,
            radius: 0.0,
            ends: [vertex; 2],
        }));
        self.gone.clear();
        self.new.clear();
        let ends = |half| ascending(mesh.origin(half), mesh.origin(next(half)));
        self.edges.all.clear();
        self.edges.all.extend(mesh.edges().map(|half| edge_sphere(cell, reference, ends(half))));
    }

    /// Between parts, what is farther than `range` from the bricks around all other parts has no pairs. In a periodic
    /// box, whose parts may lie across its faces, everything stays.
    fn leave_out_what_is_far(&mut self, cell: Option<&Cell>, range: f64) {
        if self.parts.is_empty() || cell.is_some() {
            return;
        }
        let parts = &self.parts;
        let count = parts.iter().max().map_or(0, |last| *last as usize + 1);
        let mut bricks = vec![bounds([]); count];
        for (position, part) in self.outer.iter().zip(parts) {
            let [low, high] = &mut bricks[*part as usize];
            (*low, *high) = (low.inf(position), high.sup(position));
        }
        let are_near = |[a, b]: &[Vec3; 2], [c, d]: &[Vec3; 2], range: f64| {
            (0..3).all(|k| a[k] - range < d[k] && c[k] - range < b[k])
        };
        let near: Vec<Vec<usize>> = (0..count)
            .map(|one| {
                let others = (0..count).filter(|other| *other != one);
                others.filter(|other| are_near(&bricks[one], &bricks[*other], range)).collect()
            })
            .collect();
        let stays = |sphere: &Sphere| {
            let point = [sphere.middle; 2];
            let others = &near[parts[sphere.ends[0] as usize] as usize];
            others.iter().any(|other| are_near(&point, &bricks[*other], range + sphere.radius))
        };
        self.vertices.all.retain(stays);
        self.edges.all.retain(stays);
    }

    /// The vertices near a triangle at the outer reference.
    fn pair_triangle(
        &self,
        cell: Option<&Cell>,
        range: f64,
        corners: [u32; 3],
        found: &mut Vec<u32>,
        block: &mut Block<Pair, false>,
        pairs: &mut Vec<Far>,
    ) {
        let (points, middle, radius) = triangle_sphere(cell, &self.outer, corners);
        self.vertices.near(cell, (&middle, radius), range, 0.0, found);
        for place in &*found {
            let [vertex, _] = self.vertices.sorted[*place as usize].ends;
            if !corners.contains(&vertex) && !self.are_one_part(vertex, corners[0]) {
                let at = &self.outer[vertex as usize];
                let Arms { point, sides: [u, v] } = Arms::new(cell, at, points.each_ref());
                let [a, b, c] = corners;
                block.push([vertex, a, b, c], &[point, u, v]);
                if block.is_full() {
                    note(block, range, pairs);
                }
            }
        }
    }

    /// Two edges that may be near at the outer reference.
    #[inline]
    fn pair_edges(
        &self,
        cell: Option<&Cell>,
        range: f64,
        one: [u32; 2],
        other: [u32; 2],
        block: &mut Block<Pair, true>,
        pairs: &mut Vec<Far>,
    ) {
        let shared = other.contains(&one[0]) | other.contains(&one[1]);
        if shared || self.are_one_part(one[0], other[0]) {
            return;
        }
        let [[a, b], [c, d]] = if one < other { [one, other] } else { [other, one] };
        let at = |vertex: u32| &self.outer[vertex as usize];
        block.push([a, b, c, d], &edge_arms(cell, [at(a), at(b)], [at(c), at(d)]));
        if block.is_full() {
            note(block, range, pairs);
        }
    }

    /// Make the inner list of the outer one.
    fn choose(&mut self, made: &Made, team: &mut Team) {
        self.inner.clone_from(&self.positions);
        let pairs = self.inner.iter().zip(&self.outer);
        self.moved.clear();
        // A little more, for what is lost in rounding.
        self.moved.extend(pairs.map(|(now, then)| (now - then).norm() as f32 * (1.0 + 1e-6)));
        let range = made.reach + made.inner_skin;
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
            let most = range as f32 * (1.0 + 1e-6);
            // What a pair has lost of its distance is no more than its vertices have moved.
            let of = |kind: usize| {
                let far = &this.far[kind];
                far[member.share(far.len())].iter().filter(move |far| {
                    let [a, b, c, d] = far.pair.map(|vertex| this.moved[vertex as usize]);
                    let lost = if kind == 0 { a + b.max(c).max(d) } else { a.max(b) + c.max(d) };
                    far.distance <= most + lost
                })
            };
            let cell = made.cell.as_ref();
            let mut block = Block::<_, false>::new([0; 4]);
            let mut keep = |pair: Pair, _: [f64; 3], _: [Vec3; 3]| vertices.push(pair);
            for Far { pair, .. } in of(0) {
                block.push(*pair, &arms::<false>(cell, &this.inner, *pair));
                if block.is_full() {
                    block.find(range * range, &mut keep);
                }
            }
            block.find(range * range, &mut keep);
            let mut block = Block::<_, true>::new([0; 4]);
            let mut keep = |pair: Pair, _: [f64; 3], _: [Vec3; 3]| edges.push(pair);
            for Far { pair, .. } in of(1) {
                block.push(*pair, &arms::<true>(cell, &this.inner, *pair));
                if block.is_full() {
                    block.find(range * range, &mut keep);
                }
            }
            block.find(range * range, &mut keep);
        });
        for (kind, near) in self.near.iter_mut().enumerate() {
            near.clear();
            scratch[..size].iter().for_each(|found| near.extend_from_slice(&found.near[kind]));
            near.sort_unstable();
        }
        self.scratch = scratch;
        self.cost.choosing = 0.5 * (self.far[0].len() + self.far[1].len()) as f64;
    }

    /// Have the pairs of other triangles; false if too many are new.
    fn follow_flips(&mut self, mesh: &Triangulation, made: &Made) -> bool {
        let changed = |(old, new): &(&[u32; 3], &[u32; 3])| old != new;
        let pairs = self.triangles.iter().zip(mesh.triangles()).filter(changed);
        let (mut old, mut new): (Vec<_>, Vec<_>) =
            pairs.map(|(old, new)| (lowest_first(*old), lowest_first(*new))).unzip();
        if FEW * new.len() > self.triangles.len() {
            return false;
        }
        self.triangles.clear();
        self.triangles.extend_from_slice(mesh.triangles());
        let [mut old_edges, mut new_edges] = [&old, &new].map(|triangles| {
            let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            sides.map(|[a, b]| ascending(a, b)).collect::<Vec<_>>()
        });
        keep_differences(&mut old, &mut new);
        keep_differences(&mut old_edges, &mut new_edges);
        let mut touched = vec![false; mesh.num_vertices()];
        old.as_flattened().iter().for_each(|vertex| touched[*vertex as usize] = true);
        let touched = |vertex: u32| touched[vertex as usize];
        let has_gone =
            |a: u32, b: u32| touched(a) && touched(b) && old_edges.binary_search(&[a, b]).is_ok();
        let triangle_stays = |[_, a, b, c]: Pair| {
            !(touched(a) && touched(b) && touched(c) && old.binary_search(&[a, b, c]).is_ok())
        };
        let edges_stay = |[a, b, c, d]: Pair| !has_gone(a, b) && !has_gone(c, d);
        self.far[0].retain(|far| triangle_stays(far.pair));
        self.far[1].retain(|far| edges_stay(far.pair));
        self.near[0].retain(|pair| triangle_stays(*pair));
        self.near[1].retain(|pair| edges_stay(*pair));
        let cell = made.cell.as_ref();
        let range = made.reach + made.outer_skin;
        self.collect_edges(mesh, cell);
        self.leave_out_what_is_far(cell, range);
        self.edges.sort(cell, range + made.mean);
        let [known_vertices, known_edges] = [0, 1].map(|kind| self.far[kind].len());
        let mut far = std::mem::take(&mut self.far);
        let mut found = Vec::new();
        let mut block = Block::new([0; 4]);
        for triangle in new {
            self.pair_triangle(cell, range, triangle, &mut found, &mut block, &mut far[0]);
        }
        note(&mut block, range, &mut far[0]);
        let mut block = Block::new([0; 4]);
        for ends in &new_edges {
            let edge = edge_sphere(cell, &self.outer, *ends);
            let largest = self.edges.largest;
            self.edges.near(cell, (&edge.middle, edge.radius), range, largest, &mut found);
            for place in &found {
                let other = self.edges.sorted[*place as usize].ends;
                // Of two new ones the higher one finds the lower one.
                if other < *ends || new_edges.binary_search(&other).is_err() {
                    self.pair_edges(cell, range, *ends, other, &mut block, &mut far[1]);
                }
            }
        }
        note(&mut block, range, &mut far[1]);
        self.far = far;
        let range = made.reach + made.inner_skin;
        for far in &self.far[0][known_vertices..] {
            let [r, u, v] = arms::<false>(cell, &self.inner, far.pair);
            if (Arms { point: r, sides: [u, v] }).nearest().squared < range * range {
                self.near[0].push(far.pair);
            }
        }
        for far in &self.far[1][known_edges..] {
            let [a, b, c, d] = far.pair.map(|vertex| &self.inner[vertex as usize]);
            if crossing(cell, [a, b], [c, d]).squared < range * range {
                self.near[1].push(far.pair);
            }
        }
        self.near.iter_mut().for_each(|near| near.sort_unstable());
        true
    }

    /// The vertices within reach of a triangle at present, ascending.
    pub fn vertices_near_now(&self, corners: [u32; 3], found: &mut Vec<u32>) {
        found.clear();
        let Some(Made { reach, outer_skin, cell, .. }) = self.made_for else { return };
        let cell = cell.as_ref();
        let (points, middle, radius) = triangle_sphere(cell, &self.positions, corners);
        // No vertex is farther than half of the skin from where the grid has it.
        self.vertices.near(cell, (&middle, radius), reach + 0.5 * outer_skin, 0.0, found);
        for place in &mut *found {
            [*place, _] = self.vertices.sorted[*place as usize].ends;
        }
        found.retain(|vertex| {
            let at = &self.positions[*vertex as usize];
            !corners.contains(vertex)
                && !self.are_one_part(*vertex, corners[0])
                && Arms::new(cell, at, points.each_ref()).nearest().squared < reach * reach
        });
        found.sort_unstable();
    }

    /// The ends of all edges within reach of an edge at present, ascending.
    pub fn edges_near_now(&self, ends: [u32; 2], found: &mut Vec<[u32; 2]>) {
        found.clear();
        let Some(Made { reach, outer_skin, cell, .. }) = self.made_for else { return };
        let cell = cell.as_ref();
        let Sphere { middle, radius, .. } = edge_sphere(cell, &self.positions, ends);
        let mut places = Vec::new();
        let (around, largest) = ((&middle, radius), self.edges.largest);
        self.edges.near(cell, around, reach + 0.5 * outer_skin, largest, &mut places);
        let known = places.iter().map(|place| self.edges.sorted[*place as usize].ends);
        for [p, q] in known.chain(self.new.iter().copied()) {
            let [a, b, c, d] = [ends[0], ends[1], p, q].map(|end| &self.positions[end as usize]);
            if !ends.contains(&p)
                && !ends.contains(&q)
                && !self.are_one_part(p, ends[0])
                && crossing(cell, [a, b], [c, d]).squared < reach * reach
                && !self.gone.contains(&[p, q])
            {
                found.push([p, q]);
            }
        }
        found.sort_unstable();
    }

    /// Have kl in place of ij.
    pub fn follow(&mut self, quad: &Quad) {
        let Some(made) = self.made_for else { return };
        let [i, j, k, l] = quad.vertices;
        let (old, new) = (ascending(i, j), ascending(k, l));
        move_or_add(old, &mut self.new, &mut self.gone);
        move_or_add(new, &mut self.gone, &mut self.new);
        if self.new.len() > MOST_NEW {
            let (cell, size) = (made.cell.as_ref(), made.reach + made.outer_skin + made.mean);
            self.edges.all.retain(|edge| !self.gone.contains(&edge.ends));
            let new = self.new.iter().map(|ends| edge_sphere(cell, &self.outer, *ends));
            self.edges.all.extend(new);
            self.gone.clear();
            self.new.clear();
            self.edges.sort(cell, size);
        }
    }
}

/// From the first of the second thing to that of the first, and along both.
#[inline]
pub fn arms<const EDGES: bool>(cell: Option<&Cell>, positions: &[Vec3], pair: Pair) -> [Vec3; 3] {
    let [p, a, b, c] = pair.map(|vertex| &positions[vertex as usize]);
    if EDGES {
        return edge_arms(cell, [p, a], [b, c]);
    }
    let Arms { point, sides: [u, v] } = Arms::new(cell, p, [a, b, c]);
    [point, u, v]
}

/// Keep the pairs of a block that are near enough.
fn note<const EDGES: bool>(block: &mut Block<Pair, EDGES>, range: f64, pairs: &mut Vec<Far>) {
    block.find(range * range, |pair, [squared, ..], _| {
        pairs.push(Far { pair, distance: squared.sqrt() as f32 * (1.0 - 1e-6) });
    });
}

/// Take an edge out of one list, or if it is not there put it into the other.
fn move_or_add(edge: [u32; 2], from: &mut Vec<[u32; 2]>, to: &mut Vec<[u32; 2]>) {
    match from.iter().position(|other| *other == edge) {
        Some(place) => drop(from.swap_remove(place)),
        None => to.push(edge),
    }
}

#[inline]
pub fn ascending(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// The same triangle from its lowest corner on.
#[inline]
pub fn lowest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Sort both, and keep what only one of them has, once.
fn keep_differences<T: Ord + Clone>(one: &mut Vec<T>, other: &mut Vec<T>) {
    for all in [&mut *one, &mut *other] {
        all.sort_unstable();
        all.dedup();
    }
    let before = one.clone();
    one.retain(|x| other.binary_search(x).is_err());
    other.retain(|x| before.binary_search(x).is_err());
}

fn edge_sphere(cell: Option<&Cell>, positions: &[Vec3], ends: [u32; 2]) -> Sphere {
    let [start, end] = ends.map(|end| &positions[end as usize]);
    let half = difference(cell, end, start) * 0.5;
    Sphere { middle: start + half, radius: half.norm(), ends }
}

/// The corners of a triangle as one piece, its middle and how far they are from it.
fn triangle_sphere(
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
