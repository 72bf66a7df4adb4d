//! Numbers, terms and calls of all kinds.

use crate::potentials::{MAX_PARAMETERS, REGISTRY};
use proptest::collection::vec;
use proptest::prelude::*;

/// Numbers of any size, not finite ones among them, and many that are usual.
pub fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -3.0..3.0,
        4 => 0.0..100.0,
        1 => proptest::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, 1e300, -1e300, 1e-300, 5e-324, 1e155, 1e-155]),
    ]
}

/// Mostly within a range.
pub fn index(count: i32) -> impl Strategy<Value = i32> {
    prop_oneof![30 => 0..count, 1 => any::<i32>(), 1 => Just(-1), 1 => Just(count)]
}

/// A term: everything but what it points to.
#[derive(Debug, Clone)]
pub struct Wild {
    pub potential: usize,
    pub form: usize,
    pub switches: u32,
    pub derivatives: bool,
    pub values: [f64; MAX_PARAMETERS],
    /// Values of single elements: of which kind they are as many as, and what they are.
    pub fields: Option<(usize, usize, Vec<f64>)>,
    pub particles: Vec<u32>,
    pub numbers: Option<(bool, Vec<f64>)>,
}

pub fn wild() -> impl Strategy<Value = Wild> {
    let values = prop::array::uniform(prop_oneof![3 => 0.1..3.0, 1 => number()]);
    let fields = prop::option::weighted(0.3, (0..MAX_PARAMETERS, 0usize..5, vec(number(), 1..7)));
    let numbers = prop::option::weighted(0.8, (any::<bool>(), vec(number(), 1..40)));
    (
        (0..REGISTRY.len(), 0usize..8, any::<u32>(), any::<bool>()),
        (values, fields, vec(0u32..16, 0..3), numbers),
    )
        .prop_map(
            |((potential, form, switches, derivatives), (values, fields, particles, numbers))| {
                Wild { potential, form, switches, derivatives, values, fields, particles, numbers }
            },
        )
}

/// What a membrane is asked for, or what changes beside it.
#[derive(Debug, Clone)]
pub enum Call {
    Evaluate {
        terms: Vec<Wild>,
        energies: bool,
        forces: bool,
    },
    Virial(Vec<Wild>),
    Check(Wild),
    Flip {
        terms: Vec<Wild>,
        rules: (f64, i32, i32, f64, i32),
        attempts: i64,
        demon: f64,
        change: bool,
    },
    Swap {
        terms: Vec<Wild>,
        rules: (f64, i32),
        attempts: i64,
        kinds: Vec<u32>,
        demon: f64,
    },
    SetTriangles(Vec<(usize, usize, i32)>),
    Restore {
        corners: Vec<(usize, usize, i32)>,
        order: Vec<(usize, u32)>,
        flips: i64,
    },
    Move(Vec<(usize, f64)>),
    Coincide(usize, usize),
    Scale(f64),
    Box(Option<[f64; 9]>),
}

pub fn call() -> impl Strategy<Value = Call> {
    let terms = || vec(wild(), 1..4);
    let corners = || vec((0usize..20, 0usize..3, index(12)), 0..4);
    let rules = (
        prop_oneof![3 => Just(300.0), 1 => number()],
        prop_oneof![3 => Just(3), 1 => any::<i32>()],
        prop_oneof![3 => Just(12), 1 => any::<i32>()],
        prop_oneof![3 => Just(0.0), 1 => number()],
        0..2,
    );
    let ours = (0.5f64..9.0, 0.5f64..9.0, 0.5f64..9.0);
    let reduced = ours.prop_map(|(a, b, c)| Some([a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c]));
    prop_oneof![
        4 => (terms(), any::<bool>(), any::<bool>())
            .prop_map(|(terms, energies, forces)| Call::Evaluate { terms, energies, forces }),
        1 => terms().prop_map(Call::Virial),
        2 => wild().prop_map(Call::Check),
        3 => (terms(), rules, 0i64..300, number(), any::<bool>()).prop_map(
            |(terms, rules, attempts, demon, change)| Call::Flip { terms, rules, attempts, demon, change }
        ),
        2 => (terms(), (number(), 0..2), 0i64..100, vec(0u32..3, 12), number()).prop_map(
            |(terms, rules, attempts, kinds, demon)| Call::Swap { terms, rules, attempts, kinds, demon }
        ),
        1 => corners().prop_map(Call::SetTriangles),
        1 => (corners(), vec((0usize..12, 0u32..14), 0..3), any::<i64>())
            .prop_map(|(corners, order, flips)| Call::Restore { corners, order, flips }),
        2 => vec((0usize..36, number()), 1..4).prop_map(Call::Move),
        1 => (0usize..12, 0usize..12).prop_map(|(one, other)| Call::Coincide(one, other)),
        1 => prop_oneof![1e-3..1e3, number()].prop_map(Call::Scale),
        1 => prop_oneof![2 => Just(None), 2 => reduced, 1 => prop::array::uniform9(number()).prop_map(Some)]
            .prop_map(Call::Box),
    ]
}
