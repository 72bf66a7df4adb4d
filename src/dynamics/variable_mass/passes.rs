//! The passes of a time step over vertices, in lanes.

use crate::dynamics::plaquettes::{LANES, Lanes, Layout, THIRD, Vectors};
use crate::dynamics::random::{GROUP, Stream, fill_group};
use crate::lanes::{Arithmetic, Kernel, run};
use std::ops::Range;

/// How far an iterate is from the one before, and how large it is, by their largest components.
#[derive(Clone, Copy, Default)]
pub struct Change {
    pub change: f64,
    pub scale: f64,
}

impl Change {
    /// The larger of both.
    pub fn join(self, other: Self) -> Self {
        Self { change: self.change.max(other.change), scale: self.scale.max(other.scale) }
    }
}

/// a b + c in each lane.
#[inline(always)]
fn multiply_add<A: Arithmetic>(a: &Lanes, b: &Lanes, c: &Lanes) -> Lanes {
    let mut sum = *c;
    for lane in 0..LANES {
        sum[lane] = A::multiply_add(a[lane], b[lane], c[lane]);
    }
    sum
}

/// The largest changes and sizes of the components in each lane.
#[derive(Default)]
struct Changes {
    change: Lanes,
    scale: Lanes,
}

impl Changes {
    /// Put a component of an iterate in the place of the one before.
    #[inline(always)]
    fn replace(&mut self, old: &mut Lanes, new: Lanes) {
        for lane in 0..LANES {
            // Other than `f64::max`, these comparisons are one instruction.
            let (change, scale) = ((new[lane] - old[lane]).abs(), new[lane].abs());
            self.change[lane] = if change > self.change[lane] { change } else { self.change[lane] };
            self.scale[lane] = if scale > self.scale[lane] { scale } else { self.scale[lane] };
        }
        *old = new;
    }

    #[inline(always)]
    fn largest(&self) -> Change {
        Change { change: largest(&self.change), scale: largest(&self.scale) }
    }
}

#[inline(always)]
fn largest(lanes: &Lanes) -> f64 {
    let mut largest = 0.0f64;
    for lane in lanes {
        largest = largest.max(*lane);
    }
    largest
}

/// ∂K/∂aᵢ = −σ vᵢ²/2 at constant A and momenta, and the sum K of mᵢ vᵢ²/2; σ = mᵢ/aᵢ.
pub struct Energies<'a> {
    pub momenta: &'a [Vectors],
    pub inverse_masses: &'a [Lanes],
    pub areas: &'a [Lanes],
    /// σ, amu/nm².
    pub density: f64,
    pub by_area: &'a mut [Lanes],
    pub kinetic: &'a mut f64,
}

impl Energies<'_> {
    pub fn run(self) {
        run(self);
    }
}

impl Kernel for Energies<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut sums = Lanes::default();
        let inputs = self.momenta.iter().zip(self.inverse_masses).zip(self.areas);
        for (((p, inverse), areas), by_area) in inputs.zip(self.by_area) {
            for lane in 0..LANES {
                let mut square = 0.0;
                for axis in 0..3 {
                    let v = p[axis][lane] * inverse[lane];
                    square = A::multiply_add(v, v, square);
                }
                by_area[lane] = -0.5 * self.density * square;
                sums[lane] = A::multiply_add(by_area[lane], -areas[lane], sums[lane]);
            }
        }
        *self.kinetic = sums.iter().sum();
    }
}

/// p = base − τ ∂K/∂r with ∂K/∂rᵢ = Σⱼ ∂K/∂aⱼ ∂aⱼ/∂rᵢ + ∂K/∂A ∂A/∂rᵢ, for some groups of vertices.
pub struct Kick<'a> {
    pub layout: &'a Layout,
    pub groups: Range<usize>,
    /// τ, ps.
    pub time: f64,
    /// 1 for vertices that move, 0 for others.
    pub free: &'a [Lanes],
    /// ∂K/∂aᵢ of all vertices, and 0 beyond them.
    pub by_area: &'a [Lanes],
    /// ∂K/∂A.
    pub by_total: f64,
    pub total_gradients: &'a [Vectors],
    /// ∂aⱼ/∂rᵢ of these groups.
    pub neighbour_gradients: &'a [Vectors],
    pub base: &'a [Vectors],
    pub momenta: &'a mut [Vectors],
    pub change: &'a mut Change,
}

impl Kick<'_> {
    pub fn run(self) {
        run(self);
    }
}

impl Kernel for Kick<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut gradients = self.neighbour_gradients.iter();
        let by_area = self.by_area.as_flattened();
        let mut changes = Changes::default();
        let results = self.momenta.iter_mut().zip(self.base).zip(self.total_gradients);
        for (group, (((p, base), total), free)) in self.groups.zip(results.zip(self.free)) {
            let (mut by_itself, mut time) = (self.by_area[group], *free);
            for lane in 0..LANES {
                by_itself[lane] = A::multiply_add(by_itself[lane], THIRD, self.by_total);
                time[lane] *= -self.time;
            }
            let none = Lanes::default();
            let mut x = multiply_add::<A>(&by_itself, &total[0], &none);
            let mut y = multiply_add::<A>(&by_itself, &total[1], &none);
            let mut z = multiply_add::<A>(&by_itself, &total[2], &none);
            for neighbours in &self.layout.neighbours[self.layout.slots_of(group..group + 1)] {
                let gradient = gradients.next().expect("as many as slots");
                let mut theirs = Lanes::default();
                for lane in 0..LANES {
                    theirs[lane] = by_area[neighbours[lane] as usize];
                }
                x = multiply_add::<A>(&theirs, &gradient[0], &x);
                y = multiply_add::<A>(&theirs, &gradient[1], &y);
                z = multiply_add::<A>(&theirs, &gradient[2], &z);
            }
            changes.replace(&mut p[0], multiply_add::<A>(&time, &x, &base[0]));
            changes.replace(&mut p[1], multiply_add::<A>(&time, &y, &base[1]));
            changes.replace(&mut p[2], multiply_add::<A>(&time, &z, &base[2]));
        }
        *self.change = changes.largest();
    }
}

/// x = start + τ (v + p/m) with m at the x before, for some groups of vertices.
pub struct Drift<'a> {
    /// τ, ps.
    pub time: f64,
    pub start: &'a [Vectors],
    /// v with the masses at the start.
    pub velocities: &'a [Vectors],
    pub momenta: &'a [Vectors],
    pub areas: &'a [Lanes],
    /// 1 for vertices that move, 0 for others.
    pub free: &'a [Lanes],
    /// aᵢ/mᵢ, nm²/amu.
    pub inverse_density: f64,
    pub positions: &'a mut [Vectors],
    pub change: &'a mut Change,
}

impl Drift<'_> {
    pub fn run(self) {
        run(self);
    }
}

impl Kernel for Drift<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut changes = Changes::default();
        let inputs = self.start.iter().zip(self.velocities).zip(self.momenta);
        let inputs = inputs.zip(self.areas).zip(self.free).zip(self.positions);
        let time = [self.time; LANES];
        for (((((start, v), p), areas), free), x) in inputs {
            let inverse = inverse_masses(free, areas, self.inverse_density);
            let twice = multiply_add::<A>(&p[0], &inverse, &v[0]);
            changes.replace(&mut x[0], multiply_add::<A>(&time, &twice, &start[0]));
            let twice = multiply_add::<A>(&p[1], &inverse, &v[1]);
            changes.replace(&mut x[1], multiply_add::<A>(&time, &twice, &start[1]));
            let twice = multiply_add::<A>(&p[2], &inverse, &v[2]);
            changes.replace(&mut x[2], multiply_add::<A>(&time, &twice, &start[2]));
        }
        *self.change = changes.largest();
    }
}

/// 1/mᵢ, 0 for vertices that stay where they are.
#[inline(always)]
pub fn inverse_masses(free: &Lanes, areas: &Lanes, inverse_density: f64) -> Lanes {
    let mut masses = Lanes::default();
    for lane in 0..LANES {
        // Both are computed and one is chosen, which takes no branch.
        let inverse = inverse_density / areas[lane];
        masses[lane] = if free[lane] == 0.0 { 0.0 } else { inverse };
    }
    masses
}

/// v = c v + s √(1/m) ξ: the exact step of an Ornstein–Uhlenbeck process, for some groups of components.
pub struct Bath<'a> {
    pub stream: &'a Stream,
    pub first_group: u64,
    /// c = exp(−γ τ).
    pub scale: f64,
    /// s = √(kT (1 − c²)).
    pub noise: f64,
    /// √(1/m); 0 for what does not move.
    pub roots: &'a [f64],
    pub velocities: &'a mut [f64],
}

impl Bath<'_> {
    pub fn run(self) {
        run(self);
    }
}

impl Kernel for Bath<'_> {
    #[inline(always)]
    fn execute<A: Arithmetic>(self) {
        let mut normals = [0.0; GROUP];
        let groups = self.velocities.chunks_mut(GROUP).zip(self.roots.chunks(GROUP));
        for (i, (velocities, roots)) in groups.enumerate() {
            fill_group::<A>(self.stream, self.first_group + i as u64, &mut normals);
            for ((v, &root), normal) in velocities.iter_mut().zip(roots).zip(&normals) {
                let new = self.scale * *v + self.noise * root * normal;
                *v = if root == 0.0 { *v } else { new };
            }
        }
    }
}
