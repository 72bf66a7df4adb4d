//! Particles near a surface; `src/potentials/particle_surface.rs` has the formula.
//!
//! The boxes of a grid know the triangles near them, and are renewed when a vertex has moved by the skin. Particles
//! themselves are not remembered: each looks into its box, which for most of a million is empty.

use super::grid::{Grid, NOWHERE, TOGETHER, bounds};
use super::reach::{Map, Reach, SKIN};
use crate::error::{Error, Result};
use crate::mesh::cell::{check_places, nowhere};
use crate::mesh::closest::{Arms, difference, in_one_piece};
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::Quad;
use crate::mesh::{Cell, Triangulation};
use crate::potentials::particle_surface::{self, RADIUS};
use crate::potentials::{Contribution, Term};
use crate::team::{Parts, Team};
use nalgebra::Matrix3;
use std::ops::Range;

/// Particles of one term on one mesh.
#[derive(Default)]
pub struct ParticleContacts {
    cell: Option<Cell>,
    /// All vertices as they are now.
    positions: Vec<Vec3>,
    /// The middle of each triangle and how far its corners are from it.
    spheres: Vec<(Vec3, f64)>,
    /// For particles of similar reach, from that of the smallest on by factors of two.
    maps: Vec<Map>,
    /// One for each thread.
    found: Vec<Found>,
    /// Vertices, for flips, which make triangles where none has been.
    flip_map: Map,
    /// Particles near the surface when flips began, with their radii.
    near: Vec<(Vec3, f64)>,
    near_grid: Grid,
    /// How far from its middle a particle may act.
    farthest: f64,
    /// How much farther from the vertices particles have been looked for.
    slack: f64,
}

/// What one thread has found; all, one after the other, are in the order of particles and then triangles.
#[derive(Default)]
struct Found {
    touches: Vec<Touch>,
    /// The first particle whose position is not finite, or too many periodic boxes away.
    lost: Option<u32>,
}

/// A particle that feels a triangle.
struct Touch {
    /// Among the term's particles.
    place: u32,
    triangle: u32,
    pair: particle_surface::Pair,
}

impl ParticleContacts {
    /// Refuse particles that do not exist, come twice or are vertices.
    ///
    /// # Errors
    /// Names the particle.
    pub fn check(mesh: &Triangulation, particles: &[u32], num_particles: usize) -> Result<()> {
        let mut met = vec![false; num_particles];
        for &particle in particles {
            // C hands over signed numbers.
            let name = particle as i32;
            let refuse = |what: String| Err(Error::Contract(format!("particle {name} {what}")));
            let Some(met) = met.get_mut(particle as usize) else {
                let last = num_particles as i64 - 1;
                return refuse(format!("is among the particles, but indices run from 0 to {last}"));
            };
            if std::mem::replace(met, true) {
                return refuse("is among the particles twice; leave it out once".to_owned());
            }
            if mesh.particles().binary_search(&particle).is_ok() {
                return refuse(
                    "is among the particles and a vertex of the triangles, too; SurfaceRepulsionForce acts between \
                     vertices and triangles"
                        .to_owned(),
                );
            }
        }
        Ok(())
    }

    /// Add the energy of a term, and forces (kJ/mol/nm) to those of all particles.
    ///
    /// # Errors
    /// A position that is not finite or too many boxes away, a box that is too small, a particle that touches a triangle.
    pub fn evaluate(
        &mut self,
        (mesh, cell): (&Triangulation, Option<&Cell>),
        term: &Term,
        positions: &[f64],
        contribution: &mut Contribution,
        (forces, virial): (Option<&mut [f64]>, Option<&mut Matrix3<f64>>),
        team: &mut Team,
    ) -> Result<()> {
        let reach = self.prepare(mesh, cell, term, positions)?;
        let mut found = std::mem::take(&mut self.found);
        found.resize_with(team.size().max(found.len()), Found::default);
        let parts = Parts::new(&mut found);
        let this = &*self;
        team.run(|member| {
            // SAFETY: each member has its own place.
            let found = &mut unsafe { parts.part(member.index()..member.index() + 1) }[0];
            found.touches.clear();
            found.lost = None;
            let share = member.share(term.particles.len());
            for first in share.clone().step_by(TOGETHER) {
                let places = first as u32..(first + TOGETHER).min(share.end) as u32;
                this.each_home(&reach, term, positions, places, |place, at, radius, home| {
                    let lost = this.each_near(&reach, &at, radius, home, |triangle| {
                        let arms = this.arms(mesh, &at, triangle);
                        let pair = particle_surface::pair(term, radius, &arms);
                        found.touches.push(Touch { place, triangle, pair });
                    });
                    if lost {
                        found.lost.get_or_insert(place);
                    }
                });
            }
        });
        let used = &found[..team.size()];
        let lost = used.iter().find_map(|found| found.lost);
        let touches = || used.iter().flat_map(|found| &found.touches);
        for touch in touches() {
            *contribution += touch.pair.contribution;
        }
        let touching = |touch: &&Touch| !touch.pair.contribution.energy.is_finite();
        if !contribution.energy.is_finite()
            && lost.is_none()
            && let Some(&Touch { place, triangle, .. }) = touches().find(touching)
        {
            let (particle, triangle) = (term.particles[place as usize], triangle as usize);
            let corners = mesh.particles_of(triangle);
            let force = term.potential.name();
            return Err(Error::TouchingParticle { force, particle, triangle, corners });
        }
        if let Some(forces) = forces.filter(|_| lost.is_none()) {
            for Touch { place, triangle, pair } in touches() {
                let [b, c, particle] = pair.forces;
                let corners = mesh.particles_of(*triangle as usize);
                let slots = [term.particles[*place as usize], corners[0], corners[1], corners[2]];
                for (slot, force) in slots.into_iter().zip([particle, -particle - b - c, b, c]) {
                    let slot = &mut forces[3 * slot as usize..][..3];
                    slot.iter_mut().zip(force.iter()).for_each(|(sum, force)| *sum += force);
                }
            }
        }
        if let Some(virial) = virial.filter(|_| lost.is_none()) {
            for Touch { place, triangle, pair } in touches() {
                let (at, _) = of(term, positions, *place);
                let Arms { point, sides } = self.arms(mesh, &at, *triangle);
                for (force, arm) in pair.forces.iter().zip([sides[0], sides[1], point]) {
                    *virial -= force * arm.transpose();
                }
            }
        }
        self.found = found;
        let reason = lost.and_then(|place| {
            let (particle, (at, _)) = (term.particles[place as usize], of(term, positions, place));
            nowhere(cell, particle, &at)
        });
        reason.map_or(Ok(()), Err)
    }

    /// Take the positions of the vertices, and have maps for particles of all radii.
    fn prepare(
        &mut self,
        mesh: &Triangulation,
        cell: Option<&Cell>,
        term: &Term,
        positions: &[f64],
    ) -> Result<Reach> {
        self.cell = cell.copied();
        let at = |particle: u32| Vec3::from_column_slice(&positions[3 * particle as usize..][..3]);
        self.positions.clear();
        self.positions.extend(mesh.particles().iter().map(|particle| at(*particle)));
        check_places(cell, mesh.particles(), &self.positions)?;
        let mut largest = 0.0;
        self.spheres.clear();
        self.spheres.extend(mesh.triangles().iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| &self.positions[corner as usize]);
            let (u, v) = (difference(cell, b, a), difference(cell, c, a));
            let middle = (u + v) / 3.0;
            let far = middle.norm_squared().max((u - middle).norm_squared());
            let far = far.max((v - middle).norm_squared()).sqrt();
            largest = far.max(largest);
            (a + middle, far)
        }));
        let reach = Reach::new(term);
        let farthest = reach.of_class(reach.classes.len() - 1);
        if let Some(cell) = cell
            && farthest * (1.0 + SKIN) + 2.0 * largest >= cell.half_width()
        {
            return Err(Error::Contract(format!(
                "particles and triangles act on each other up to {farthest} nm, which with the size of a triangle is more \
                 than half of the periodic box; make distance or radius smaller, or the box larger"
            )));
        }
        self.maps.resize_with(reach.classes.len().max(self.maps.len()), Map::default);
        for class in (0..reach.classes.len()).filter(|class| reach.classes[*class]) {
            self.maps[class].refresh(mesh, cell, reach.of_class(class), &self.positions);
        }
        Ok(reach)
    }

    #[inline]
    fn arms(&self, mesh: &Triangulation, at: &Vec3, triangle: u32) -> Arms {
        let corners = mesh.triangles()[triangle as usize];
        Arms::new(self.cell.as_ref(), at, corners.map(|corner| &self.positions[corner as usize]))
    }

    /// Go through particles in their boxes, but for those far away, of which there may be very many.
    #[inline]
    fn each_home(
        &self,
        reach: &Reach,
        term: &Term,
        positions: &[f64],
        places: Range<u32>,
        mut visit: impl FnMut(u32, Vec3, f64, u32),
    ) {
        if !term.fields[RADIUS].is_empty() {
            for place in places {
                let (at, radius) = of(term, positions, place);
                let home = self.maps[reach.class(radius)].grid.home(&at);
                visit(place, at, radius, home.map_or(NOWHERE, |home| home as u32));
            }
            return;
        }
        let mut all = [[0.0; TOGETHER]; 3];
        for (n, place) in places.clone().enumerate() {
            let first = 3 * term.particles[place as usize] as usize;
            for (axis, all) in all.iter_mut().enumerate() {
                all[n] = positions[first + axis];
            }
        }
        let radius = term.values[RADIUS];
        let grid = &self.maps[reach.class(radius)].grid;
        for (n, (place, home)) in places.zip(grid.homes(&all)).enumerate() {
            if home == NOWHERE || !grid.items(home as usize).is_empty() {
                visit(place, Vec3::new(all[0][n], all[1][n], all[2][n]), radius, home);
            }
        }
    }

    /// Go through the triangles that a particle may feel, ascending; true if its position is not finite or too far away.
    #[inline]
    fn each_near(
        &self,
        reach: &Reach,
        at: &Vec3,
        radius: f64,
        home: u32,
        mut visit: impl FnMut(u32),
    ) -> bool {
        if home == NOWHERE {
            return nowhere(self.cell.as_ref(), 0, at).is_some();
        }
        let grid = &self.maps[reach.class(radius)].grid;
        let own = reach.from_rim + radius;
        for &triangle in grid.items(home as usize) {
            let (middle, size) = &self.spheres[triangle as usize];
            let far = difference(self.cell.as_ref(), at, middle).norm_squared();
            if far < (own + size) * (own + size) {
                visit(triangle);
            }
        }
        false
    }

    /// Be ready for flips: note which particles are near.
    ///
    /// # Errors
    /// Those of [`Self::evaluate`].
    pub fn prepare_flips(
        &mut self,
        (mesh, cell): (&Triangulation, Option<&Cell>),
        term: &Term,
        positions: &[f64],
    ) -> Result<()> {
        let reach = self.prepare(mesh, cell, term, positions)?;
        self.farthest = reach.of_class(reach.classes.len() - 1);
        let largest = self.spheres.iter().map(|(_, far)| *far).fold(0.0, f64::max);
        // Rounded up, each step a fifth more, so that the map stays as the mesh moves.
        self.slack = 2f64.powf((4.0 * (2.0 * largest).log2()).ceil() / 4.0);
        self.flip_map.refresh_vertices(cell, self.farthest + self.slack, &self.positions);
        let grid = &self.flip_map.grid;
        let mut near = std::mem::take(&mut self.near);
        near.clear();
        for place in 0..term.particles.len() as u32 {
            let (at, radius) = of(term, positions, place);
            if grid.home(&at).is_some_and(|home| !grid.items(home).is_empty()) {
                near.push((at, radius));
            }
        }
        let low_high = bounds(near.iter().map(|(at, _)| at));
        self.near_grid.set_up(cell, low_high, self.farthest, 2 * near.len());
        for (item, (at, _)) in near.iter().enumerate() {
            self.near_grid.add(item as u32, at);
        }
        self.near_grid.seal();
        self.near = near;
        Ok(())
    }

    /// The energy, kJ/mol, between all particles and two triangles as the mesh has them now.
    pub fn around(
        &self,
        mesh: &Triangulation,
        term: &Term,
        positions: &[f64],
        changed: [usize; 2],
    ) -> f64 {
        let cell = self.cell.as_ref();
        let mut energy = 0.0;
        for triangle in changed {
            let corners = mesh.triangles()[triangle];
            let knows_all = self.knows_all_near(corners);
            let corners = corners.map(|corner| &self.positions[corner as usize]);
            let mut add = |at: &Vec3, radius: f64| {
                let arms = Arms::new(cell, at, corners);
                energy += particle_surface::pair(term, radius, &arms).contribution.energy;
            };
            if !knows_all {
                for place in 0..term.particles.len() as u32 {
                    let (at, radius) = of(term, positions, place);
                    add(&at, radius);
                }
            } else if !self.near.is_empty() {
                let frame = in_one_piece(cell, corners);
                self.near_grid.near(&frame, self.farthest, |item| {
                    let (at, radius) = &self.near[item as usize];
                    add(at, *radius);
                });
            }
        }
        energy
    }

    /// Whether all particles near three vertices, as corners of a triangle, have been noted. From no point of a triangle
    /// is the next corner farther than the longest side over √3, and corners are in triangles that were there.
    #[inline]
    fn knows_all_near(&self, corners: [u32; 3]) -> bool {
        let [a, b, c] = corners.map(|corner| &self.positions[corner as usize]);
        let most = 3.0 * self.slack * self.slack;
        [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(a, b)| difference(self.cell.as_ref(), a, b).norm_squared() <= most)
    }

    /// Whether no particle is near the triangles of a quadrilateral, nor near those that a flip makes.
    pub fn is_quiet(&self, quad: &Quad) -> bool {
        let [i, j, k, l] = quad.vertices;
        self.near.is_empty()
            && [[i, j, k], [j, i, l], [k, i, l], [l, j, k]]
                .iter()
                .all(|corners| self.knows_all_near(*corners))
    }
}

/// Where a particle is, and its radius, nm.
#[inline]
fn of(term: &Term, positions: &[f64], place: u32) -> (Vec3, f64) {
    let first = 3 * term.particles[place as usize] as usize;
    let at = Vec3::new(positions[first], positions[first + 1], positions[first + 2]);
    (at, term.value(RADIUS, place as usize))
}
