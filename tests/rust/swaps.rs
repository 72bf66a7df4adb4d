//! Exchanges between neighbours: energies against whole evaluations, and visited frequencies against the Boltzmann
//! weights of all arrangements of a few vertices, which are enumerated here without any code of the crate.

use crate::support::{
    Mesh, border_terms, equipped, open_meshes, open_terms, random, spheroid, terms_on,
};
use openmm_helfrich::evaluator::{BorderEvaluator, ReferenceEvaluator};
use openmm_helfrich::membrane::Membrane;
use openmm_helfrich::mesh::{Configuration, Topology, Triangulation};
use openmm_helfrich::moves::{SwapRound, SwapRules, SwapState};
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term, VertexNumbers};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// What vertices of each kind are.
const RIGIDITIES: [f64; 3] = [1.0, 2.5, 4.0];
const SPONTANEOUS: [f64; 3] = [0.0, 0.3, -0.2];
const DOMAINS: [f64; 3] = [-3.0, 0.0, 7.0];
const MODULI: [f64; 3] = [-1.0, 0.5, -2.0];

/// Which terms depend on the kinds.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Depends {
    Lines,
    Rigidity,
    Modulus,
    All,
}

/// The values of all vertices.
struct Values {
    rigidity: Vec<f64>,
    spontaneous: Vec<f64>,
    domains: VertexNumbers,
    moduli: Vec<f64>,
    with_moduli: VertexNumbers,
}

impl Values {
    fn new(kinds: &[u32]) -> Self {
        let of = |values: [f64; 3]| -> Vec<f64> {
            kinds.iter().map(|kind| values[*kind as usize]).collect()
        };
        Self {
            rigidity: of(RIGIDITIES),
            spontaneous: of(SPONTANEOUS),
            domains: VertexNumbers::new(of(DOMAINS), None, None),
            moduli: of(MODULI),
            with_moduli: VertexNumbers::new(Vec::new(), None, None),
        }
    }

    fn terms(&self, depends: Depends, scheme: usize) -> Vec<Term<'_>> {
        let mut bending = Term::new("BendingForce", scheme, &[1.0, 0.1]).unwrap();
        bending.fields[0] = &self.rigidity;
        bending.fields[1] = &self.spontaneous;
        let mut line = Term::new("LineTensionForce", 0, &[1.7]).unwrap();
        line.numbers = &self.domains;
        let mut gauss = Term::new("GaussianCurvatureForce", 0, &[0.0]).unwrap();
        gauss.fields[0] = &self.moduli;
        gauss.numbers = &self.with_moduli;
        match depends {
            Depends::Lines => vec![line],
            Depends::Rigidity => vec![bending],
            Depends::Modulus => vec![gauss],
            Depends::All => vec![bending, line, gauss],
        }
    }
}

/// Kinds for so many vertices, in no order.
fn kinds_of(count: usize, seed: u64) -> Vec<u32> {
    let mut noise = random(seed);
    (0..count).map(|_| (1.5 * (noise() + 1.0)) as u32).collect()
}

fn moved(kinds: &[u32], sources: &[u32]) -> Vec<u32> {
    sources.iter().map(|source| kinds[*source as usize]).collect()
}

/// The energies of terms by the readable evaluator.
fn energy((positions, triangles): &Mesh, terms: &[Term]) -> f64 {
    let count = positions.len() / 3;
    let terms = &equipped(triangles, count, terms);
    let topology = Arc::new(Topology::new(triangles, count).unwrap());
    let mut sums = vec![Contribution::default(); terms.len()];
    let mesh = Triangulation::new(&topology);
    let mut borders = BorderEvaluator::default();
    let on_borders = borders.forward(&mesh, terms, positions, None).unwrap();
    ReferenceEvaluator::new(topology)
        .evaluate(Request::new(terms, positions).with_energies(&mut sums))
        .unwrap();
    borders.add(&mesh, None, on_borders, Request::new(terms, positions).with_energies(&mut sums));
    sums.iter().map(|sum| sum.energy).sum()
}

/// Those terms that do not depend on values of vertices.
fn without_kinds(mut terms: Vec<Term<'static>>) -> Vec<Term<'static>> {
    terms.retain(|term| {
        term.potential.name() != "LineTensionForce" && !(0..4).any(|k| term.is_of_vertices(k))
    });
    terms
}

/// A membrane whose vertices have kinds.
struct Mixture {
    mesh: Mesh,
    membrane: Membrane,
    kinds: Vec<u32>,
    state: SwapState,
}

impl Mixture {
    fn new(mesh: Mesh, kinds: Vec<u32>, seed: u32) -> Self {
        let membrane = Membrane::new(&mesh.1, mesh.0.len() / 3).unwrap();
        let state = SwapState { key: [seed, 9], ..SwapState::default() };
        Self { mesh, membrane, kinds, state }
    }

    /// Swap, with the energy of some terms, which `more` are beside.
    fn swap(
        &mut self,
        attempts: u64,
        rules: SwapRules,
        (depends, scheme): (Depends, usize),
        more: &[Term],
        force_change: Option<&mut [f64]>,
    ) -> u64 {
        let values = Values::new(&self.kinds);
        let terms = [&values.terms(depends, scheme), more].concat();
        let mut sources: Vec<u32> = (0..self.kinds.len() as u32).collect();
        let round = SwapRound {
            rules: &rules,
            attempts,
            state: &mut self.state,
            kinds: &self.kinds,
            sources: &mut sources,
        };
        let at = Configuration::new(&self.mesh.0, None);
        let made = self.membrane.swap(&terms, at, round, 1, force_change).unwrap();
        self.kinds = moved(&self.kinds, &sources);
        made
    }

    fn energy(&self, (depends, scheme): (Depends, usize), more: &[Term]) -> f64 {
        let values = Values::new(&self.kinds);
        energy(&self.mesh, &[&values.terms(depends, scheme), more].concat())
    }
}

const DEMON: SwapRules = SwapRules { temperature: 1.0, demon: 1 };

/// A demon says what each exchange costs.
#[test]
fn the_energy_of_an_exchange_is_that_of_two_evaluations() {
    let closed = spheroid(6, 9, &mut random(1));
    for (n, mesh) in [vec![closed], open_meshes(5)].concat().into_iter().enumerate() {
        let vertices: BTreeSet<i64> = mesh.1.as_flattened().iter().copied().collect();
        let others = without_kinds([open_terms(&mesh, true), border_terms()].concat());
        for (depends, scheme) in
            [(Depends::Lines, 0), (Depends::Modulus, 0), (Depends::All, 0), (Depends::All, 4)]
                .into_iter()
                .chain(
                    // Voronoi areas can vanish at borders, where energies have poles.
                    (1..if n == 0 { 4 } else { 1 }).map(|scheme| (Depends::Rigidity, scheme)),
                )
        {
            let more = if depends == Depends::All { &others[..] } else { &[] };
            let kinds = kinds_of(vertices.len(), 3 + n as u64);
            let mut mixture = Mixture::new(mesh.clone(), kinds, n as u32);
            let mut composition = mixture.kinds.clone();
            composition.sort_unstable();
            let mut made = 0;
            let mut last = mixture.energy((depends, scheme), more);
            while made < 12 {
                mixture.state.demon_energy = 1e6;
                made += mixture.swap(1, DEMON, (depends, scheme), more, None);
                let now = mixture.energy((depends, scheme), more);
                let cost = 1e6 - mixture.state.demon_energy;
                let error = (now - last - cost).abs();
                assert!(error < 1e-9 * (last.abs() + 10.0), "{n} {depends:?} {scheme}: {error}");
                last = now;
            }
            mixture.kinds.sort_unstable();
            assert_eq!(mixture.kinds, composition);
        }
    }
}

#[test]
fn a_demon_keeps_the_energy() {
    let mesh = spheroid(6, 9, &mut random(3));
    let mut mixture = Mixture::new(mesh, kinds_of(56, 4), 2);
    let what = (Depends::All, 0);
    mixture.state.demon_energy = 3.0;
    let before = mixture.energy(what, &[]) + 3.0;
    for _ in 0..20 {
        mixture.swap(200, DEMON, what, &[], None);
        assert!(mixture.state.demon_energy >= 0.0);
        let after = mixture.energy(what, &[]) + mixture.state.demon_energy;
        assert!((after - before).abs() < 1e-9 * before.abs(), "{after} {before}");
    }
    let SwapState { attempts, accepted, by_kind, by_energy, .. } = mixture.state;
    assert_eq!(attempts, 4000);
    assert_eq!(attempts, accepted + by_kind + by_energy);
    assert!(accepted.min(by_kind).min(by_energy) > 100, "{:?}", mixture.state);
}

/// All different arrangements of kinds.
fn arrangements(kinds: &[u32]) -> Vec<Vec<u32>> {
    let mut sorted = kinds.to_vec();
    sorted.sort_unstable();
    let mut all = vec![Vec::new()];
    for _ in 0..kinds.len() {
        let mut longer = BTreeSet::new();
        for begun in &all {
            for kind in &sorted {
                let count = |list: &[u32]| list.iter().filter(|one| *one == kind).count();
                if count(begun) < count(&sorted) {
                    longer.insert([&begun[..], &[*kind]].concat());
                }
            }
        }
        all = longer.into_iter().collect();
    }
    all
}

/// Compare visits with Boltzmann weights by χ²; between two looks there are `apart` attempts.
fn visits_are_boltzmann(
    mesh: &Mesh,
    kinds: &[u32],
    number: usize,
    what: (Depends, usize),
    rules: SwapRules,
    seed: u32,
) {
    const LOOKS: usize = 20_000;
    let states = arrangements(kinds);
    assert_eq!(states.len(), number);
    let weight = |state: &Vec<u32>| {
        let values = Values::new(state);
        (-energy(mesh, &values.terms(what.0, what.1)) / rules.temperature).exp()
    };
    let weights: Vec<f64> = states.iter().map(weight).collect();
    let sum: f64 = weights.iter().sum();
    let index: HashMap<&Vec<u32>, usize> = states.iter().zip(0..).collect();
    let mut mixture = Mixture::new(mesh.clone(), kinds.to_vec(), seed);
    let mut visits = vec![0.0; states.len()];
    for _ in 0..LOOKS {
        mixture.swap(60, rules, what, &[], None);
        visits[index[&mixture.kinds]] += 1.0;
    }
    let expected = weights.iter().map(|weight| weight / sum * LOOKS as f64);
    let chi_squared: f64 =
        visits.iter().zip(expected).map(|(found, wanted)| (found - wanted).powi(2) / wanted).sum();
    let least = weights.iter().fold(f64::INFINITY, |least, w| w.min(least)) / sum;
    let most = weights.iter().fold(0.0, |most: f64, w| w.max(most)) / sum;
    // Every state is expected often enough, and they differ.
    assert!(least * LOOKS as f64 > 10.0 && most > 2.0 * least, "{what:?}: {least} {most}");
    let freedom = (states.len() - 1) as f64;
    let deviation = (chi_squared - freedom) / (2.0 * freedom).sqrt();
    assert!(deviation.abs() < 4.0, "{what:?}: χ² {chi_squared} for {freedom}, {deviation} σ");
}

/// An uneven octahedron, 3 nm wide.
fn octahedron() -> Mesh {
    let mut noise = random(6);
    let corners: [[f64; 3]; 6] = std::array::from_fn(|n| {
        let mut corner = [0.0; 3];
        corner[n / 2] = if n % 2 == 0 { 3.0 } else { -3.0 };
        corner.map(|x| x + 0.7 * noise())
    });
    let triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    (corners.as_flattened().to_vec(), triangles)
}

#[test]
fn visited_frequencies_are_boltzmann_weights() {
    let kinds = [0, 1, 0, 2, 1, 0];
    let ways = [Depends::Lines, Depends::Rigidity, Depends::Modulus, Depends::All];
    for (n, (depends, temperatures)) in
        ways.into_iter().zip([[3.0, 2.0], [5.0, 0.8], [1.0, 0.6], [10.0, 3.0]]).enumerate()
    {
        let seed = 5 + n as u32;
        let [three, two] = temperatures.map(|temperature| SwapRules { temperature, demon: 0 });
        visits_are_boltzmann(&octahedron(), &kinds, 60, (depends, 0), three, seed);
        visits_are_boltzmann(&octahedron(), &kinds.map(|k| k.min(1)), 20, (depends, 4), two, seed);
    }
}

/// With two triangles away, four vertices are on the border, where nothing bends.
#[test]
fn visited_frequencies_are_boltzmann_weights_on_an_open_surface() {
    let (positions, mut triangles) = octahedron();
    triangles.truncate(6);
    let ways = [(Depends::Lines, 12.0), (Depends::Modulus, 5.0), (Depends::All, 12.0)];
    for (depends, temperature) in ways {
        let rules = SwapRules { temperature, demon: 0 };
        let mesh = (positions.clone(), triangles.clone());
        visits_are_boltzmann(&mesh, &[0, 1, 0, 2, 1, 0], 60, (depends, 0), rules, 8);
    }
}

/// What a leapfrog wants to know: by how much exchanges have changed forces; and the evaluation that follows gets those
/// that are remembered only where it would find the same.
#[test]
fn the_change_of_forces_is_that_of_two_evaluations() {
    let mesh = spheroid(6, 9, &mut random(31));
    let more = without_kinds(terms_on(&mesh, true));
    let at = Configuration::new(&mesh.0, None);
    for depends in [Depends::Rigidity, Depends::All] {
        let mut mixture = Mixture::new(mesh.clone(), kinds_of(56, 4), 3);
        let forces = |kinds: &[u32]| {
            let values = Values::new(kinds);
            let terms = [&values.terms(depends, 0), &more[..]].concat();
            let mut forces = vec![0.0; mesh.0.len()];
            let mut membrane = Membrane::new(&mesh.1, 56).unwrap();
            membrane
                .evaluate(Request::new(&terms, at.positions).with_forces(&mut forces[..]), at.cell)
                .unwrap();
            forces
        };
        let before = forces(&mixture.kinds);
        let mut change = vec![0.0; mesh.0.len()];
        let hot = SwapRules { temperature: 1e6, demon: 0 };
        assert!(mixture.swap(100, hot, (depends, 0), &more, Some(&mut change)) > 10);
        let after = forces(&mixture.kinds);
        let largest = after.iter().fold(0f64, |most, force| most.max(force.abs()));
        for ((change, before), after) in change.iter().zip(&before).zip(&after) {
            assert!((after - before - change).abs() < 1e-11 * largest);
        }
        assert_ne!(before, after);
    }
}

/// The owner of numbers, as C++ has it, which must be asked for by the version that the exchange was told.
#[test]
fn evaluations_after_exchanges_have_the_new_values() {
    let mesh = spheroid(6, 9, &mut random(31));
    let at = Configuration::new(&mesh.0, None);
    let mut membrane = Membrane::new(&mesh.1, 56).unwrap();
    let mut kinds = kinds_of(56, 4);
    let mut state = SwapState { key: [5, 5], ..SwapState::default() };
    for round in 0..5 {
        let evaluate = |membrane: &mut Membrane, kinds: &[u32], owner: Option<u64>| {
            let mut values = Values::new(kinds);
            values.domains.owner = owner.unwrap_or(values.domains.owner);
            values.domains.version = round;
            let terms = values.terms(Depends::All, 0);
            let mut forces = vec![0.0; mesh.0.len()];
            membrane
                .evaluate(Request::new(&terms, at.positions).with_forces(&mut forces[..]), at.cell)
                .unwrap();
            forces
        };
        let found = evaluate(&mut membrane, &kinds, Some(77));
        assert_eq!(found, evaluate(&mut Membrane::new(&mesh.1, 56).unwrap(), &kinds, None));
        let mut values = Values::new(&kinds);
        (values.domains.owner, values.domains.version) = (77, round);
        let terms = values.terms(Depends::All, 0);
        let mut sources: Vec<u32> = (0..56).collect();
        let rules = SwapRules { temperature: 1e6, demon: 0 };
        let turn = SwapRound {
            rules: &rules,
            attempts: 60,
            state: &mut state,
            kinds: &kinds,
            sources: &mut sources,
        };
        let mut change = vec![0.0; mesh.0.len()];
        assert!(membrane.swap(&terms, at, turn, round + 1, Some(&mut change)).unwrap() > 10);
        kinds = moved(&kinds, &sources);
    }
}
