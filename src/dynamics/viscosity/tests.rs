//! What a sweep promises, by formulas and against the update as the head of `viscosity.rs` has it.

use super::*;
use crate::mesh::Topology;
use crate::test_meshes::icosahedron;

const KT: f64 = 2.5;

/// A surface in motion, without any pattern.
struct Moving {
    mesh: Triangulation,
    masses: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    viscosity: Viscosity,
    stream: Stream,
}

impl Moving {
    fn new(triangles: &[[i64; 3]], positions: Vec<f64>, masses: Vec<f64>) -> Self {
        let mesh = Triangulation::new(&Topology::new(triangles, masses.len()).unwrap());
        let viscosity = Viscosity::new(&mesh, &masses);
        let mut velocities = vec![0.0; positions.len()];
        super::super::random::normals(&mut Stream { key: [9, 9], draws: 0 }, &mut velocities);
        Self {
            mesh,
            masses,
            positions,
            velocities,
            viscosity,
            stream: Stream { key: [3, 4], draws: 0 },
        }
    }

    fn icosahedron(mass: impl Fn(usize) -> f64) -> Self {
        let (vertices, triangles) = icosahedron();
        let shaken = vertices.as_flattened().iter().enumerate();
        let positions = shaken.map(|(k, x)| x + 0.2 * (7.0 * k as f64).sin()).collect();
        Self::new(&triangles, positions, (0..12).map(mass).collect())
    }

    fn sweep(&mut self, friction: f64, kt: f64, lag: f64, cell: Option<&Cell>) -> Result<()> {
        let Self { positions, velocities, .. } = self;
        let motion = Motion { positions, velocities, cell };
        self.viscosity.sweep((&self.mesh, 0), motion, Bath { friction, kt, lag }, &mut self.stream)
    }

    fn place(&self, vertex: u32, lag: f64) -> Vec3 {
        let of = |all: &[f64]| Vec3::from(all.as_chunks::<3>().0[vertex as usize]);
        of(&self.positions) - of(&self.velocities) * lag
    }

    /// Momentum, and angular momentum about the origin.
    fn momenta(&self) -> [Vec3; 2] {
        let mut sums = [Vec3::zeros(); 2];
        for (vertex, mass) in self.masses.iter().enumerate() {
            let velocity = Vec3::from(self.velocities.as_chunks::<3>().0[vertex]);
            sums[0] += velocity * *mass;
            sums[1] += self.place(vertex as u32, 0.0).cross(&velocity) * *mass;
        }
        sums
    }
}

/// The formula of the head, edge after edge; the middle scheme moves positions by the change of velocities.
#[test]
fn a_sweep_is_that_of_the_formula() {
    let mass = |i: usize| if i == 5 || i == 11 { 0.0 } else { 1.0 + i as f64 };
    let (friction, lag) = (3.0, 0.05);
    let mut moving = Moving::icosahedron(mass);
    // A velocity that a particle without mass may have, and that means nothing.
    let before = moving.velocities.clone();
    for draw in 0..3 {
        let mut velocities: Vec<Vec3> =
            moving.velocities.as_chunks::<3>().0.iter().map(|v| Vec3::from(*v)).collect();
        for (vertex, velocity) in velocities.iter_mut().enumerate() {
            if mass(vertex) == 0.0 {
                *velocity = Vec3::zeros();
            }
        }
        let old = velocities.clone();
        let places: Vec<Vec3> =
            (0..12).map(|v| moving.place(v, 0.0) - old[v as usize] * lag).collect();
        let mut normals = [0.0; GROUP];
        let mut stream = Stream { key: [3, 4], draws: draw };
        super::super::random::normals(&mut stream, &mut normals);
        let edges = in_order(&moving.mesh);
        let mut sweep: Vec<usize> = (0..edges.len()).collect();
        if draw % 2 == 1 {
            sweep.reverse();
        }
        for edge in sweep {
            let [i, j] = edges[edge].map(|vertex| vertex as usize);
            let weights = [i, j].map(|v| if mass(v) == 0.0 { 0.0 } else { 1.0 / mass(v) });
            let reduced = 1.0 / (weights[0] + weights[1]);
            if reduced.is_infinite() {
                continue;
            }
            let e = (places[i] - places[j]).normalize();
            let u = (velocities[i] - velocities[j]).dot(&e);
            let noise = (KT / reduced * (1.0 - (-2.0 * friction / reduced).exp())).sqrt();
            let after = u * (-friction / reduced).exp() + noise * normals[edge];
            velocities[i] += e * ((after - u) * reduced * weights[0]);
            velocities[j] -= e * ((after - u) * reduced * weights[1]);
        }
        let expected: Vec<Vec3> =
            (0..12).map(|v| moving.place(v as u32, 0.0) + (velocities[v] - old[v]) * lag).collect();
        moving.sweep(friction, KT, lag, None).unwrap();
        for vertex in 0..12 {
            let found = Vec3::from(moving.velocities.as_chunks::<3>().0[vertex]);
            if mass(vertex) == 0.0 {
                assert_eq!(found, Vec3::from(before.as_chunks::<3>().0[vertex]));
            } else {
                assert!((found - velocities[vertex]).norm() < 1e-13, "{vertex}");
            }
            assert!((moving.place(vertex as u32, 0.0) - expected[vertex]).norm() < 1e-14);
        }
    }
    assert_eq!(moving.stream.draws, 3);
}

/// About any point, and with the positions that the middle scheme gives.
#[test]
fn momenta_are_conserved_to_rounding() {
    for lag in [0.0, 0.3] {
        let mut moving = Moving::icosahedron(|i| 1.0 + i as f64);
        let before = moving.momenta();
        for _ in 0..100 {
            moving.sweep(5.0, KT, lag, None).unwrap();
        }
        let after = moving.momenta();
        for (before, after) in before.iter().zip(&after) {
            assert!((before - after).norm() < 1e-12 * (1.0 + before.norm()), "{before} {after}");
        }
    }
}

/// Mean and variance of u after the update of a single edge, from the same start each time; of a light and a heavy
/// vertex, for a weak and a strong friction.
#[test]
fn the_relative_velocity_has_the_formulas_distribution() {
    const DRAWS: usize = 20_000;
    // Only one edge of the triangle has ends that both move.
    let masses = vec![2.0, 7.0, 0.0];
    let reduced: f64 = 2.0 * 7.0 / 9.0;
    for friction in [0.01f64, 1.0, 30.0] {
        let (mut sum, mut squares, mut fourth) = (0.0, 0.0, 0.0);
        // Far away, so that its edges are at right angles to the one of interest.
        let positions = vec![1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1e9, 0.0];
        let mut moving = Moving::new(&[[0, 1, 2]], positions, masses.clone());
        let start = 1.5;
        let decay = (-friction / reduced).exp();
        let variance = KT / reduced * (1.0 - decay * decay);
        for _ in 0..DRAWS {
            moving.velocities.fill(0.0);
            (moving.velocities[0], moving.velocities[3]) = (start + 0.25, 0.25);
            moving.sweep(friction, KT, 0.0, None).unwrap();
            let u = (moving.velocities[0] - moving.velocities[3] - start * decay) / variance.sqrt();
            (sum, squares, fourth) = (sum + u, squares + u * u, fourth + u.powi(4));
        }
        let count = DRAWS as f64;
        // Four standard errors, of a standard normal distribution.
        assert!((sum / count).abs() < 4.0 / count.sqrt(), "{friction}: {}", sum / count);
        assert!((squares / count - 1.0).abs() < 4.0 * (2.0 / count).sqrt());
        assert!((fourth / count - 3.0).abs() < 4.0 * (96.0 / count).sqrt());
    }
}

/// −γ u² a time for each edge, without noise.
#[test]
fn weak_friction_dissipates_as_it_should() {
    let friction = 1e-6;
    let mut moving = Moving::icosahedron(|i| 1.0 + i as f64);
    let energy = |moving: &Moving| -> f64 {
        let all = moving.velocities.as_chunks::<3>().0.iter().zip(&moving.masses);
        all.map(|(v, mass)| 0.5 * mass * Vec3::from(*v).norm_squared()).sum()
    };
    let expected: f64 = in_order(&moving.mesh)
        .iter()
        .map(|&[i, j]| {
            let velocity = |v: u32| Vec3::from(moving.velocities.as_chunks::<3>().0[v as usize]);
            let e = (moving.place(i, 0.0) - moving.place(j, 0.0)).normalize();
            -friction * (velocity(i) - velocity(j)).dot(&e).powi(2)
        })
        .sum();
    let before = energy(&moving);
    moving.sweep(friction, 1e-300, 0.0, None).unwrap();
    assert!(((energy(&moving) - before) / expected - 1.0).abs() < 1e-5);
}

/// Where a particle has been wrapped to makes no difference.
#[test]
fn edges_are_nearest_images() {
    let vectors = [[9.0, 0.0, 0.0], [1.0, 8.5, 0.0], [-1.5, 2.0, 8.0]];
    let cell = Cell::new(vectors).unwrap();
    let mut whole = Moving::icosahedron(|_| 2.0);
    whole.sweep(3.0, KT, 0.1, None).unwrap();
    let mut wrapped = Moving::icosahedron(|_| 2.0);
    for (vertex, position) in wrapped.positions.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let image = [vertex as i32 % 3 - 1, vertex as i32 % 2, 1 - vertex as i32 % 4];
        *position = (Vec3::from(*position) + cell.shift(image)).into();
    }
    wrapped.sweep(3.0, KT, 0.1, Some(&cell)).unwrap();
    for (one, other) in whole.velocities.iter().zip(&wrapped.velocities) {
        assert!((one - other).abs() < 1e-13);
    }
}

/// Every edge comes once, and most of them have no vertex in common with the one before.
#[test]
fn the_order_is_of_all_edges() {
    let triangles = crate::test_meshes::with_holes();
    for mesh in triangles {
        let mut ordered = in_order(&mesh);
        let touching =
            ordered.windows(2).filter(|pair| pair[0].iter().any(|v| pair[1].contains(v)));
        assert!(touching.count() * 3 < ordered.len());
        let mut plain: Vec<_> =
            mesh.edges().map(|half| [mesh.origin(half), mesh.origin(next(half))]).collect();
        plain.sort_unstable();
        ordered.sort_unstable();
        assert_eq!(ordered, plain);
    }
}

/// Of an edge whose ends are both pinned nothing is left to move, at any temperature.
#[test]
fn neighbours_that_are_pinned_stay() {
    let pinned = [0, 1, 2, 3, 4, 5];
    for kt in [KT, 4.0, 50.0, 1e6] {
        let mut moving = Moving::icosahedron(|i| if pinned.contains(&i) { 0.0 } else { 2.0 });
        let ends: Vec<_> = moving.mesh.edges().map(|half| moving.mesh.origin(half)).collect();
        assert!(ends.iter().any(|end| *end < 6));
        let before = (moving.positions.clone(), moving.velocities.clone());
        moving.sweep(3.0, kt, 0.05, None).unwrap();
        assert!(moving.velocities.iter().all(|component| component.is_finite()), "kT = {kt}");
        for vertex in pinned {
            assert_eq!(moving.positions[3 * vertex..][..3], before.0[3 * vertex..][..3]);
            assert_eq!(moving.velocities[3 * vertex..][..3], before.1[3 * vertex..][..3]);
        }
        assert!(moving.velocities[18..] != before.1[18..]);
    }
}

#[test]
fn what_is_refused_changes_nothing() {
    let small = Cell::new([[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]]).unwrap();
    type Case<'a> = (fn(&mut Moving), Option<&'a Cell>, fn(&Error) -> bool);
    let cases: [Case; 5] = [
        (
            |moving| moving.positions[3 * 4 + 1] = f64::NAN,
            None,
            |error| matches!(error, Error::NonFinitePosition { particle: 4, .. }),
        ),
        (
            |moving| moving.velocities[3 * 7] = f64::INFINITY,
            None,
            |error| matches!(error, Error::NonFiniteVelocity { particle: 7, .. }),
        ),
        (
            |moving| {
                moving.positions.copy_within(0..3, 33);
                moving.velocities.copy_within(0..3, 33);
            },
            None,
            |error| matches!(error, Error::EdgeWithoutLength { edge: [0, 11] | [11, 0], .. }),
        ),
        (
            |moving| moving.positions[3 * 2] = 1e200,
            None,
            |error| matches!(error, Error::OverflownEdge { edge } if edge.contains(&2)),
        ),
        (|_| (), Some(&small), |error| matches!(error, Error::LongEdge { .. })),
    ];
    for (change, cell, is_right) in cases {
        for lag in [0.0, 0.1] {
            let mut moving = Moving::icosahedron(|_| 1.0);
            change(&mut moving);
            let before = (moving.positions.clone(), moving.velocities.clone());
            let error = moving.sweep(1.0, KT, lag, cell).unwrap_err();
            assert!(is_right(&error), "{error}");
            let bits = |all: &[f64]| all.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&moving.positions), bits(&before.0));
            assert_eq!(bits(&moving.velocities), bits(&before.1));
            assert_eq!(moving.stream.draws, 0);
        }
    }
}
