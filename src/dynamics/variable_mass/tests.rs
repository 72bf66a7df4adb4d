use super::vertices::Vertices;
use super::*;
use crate::dynamics::random::normals;
use crate::test_meshes::{icosahedron, octahedron};

const STEP: f64 = 0.05;
const BOX: [[f64; 3]; 3] = [[9.0, 0.0, 0.0], [1.0, 8.0, 0.0], [-2.0, 1.5, 10.0]];

/// An icosahedron, an octahedron with a hole and two particles that are no vertices, out of shape; one vertex of each
/// surface and one of the particles do not move.
struct Start {
    triangles: Vec<[i32; 3]>,
    masses: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    cell: Option<Cell>,
}

fn noise(key: u32, length: usize) -> Vec<f64> {
    let mut values = vec![0.0; length];
    normals(&mut Stream { key: [key, 0], draws: 0 }, &mut values);
    values
}

fn start(is_periodic: bool) -> Start {
    let ((mut vertices, closed), (others, open)) = (icosahedron(), octahedron());
    let open = open[1..].iter().map(|corners| corners.map(|corner| corner + 12));
    let triangles = closed.into_iter().chain(open);
    vertices.extend(others.iter().map(|[x, y, z]| [x + 4.0, *y, *z]));
    vertices.extend([[2.0, 3.0, 1.0], [-1.0, 3.5, 2.0]]);
    let count = vertices.len();
    let cell = is_periodic.then(|| Cell::new(BOX).unwrap());
    let jitter = noise(1, 3 * count);
    let mut positions: Vec<_> =
        vertices.as_flattened().iter().zip(&jitter).map(|(x, noise)| x + 0.15 * noise).collect();
    if let Some(cell) = &cell {
        for position in positions.as_chunks_mut::<3>().0 {
            let here = crate::mesh::geometry::Vec3::from(*position);
            *position = (here + cell.shift(cell.wrap(&here))).into();
        }
    }
    let fixed = [5, 14, 19];
    let masses: Vec<_> = (0..count)
        .map(|i| if fixed.contains(&i) { 0.0 } else { 2.0 + 0.3 * (i % 5) as f64 })
        .collect();
    let mut velocities = noise(2, 3 * count);
    for &particle in &fixed {
        velocities[3 * particle..3 * particle + 3].fill(0.0);
    }
    let triangles = triangles.map(|corners| corners.map(|corner| corner as i32)).collect();
    Start { triangles, masses, positions, velocities, cell }
}

impl Start {
    fn masses(&self, density: f64) -> VariableMasses {
        let mut masses = VariableMasses::new(&self.masses, density);
        // The same triangles in another order and sense are the same surface.
        let mut others = self.triangles.clone();
        others.reverse();
        others.iter_mut().for_each(|corners| corners.reverse());
        let is_periodic = self.cell.is_some();
        let sheets = [&self.triangles, &others].map(|t| Sheet { triangles: t, is_periodic });
        masses.set_surfaces(&sheets).unwrap();
        masses
    }

    /// aᵢ of all particles and A of both surfaces, as the textbook has them.
    fn areas(&self, positions: &[f64]) -> (Vec<f64>, [f64; 2]) {
        let (mut areas, mut totals) = (vec![0.0; self.masses.len()], [0.0; 2]);
        let place = |i: i32| crate::mesh::geometry::Vec3::from(positions.as_chunks().0[i as usize]);
        for &[a, b, c] in &self.triangles {
            let [ab, ac] = [b, c].map(|corner| {
                let side = place(corner) - place(a);
                side + self
                    .cell
                    .map_or_else(Default::default, |cell| cell.shift(cell.nearest(&side)))
            });
            let area = 0.5 * ab.cross(&ac).norm();
            for corner in [a, b, c] {
                areas[corner as usize] += area / 3.0;
            }
            totals[usize::from(a >= 12)] += area;
        }
        (areas, totals)
    }

    /// The masses as the definition has them.
    fn expected(&self, density: f64, positions: &[f64]) -> Vec<f64> {
        let (areas, totals) = self.areas(positions);
        let sums = [0..12, 12..18].map(|range| self.masses[range].iter().sum::<f64>());
        let mass = |i: usize| match i {
            _ if self.masses[i] == 0.0 => 0.0,
            18.. => self.masses[i],
            _ if density > 0.0 => density * areas[i],
            _ => sums[usize::from(i >= 12)] * areas[i] / totals[usize::from(i >= 12)],
        };
        (0..self.masses.len()).map(mass).collect()
    }
}

/// Springs that bind every component to where it started.
fn forces(start: &Start, positions: &[f64]) -> Vec<f64> {
    let displacements = positions.iter().zip(&start.positions).map(|(x, x0)| x - x0);
    displacements.enumerate().map(|(i, x)| -(20.0 + (i % 7) as f64) * x).collect()
}

fn run(
    masses: &mut VariableMasses,
    mut team: Option<&mut Team>,
    start: &Start,
    (positions, velocities): (&mut [f64], &mut [f64]),
    steps: usize,
) {
    let cell = start.cell.as_ref();
    for _ in 0..steps {
        let before = forces(start, positions);
        let particles = Particles { positions, velocities, forces: &before };
        masses.begin(team.as_deref_mut(), particles, cell, STEP).unwrap();
        let after = forces(start, positions);
        let particles = Particles { positions, velocities, forces: &after };
        masses.finish(team.as_deref_mut(), particles, cell, STEP).unwrap();
    }
}

fn both() -> impl Iterator<Item = (Start, f64)> {
    [false, true]
        .into_iter()
        .flat_map(|periodic| [0.0, 0.7].map(|density| (start(periodic), density)))
}

#[test]
fn masses_are_those_of_the_definition() {
    for (start, density) in both() {
        let found = start.masses(density).masses(&start.positions, start.cell.as_ref()).unwrap();
        for (found, expected) in found.iter().zip(start.expected(density, &start.positions)) {
            assert!((found - expected).abs() < 1e-13, "{found} {expected}");
        }
    }
}

/// An impulse of the kinetic energy's force against finite differences of the energy at constant momenta.
#[test]
fn kicks_follow_the_gradient_of_the_kinetic_energy() {
    for (start, density) in both() {
        let masses = start.expected(density, &start.positions);
        let momenta: Vec<_> =
            start.velocities.iter().enumerate().map(|(i, v)| masses[i / 3] * v).collect();
        let energy = |positions: &[f64]| -> f64 {
            let masses = start.expected(density, positions);
            let parts = momenta.iter().enumerate();
            parts
                .filter(|(i, _)| masses[i / 3] > 0.0)
                .map(|(i, p)| 0.5 * p * p / masses[i / 3])
                .sum()
        };
        let sheet = Sheet { triangles: &start.triangles, is_periodic: start.cell.is_some() };
        let plaquettes = Plaquettes::new(&[sheet], start.masses.len()).unwrap();
        let mut vertices = Vertices::new(plaquettes, &start.masses, density);
        vertices.plaquettes.place(&mut None, &start.positions, start.cell.as_ref()).unwrap();
        vertices.weigh();
        vertices.read(&start.velocities);
        vertices.add_forces(&vec![0.0; 3 * masses.len()], 0.0);
        vertices.kick(&mut None, 1.0);
        let mut velocities = start.velocities.clone();
        vertices.write_velocities(&mut velocities);
        for i in 0..3 * 18 {
            let at = |shift: f64| {
                let mut moved = start.positions.clone();
                moved[i] += shift;
                energy(&moved)
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            let expected = if masses[i / 3] == 0.0 { 0.0 } else { -slope };
            let found = masses[i / 3] * velocities[i] - momenta[i];
            assert!((found - expected).abs() < 1e-8, "{i}: {found} {expected}");
        }
    }
}

#[test]
fn steps_are_reversible_and_do_not_depend_on_threads() {
    for (start, density) in both() {
        let (mut x, mut v) = (start.positions.clone(), start.velocities.clone());
        let mut masses = start.masses(density);
        run(&mut masses, None, &start, (&mut x, &mut v), 50);
        let (mut x2, mut v2) = (start.positions.clone(), start.velocities.clone());
        let mut team = Team::new(2).unwrap();
        run(&mut start.masses(density), Some(&mut team), &start, (&mut x2, &mut v2), 50);
        assert!(x == x2 && v == v2);
        assert!(x.iter().zip(&start.positions).any(|(now, then)| (now - then).abs() > 0.3));

        v.iter_mut().for_each(|v| *v = -*v);
        run(&mut masses, None, &start, (&mut x, &mut v), 50);
        for i in 0..x.len() {
            assert!((x[i] - start.positions[i]).abs() < 1e-10, "{i}");
            assert!((v[i] + start.velocities[i]).abs() < 1e-10, "{i}");
        }
    }
}

#[test]
fn a_bath_keeps_what_does_not_move_and_has_the_exact_variance() {
    let start = start(false);
    let mut masses = start.masses(0.7);
    let inverse = masses.masses(&start.positions, None).unwrap();
    let (mut x, mut v) = (start.positions.clone(), start.velocities.clone());
    let mut stream = Stream { key: [3, 1], draws: 4 };
    let mut expected = vec![0.0; v.len()];
    normals(&mut stream.clone(), &mut expected);
    let none = vec![0.0; v.len()];
    let particles = Particles { positions: &mut x, velocities: &mut v, forces: &none };
    masses.bathe(None, particles, None, &mut stream, (0.4, 1.5, 2.5)).unwrap();
    assert!(x == start.positions && stream.draws == 5);
    let scale = (-0.6f64).exp();
    for i in 0..v.len() {
        let mass = inverse[i / 3];
        let noise = ((1.0 - scale * scale) * 2.5 / mass).sqrt() * expected[i];
        let expected = if mass == 0.0 { 0.0 } else { scale * start.velocities[i] + noise };
        assert!((v[i] - expected).abs() < 1e-13, "{i}");
    }
}

#[test]
fn what_cannot_be_solved_names_the_culprit() {
    let mut start = start(false);
    start.velocities[3] = 1e3;
    let mut masses = start.masses(0.0);
    let zero = vec![0.0; start.velocities.len()];
    let mut step = |velocities: &[f64]| {
        let (mut x, mut v) = (start.positions.clone(), velocities.to_vec());
        let particles = Particles { positions: &mut x, velocities: &mut v, forces: &zero };
        let failure = masses.begin(None, particles, None, STEP).unwrap_err().to_string();
        assert!(
            x == start.positions && (0..v.len()).all(|i| v[i].to_bits() == velocities[i].to_bits())
        );
        failure
    };
    let failure = step(&start.velocities);
    assert!(failure.contains("0.05 ps") && failure.contains("particle 1 "), "{failure}");
    let mut broken = start.velocities.clone();
    broken[25] = f64::NAN;
    let failure = step(&broken);
    assert!(failure.contains("velocity of particle 8 "), "{failure}");

    let mut flat = start.positions.clone();
    flat.copy_within(0..3, 3);
    let failure = masses.masses(&flat, None).unwrap_err().to_string();
    assert!(failure.contains("has no area"), "{failure}");
}

#[test]
fn two_triangulations_of_the_same_particles_are_refused() {
    let start = start(false);
    let mut masses = VariableMasses::new(&start.masses, 0.0);
    let mut others = start.triangles.clone();
    // The edge of the first two triangles, turned.
    let ([a, b, c], [_, _, d]) = (others[0], others[1]);
    assert_eq!(others[1], [a, c, d]);
    (others[0], others[1]) = ([a, b, d], [b, c, d]);
    let sheets =
        [&start.triangles, &others].map(|triangles| Sheet { triangles, is_periodic: false });
    let failure = masses.set_surfaces(&sheets).unwrap_err().to_string();
    assert!(failure.contains("the same triangles") && failure.contains("edge"), "{failure}");
    let sheets =
        [false, true].map(|is_periodic| Sheet { triangles: &start.triangles, is_periodic });
    let failure = masses.set_surfaces(&sheets).unwrap_err().to_string();
    assert!(failure.contains("periodic"), "{failure}");
}
