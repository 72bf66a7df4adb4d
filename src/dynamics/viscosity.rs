//! Friction and noise along the edges of a surface, which make it viscous.
//!
//! Of the edge of two vertices i and j, with the unit vector e from j to i, inverse masses w and w' and the reduced mass
//! μ = 1 / (w + w'), the relative velocity u = (v_i − v_j)·e gets the exact Ornstein–Uhlenbeck update over a time Δt at
//! fixed positions:
//!
//! ```text
//! u → u exp(−γ Δt / μ) + √(kT / μ (1 − exp(−2 γ Δt / μ))) ξ
//! ```
//!
//! with ξ of the standard normal distribution, by equal and opposite impulses along e. It leaves the Maxwell
//! distribution unchanged and conserves momentum and angular momentum, and so does a sweep over all edges, whatever its
//! order. The pairwise force is that of P. Español, P. Warren, doi:10.1209/0295-5075/30/4/001, without their range;
//! exact updates of pairs are those of T. Shardlow, doi:10.1137/S1064827501392879 and E. A. J. F. Peters,
//! doi:10.1209/epl/i2004-10010-4. Sweeps go forwards and backwards in turn, so that two of them are symmetric in time.
//!
//! exp(−γ Δt / μ) is the product of exp(−γ Δt w) and exp(−γ Δt w'): vertices have exponentials, and edges none. Edge
//! after edge it is one thread's work; directions and random numbers are computed before, many at once.

use super::random::{GROUP, Stream, fill_group};
use crate::error::{Error, Result};
use crate::lanes::{Arithmetic, Kernel, run};
use crate::mesh::cell::nowhere;
use crate::mesh::geometry::Vec3;
use crate::mesh::triangulation::next;
use crate::mesh::unfolding::too_long;
use crate::mesh::{Cell, Triangulation};

/// So many edges are put in order together, as many as leave their vertices in the nearest cache.
const BLOCK: usize = 1024;

/// Friction and noise of one sweep.
#[derive(Debug, Clone, Copy)]
pub struct Bath {
    /// γ Δt, amu.
    pub friction: f64,
    /// kT, kJ/mol.
    pub kt: f64,
    /// How long before the positions the sweep happens, ps: vertices are moved back with their velocities of before,
    /// and on with those of after.
    pub lag: f64,
}

/// Where all particles are, in the layout x y z of one after the other, and how they move.
pub struct Motion<'a> {
    /// nm.
    pub positions: &'a mut [f64],
    /// nm/ps.
    pub velocities: &'a mut [f64],
    /// The periodic box, if there is one; edges connect nearest images in it.
    pub cell: Option<&'a Cell>,
}

/// What is known of a surface between sweeps, and the memory that they take.
pub struct Viscosity {
    /// Of the vertices, 1/amu; 0 for those that do not move.
    inverse_masses: Vec<f64>,
    /// That of the membrane whose edges these are.
    generation: Option<u64>,
    /// The vertices at the ends of each edge, in the order of a sweep.
    edges: Vec<[u32; 2]>,
    /// The γ Δt that `losses` are for.
    friction: f64,
    /// 1 − exp(−γ Δt w) of each vertex.
    losses: Vec<f64>,
    /// Where each vertex is during the sweep.
    places: Vec<Vec3>,
    /// The velocity of each vertex, and its inverse mass.
    velocities: Vec<[f64; 4]>,
    /// The edges that the sweep has come to.
    group: Group,
}

/// What a sweep does to edges that follow each other.
struct Group {
    /// x, y and z of e; first of the separation.
    direction: [[f64; GROUP]; 3],
    /// 1/μ, 1/amu.
    inverse_mass: [f64; GROUP],
    /// 1 − exp(−γ Δt / μ); then the impulse for each unit of u, amu.
    damping: [f64; GROUP],
    /// Standard normals; then the random impulse, amu nm/ps.
    kick: [f64; GROUP],
}

impl Viscosity {
    /// For the vertices of a surface among particles of these masses, amu.
    pub fn new(mesh: &Triangulation, masses: &[f64]) -> Self {
        let inverse = |particle: &u32| match masses[*particle as usize] {
            0.0 => 0.0,
            mass => 1.0 / mass,
        };
        Self {
            inverse_masses: mesh.particles().iter().map(inverse).collect(),
            generation: None,
            edges: Vec::new(),
            friction: f64::NAN,
            losses: Vec::new(),
            places: Vec::new(),
            velocities: Vec::new(),
            group: Group {
                direction: [[1.0; GROUP]; 3],
                inverse_mass: [1.0; GROUP],
                damping: [0.0; GROUP],
                kick: [0.0; GROUP],
            },
        }
    }

    /// Sweep over all edges of a mesh of a generation, with the random numbers of the stream's present draw.
    ///
    /// # Errors
    /// A position or velocity that is not finite, an edge without length, and in a periodic box one that is not shorter
    /// than half of its least width. Nothing has changed then.
    pub fn sweep(
        &mut self,
        (mesh, generation): (&Triangulation, u64),
        motion: Motion,
        bath: Bath,
        stream: &mut Stream,
    ) -> Result<()> {
        if self.generation != Some(generation) {
            self.edges = in_order(mesh);
            self.generation = Some(generation);
        }
        if self.friction != bath.friction {
            let loss = |inverse: &f64| -(-bath.friction * inverse).exp_m1();
            self.losses = self.inverse_masses.iter().map(loss).collect();
            self.friction = bath.friction;
        }
        self.gather(mesh, &motion, bath.lag);
        let forwards = stream.draws.is_multiple_of(2);
        let Self { edges, losses, places, velocities, group, .. } = self;
        let count = edges.len().div_ceil(GROUP);
        for turn in 0..count {
            let number = if forwards { turn } else { count - 1 - turn };
            let edges = &edges[number * GROUP..edges.len().min((number + 1) * GROUP)];
            group
                .separate(edges, places, motion.cell)
                .map_err(|(edge, square)| refused(mesh, edge, square, &motion))?;
            group.weigh(edges, velocities, losses);
            run(Prepare { group, number: number as u64, kt: bath.kt, stream });
            group.apply(edges, velocities, forwards);
        }
        stream.draws += 1;
        self.scatter(mesh, motion, bath.lag);
        Ok(())
    }

    /// Velocities, and positions at the time of the sweep.
    fn gather(&mut self, mesh: &Triangulation, motion: &Motion, lag: f64) {
        let positions = motion.positions.as_chunks::<3>().0;
        let velocities = motion.velocities.as_chunks::<3>().0;
        let vertices = mesh.particles().iter().zip(&self.inverse_masses);
        let moving = vertices.map(|(&particle, &inverse)| {
            // A particle without mass stays where it is, even if it has been given a velocity.
            let [x, y, z] = if inverse == 0.0 { [0.0; 3] } else { velocities[particle as usize] };
            [x, y, z, inverse]
        });
        self.velocities.clear();
        self.velocities.extend(moving);
        let vertices = mesh.particles().iter().zip(&self.velocities);
        let places = vertices.map(|(&particle, &[x, y, z, _])| {
            Vec3::from(positions[particle as usize]) - Vec3::new(x, y, z) * lag
        });
        self.places.clear();
        self.places.extend(places);
    }

    /// Give particles what has become of their velocities, and of their positions.
    fn scatter(&self, mesh: &Triangulation, motion: Motion, lag: f64) {
        let positions = motion.positions.as_chunks_mut::<3>().0;
        let velocities = motion.velocities.as_chunks_mut::<3>().0;
        for (&particle, found) in mesh.particles().iter().zip(&self.velocities) {
            if found[3] == 0.0 {
                continue;
            }
            let position = &mut positions[particle as usize];
            let velocity = &mut velocities[particle as usize];
            for axis in 0..3 {
                position[axis] += lag * (found[axis] - velocity[axis]);
            }
            velocity.copy_from_slice(&found[..3]);
        }
    }
}

impl Group {
    /// Have the separations of some edges; or else the vertices of one that has no direction, and the square of what
    /// would be its length.
    fn separate(
        &mut self,
        edges: &[[u32; 2]],
        places: &[Vec3],
        cell: Option<&Cell>,
    ) -> std::result::Result<(), ([u32; 2], f64)> {
        let limit = cell.map_or(f64::INFINITY, |cell| cell.half_width().powi(2));
        for (slot, &[i, j]) in edges.iter().enumerate() {
            let mut separation = places[i as usize] - places[j as usize];
            let mut square = separation.norm_squared();
            if let Some(cell) = cell
                && square >= limit
            {
                // What is shorter is the nearest image already.
                separation += cell.shift(cell.nearest(&separation));
                square = separation.norm_squared();
            }
            if !(square > 0.0 && square < limit) {
                return Err(([i, j], square));
            }
            for (axis, component) in self.direction.iter_mut().zip(&separation) {
                axis[slot] = *component;
            }
        }
        Ok(())
    }

    /// Have the reduced masses of some edges, and how much of u is lost.
    fn weigh(&mut self, edges: &[[u32; 2]], velocities: &[[f64; 4]], losses: &[f64]) {
        let slots = self.inverse_mass.iter_mut().zip(&mut self.damping);
        for (&[i, j], (inverse_mass, loss)) in edges.iter().zip(slots) {
            let (i, j) = (i as usize, j as usize);
            // Of two vertices that do not move both losses are zero, and nothing happens, whatever stands here.
            let sum = velocities[i][3] + velocities[j][3];
            *inverse_mass = if sum == 0.0 { 1.0 } else { sum };
            *loss = losses[i] + losses[j] - losses[i] * losses[j];
        }
    }

    /// Change the velocities of the ends of some edges, one edge after the other.
    fn apply(&self, edges: &[[u32; 2]], velocities: &mut [[f64; 4]], forwards: bool) {
        let mut one = |(slot, &[i, j]): (usize, &[u32; 2])| {
            let (i, j) = (i as usize, j as usize);
            let e: [f64; 3] = std::array::from_fn(|axis| self.direction[axis][slot]);
            let (mut here, mut there) = (velocities[i], velocities[j]);
            let u = (here[0] - there[0]) * e[0]
                + (here[1] - there[1]) * e[1]
                + (here[2] - there[2]) * e[2];
            let impulse = self.kick[slot] - self.damping[slot] * u;
            let (to_here, to_there) = (here[3] * impulse, there[3] * impulse);
            for axis in 0..3 {
                here[axis] += to_here * e[axis];
                there[axis] -= to_there * e[axis];
            }
            (velocities[i], velocities[j]) = (here, there);
        };
        let edges = edges.iter().enumerate();
        if forwards { edges.for_each(&mut one) } else { edges.rev().for_each(&mut one) }
    }
}

/// Has the directions of a group, and its impulses. The group's last edges may be no edges; nobody asks what becomes of
/// these.
struct Prepare<'a> {
    group: &'a mut Group,
    number: u64,
    kt: f64,
    stream: &'a Stream,
}

impl Kernel for Prepare<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let Group { direction: [x, y, z], inverse_mass, damping, kick } = self.group;
        fill_group::<A>(self.stream, self.number, kick);
        for slot in 0..GROUP {
            let scale = 1.0 / (x[slot] * x[slot] + y[slot] * y[slot] + z[slot] * z[slot]).sqrt();
            (x[slot], y[slot], z[slot]) = (scale * x[slot], scale * y[slot], scale * z[slot]);
            let (mass, loss) = (1.0 / inverse_mass[slot], damping[slot]);
            damping[slot] = mass * loss;
            // 1 − exp(−2 γ Δt / μ) without a difference of numbers that may be nearly the same.
            kick[slot] *= (self.kt * mass * (loss * (2.0 - loss))).sqrt();
        }
    }
}

/// The edges of a mesh, in an order that depends on its triangles only. Edges that follow each other have no vertex in
/// common where that can be had, so that the processor need not wait for one to begin with the next.
fn in_order(mesh: &Triangulation) -> Vec<[u32; 2]> {
    let ends = mesh.edges().map(|half| [mesh.origin(half), mesh.origin(next(half))]);
    let edges: Vec<[u32; 2]> = ends.collect();
    let mut ordered = vec![[0; 2]; edges.len()];
    // The colours that edges at each vertex have: each edge of a block gets the first that is free at both ends.
    let mut taken = vec![0u64; mesh.num_vertices()];
    let mut colours = [0; BLOCK];
    for (block, ordered) in edges.chunks(BLOCK).zip(ordered.chunks_mut(BLOCK)) {
        let mut starts = [0; 65];
        for (&[i, j], colour) in block.iter().zip(&mut colours) {
            let free = !(taken[i as usize] | taken[j as usize]);
            *colour = free.trailing_zeros().min(63) as usize;
            taken[i as usize] |= 1 << *colour;
            taken[j as usize] |= 1 << *colour;
            starts[*colour + 1] += 1;
        }
        for colour in 0..64 {
            starts[colour + 1] += starts[colour];
        }
        for (&edge, &colour) in block.iter().zip(&colours) {
            ordered[starts[colour]] = edge;
            starts[colour] += 1;
            edge.into_iter().for_each(|vertex| taken[vertex as usize] = 0);
        }
    }
    ordered
}

/// Why an edge has no direction.
#[cold]
fn refused(mesh: &Triangulation, edge: [u32; 2], square: f64, motion: &Motion) -> Error {
    let edge = edge.map(|vertex| mesh.particles()[vertex as usize]);
    let of = |all: &[f64], particle: u32| all.as_chunks::<3>().0[particle as usize];
    for particle in edge {
        let position = of(motion.positions, particle);
        if let Some(reason) = nowhere(motion.cell, particle, &position.into()) {
            return reason;
        }
        let velocity = of(motion.velocities, particle);
        if !velocity.iter().all(|component| component.is_finite()) {
            return Error::NonFiniteVelocity { particle, velocity };
        }
    }
    if square == 0.0 {
        return Error::EdgeWithoutLength { edge, position: of(motion.positions, edge[0]) };
    }
    match motion.cell {
        Some(cell) => too_long(edge, square.sqrt(), motion.positions, cell),
        None => Error::OverflownEdge { edge },
    }
}

#[cfg(test)]
mod tests;
