//! Bond flips: energies of single flips against whole evaluations, and visited frequencies against the Boltzmann
//! weights of all triangulations of a few vertices, which are enumerated here without any code of the crate.

use crate::support::{
    Mesh, border_terms, equipped, open_meshes, open_terms, random, spheroid, terms_of_vertices,
    terms_on,
};
use openmm_helfrich::evaluator::{
    BorderEvaluator, CpuEvaluator, InstructionSet, ReferenceEvaluator,
};
use openmm_helfrich::membrane::Membrane;
use openmm_helfrich::mesh::numbering::breadth_first;
use openmm_helfrich::mesh::triangulation::Turn;
use openmm_helfrich::mesh::{Configuration, NONE, Topology, Triangulation};
use openmm_helfrich::moves::local::{Flipped, LocalEnergy};
use openmm_helfrich::moves::{FlipRules, FlipState, Round};
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

const ANY: FlipRules =
    FlipRules { temperature: 1.0, min_degree: 3, max_degree: 64, max_edge_length: 0.0, demon: 0 };

fn seeded(seed: u32) -> FlipState {
    FlipState { key: [seed, 7], ..FlipState::default() }
}

/// The energies of terms by the readable evaluator, on a mesh built from nothing.
fn energies(triangles: &[[i64; 3]], terms: &[Term], positions: &[f64]) -> Vec<f64> {
    let terms = &equipped(triangles, positions.len() / 3, terms);
    let topology = Arc::new(Topology::new(triangles, positions.len() / 3).unwrap());
    let mut sums = vec![Contribution::default(); terms.len()];
    let mesh = Triangulation::new(&topology);
    let mut borders = BorderEvaluator::default();
    let on_borders = borders.forward(&mesh, terms, positions, None).unwrap();
    ReferenceEvaluator::new(topology)
        .evaluate(Request::new(terms, positions).with_energies(&mut sums))
        .unwrap();
    borders.add(&mesh, None, on_borders, Request::new(terms, positions).with_energies(&mut sums));
    sums.iter().map(|sum| sum.energy).collect()
}

fn corners(mesh: &Triangulation) -> Vec<[i64; 3]> {
    (0..mesh.triangles().len()).map(|t| mesh.particles_of(t).map(i64::from)).collect()
}

/// Flips at random; calls `check` with the mesh before and after, and what the flip was said to change.
fn walk(
    (positions, triangles): &Mesh,
    terms: &[Term],
    flips: usize,
    seed: u64,
    mut check: impl FnMut(&[[i64; 3]], &[[i64; 3]], f64),
) {
    let mut noise = random(seed);
    let count = positions.len() / 3;
    let mut mesh = Triangulation::new(&Topology::new(triangles, count).unwrap());
    let mut local = LocalEnergy::default();
    let fill = |local: &mut LocalEnergy, mesh: &Triangulation| {
        let equipped = equipped(&corners(mesh), count, terms);
        let mut evaluator = CpuEvaluator::of(mesh, &breadth_first(mesh), InstructionSet::Best, 1);
        let survey = |survey: &mut _| evaluator.survey(Request::new(&equipped, positions), survey);
        local.fill(mesh, terms, None, survey).unwrap();
    };
    fill(&mut local, &mesh);
    // What they share holds on.
    let equipped = equipped(&corners(&mesh), count, terms);
    let mut flipped = Flipped::default();
    let mut made = 0;
    while made < flips {
        let half = ((noise() + 1.0) * 0.5 * (3 * mesh.triangles().len()) as f64) as u32;
        let turn = if noise() > 0.0 { Turn::Left } else { Turn::Right };
        if mesh.twin(half) == NONE {
            continue;
        }
        let quad = mesh.quad(half);
        let [i, j, k, l] = quad.vertices;
        let spare =
            |vertex: u32| mesh.degrees()[vertex as usize] > 3 - u32::from(mesh.is_border(vertex));
        if !spare(i) || !spare(j) || mesh.are_joined(k, l) {
            continue;
        }
        let before = corners(&mesh);
        let difference = local.flipped(&mesh, &equipped, &quad, turn, f64::INFINITY, &mut flipped);
        if !difference.is_finite() {
            continue;
        }
        mesh.flip(&quad, turn);
        local.apply(&mesh, &quad, &flipped);
        check(&before, &corners(&mesh), difference);
        made += 1;
    }
    // What was kept current is what a new look finds.
    let kept = local.total(&mesh, terms);
    fill(&mut local, &mesh);
    let fresh = local.total(&mesh, terms);
    assert!((kept - fresh).abs() <= 1e-9 * fresh.abs().max(1.0), "{kept} {fresh}");
}

fn difference_is_right_on(mesh: &Mesh, terms: &[Term], flips: usize, seed: u64) {
    walk(mesh, terms, flips, seed, |before, after, difference| {
        let [old, new] = [before, after].map(|triangles| energies(triangles, terms, &mesh.0));
        let expected: f64 = new.iter().zip(&old).map(|(new, old)| new - old).sum();
        let scale: f64 = new.iter().chain(&old).map(|energy| energy.abs()).sum();
        let names: Vec<_> = terms.iter().map(|term| (term.potential.name(), term.form)).collect();
        assert!(
            (difference - expected).abs() <= 1e-9 * scale,
            "{names:?}: {difference} {expected}"
        );
    });
}

#[test]
fn the_energy_of_a_flip_is_that_of_two_evaluations_for_each_term() {
    for index in 0.. {
        let seed = 100 + index as u64;
        let mesh = spheroid(6, 9, &mut random(seed));
        let Some(term) = terms_on(&mesh, false).get(index).copied() else { break };
        for wants_derivatives in [false, true] {
            let term = Term { wants_derivatives, ..term };
            difference_is_right_on(&mesh, &[term], 40, seed);
        }
    }
}

#[test]
fn the_energy_of_a_flip_is_that_of_two_evaluations_for_all_terms_together() {
    for seed in [3, 4] {
        let mesh = spheroid(6, 9, &mut random(seed));
        let mut terms = terms_on(&mesh, true);
        if seed == 4 {
            terms.reverse();
        }
        difference_is_right_on(&mesh, &terms, 60, seed);
    }
}

/// The open meshes that have edges to flip.
fn flipping(seed: u64) -> Vec<Mesh> {
    open_meshes(seed).drain(..5).collect()
}

#[test]
fn the_energy_of_a_flip_near_a_border_is_that_of_two_evaluations() {
    for (n, mesh) in flipping(3).iter().enumerate() {
        let with_borders =
            |wants_derivatives| [open_terms(mesh, wants_derivatives), border_terms()].concat();
        for term in with_borders(n % 2 == 0) {
            difference_is_right_on(mesh, &[term], 40, 50 + n as u64);
        }
        difference_is_right_on(mesh, &with_borders(true), 60, 70 + n as u64);
    }
}

#[test]
fn values_of_vertices_and_triangles_take_part() {
    let mut noise = random(8);
    let (positions, triangles) = spheroid(6, 9, &mut noise);
    let mut values = |count: usize, least: f64| -> Vec<f64> {
        (0..count).map(|_| least + 0.5 * (noise() + 1.0)).collect()
    };
    let rigidities = values(positions.len() / 3, 1.0);
    let spontaneous = values(positions.len() / 3, -0.2);
    let targets = values(triangles.len(), 8.0);
    for form in 0..5 {
        let mut bending = Term::new("BendingForce", form, &[1.0, 0.0]).unwrap();
        bending.fields[0] = &rigidities;
        bending.fields[1] = &spontaneous;
        let mut areas = Term::new("TriangleAreaForce", 0, &[1.0, 8.0]).unwrap();
        areas.fields[1] = &targets;
        let mesh = spheroid(6, 9, &mut random(9 + form as u64));
        difference_is_right_on(&mesh, &[bending, areas], 60, 9 + form as u64);
    }
}

/// A million flips with a full validation now and then, and with evaluations that must follow.
#[test]
fn many_flips_leave_a_valid_surface_and_current_evaluators() {
    let mesh = spheroid(6, 9, &mut random(21));
    // A crumpled surface may have a volume below zero, of which no osmotic pressure can be said.
    let mut terms = terms_on(&mesh, true);
    terms.retain(|term| term.potential.name() != "OsmoticPressureForce");
    flip_often(&mesh, &terms, 1_000_000);
}

#[test]
fn many_flips_near_borders_leave_a_valid_surface_and_current_evaluators() {
    for mesh in flipping(22) {
        flip_often(&mesh, &open_terms(&mesh, true), 100_000);
    }
}

fn flip_often((positions, triangles): &Mesh, terms: &[Term], flips: u64) {
    let count = positions.len() / 3;
    let mut membrane = Membrane::new(triangles, count).unwrap();
    let loops = membrane.mesh().border_loops();
    let mut state = seeded(5);
    let hot = FlipRules { temperature: 1e6, ..ANY };
    // That the surface is not inside out is settled before it is crumpled.
    membrane.evaluate(Request::new(terms, positions), None).unwrap();
    let mut made = 0;
    for round in 0.. {
        made += membrane
            .flip(
                &terms[..1],
                Configuration::new(positions, None),
                Round { rules: &hot, attempts: 3000, state: &mut state },
                None,
                &mut [],
            )
            .unwrap();
        let mesh = corners(membrane.mesh());
        let valid = Triangulation::new(&Topology::new(&mesh, count).unwrap());
        assert_eq!(&valid, membrane.mesh());
        assert_eq!(valid.border_loops(), loops);
        if round % 40 == 0 {
            let mut sums = vec![Contribution::default(); terms.len()];
            let mut forces = vec![0.0; positions.len()];
            membrane
                .evaluate(
                    Request::new(terms, positions)
                        .with_energies(&mut sums)
                        .with_forces(&mut forces[..]),
                    None,
                )
                .unwrap();
            let topology = Arc::new(Topology::new(&mesh, count).unwrap());
            let (mut expected, mut exact) = (sums.clone(), vec![0.0; positions.len()]);
            let equipped = equipped(&mesh, count, terms);
            ReferenceEvaluator::new(topology)
                .evaluate(
                    Request::new(&equipped, positions)
                        .with_energies(&mut expected)
                        .with_forces(&mut exact[..]),
                )
                .unwrap();
            for (found, expected) in sums.iter().zip(&expected) {
                let error = (found.energy - expected.energy).abs();
                assert!(error <= 1e-10 * expected.energy.abs().max(1.0));
            }
            let largest = exact.iter().fold(0f64, |most, force| most.max(force.abs()));
            let error = exact.iter().zip(&forces).fold(0f64, |e, (x, y)| e.max((x - y).abs()));
            assert!(error <= 1e-10 * largest, "{error} of {largest}");
        }
        if made > flips {
            break;
        }
    }
    let counted = state.accepted + state.by_border + state.by_degree + state.by_length;
    assert_eq!(state.attempts, counted + state.by_shape + state.by_energy + state.by_edge);
    assert_eq!(state.by_border > 0, !loops.is_empty());
    assert_eq!(state.accepted, made);
}

#[test]
fn what_was_saved_goes_on_with_the_same_bits() {
    let mesh = spheroid(8, 11, &mut random(2));
    let terms = terms_on(&mesh, true);
    let (positions, triangles) = mesh;
    let count = positions.len() / 3;
    let run = |membrane: &mut Membrane, state: &mut FlipState| {
        membrane
            .flip(
                &terms,
                Configuration::new(&positions, None),
                Round { rules: &FlipRules { temperature: 50.0, ..ANY }, attempts: 2000, state },
                None,
                &mut [],
            )
            .unwrap();
        let mut sums = vec![Contribution::default(); terms.len()];
        let mut forces = vec![0.0; positions.len()];
        membrane
            .evaluate(
                Request::new(&terms, &positions)
                    .with_energies(&mut sums)
                    .with_forces(&mut forces[..]),
                None,
            )
            .unwrap();
        (membrane.connectivity(), sums, forces)
    };
    let mut unbroken = Membrane::new(&triangles, count).unwrap();
    let mut state = seeded(11);
    run(&mut unbroken, &mut state);
    let (saved, mut continued) = (unbroken.connectivity(), state);
    assert!(saved.flips > 0);
    let mut restored = Membrane::new(&triangles, count).unwrap();
    // It has a history of its own.
    run(&mut restored, &mut seeded(12));
    restored.restore(&saved).unwrap();
    assert!(run(&mut unbroken, &mut state) == run(&mut restored, &mut continued));
    assert_eq!(state, continued);
}

#[test]
fn a_demon_keeps_the_energy() {
    let mesh = spheroid(6, 9, &mut random(31));
    let terms = terms_on(&mesh, true);
    let (positions, triangles) = mesh;
    let mut membrane = Membrane::new(&triangles, positions.len() / 3).unwrap();
    let mut state = FlipState { demon_energy: 40.0, ..seeded(3) };
    let total = |membrane: &Membrane| -> f64 {
        energies(&corners(membrane.mesh()), &terms, &positions).iter().sum()
    };
    let before = total(&membrane) + state.demon_energy;
    for _ in 0..20 {
        let rules = FlipRules { demon: 1, ..ANY };
        membrane
            .flip(
                &terms,
                Configuration::new(&positions, None),
                Round { rules: &rules, attempts: 500, state: &mut state },
                None,
                &mut [],
            )
            .unwrap();
        assert!(state.demon_energy >= 0.0);
        let after = total(&membrane) + state.demon_energy;
        assert!((after - before).abs() < 1e-9 * before.abs(), "{after} {before}");
    }
    assert!(state.accepted > 50, "{}", state.accepted);
}

#[test]
fn bounds_are_kept() {
    let (positions, triangles) = spheroid(6, 9, &mut random(41));
    let count = positions.len() / 3;
    let mut membrane = Membrane::new(&triangles, count).unwrap();
    let longest = 9.0;
    let rules = FlipRules { min_degree: 4, max_degree: 9, max_edge_length: longest, ..ANY };
    let hot = FlipRules { temperature: 1e9, ..rules };
    let term = Term::new("SurfaceAreaForce", 0, &[1.0, 900.0]).unwrap();
    let mut state = seeded(1);
    let place = |particle: i64| {
        nalgebra::Vector3::from_column_slice(&positions[3 * particle as usize..][..3])
    };
    let edges = |mesh: &Triangulation| -> BTreeSet<[i64; 2]> {
        let sides = corners(mesh).into_iter().flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
        sides.map(|[a, b]| [a.min(b), a.max(b)]).collect()
    };
    let start = edges(membrane.mesh());
    for _ in 0..50 {
        membrane
            .flip(
                &[term],
                Configuration::new(&positions, None),
                Round { rules: &hot, attempts: 200, state: &mut state },
                None,
                &mut [],
            )
            .unwrap();
        assert!(membrane.mesh().degrees().iter().all(|degree| (4..=9).contains(degree)));
        for edge in edges(membrane.mesh()).difference(&start) {
            assert!((place(edge[0]) - place(edge[1])).norm() <= longest);
        }
    }
    assert!(state.by_degree > 0 && state.by_length > 0 && state.accepted > 0);
    let narrow = FlipRules { max_degree: 8, ..rules };
    assert!(narrow.check(&Triangulation::new(&Topology::new(&triangles, count).unwrap())).is_err());
}

/// A triangulation by its triangles, each from its lowest vertex on, in order.
type Key = Vec<[u32; 3]>;

fn key(triangles: impl Iterator<Item = [u32; 3]>) -> Key {
    let rotated = triangles.map(|[a, b, c]| {
        if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    });
    let mut key: Key = rotated.collect();
    key.sort_unstable();
    key
}

/// All oriented triangulations that flips lead to, by sets of triangles, one by one.
fn enumerate(start: Key) -> Vec<Key> {
    let mut known = BTreeSet::from([start.clone()]);
    let mut open = vec![start];
    while let Some(mesh) = open.pop() {
        let joined = |a: u32, b: u32| mesh.iter().any(|t| t.contains(&a) && t.contains(&b));
        for first in &mesh {
            for side in 0..3 {
                let [i, j, k] = [0, 1, 2].map(|n| first[(side + n) % 3]);
                let runs = |t: &&[u32; 3]| (0..3).any(|n| t[n] == j && t[(n + 1) % 3] == i);
                let Some(second) = mesh.iter().find(runs) else { continue };
                let l = *second.iter().find(|v| **v != i && **v != j).unwrap();
                if joined(k, l) {
                    continue;
                }
                let rest = mesh.iter().filter(|t| *t != first && *t != second).copied();
                let flipped = key(rest.chain([[i, l, k], [j, k, l]]));
                if known.insert(flipped.clone()) {
                    open.push(flipped);
                }
            }
        }
    }
    known.into_iter().collect()
}

/// A bipyramid over N − 2 vertices, and points about a sphere.
fn tiny(count: u32, seed: u64) -> (Vec<[i64; 3]>, Vec<f64>) {
    let base = count - 2;
    let mut triangles = Vec::new();
    for n in 0..base {
        let (a, b) = (i64::from(n), i64::from((n + 1) % base));
        triangles.extend([[a, b, i64::from(base)], [b, a, i64::from(base) + 1]]);
    }
    let mut noise = random(seed);
    let mut positions = Vec::new();
    for n in 0..count {
        let angle = std::f64::consts::TAU * f64::from(n) / f64::from(base);
        let point = if n < base {
            [angle.cos(), angle.sin(), 0.0]
        } else {
            [0.0, 0.0, if n == base { 1.0 } else { -1.0 }]
        };
        positions.extend(point.map(|x| 3.0 * x + 0.6 * noise()));
    }
    (triangles, positions)
}

/// A polygon of some corners, with vertices inside, and points near its plane.
fn polygon(corners: u32, inside: u32, seed: u64) -> (Vec<[i64; 3]>, Vec<f64>) {
    // A fan about the last corner, or about a vertex inside, next to which any others are put.
    let n = i64::from(corners);
    let mut triangles: Vec<_> = match inside {
        0 => (0..n - 2).map(|k| [k, k + 1, n - 1]).collect(),
        _ => (0..n).map(|k| [k, (k + 1) % n, n]).collect(),
    };
    for vertex in n + 1..n + i64::from(inside) {
        let [a, b, c] = triangles[0];
        triangles[0] = [a, b, vertex];
        triangles.extend([[b, c, vertex], [c, a, vertex]]);
    }
    let mut noise = random(seed);
    let mut positions = Vec::new();
    for n in 0..corners + inside {
        let angle = std::f64::consts::TAU * f64::from(n) / f64::from(corners);
        let far = if n < corners { 3.0 } else { 0.5 };
        positions.extend([far * angle.cos(), far * angle.sin(), 0.0].map(|x| x + 0.6 * noise()));
    }
    (triangles, positions)
}

/// Compare visits with Boltzmann weights by χ². `apart` attempts lie between two looks, so that these are nearly
/// independent; the temperature is such that `share` of the states matter.
fn visits_are_boltzmann(
    count: u32,
    terms: &[Term],
    looks: usize,
    apart: u64,
    share: f64,
    seed: u32,
) {
    let mesh = tiny(count, 5 + u64::from(count));
    let states = [20, 390, 11_424][count as usize - 5];
    visits_are_boltzmann_on(&mesh, states, terms, looks, apart, share, seed);
}

fn visits_are_boltzmann_on(
    (triangles, positions): &(Vec<[i64; 3]>, Vec<f64>),
    number: usize,
    terms: &[Term],
    looks: usize,
    apart: u64,
    share: f64,
    seed: u32,
) {
    let count = positions.len() / 3;
    let start = key(triangles.iter().map(|t| t.map(|v| v as u32)));
    let states = enumerate(start);
    assert_eq!(states.len(), number);
    let energy = |state: &Key| -> f64 {
        let triangles: Vec<_> = state.iter().map(|t| t.map(i64::from)).collect();
        energies(&triangles, terms, positions).iter().sum()
    };
    let known: Vec<f64> = states.iter().map(energy).collect();
    let least = known.iter().copied().fold(f64::INFINITY, f64::min);
    let weights = |temperature: f64| -> Vec<f64> {
        let all = known.iter().map(|energy| (-(energy - least) / temperature).exp());
        let sum: f64 = all.clone().sum();
        all.map(|weight| weight / sum).collect()
    };
    // As cold as can be with so many states in effect, by the sum of the squares of their weights.
    let in_effect = |temperature: f64| {
        1.0 / weights(temperature).iter().map(|weight| weight * weight).sum::<f64>()
    };
    let mut temperature = 1e-3;
    while in_effect(temperature) < share * states.len() as f64 {
        temperature *= 1.2;
    }
    let weights = weights(temperature);
    let index: HashMap<&Key, usize> = states.iter().enumerate().map(|(n, key)| (key, n)).collect();

    let mut membrane = Membrane::new(triangles, count).unwrap();
    let (rules, mut state) = (FlipRules { temperature, ..ANY }, seeded(seed));
    let mut visits = vec![0usize; states.len()];
    for _ in 0..looks {
        membrane
            .flip(
                terms,
                Configuration::new(positions, None),
                Round { rules: &rules, attempts: apart, state: &mut state },
                None,
                &mut [],
            )
            .unwrap();
        let mesh = membrane.mesh();
        visits[index[&key((0..mesh.triangles().len()).map(|t| mesh.particles_of(t)))]] += 1;
    }
    // States of few expected visits are put together.
    let (mut chi_squared, mut classes, mut rare) = (0.0, 0, (0.0, 0.0));
    for (weight, visits) in weights.iter().zip(&visits) {
        let expected = weight * looks as f64;
        if expected < 10.0 {
            rare = (rare.0 + expected, rare.1 + *visits as f64);
        } else {
            chi_squared += (*visits as f64 - expected).powi(2) / expected;
            classes += 1;
        }
    }
    if rare.0 > 10.0 {
        chi_squared += (rare.1 - rare.0).powi(2) / rare.0;
        classes += 1;
    }
    assert!(classes > states.len() / 4, "{classes} of {}", states.len());
    let freedom = f64::from(classes as u32 - 1);
    let deviation = (chi_squared - freedom) / (2.0 * freedom).sqrt();
    let names: Vec<_> = terms.iter().map(|term| (term.potential.name(), term.form)).collect();
    assert!(
        deviation.abs() < 4.0,
        "{count} {names:?}: χ² {chi_squared} for {freedom}, {deviation} σ"
    );
}

/// Terms with scales that fit a mesh of a few vertices, 3 nm from its middle.
fn small_terms() -> Vec<Term<'static>> {
    let mut terms: Vec<_> = (0..5)
        .filter(|form| ![1, 3].contains(form))
        .map(|form| Term::new("BendingForce", form, &[1.0, 0.3]).unwrap())
        .collect();
    for (name, form, values) in [
        ("DihedralForce", 0, &[1.5, 0.0][..]),
        ("SurfaceAreaForce", 0, &[0.5, 60.0]),
        ("EnclosedVolumeForce", 0, &[0.5, 25.0]),
        ("TriangleHeightForce", 0, &[3.0, 0.2]),
        ("TriangleAreaForce", 0, &[0.5, 6.0]),
        ("PlaquetteAreaForce", 0, &[2.0, 60.0]),
        ("TriangleAreaRepulsionForce", 0, &[2.0, 0.5]),
    ] {
        terms.push(Term::new(name, form, values).unwrap());
    }
    terms
}

#[test]
fn visited_frequencies_are_boltzmann_weights_for_each_term() {
    for (n, term) in small_terms().iter().enumerate() {
        visits_are_boltzmann(5, &[*term], 20_000, 60, 0.5, 10 + n as u32);
        visits_are_boltzmann(6, &[*term], 20_000, 100, 0.5, 30 + n as u32);
    }
}

#[test]
fn visited_frequencies_are_boltzmann_weights_for_all_terms_together() {
    let terms = small_terms();
    visits_are_boltzmann(5, &terms, 20_000, 60, 0.5, 1);
    visits_are_boltzmann(6, &terms, 40_000, 100, 0.5, 2);
    visits_are_boltzmann(7, &terms, 200_000, 40, 0.6, 3);
}

/// All triangulations of polygons, with vertices inside or without. There are as many as W. G. Brown's formula says
/// (doi:10.1112/plms/s3-14.4.746), times the orders of the vertices inside.
#[test]
fn visited_frequencies_are_boltzmann_weights_within_borders() {
    let mut terms = small_terms();
    terms.retain(|term| !term.potential.needs_outside());
    terms.extend(border_terms());
    for (n, (corners, inside, states)) in
        [(6, 0, 14), (6, 1, 84), (7, 0, 42), (7, 1, 330), (5, 2, 210)].into_iter().enumerate()
    {
        let mesh = polygon(corners, inside, 3 + u64::from(corners));
        let seed = 80 + n as u32;
        visits_are_boltzmann_on(&mesh, states, &terms, 15_000, 300, 0.5, seed);
        // Without a vertex inside nothing bends.
        let alone = if n < 2 { &terms[..] } else { &[] };
        for term in alone {
            visits_are_boltzmann_on(&mesh, states, &[*term], 4000, 300, 0.5, seed);
        }
    }
}

/// Voronoi areas of these meshes are negative here and there, and energies of either sign are large; the weights
/// hold all the same.
#[test]
fn visited_frequencies_are_boltzmann_weights_with_voronoi_areas() {
    for (n, form) in [1, 3].into_iter().enumerate() {
        let term = Term::new("BendingForce", form, &[1.0, 0.3]).unwrap();
        visits_are_boltzmann(5, &[term], 20_000, 100, 0.6, 50 + n as u32);
        visits_are_boltzmann(6, &[term], 20_000, 150, 0.6, 60 + n as u32);
    }
}

/// Energies against a reference in which each vertex has its place: the shape at rest goes along with the flips.
#[test]
fn visited_frequencies_are_boltzmann_weights_with_a_reference() {
    for count in [5, 6] {
        let (triangles, positions) = tiny(count, 5 + u64::from(count));
        let terms = terms_of_vertices(&(positions, triangles), None);
        for (n, term) in terms.iter().enumerate() {
            visits_are_boltzmann(count, &[*term], 20_000, 100, 0.5, 90 + n as u32);
        }
        visits_are_boltzmann(count, &terms, 20_000, 100, 0.5, 89);
    }
    let (triangles, positions) = polygon(6, 1, 9);
    let terms = terms_of_vertices(&(positions.clone(), triangles.clone()), None);
    visits_are_boltzmann_on(&(triangles, positions), 84, &terms, 15_000, 300, 0.5, 88);
}

/// What a leapfrog wants to know: by how much flips have changed forces; and the evaluation that follows gets those
/// that are remembered only where it would find the same.
#[test]
fn the_change_of_forces_is_that_of_two_evaluations() {
    let mut noise = random(31);
    let mesh = spheroid(6, 9, &mut noise);
    let terms = terms_on(&mesh, true);
    let (positions, triangles) = mesh;
    let count = positions.len() / 3;
    let hot = FlipRules { temperature: 1e6, ..ANY };
    let forces_of = |membrane: &mut Membrane, terms: &[Term], positions: &[f64]| {
        let mut forces = vec![0.0; positions.len()];
        membrane
            .evaluate(Request::new(terms, positions).with_forces(&mut forces[..]), None)
            .unwrap();
        forces
    };
    for seed in 0..4 {
        let mut membrane = Membrane::new(&triangles, count).unwrap();
        let before = forces_of(&mut membrane, &terms, &positions);
        let mut change = vec![0.0; positions.len()];
        let mut state = seeded(seed);
        let made = membrane
            .flip(
                &terms,
                Configuration::new(&positions, None),
                Round { rules: &hot, attempts: 100, state: &mut state },
                Some(&mut change),
                &mut [],
            )
            .unwrap();
        assert!(made > 0);
        let saved = membrane.connectivity();
        let mut other = Membrane::new(&triangles, count).unwrap();
        other.restore(&saved).unwrap();
        let after = forces_of(&mut other, &terms, &positions);
        for ((change, after), before) in change.iter().zip(&after).zip(&before) {
            assert_eq!(*change, after - before);
        }
        // The first evaluation is remembered, the second is not; a change of anything in between counts.
        let mut moved = positions.clone();
        moved[4] += 0.01;
        let fewer = &terms[1..];
        let expected = match seed {
            0 => after.clone(),
            1 => forces_of(&mut other, &terms, &moved),
            2 => forces_of(&mut other, fewer, &positions),
            _ => {
                other.set_triangles(&triangles).unwrap();
                membrane.set_triangles(&triangles).unwrap();
                forces_of(&mut other, &terms, &positions)
            }
        };
        let (terms, positions) = match seed {
            1 => (&terms[..], &moved),
            2 => (fewer, &positions),
            _ => (&terms[..], &positions),
        };
        for _ in 0..2 {
            assert_eq!(forces_of(&mut membrane, terms, positions), expected);
        }
    }
}
