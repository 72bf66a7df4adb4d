//! Time of attempts to flip a bond: `cargo bench --bench flips`.
//!
//! For each size of a vesicle with the paper's forces: the pass over the whole mesh that begins a batch of attempts, an
//! attempt and how many are accepted, the same of plain code, the renewed layout after a batch, and the forces of an
//! evaluation to compare with, µs; the shortest of several runs.

use openmm_helfrich::evaluator::{CpuEvaluator, InstructionSet, Survey};
use openmm_helfrich::mesh::numbering::breadth_first;
use openmm_helfrich::mesh::{Topology, Triangulation};
use openmm_helfrich::moves::local::LocalEnergy;
use openmm_helfrich::moves::{FlipRules, FlipState, Round, flips};
use openmm_helfrich::potentials::{Evaluator, Request, Term};
use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

#[path = "plain_flips.rs"]
mod plain_flips;
#[path = "spheres.rs"]
mod spheres;

use plain_flips::{Model, PlainFlips};

fn shortest(runs: usize, mut body: impl FnMut() -> f64) -> f64 {
    (0..runs).map(|_| body()).fold(f64::INFINITY, f64::min)
}

fn timed<T>(body: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    black_box(body());
    start.elapsed().as_secs_f64() * 1e6
}

fn main() {
    let large = std::env::args().any(|argument| argument == "--large");
    let sizes = [5, 10, 20, 64, 316];
    println!("vertices  begin  attempt  accepted  plain  accepted  layout  forces");
    for &n in &sizes[..if large { 5 } else { 4 }] {
        let (positions, triangles) = spheres::sphere(n);
        let count = positions.len() / 3;
        let radius = 100.0 * n as f64;
        let area = 4.0 * PI * radius.powi(2);
        let terms = [
            Term::new("BendingForce", 0, &[50.0, 0.0]).unwrap(),
            Term::new("SurfaceAreaForce", 0, &[1.3, area]).unwrap(),
            Term::new("EnclosedVolumeForce", 0, &[0.04, area * radius / 3.0]).unwrap(),
            Term::new("TriangleHeightForce", 0, &[20.0, 9.977]).unwrap(),
        ];
        let topology = Topology::new(&triangles, count).unwrap();
        let mut mesh = Triangulation::new(&topology);
        let mut local = LocalEnergy::default();
        let rules = FlipRules {
            temperature: 2.494,
            min_degree: 3,
            max_degree: 10,
            max_edge_length: 0.0,
            demon: 0,
        };
        let mut state = FlipState { key: [1, 2], ..FlipState::default() };
        let edges = mesh.num_edges() as u64;
        let order = breadth_first(&mesh);
        let mut evaluator = CpuEvaluator::of(&mesh, &order, InstructionSet::Best, 1);
        let mut forces = vec![0.0; positions.len()];
        // From here on the mesh is that of a fluid.
        let fill = |mesh: &Triangulation, local: &mut LocalEnergy, evaluator: &mut CpuEvaluator| {
            let survey =
                |survey: &mut Survey| evaluator.survey(Request::new(&terms, &positions), survey);
            local.fill(mesh, &terms, None, survey).unwrap();
        };
        fill(&mesh, &mut local, &mut evaluator);
        flips::attempt(
            &mut mesh,
            &mut local,
            &terms,
            Round { rules: &rules, attempts: 10 * edges, state: &mut state },
            &mut [],
        );
        let runs = (200_000 / count).clamp(3, 50);
        evaluator.lay_out(&mesh, &order);
        let begin = shortest(runs, || timed(|| fill(&mesh, &mut local, &mut evaluator)));
        let before = state;
        let attempt = shortest(runs, || {
            timed(|| {
                flips::attempt(
                    &mut mesh,
                    &mut local,
                    &terms,
                    Round { rules: &rules, attempts: edges, state: &mut state },
                    &mut [],
                )
            }) / edges as f64
        });
        let accepted =
            (state.accepted - before.accepted) as f64 / (state.attempts - before.attempts) as f64;
        let model = Model {
            rigidity: 50.0,
            area: [1.3, area],
            volume: [0.04, area * radius / 3.0],
            heights: [20.0, 9.977],
            temperature: rules.temperature,
            max_degree: rules.max_degree as usize,
        };
        let mut plain = PlainFlips::new(model, &positions, &triangles);
        plain.attempt(10 * edges);
        plain.accepted = 0;
        let few = runs.min(10);
        let plain_attempt = shortest(few, || timed(|| plain.attempt(edges)) / edges as f64);
        let plain_accepted = plain.accepted as f64 / (few as u64 * edges) as f64;
        let layout = shortest(runs, || timed(|| evaluator.lay_out(&mesh, &order)));
        let evaluation = shortest(runs, || {
            timed(|| {
                evaluator
                    .evaluate(Request::new(&terms, &positions).with_forces(&mut forces[..]))
                    .unwrap()
            })
        });
        println!(
            "{count:8} {begin:6.1} {attempt:8.4} {accepted:9.3} {plain_attempt:6.3} \
             {plain_accepted:9.3} {layout:7.1} {evaluation:7.1}"
        );
    }
}
