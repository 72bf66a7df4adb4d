//! The vertices of all surfaces, in lanes, and the equations of a time step.

use super::passes::{Change, Drift, Energies, Kick, inverse_masses};
use crate::dynamics::plaquettes::{LANES, Lanes, Plaquettes, Vectors, share};
use crate::error::{Error, Result};
use crate::mesh::Cell;
use crate::mesh::topology::NONE;
use crate::team::{Parts, Team};

/// After so many iterations a time step is given up.
const MOST_ITERATIONS: usize = 100;

/// Vertices on the way through a time step.
pub struct Vertices {
    /// The geometry at their positions.
    pub plaquettes: Plaquettes,
    /// m there, amu; 0 for those that stay where they are.
    pub masses: Vec<Lanes>,
    /// 1/m, 1/amu, or 0.
    pub inverse_masses: Vec<Lanes>,
    /// 1 for those that move, 0 for others.
    free: Vec<Lanes>,
    /// σ where it is given, amu/nm²; or 0.
    given_density: f64,
    /// M of each surface, amu.
    surface_masses: Vec<f64>,
    /// σ of each surface, amu/nm².
    densities: Vec<f64>,
    /// p, amu nm/ps.
    momenta: Vec<Vectors>,
    /// What p is without −∂K/∂q.
    base: Vec<Vectors>,
    /// p/m, nm/ps.
    velocities: Vec<Vectors>,
    /// Positions on trial, nm, and the areas there.
    trial: Vec<Vectors>,
    trial_areas: Vec<Lanes>,
    /// ∂K/∂aᵢ, with a last group of zeros for places without a neighbour, and ∂K/∂A of each surface.
    by_area: Vec<Lanes>,
    by_total: Vec<f64>,
    /// K of each tile.
    energies: Vec<f64>,
    /// The last change in each tile.
    changes: Vec<Change>,
}

/// Tells when an iteration has come to rounding.
#[derive(Default)]
struct Progress {
    last: Option<f64>,
}

impl Progress {
    /// Whether there is no more to gain: changes are rounding, or the next one will be, as the last two tell.
    fn is_done(&mut self, now: Change) -> bool {
        let rounding = f64::EPSILON * now.scale;
        let last = self.last.replace(now.change);
        now.change <= 2.0 * rounding
            || last.is_some_and(|last| {
                now.change < last && now.change * (now.change / last) <= 0.25 * rounding
            })
    }
}

/// The vectors of particles in lanes; those of the first for lanes without one.
#[inline]
fn of_particles(vectors: &[f64], particles: &[u32; LANES]) -> Vectors {
    let vectors = vectors.as_chunks::<3>().0;
    let mut found = Vectors::default();
    for (lane, &particle) in particles.iter().enumerate() {
        let vector = vectors[if particle == NONE { particles[0] } else { particle } as usize];
        (0..3).for_each(|axis| found[axis][lane] = vector[axis]);
    }
    found
}

impl Vertices {
    /// Vertices with the masses of all particles of a System, amu, and the density that is given, amu/nm², or 0.
    pub fn new(plaquettes: Plaquettes, masses: &[f64], given_density: f64) -> Self {
        let layout = plaquettes.layout();
        let groups = layout.particles.len();
        let mut surface_masses = vec![0.0; layout.is_periodic.len()];
        let mut free = vec![Lanes::default(); groups];
        for tile in &layout.tiles {
            for group in tile.groups() {
                for (lane, &particle) in layout.particles[group].iter().enumerate() {
                    if particle != NONE && masses[particle as usize] != 0.0 {
                        free[group][lane] = 1.0;
                        surface_masses[tile.surface] += masses[particle as usize];
                    }
                }
            }
        }
        let (vectors, lanes) = (vec![Vectors::default(); groups], vec![Lanes::default(); groups]);
        Self {
            masses: lanes.clone(),
            inverse_masses: lanes.clone(),
            free,
            given_density,
            densities: vec![0.0; surface_masses.len()],
            momenta: vectors.clone(),
            base: vectors.clone(),
            velocities: vectors.clone(),
            trial: vectors,
            trial_areas: lanes.clone(),
            by_area: vec![Lanes::default(); groups + 1],
            by_total: vec![0.0; surface_masses.len()],
            energies: vec![0.0; layout.tiles.len()],
            changes: vec![Change::default(); layout.tiles.len()],
            surface_masses,
            plaquettes,
        }
    }

    /// Find the masses at the positions of the plaquettes.
    pub fn weigh(&mut self) {
        self.find_densities();
        for tile in &self.plaquettes.layout().tiles {
            let density = self.densities[tile.surface];
            let inverse = 1.0 / density;
            for group in tile.groups() {
                let (free, areas) = (&self.free[group], &self.plaquettes.areas[group]);
                self.inverse_masses[group] = inverse_masses(free, areas, inverse);
                let masses = &mut self.masses[group];
                (0..LANES).for_each(|k| masses[k] = density * areas[k] * free[k]);
            }
        }
    }

    fn find_densities(&mut self) {
        let surfaces = self.surface_masses.iter().zip(&self.plaquettes.totals);
        for (density, (mass, total)) in self.densities.iter_mut().zip(surfaces) {
            *density = if self.given_density > 0.0 { self.given_density } else { mass / total };
        }
    }

    /// Momenta from the velocities of all particles.
    pub fn read(&mut self, velocities: &[f64]) {
        let particles = &self.plaquettes.layout().particles;
        let lanes = particles.iter().zip(&self.masses).zip(&mut self.momenta);
        for ((particles, masses), p) in lanes {
            let v = of_particles(velocities, particles);
            for (p, v) in p.iter_mut().zip(&v) {
                (0..LANES).for_each(|lane| p[lane] = masses[lane] * v[lane]);
            }
        }
    }

    /// Give all particles the positions on trial.
    pub fn write_positions(&self, positions: &mut [f64]) {
        for (particles, x) in self.plaquettes.layout().particles.iter().zip(&self.trial) {
            for (lane, &particle) in particles.iter().enumerate().filter(|(_, p)| **p != NONE) {
                let first = 3 * particle as usize;
                (0..3).for_each(|axis| positions[first + axis] = x[axis][lane]);
            }
        }
    }

    /// Give all particles that move the velocities of their momenta and masses.
    pub fn write_velocities(&self, velocities: &mut [f64]) {
        let particles = &self.plaquettes.layout().particles;
        let lanes = particles.iter().zip(&self.inverse_masses).zip(&self.momenta);
        for ((particles, inverse), p) in lanes {
            for lane in (0..LANES).filter(|lane| inverse[*lane] != 0.0) {
                let first = 3 * particles[lane] as usize;
                (0..3).for_each(|axis| velocities[first + axis] = p[axis][lane] * inverse[lane]);
            }
        }
    }

    /// Begin a kick with the momenta and an impulse of the forces on all particles.
    pub fn add_forces(&mut self, forces: &[f64], time: f64) {
        let particles = &self.plaquettes.layout().particles;
        let lanes = particles.iter().zip(&self.free).zip(&self.momenta).zip(&mut self.base);
        for (((particles, free), p), base) in lanes {
            let f = of_particles(forces, particles);
            for ((base, p), f) in base.iter_mut().zip(p).zip(&f) {
                (0..LANES)
                    .for_each(|k| base[k] = p[k] + if free[k] == 0.0 { 0.0 } else { time * f[k] });
            }
        }
    }

    /// p = base − τ ∂K/∂q with ∂K/∂q of the momenta before. Returns the change.
    pub fn kick(&mut self, team: &mut Option<&mut Team>, time: f64) -> Change {
        self.find_energies(team);
        let layout = self.plaquettes.layout();
        let (momenta, changes) = (Parts::new(&mut self.momenta), Parts::new(&mut self.changes));
        let (free, base, by_area, by_total) =
            (&self.free, &self.base, &self.by_area, &self.by_total);
        let totals = &self.plaquettes.total_gradients;
        let neighbours = &self.plaquettes.neighbour_gradients;
        share(team, layout.tiles.len(), |tiles| {
            for tile in tiles {
                let groups = layout.tiles[tile].groups();
                // SAFETY: each tile has its own groups and its own change.
                let (momenta, change) =
                    unsafe { (momenta.part(groups.clone()), changes.part(tile..tile + 1)) };
                Kick {
                    layout,
                    time,
                    free: &free[groups.clone()],
                    by_area,
                    by_total: by_total[layout.tiles[tile].surface],
                    total_gradients: &totals[groups.clone()],
                    neighbour_gradients: &neighbours[layout.slots_of(groups.clone())],
                    base: &base[groups.clone()],
                    groups,
                    momenta,
                    change: &mut change[0],
                }
                .run();
            }
        });
        self.join_changes()
    }

    /// The derivatives of K with respect to areas, at the present momenta.
    fn find_energies(&mut self, team: &mut Option<&mut Team>) {
        let layout = self.plaquettes.layout();
        let (by_area, sums) = (Parts::new(&mut self.by_area), Parts::new(&mut self.energies));
        let (momenta, inverse_masses) = (&self.momenta, &self.inverse_masses);
        let (areas, densities) = (&self.plaquettes.areas, &self.densities);
        share(team, layout.tiles.len(), |tiles| {
            for tile in tiles {
                let groups = layout.tiles[tile].groups();
                // SAFETY: each tile has its own groups and its own sum.
                let (by_area, kinetic) =
                    unsafe { (by_area.part(groups.clone()), sums.part(tile..tile + 1)) };
                Energies {
                    momenta: &momenta[groups.clone()],
                    inverse_masses: &inverse_masses[groups.clone()],
                    areas: &areas[groups],
                    density: densities[layout.tiles[tile].surface],
                    by_area,
                    kinetic: &mut kinetic[0],
                }
                .run();
            }
        });
        self.by_total.fill(0.0);
        if self.given_density > 0.0 {
            return;
        }
        for (tile, sum) in layout.tiles.iter().zip(&self.energies) {
            self.by_total[tile.surface] += sum / self.plaquettes.totals[tile.surface];
        }
    }

    /// Solve for the momenta after half a kick. They are on neither side of it yet, so ∂K/∂q is that of the solution.
    ///
    /// # Errors
    /// Momenta that are not finite; no solution.
    pub fn kick_implicitly(&mut self, team: &mut Option<&mut Team>, step: f64) -> Result<()> {
        self.momenta.copy_from_slice(&self.base);
        let mut progress = Progress::default();
        for _ in 0..MOST_ITERATIONS {
            let change = self.kick(team, 0.5 * step);
            if !self.energies.iter().sum::<f64>().is_finite() {
                return Err(self.find_infinite().unwrap_or_else(|| self.give_up("kick", step)));
            }
            if progress.is_done(change) {
                return Ok(());
            }
        }
        Err(self.give_up("kick", step))
    }

    /// Solve for the positions after a step with the present momenta.
    ///
    /// # Errors
    /// No solution.
    pub fn drift(
        &mut self,
        team: &mut Option<&mut Team>,
        cell: Option<&Cell>,
        step: f64,
    ) -> Result<()> {
        let lanes = self.momenta.iter().zip(&self.inverse_masses).zip(&mut self.velocities);
        let places = self.plaquettes.positions.iter().zip(&mut self.trial);
        for (((p, inverse), v), (start, trial)) in lanes.zip(places) {
            for axis in 0..3 {
                for lane in 0..LANES {
                    v[axis][lane] = p[axis][lane] * inverse[lane];
                    trial[axis][lane] = start[axis][lane] + step * v[axis][lane];
                }
            }
        }
        let mut progress = Progress::default();
        for _ in 0..MOST_ITERATIONS {
            self.plaquettes.measure(team, &self.trial, &mut self.trial_areas, cell);
            if !self.plaquettes.totals.iter().sum::<f64>().is_finite() {
                break;
            }
            self.find_densities();
            if progress.is_done(self.drift_once(team, 0.5 * step)) {
                return Ok(());
            }
        }
        Err(self.give_up("drift", step))
    }

    /// Positions on trial by the masses at those before.
    fn drift_once(&mut self, team: &mut Option<&mut Team>, time: f64) -> Change {
        let layout = self.plaquettes.layout();
        let (trial, changes) = (Parts::new(&mut self.trial), Parts::new(&mut self.changes));
        let (start, areas, densities) =
            (&self.plaquettes.positions, &self.trial_areas, &self.densities);
        let (free, momenta, velocities) = (&self.free, &self.momenta, &self.velocities);
        share(team, layout.tiles.len(), |tiles| {
            for tile in tiles {
                let groups = layout.tiles[tile].groups();
                // SAFETY: each tile has its own groups and its own change.
                let (positions, change) =
                    unsafe { (trial.part(groups.clone()), changes.part(tile..tile + 1)) };
                Drift {
                    time,
                    start: &start[groups.clone()],
                    velocities: &velocities[groups.clone()],
                    momenta: &momenta[groups.clone()],
                    areas: &areas[groups.clone()],
                    free: &free[groups],
                    inverse_density: 1.0 / densities[layout.tiles[tile].surface],
                    positions,
                    change: &mut change[0],
                }
                .run();
            }
        });
        self.join_changes()
    }

    fn join_changes(&self) -> Change {
        self.changes.iter().copied().fold(Change::default(), Change::join)
    }

    /// The vertex whose velocity or force is not finite.
    fn find_infinite(&self) -> Option<Error> {
        let particles = &self.plaquettes.layout().particles;
        for (particles, base) in particles.iter().zip(&self.base) {
            for (lane, &particle) in particles.iter().enumerate() {
                if !(0..3).all(|axis| base[axis][lane].is_finite()) {
                    return Some(Error::NonFiniteMomentum { particle });
                }
            }
        }
        None
    }

    /// The error that names the vertex that would go furthest across its plaquette.
    fn give_up(&self, equation: &'static str, step: f64) -> Error {
        let layout = self.plaquettes.layout();
        let (mut furthest, mut particle) = (0.0, 0);
        for (group, particles) in layout.particles.iter().enumerate() {
            for lane in (0..LANES).filter(|lane| self.inverse_masses[group][*lane] != 0.0) {
                let square: f64 = (0..3).map(|axis| self.base[group][axis][lane].powi(2)).sum();
                let distance = step * square.sqrt() * self.inverse_masses[group][lane];
                let ways = distance / self.plaquettes.areas[group][lane].sqrt();
                if ways > furthest {
                    (furthest, particle) = (ways, particles[lane]);
                }
            }
        }
        let iterations = MOST_ITERATIONS;
        Error::NotConverged { equation, step, iterations, particle, ways: furthest }
    }
}
