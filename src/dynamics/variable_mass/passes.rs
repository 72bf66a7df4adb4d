//! The passes of the implicit equations over vertices, in lanes.

use crate::dynamics::instructions::{Arithmetic, Kernel, run};
use crate::dynamics::plaquettes::{LANES, Lanes, Layout, Neighbours, Vectors};
use crate::dynamics::random::{GROUP, Stream, fill_group};
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

/// Put an iterate in the place of the one before.
#[inline(always)]
fn replace(old: &mut f64, new: f64, change: &mut f64, scale: &mut f64) {
    *change = change.max((new - *old).abs());
    *scale = scale.max(new.abs());
    *old = new;
}

#[inline(always)]
fn largest(lanes: Lanes) -> f64 {
    lanes.into_iter().fold(0.0, f64::max)
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
                let v = [0, 1, 2].map(|axis| p[axis][lane] * inverse[lane]);
                let square = A::multiply_add(v[2], v[2], A::multiply_add(v[1], v[1], v[0] * v[0]));
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
    /// ∂K/∂aᵢ of all vertices.
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
        let neighbours = &self.layout.neighbours;
        let mut slot = self.layout.neighbours_of(self.groups.clone()).start;
        let mut gradients = self.neighbour_gradients.iter();
        let by_area = self.by_area.as_flattened();
        let (mut change, mut scale) = (Lanes::default(), Lanes::default());
        let results = self.momenta.iter_mut().zip(self.base).zip(self.total_gradients);
        for (group, (((p, base), total), free)) in self.groups.zip(results.zip(self.free)) {
            let mut slope = Vectors::default();
            let own = &self.by_area[group];
            for lane in 0..LANES {
                let by_itself = own[lane] / 3.0 + self.by_total;
                (0..3).for_each(|axis| slope[axis][lane] = by_itself * total[axis][lane]);
            }
            let end = self.layout.neighbours_of(group..group + 1).end;
            for Neighbours { vertices, .. } in &neighbours[slot..end] {
                let gradient = gradients.next().expect("as many as neighbours");
                let theirs: Lanes = std::array::from_fn(|k| by_area[vertices[k] as usize]);
                for axis in 0..3 {
                    for lane in 0..LANES {
                        slope[axis][lane] =
                            A::multiply_add(theirs[lane], gradient[axis][lane], slope[axis][lane]);
                    }
                }
            }
            slot = end;
            for axis in 0..3 {
                for lane in 0..LANES {
                    let time = -self.time * free[lane];
                    let new = A::multiply_add(time, slope[axis][lane], base[axis][lane]);
                    replace(&mut p[axis][lane], new, &mut change[lane], &mut scale[lane]);
                }
            }
        }
        *self.change = Change { change: largest(change), scale: largest(scale) };
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
        let (mut change, mut scale) = (Lanes::default(), Lanes::default());
        let inputs = self.start.iter().zip(self.velocities).zip(self.momenta);
        let inputs = inputs.zip(self.areas).zip(self.free).zip(self.positions);
        for (((((start, v), p), areas), free), x) in inputs {
            let inverse = inverse_masses(free, areas, self.inverse_density);
            for axis in 0..3 {
                for lane in 0..LANES {
                    let twice = A::multiply_add(p[axis][lane], inverse[lane], v[axis][lane]);
                    let new = A::multiply_add(self.time, twice, start[axis][lane]);
                    replace(&mut x[axis][lane], new, &mut change[lane], &mut scale[lane]);
                }
            }
        }
        *self.change = Change { change: largest(change), scale: largest(scale) };
    }
}

/// 1/mᵢ, 0 for vertices that stay where they are.
#[inline(always)]
pub fn inverse_masses(free: &Lanes, areas: &Lanes, inverse_density: f64) -> Lanes {
    std::array::from_fn(|lane| {
        // Both are computed and one is chosen, which takes no branch.
        let inverse = inverse_density / areas[lane];
        if free[lane] == 0.0 { 0.0 } else { inverse }
    })
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
