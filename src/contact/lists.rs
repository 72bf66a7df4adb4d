//! Which vertices may touch which triangles of a surface.
//!
//! The list of a triangle has the vertices that are nearer than reach + skin at the positions of the **reference**, in
//! ascending order, but for those that are excluded: its corners and their neighbours. It is good until a
//! vertex has moved by half of the skin. Flips keep it current: those of the two triangles are made anew, and the four
//! vertices come into those lists or leave them whose exclusion changes.

use super::closest::{Arms, difference};
use super::grid::{Grid, bounds};
use crate::error::{Error, Result};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::{Quad, next, previous};
use crate::mesh::{Cell, Triangulation};
use crate::team::{Parts, Team};

/// The skin as a share of the reach: thicker ones are renewed less often, but have more pairs in them.
const SKIN: f64 = 0.4;

/// Lists for one mesh.
#[derive(Default)]
pub struct Lists {
    made_for: Option<Made>,
    /// All vertices as they are now.
    positions: Vec<Vec3>,
    reference: Vec<Vec3>,
    /// The reference's vertices.
    grid: Grid,
    /// For each vertex the connected part that it is on; empty unless that matters.
    parts: Vec<u32>,
    /// Where the list of each triangle begins, and how long it is.
    places: Vec<[u32; 2]>,
    vertices: Vec<u32>,
    /// Triangles with a list that is not empty, ascending.
    busy: Vec<u32>,
    /// Whether these are to be noted anew.
    busy_changed: bool,
    /// With more vertices in the lists and in the gaps between them all are made anew.
    most: usize,
    /// Whether a vertex has come into any list since they were made.
    listed: Vec<bool>,
    /// One for each thread; kept for their memory.
    scratch: Vec<Vec<u32>>,
}

/// What lists depend on, beside the reference.
#[derive(Clone, Copy, PartialEq)]
struct Made {
    reach: f64,
    between_parts: bool,
    cell: Option<Cell>,
    fingerprint: u64,
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
        let fingerprint = mesh.fingerprint();
        let wanted = Made { reach, between_parts, cell: cell.copied(), fingerprint };
        let particles = mesh.particles();
        let at = |particle: u32| Vec3::from_column_slice(&positions[3 * particle as usize..][..3]);
        self.positions.clear();
        self.positions.extend(particles.iter().map(|particle| at(*particle)));
        // Lists of a longer reach are good, too: force groups may take turns.
        let good = self.made_for.filter(|made| {
            let Made { reach, between_parts, cell, fingerprint } = *made;
            reach >= wanted.reach
                && between_parts <= wanted.between_parts
                && (cell, fingerprint) == (wanted.cell, wanted.fingerprint)
                && self.vertices.len() <= self.most
        });
        if let Some(made) = good {
            let pairs = self.positions.iter().zip(&self.reference);
            let farthest = pairs.fold(0.0, |farthest: f64, (now, then)| {
                let moved = (now - then).norm_squared();
                // What is no number counts as far.
                if moved <= farthest { farthest } else { moved }
            });
            if farthest < 0.25 * (SKIN * made.reach).powi(2) {
                self.note_busy();
                return Ok(());
            }
        }
        self.made_for = None;
        for (position, particle) in self.positions.iter().zip(particles) {
            if !position.iter().all(|x| x.is_finite()) {
                let (particle, position) = (*particle, (*position).into());
                return Err(Error::NonFinitePosition { particle, position });
            }
        }
        if let Some(cell) = cell
            && reach * (1.0 + SKIN) >= cell.half_width()
        {
            return Err(Error::Contract(format!(
                "the repulsion reaches {reach} nm, which with some margin is more than half of the periodic box; make \
                 the distance smaller or the box larger"
            )));
        }
        self.make(mesh, wanted, team);
        self.made_for = Some(wanted);
        Ok(())
    }

    /// What has been found at the last refresh.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Triangles that have a list, ascending.
    pub fn busy(&self) -> &[u32] {
        &self.busy
    }

    /// The list of a triangle.
    #[inline]
    pub fn of(&self, triangle: u32) -> &[u32] {
        let [start, length] = self.places[triangle as usize];
        &self.vertices[start as usize..(start + length) as usize]
    }

    /// Whether a vertex may be in some list.
    #[inline]
    pub fn has(&self, vertex: u32) -> bool {
        self.listed[vertex as usize]
    }

    /// Whether two vertices are on the same part; false unless lists are between parts.
    #[inline]
    fn are_one_part(&self, one: u32, other: u32) -> bool {
        !self.parts.is_empty() && self.parts[one as usize] == self.parts[other as usize]
    }

    fn make(&mut self, mesh: &Triangulation, wanted: Made, team: &mut Team) {
        let range = wanted.reach * (1.0 + SKIN);
        std::mem::swap(&mut self.reference, &mut self.positions);
        self.positions.clone_from(&self.reference);
        self.parts = if wanted.between_parts { mesh.parts() } else { Vec::new() };
        let (count, box_) = (mesh.num_vertices(), bounds(&self.reference));
        self.grid.set_up(wanted.cell.as_ref(), box_, range, 2 * count);
        for (vertex, position) in self.reference.iter().enumerate() {
            self.grid.add(vertex as u32, position);
        }
        self.grid.seal();
        let mut places = std::mem::take(&mut self.places);
        let mut scratch = std::mem::take(&mut self.scratch);
        places.resize(mesh.triangles().len(), [0; 2]);
        scratch.resize_with(team.size(), Vec::new);
        let (all_places, all_scratch) = (Parts::new(&mut places), Parts::new(&mut scratch));
        team.run(|member| {
            let share = member.share(mesh.triangles().len());
            // SAFETY: each member has its own place, and its own share of the triangles.
            let (found, places) = unsafe {
                let scratch = all_scratch.part(member.index()..member.index() + 1);
                (&mut scratch[0], all_places.part(share.clone()))
            };
            found.clear();
            let mut excluded = Vec::new();
            for (place, triangle) in places.iter_mut().zip(share) {
                let start = found.len();
                self.find(mesh, &wanted, triangle as u32, &mut excluded, found);
                found[start..].sort_unstable();
                *place = [start as u32, (found.len() - start) as u32];
            }
        });
        self.vertices.clear();
        for (index, found) in scratch.iter().enumerate() {
            let offset = self.vertices.len() as u32;
            // As Member::share has it.
            let (all, members) = (places.len(), scratch.len());
            let share = all * index / members..all * (index + 1) / members;
            places[share].iter_mut().for_each(|place| place[0] += offset);
            self.vertices.extend_from_slice(found);
        }
        (self.places, self.scratch) = (places, scratch);
        self.listed.clear();
        self.listed.resize(count, false);
        self.vertices.iter().for_each(|vertex| self.listed[*vertex as usize] = true);
        self.most = 2 * self.vertices.len() + 8 * mesh.triangles().len();
        self.busy_changed = true;
        self.note_busy();
    }

    fn note_busy(&mut self) {
        if !std::mem::take(&mut self.busy_changed) {
            return;
        }
        self.busy.clear();
        let places = self.places.iter().enumerate();
        self.busy.extend(places.filter(|(_, place)| place[1] > 0).map(|(t, _)| t as u32));
    }

    /// Add the vertices near a triangle at the reference's positions, in any order.
    fn find(
        &self,
        mesh: &Triangulation,
        wanted: &Made,
        triangle: u32,
        excluded: &mut Vec<u32>,
        found: &mut Vec<u32>,
    ) {
        let range = wanted.reach * (1.0 + SKIN);
        let corners = mesh.triangles()[triangle as usize];
        excluded.clear();
        for corner in corners {
            excluded.push(corner);
            each_neighbour(mesh, corner, |neighbour| excluded.push(neighbour));
        }
        let (cell, points) = (wanted.cell.as_ref(), frame(wanted.cell.as_ref(), &self.reference, corners));
        self.grid.near(&points, range, |vertex| {
            if self.are_one_part(vertex, corners[0]) || excluded.contains(&vertex) {
                return;
            }
            let arms = Arms::new(cell, &self.reference[vertex as usize], points.each_ref());
            if arms.nearest().squared < range * range {
                found.push(vertex);
            }
        });
    }

    /// The vertices that may be nearer than the reach to a triangle of present positions, whatever its corners are now,
    /// ascending and without those that are excluded.
    pub fn near_now(&self, mesh: &Triangulation, triangle: u32, found: &mut Vec<u32>) {
        found.clear();
        let Some(made) = self.made_for else { return };
        let corners = mesh.triangles()[triangle as usize];
        let points = frame(made.cell.as_ref(), &self.positions, corners);
        // Vertices are within half of the skin from where the grid has them.
        self.grid.near(&points, made.reach * (1.0 + 0.5 * SKIN), |vertex| {
            if !self.are_one_part(vertex, corners[0]) && !is_excluded(mesh, vertex, corners) {
                found.push(vertex);
            }
        });
        found.sort_unstable();
    }

    /// Follow a flip, which `mesh` has made; `quad` is as it was before.
    pub fn follow(&mut self, mesh: &Triangulation, quad: &Quad) {
        let Some(mut made) = self.made_for else { return };
        made.fingerprint = mesh.fingerprint();
        let (mut excluded, mut found) = (Vec::new(), Vec::new());
        let changed = quad.triangles().map(|triangle| triangle as u32);
        for triangle in changed {
            found.clear();
            self.find(mesh, &made, triangle, &mut excluded, &mut found);
            found.sort_unstable();
            self.replace(triangle, &found);
        }
        let [i, j, k, l] = quad.vertices;
        for (vertex, corner) in [(k, l), (l, k), (i, j), (j, i)] {
            each_leaving(mesh, corner, |half| {
                let triangle = half / 3;
                if changed.contains(&triangle) {
                    return;
                }
                let list = self.of(triangle);
                let place = list.binary_search(&vertex);
                let wanted = self.is_wanted(mesh, &made, vertex, triangle);
                found.clear();
                found.extend_from_slice(list);
                match place {
                    Ok(at) if !wanted => drop(found.remove(at)),
                    Err(at) if wanted => found.insert(at, vertex),
                    _ => return,
                }
                self.replace(triangle, &found);
            });
        }
        self.made_for = Some(made);
        self.busy_changed = true;
    }

    /// Whether a vertex belongs into the list of a triangle.
    fn is_wanted(&self, mesh: &Triangulation, made: &Made, vertex: u32, triangle: u32) -> bool {
        let corners = mesh.triangles()[triangle as usize];
        if self.are_one_part(vertex, corners[0]) || is_excluded(mesh, vertex, corners) {
            return false;
        }
        let cell = made.cell.as_ref();
        let points = frame(cell, &self.reference, corners);
        let arms = Arms::new(cell, &self.reference[vertex as usize], points.each_ref());
        arms.nearest().squared < (made.reach * (1.0 + SKIN)).powi(2)
    }

    /// What has been the list of a triangle stays behind as a gap until all are made anew.
    fn replace(&mut self, triangle: u32, list: &[u32]) {
        let place = &mut self.places[triangle as usize];
        if list.len() > place[1] as usize {
            place[0] = self.vertices.len() as u32;
            self.vertices.extend_from_slice(list);
        } else {
            self.vertices[place[0] as usize..][..list.len()].copy_from_slice(list);
        }
        place[1] = list.len() as u32;
        list.iter().for_each(|vertex| self.listed[*vertex as usize] = true);
    }
}

/// The corners of a triangle, the second and third at their images near the first.
#[inline]
fn frame(cell: Option<&Cell>, positions: &[Vec3], corners: [u32; 3]) -> [Vec3; 3] {
    let [a, b, c] = corners.map(|corner| &positions[corner as usize]);
    [*a, a + difference(cell, b, a), a + difference(cell, c, a)]
}

/// What a side without a neighbour has for its twin.
const NONE: u32 = u32::MAX;

/// Go round the half-edges that leave a vertex.
#[inline]
pub fn each_leaving(mesh: &Triangulation, vertex: u32, mut visit: impl FnMut(u32)) {
    let start = mesh.leaving(vertex);
    let mut half = start;
    loop {
        visit(half);
        half = mesh.after(half);
        if half == start || half == NONE {
            return;
        }
    }
}

/// Go round the neighbours of a vertex.
#[inline]
fn each_neighbour(mesh: &Triangulation, vertex: u32, mut visit: impl FnMut(u32)) {
    each_leaving(mesh, vertex, |half| {
        visit(mesh.origin(next(half)));
        // At a border the last triangle has a side that no other begins with.
        if mesh.after(half) == NONE {
            visit(mesh.origin(previous(half)));
        }
    });
}

/// Whether a vertex is a corner of a triangle, or joined to one.
#[inline]
pub fn is_excluded(mesh: &Triangulation, vertex: u32, corners: [u32; 3]) -> bool {
    corners.contains(&vertex) || {
        let mut excluded = false;
        each_neighbour(mesh, vertex, |neighbour| excluded |= corners.contains(&neighbour));
        excluded
    }
}
