//! One time step of all particles, for OpenMM's Verlet, LangevinMiddle and Brownian integrators.
//!
//! The schemes are those of OpenMM's Reference platform, operation by operation, so that what is not random has
//! the same bits. Arrays are flat: x, y, z of particle 0, x, y, z of particle 1 …. Components come in
//! groups of [`GROUP`], each with its own random numbers; threads share groups, so that the results do not
//! depend on their number.

use super::random::{GROUP, Stream, fill_group};
use crate::lanes::{Arithmetic, Kernel, run};
use crate::team::{Parts, Team};
use std::ops::Range;

/// From this many particles on, threads that have just evaluated membranes share a step,
pub const PARALLEL_FROM: usize = 4_000;

/// and from this many on, threads that may sleep.
pub const WAKE_FROM: usize = 20_000;

/// What a step reads and changes; three values for each particle, nm, nm/ps and kJ/mol/nm.
pub struct Particles<'a> {
    /// Changed by the step.
    pub positions: &'a mut [f64],
    /// Changed by the step.
    pub velocities: &'a mut [f64],
    /// Those at the positions before the step.
    pub forces: &'a [f64],
}

/// What happens to one component of one particle.
trait Scheme: Sync {
    /// Whether it takes a random number.
    const IS_RANDOM: bool;

    /// The position and velocity after the step, of a particle with 1/m and √(1/m); `normal` has mean 0
    /// and variance 1.
    fn advance(&self, before: State, inverse_mass: f64, root: f64, normal: f64) -> (f64, f64);
}

/// One component of one particle.
#[derive(Clone, Copy)]
struct State {
    position: f64,
    velocity: f64,
    force: f64,
}

/// Leapfrog, v(t + dt/2) = v(t − dt/2) + f dt/m, x(t + dt) = x + v dt.
struct Verlet {
    step: f64,
    inverse_step: f64,
}

/// Kick, half drift, Ornstein–Uhlenbeck, half drift: Z. Zhang, X. Liu, K. Yan, M. E. Tuckerman, J. Liu,
/// doi:10.1021/acs.jpca.9b02771.
struct LangevinMiddle {
    step: f64,
    half_step: f64,
    /// exp(−γ dt).
    scale: f64,
    /// √(kT (1 − scale²)), what the noise has besides √(1/m).
    noise: f64,
}

/// x(t + dt) = x + f dt/(γ m) + √(2 kT dt/(γ m)) ξ.
struct Brownian {
    force_scale: f64,
    noise: f64,
    inverse_step: f64,
}

impl Scheme for Verlet {
    const IS_RANDOM: bool = false;

    #[inline(always)]
    fn advance(&self, before: State, inverse_mass: f64, _: f64, _: f64) -> (f64, f64) {
        let velocity = before.velocity + inverse_mass * before.force * self.step;
        let position = before.position + velocity * self.step;
        // Constraints would have moved the position meanwhile; OpenMM does this without them, too.
        (position, self.inverse_step * (position - before.position))
    }
}

impl Scheme for LangevinMiddle {
    const IS_RANDOM: bool = true;

    #[inline(always)]
    fn advance(&self, before: State, inverse_mass: f64, root: f64, normal: f64) -> (f64, f64) {
        let kicked = before.velocity + (self.step * inverse_mass) * before.force;
        let middle = before.position + kicked * self.half_step;
        let velocity = self.scale * kicked + self.noise * root * normal;
        (middle + velocity * self.half_step, velocity)
    }
}

impl Scheme for Brownian {
    const IS_RANDOM: bool = true;

    #[inline(always)]
    fn advance(&self, before: State, inverse_mass: f64, root: f64, normal: f64) -> (f64, f64) {
        let position = before.position
            + self.force_scale * inverse_mass * before.force
            + self.noise * root * normal;
        (position, self.inverse_step * (position - before.position))
    }
}

/// The masses of particles, ready for time steps. Massless particles do not move.
pub struct Dynamics {
    masses: Masses,
}

enum Masses {
    /// 1/m and its root.
    Equal(f64, f64),
    /// The same for each component; 0 for massless particles.
    Each(Vec<f64>, Vec<f64>),
}

impl Dynamics {
    /// Time steps of particles with these masses, amu.
    pub fn new(masses: &[f64]) -> Self {
        let inverse = |mass: f64| if mass == 0.0 { 0.0 } else { 1.0 / mass };
        let first = masses.first().copied().unwrap_or(0.0);
        if masses.iter().all(|&mass| mass == first) {
            return Self { masses: Masses::Equal(inverse(first), inverse(first).sqrt()) };
        }
        let inverse: Vec<_> = masses.iter().flat_map(|&mass| [inverse(mass); 3]).collect();
        let root = inverse.iter().map(|inverse| inverse.sqrt()).collect();
        Self { masses: Masses::Each(inverse, root) }
    }

    /// A step of OpenMM's VerletIntegrator, of `step` ps.
    pub fn verlet(&self, team: Option<&mut Team>, particles: Particles, step: f64) {
        let scheme = Verlet { step, inverse_step: 1.0 / step };
        self.advance(team, particles, &scheme, &Stream { key: [0; 2], draws: 0 });
    }

    /// A step of OpenMM's LangevinMiddleIntegrator, of `step` ps with `friction` in 1/ps and kT in kJ/mol. Takes one
    /// draw of the stream.
    pub fn langevin_middle(
        &self,
        team: Option<&mut Team>,
        particles: Particles,
        stream: &mut Stream,
        (step, friction, kt): (f64, f64, f64),
    ) {
        let scale = (-step * friction).exp();
        let noise = (1.0 - scale * scale).sqrt() * kt.sqrt();
        let scheme = LangevinMiddle { step, half_step: 0.5 * step, scale, noise };
        self.advance(team, particles, &scheme, stream);
        stream.draws += 1;
    }

    /// A step of OpenMM's BrownianIntegrator, of `step` ps with `friction` in 1/ps and kT in kJ/mol. Takes one draw
    /// of the stream.
    pub fn brownian(
        &self,
        team: Option<&mut Team>,
        particles: Particles,
        stream: &mut Stream,
        (step, friction, kt): (f64, f64, f64),
    ) {
        let noise = (2.0 * kt * step / friction).sqrt();
        let scheme = Brownian { force_scale: step / friction, noise, inverse_step: 1.0 / step };
        self.advance(team, particles, &scheme, stream);
        stream.draws += 1;
    }

    fn advance<S: Scheme>(
        &self,
        team: Option<&mut Team>,
        particles: Particles,
        scheme: &S,
        stream: &Stream,
    ) {
        let Particles { positions, velocities, forces } = particles;
        let length = positions.len();
        assert!(velocities.len() == length && forces.len() == length, "arrays of one length");
        if let Masses::Each(inverse, _) = &self.masses {
            assert_eq!(inverse.len(), length, "as many masses as particles");
        }
        let (positions, velocities) = (Parts::new(positions), Parts::new(velocities));
        let advance = |groups: Range<usize>| {
            let range = groups.start * GROUP..(groups.end * GROUP).min(length);
            // SAFETY: groups do not overlap, and those of different threads are different.
            let (positions, velocities) =
                unsafe { (positions.part(range.clone()), velocities.part(range.clone())) };
            let forces = &forces[range.clone()];
            let first_group = groups.start as u64;
            let masses = match &self.masses {
                // Without any mass nothing moves.
                Masses::Equal(0.0, _) => return,
                Masses::Equal(inverse, root) => MassesOf::Equal(*inverse, *root),
                Masses::Each(inverse, root) => {
                    MassesOf::Each(&inverse[range.clone()], &root[range])
                }
            };
            run(Advance { scheme, stream, first_group, masses, positions, velocities, forces });
        };
        let groups = length.div_ceil(GROUP);
        match team.filter(|team| team.size() > 1 && length >= 3 * PARALLEL_FROM) {
            Some(team) => team.run(|member| advance(member.share(groups))),
            None => advance(0..groups),
        }
    }
}

/// The masses of a range of components.
#[derive(Clone, Copy)]
enum MassesOf<'a> {
    Equal(f64, f64),
    Each(&'a [f64], &'a [f64]),
}

/// The step of some groups that follow each other.
struct Advance<'a, S> {
    scheme: &'a S,
    stream: &'a Stream,
    first_group: u64,
    masses: MassesOf<'a>,
    positions: &'a mut [f64],
    velocities: &'a mut [f64],
    forces: &'a [f64],
}

impl<S: Scheme> Kernel for Advance<'_, S> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut normals = [0.0; GROUP];
        let arrays = self.positions.chunks_mut(GROUP).zip(self.velocities.chunks_mut(GROUP));
        for (i, (x, v)) in arrays.enumerate() {
            if S::IS_RANDOM {
                fill_group::<A>(self.stream, self.first_group + i as u64, &mut normals);
            }
            let range = i * GROUP..i * GROUP + x.len();
            let f = &self.forces[range.clone()];
            let before =
                |x: &f64, v: &f64, f: &f64| State { position: *x, velocity: *v, force: *f };
            match self.masses {
                MassesOf::Equal(inverse, root) => {
                    for (((x, v), f), normal) in x.iter_mut().zip(v).zip(f).zip(&normals) {
                        (*x, *v) = self.scheme.advance(before(x, v, f), inverse, root, *normal);
                    }
                }
                MassesOf::Each(inverse, root) => {
                    let masses = inverse[range.clone()].iter().zip(&root[range]);
                    let states = x.iter_mut().zip(v).zip(f).zip(&normals).zip(masses);
                    for ((((x, v), f), normal), (&inverse, &root)) in states {
                        let state = before(x, v, f);
                        let after = self.scheme.advance(state, inverse, root, *normal);
                        // Both are computed and one is chosen, which takes no branch.
                        let moves = inverse != 0.0;
                        *x = if moves { after.0 } else { state.position };
                        *v = if moves { after.1 } else { state.velocity };
                    }
                }
            }
        }
    }
}

/// Set all forces to zero.
pub fn clear(team: Option<&mut Team>, forces: &mut [f64]) {
    let length = forces.len();
    match team.filter(|team| team.size() > 1 && length >= 3 * PARALLEL_FROM) {
        None => forces.fill(0.0),
        Some(team) => {
            let parts = Parts::new(forces);
            // The bounds of groups, so that the memory is near the thread that will use it.
            team.run(|member| {
                let groups = member.share(length.div_ceil(GROUP));
                let range = groups.start * GROUP..(groups.end * GROUP).min(length);
                // SAFETY: the shares of members do not overlap.
                unsafe { parts.part(range) }.fill(0.0);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::kernels::{Fused, Plain};

    const SIZE: usize = 100;
    const STEP: f64 = 0.003;

    /// Positions, velocities and forces without any pattern.
    fn arrays(num_particles: usize) -> [Vec<f64>; 3] {
        let mut stream = Stream { key: [17, 0], draws: 0 };
        std::array::from_fn(|_| {
            let mut values = vec![0.0; 3 * num_particles];
            super::super::random::normals(&mut stream, &mut values);
            values
        })
    }

    fn masses(num_particles: usize) -> Vec<f64> {
        (0..num_particles).map(|i| if i % 5 == 2 { 0.0 } else { 1.0 + i as f64 }).collect()
    }

    fn langevin_steps(masses: &[f64], threads: usize, steps: usize) -> [Vec<f64>; 2] {
        let dynamics = Dynamics::new(masses);
        let [mut positions, mut velocities, forces] = arrays(masses.len());
        let mut stream = Stream { key: [1, 2], draws: 0 };
        let mut team = Team::new(threads).unwrap();
        for _ in 0..steps {
            let particles = Particles {
                positions: &mut positions,
                velocities: &mut velocities,
                forces: &forces,
            };
            dynamics.langevin_middle(Some(&mut team), particles, &mut stream, (STEP, 1.5, 2.5));
        }
        assert_eq!(stream.draws, steps as u64);
        [positions, velocities]
    }

    /// The loops of the kernels against the scheme as the textbook has it, one component after the other.
    #[test]
    fn langevin_steps_are_those_of_the_scheme() {
        let masses = masses(SIZE);
        let [positions, velocities] = langevin_steps(&masses, 1, 1);
        let [old_positions, old_velocities, forces] = arrays(SIZE);
        let mut noise = vec![0.0; 3 * SIZE];
        super::super::random::normals(&mut Stream { key: [1, 2], draws: 0 }, &mut noise);
        let scale = (-STEP * 1.5).exp();
        for i in 0..3 * SIZE {
            let mass = masses[i / 3];
            let (mut x, mut v) = (old_positions[i], old_velocities[i]);
            if mass != 0.0 {
                v += STEP * forces[i] / mass;
                x += v * STEP / 2.0;
                v = scale * v + ((1.0 - scale * scale) * 2.5 / mass).sqrt() * noise[i];
                x += v * STEP / 2.0;
            }
            assert!((positions[i] - x).abs() < 1e-14 && (velocities[i] - v).abs() < 1e-14, "{i}");
        }
    }

    #[test]
    fn threads_do_not_change_the_bits() {
        let masses = masses(PARALLEL_FROM + 7);
        let one = langevin_steps(&masses, 1, 2);
        for threads in [2, 3] {
            assert_eq!(langevin_steps(&masses, threads, 2), one);
        }
        // The first particles do not notice how many there are.
        assert_eq!(langevin_steps(&masses[..SIZE], 1, 2)[0][..], one[0][..3 * SIZE]);
    }

    /// Without fused multiply-adds, the random numbers differ by rounding and nothing else does.
    #[test]
    fn instructions_change_the_last_digits_of_noise_only() {
        fn step<A: Arithmetic, S: Scheme>(scheme: &S) -> [Vec<f64>; 2] {
            let [mut positions, mut velocities, forces] = arrays(SIZE);
            Advance {
                scheme,
                stream: &Stream { key: [1, 2], draws: 3 },
                first_group: 0,
                masses: MassesOf::Equal(0.02, 0.02f64.sqrt()),
                positions: &mut positions,
                velocities: &mut velocities,
                forces: &forces,
            }
            .execute::<A>();
            [positions, velocities]
        }
        let verlet = Verlet { step: STEP, inverse_step: 1.0 / STEP };
        assert_eq!(step::<Plain, _>(&verlet), step::<Fused, _>(&verlet));
        let langevin = LangevinMiddle { step: STEP, half_step: STEP / 2.0, scale: 0.9, noise: 1.0 };
        let (plain, fused) = (step::<Plain, _>(&langevin), step::<Fused, _>(&langevin));
        for (a, b) in plain.iter().flatten().zip(fused.iter().flatten()) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn forces_are_cleared_with_and_without_threads() {
        for (length, threads) in [(0, 1), (7, 2), (3 * PARALLEL_FROM + 1, 3)] {
            let mut forces = vec![1.0; length];
            clear(Some(&mut Team::new(threads).unwrap()), &mut forces);
            assert!(forces.iter().all(|&force| force == 0.0));
        }
    }

    #[test]
    #[should_panic(expected = "as many masses as particles")]
    fn masses_and_particles_must_match() {
        let [mut positions, mut velocities, forces] = arrays(SIZE);
        let particles =
            Particles { positions: &mut positions, velocities: &mut velocities, forces: &forces };
        Dynamics::new(&[1.0, 2.0]).verlet(None, particles, STEP);
    }
}
