//! Positions as the shaders take them: relative to the middle of each connected part of the mesh, in units of a
//! power of two near the mean edge, so that no size of mesh leaves the range of a float, and in single precision as whole
//! numbers. (OpenMM's platforms do this on the device, relative to the first vertex of each part: `openmm_kernels.c`.)
//!
//! The difference of two whole numbers is exact. So the sides of triangles, from which all forces come, are as
//! precise as their lengths allow, and not as the mesh's size does.

use super::Precision;
use super::interface::HALF_WIDTH_BITS;
use crate::mesh::Topology;

/// Adding it to a number below 2³¹ leaves the number, rounded, in the last bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// How positions were brought to the device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The device's unit of length, nm.
    pub unit: f64,
    /// A step of the lattice, in those units.
    pub quantum: f64,
}

/// The parts of a mesh and their positions.
pub struct Lattice {
    /// The part of each vertex, and their number.
    parts: Vec<u32>,
    num_parts: usize,
    middles: Vec<[f64; 3]>,
    steps: Vec<i32>,
    reals: Vec<f64>,
}

impl Lattice {
    pub fn new(topology: &Topology, precision: Precision) -> Self {
        let (parts, num_parts) = connected_parts(topology);
        let length = 3 * topology.num_vertices();
        let (steps, reals) = match precision {
            Precision::Single => (vec![0; length], Vec::new()),
            Precision::Double => (Vec::new(), vec![0.0; length]),
        };
        Self { parts, num_parts, middles: vec![[0.0; 3]; num_parts], steps, reals }
    }

    /// Take the positions of all particles. `None` if they are not finite or all the same: then there is nothing
    /// that the device could compute.
    pub fn place(&mut self, topology: &Topology, all: &[f64]) -> Option<Scale> {
        let half = self.find_middles(topology, all)?;
        let exponent = half.log2().floor() as i32 + 1;
        // The edge of a sphere's mesh; any value of this order would do.
        let edge = 3.8 * half / (topology.num_vertices() as f64).sqrt();
        let unit = 2f64.powi(edge.log2().round() as i32);
        let steps_per_nm = 2f64.powi(HALF_WIDTH_BITS as i32 - exponent);
        let scale = Scale { unit, quantum: 1.0 / (steps_per_nm * unit) };
        // Sizes beyond these powers are no membranes, but must not become infinities unnoticed.
        if !(1e-100..1e100).contains(&half) {
            return None;
        }
        let vertices = topology.particles.iter().zip(&self.parts);
        if self.reals.is_empty() {
            for ((particle, part), steps) in vertices.zip(self.steps.chunks_exact_mut(3)) {
                let middle = &self.middles[*part as usize];
                let position = &all[3 * *particle as usize..][..3];
                for axis in 0..3 {
                    let rounded = (position[axis] - middle[axis]) * steps_per_nm + ROUNDER;
                    steps[axis] = rounded.to_bits() as i32;
                }
            }
        } else {
            let inverse = 1.0 / unit;
            for ((particle, part), reals) in vertices.zip(self.reals.chunks_exact_mut(3)) {
                let middle = &self.middles[*part as usize];
                let position = &all[3 * *particle as usize..][..3];
                for axis in 0..3 {
                    reals[axis] = (position[axis] - middle[axis]) * inverse;
                }
            }
        }
        Some(scale)
    }

    /// What the device shall read.
    pub fn bytes(&self) -> &[u8] {
        if self.reals.is_empty() {
            bytemuck::cast_slice(&self.steps)
        } else {
            bytemuck::cast_slice(&self.reals)
        }
    }

    /// The middle of each part's bounding box; returns half of the largest width.
    fn find_middles(&mut self, topology: &Topology, all: &[f64]) -> Option<f64> {
        let empty = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut boxes = vec![empty; self.num_parts];
        let mut finite = true;
        for (particle, part) in topology.particles.iter().zip(&self.parts) {
            let (low, high) = &mut boxes[*part as usize];
            let position = &all[3 * *particle as usize..][..3];
            for axis in 0..3 {
                let x = position[axis];
                finite &= x.is_finite();
                low[axis] = low[axis].min(x);
                high[axis] = high[axis].max(x);
            }
        }
        let mut half: f64 = 0.0;
        for ((low, high), middle) in boxes.iter().zip(&mut self.middles) {
            for axis in 0..3 {
                middle[axis] = low[axis] + 0.5 * (high[axis] - low[axis]);
                half = half.max(high[axis] - middle[axis]).max(middle[axis] - low[axis]);
            }
        }
        (finite && half > 0.0 && half.is_finite()).then_some(half)
    }
}

/// Number the connected parts of a mesh.
pub fn connected_parts(topology: &Topology) -> (Vec<u32>, usize) {
    const UNKNOWN: u32 = u32::MAX;
    let mut parts = vec![UNKNOWN; topology.num_vertices()];
    let mut count = 0;
    let mut waiting = Vec::new();
    for seed in 0..parts.len() {
        if parts[seed] != UNKNOWN {
            continue;
        }
        parts[seed] = count;
        waiting.push(seed);
        while let Some(vertex) = waiting.pop() {
            for corner in &topology.corners[topology.ring(vertex)] {
                for neighbour in topology.triangles[*corner as usize / 3] {
                    if parts[neighbour as usize] == UNKNOWN {
                        parts[neighbour as usize] = count;
                        waiting.push(neighbour as usize);
                    }
                }
            }
        }
        count += 1;
    }
    (parts, count as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::octahedron;

    /// Two octahedra of radius 1, far from each other.
    fn pair() -> (Topology, Vec<f64>) {
        let (vertices, mut triangles) = octahedron();
        triangles.extend(octahedron().1.iter().map(|t| t.map(|v| v + 6)));
        let near = vertices.as_flattened().to_vec();
        let far = near.iter().map(|x| x + 1e6);
        let positions = near.iter().copied().chain(far).collect();
        (Topology::new(&triangles, 12).unwrap(), positions)
    }

    #[test]
    fn each_part_has_its_own_middle() {
        let (topology, positions) = pair();
        let mut lattice = Lattice::new(&topology, Precision::Single);
        assert_eq!(lattice.num_parts, 2);
        let scale = lattice.place(&topology, &positions).unwrap();
        let steps_per_nm = 1.0 / (scale.quantum * scale.unit);
        assert_eq!(steps_per_nm, 2f64.powi(28));
        for (step, x) in lattice.steps.iter().zip(positions[..18].iter().chain(&positions[..18])) {
            assert_eq!(f64::from(*step), x * steps_per_nm);
        }
    }

    #[test]
    fn positions_are_rounded_to_the_nearest_step() {
        let (topology, mut positions) = pair();
        positions[1] = 0.3;
        positions[4] = -0.3;
        let mut lattice = Lattice::new(&topology, Precision::Single);
        lattice.place(&topology, &positions).unwrap();
        assert_eq!(lattice.steps[1], (0.3 * 2f64.powi(28)).round() as i32);
        assert_eq!(lattice.steps[4], (-0.3 * 2f64.powi(28)).round() as i32);
    }

    #[test]
    fn what_has_no_size_or_no_place_is_refused() {
        let (topology, positions) = pair();
        let mut lattice = Lattice::new(&topology, Precision::Double);
        assert!(lattice.place(&topology, &vec![1.0; 36]).is_none());
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut lost = positions.clone();
            lost[7] = bad;
            assert!(lattice.place(&topology, &lost).is_none());
        }
    }
}
