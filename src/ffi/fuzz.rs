//! Any calls with any numbers: each succeeds or leaves a message, and a membrane stays one.
//!
//! `PROPTEST_CASES=100000 cargo test --release --lib ffi::fuzz` looks longer, and `PROPTEST_RNG_SEED` elsewhere.

use super::*;
use crate::dynamics::random::Stream;
use crate::membrane::Membrane;
use crate::mesh::{Topology, Triangulation};
use crate::moves::{FlipRules, FlipState, SwapRules, SwapState};
use crate::potentials::{Contribution, MAX_PARAMETERS, REGISTRY, VertexNumbers};
use crate::test_meshes::{icosahedron, octahedron};
use proptest::collection::vec;
use proptest::prelude::*;
use std::ptr;

/// Numbers of any size, not finite ones among them, and many that are usual.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -3.0..3.0,
        4 => 0.0..100.0,
        1 => proptest::num::f64::ANY,
        1 => prop::sample::select(vec![0.0, -0.0, f64::NAN, f64::INFINITY, 1e300, -1e300, 1e-300, 5e-324, 1e155, 1e-155]),
    ]
}

/// Mostly within a range.
fn index(count: i32) -> impl Strategy<Value = i32> {
    prop_oneof![30 => 0..count, 1 => any::<i32>(), 1 => Just(-1), 1 => Just(count)]
}

/// A term: everything but what it points to.
#[derive(Debug, Clone)]
struct Wild {
    potential: usize,
    form: usize,
    switches: u32,
    derivatives: bool,
    values: [f64; MAX_PARAMETERS],
    /// Values of single elements: of which kind they are as many as, and what they are.
    fields: Option<(usize, usize, Vec<f64>)>,
    particles: Vec<u32>,
    numbers: Option<(bool, Vec<f64>)>,
}

fn wild() -> impl Strategy<Value = Wild> {
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

#[derive(Debug, Clone)]
enum Call {
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

fn call() -> impl Strategy<Value = Call> {
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

/// What a term points to.
struct Kept {
    field: Vec<f64>,
    numbers: *mut VertexNumbers,
}

impl Drop for Kept {
    fn drop(&mut self) {
        unsafe { Helfrich_Numbers_destroy(self.numbers) };
    }
}

/// One membrane and what it is called with.
struct Bench {
    membrane: *mut Membrane,
    positions: Vec<f64>,
    vectors: Option<[[f64; 3]; 3]>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        unsafe { Helfrich_Membrane_destroy(self.membrane) };
    }
}

/// A status, and of a failure its message, which names somebody and is no panic's.
fn told(status: c_int) -> std::result::Result<bool, TestCaseError> {
    if status == 0 {
        return Ok(true);
    }
    let said = last_error();
    prop_assert_eq!(status, 1);
    prop_assert!(said.contains(": ") && !said.contains("internal error"), "{}", said);
    Ok(false)
}

impl Bench {
    fn counts(&self) -> [usize; 5] {
        let mesh = unsafe { &*self.membrane }.mesh();
        [mesh.num_vertices(), mesh.triangles().len(), mesh.num_edges(), 2, 7]
    }

    fn inputs(&self, terms: &[Wild]) -> (Vec<TermInput>, Vec<Kept>) {
        let counts = self.counts();
        let mut inputs = Vec::new();
        let mut all = Vec::new();
        for term in terms {
            let cycled =
                |values: &[f64], count| values.iter().copied().cycle().take(count).collect();
            let potential = REGISTRY[term.potential];
            let forms = potential.forms().map_or(1, |(_, names)| names.len());
            let field = term
                .fields
                .as_ref()
                .map_or(Vec::new(), |(_, which, values)| cycled(values, counts[*which]));
            let numbers = term.numbers.as_ref().map_or(ptr::null_mut(), |(fits, values)| {
                let name = std::ffi::CString::new(potential.name()).unwrap();
                let mut called = ptr::null();
                let width =
                    unsafe { Helfrich_Potential_numbers(name.as_ptr(), &mut called) } as usize;
                let count = if *fits { width * counts[0] } else { values.len() };
                let values: Vec<f64> = cycled(values, count);
                let length = values.len() as i64;
                unsafe {
                    Helfrich_Numbers_create(ptr::null(), values.as_ptr(), length, ptr::null())
                }
            });
            let kept = Kept { field, numbers };
            let mut fields = [ptr::null(); MAX_PARAMETERS];
            let mut field_lengths = [0; MAX_PARAMETERS];
            if let Some((place, ..)) = term.fields {
                fields[place] = kept.field.as_ptr();
                field_lengths[place] = kept.field.len() as i64;
            }
            inputs.push(TermInput {
                potential: term.potential as c_int,
                form: (term.form % forms) as c_int,
                switches: term.switches & ((1 << potential.switches().len()) - 1),
                wants_derivatives: term.derivatives.into(),
                values: term.values,
                fields,
                field_lengths,
                particles: term.particles.as_ptr(),
                num_particles: term.particles.len() as i64,
                numbers: kept.numbers.cast(),
            });
            all.push(kept);
        }
        (inputs, all)
    }

    /// Terms, as a Context checks them before it uses them.
    fn checked(
        &self,
        terms: &[Wild],
    ) -> std::result::Result<(Vec<TermInput>, Vec<Kept>), TestCaseError> {
        let (inputs, kept) = self.inputs(terms);
        let mut good = Vec::new();
        for input in inputs {
            let subject = c"Fuzz".as_ptr();
            let fits =
                told(unsafe { Helfrich_Membrane_checkTerm(subject, self.membrane, &input) })?;
            let exist =
                told(unsafe { Helfrich_Membrane_checkParticles(subject, self.membrane, &input) })?;
            if fits && exist {
                good.push(input);
            }
        }
        Ok((good, kept))
    }

    fn vectors(&self) -> *const [[f64; 3]; 3] {
        self.vectors.as_ref().map_or(ptr::null(), |vectors| vectors)
    }

    fn triangles(&self) -> Vec<[c_int; 3]> {
        let mut corners = vec![[0; 3]; self.counts()[1]];
        unsafe { Helfrich_Membrane_triangles(self.membrane, corners.as_mut_ptr().cast()) };
        corners
    }

    /// Its triangles are those of a surface, which has the numbers that it says.
    fn is_whole(&self) -> std::result::Result<(), TestCaseError> {
        let corners: Vec<_> = self.triangles().iter().map(|t| t.map(i64::from)).collect();
        let again = Topology::new(&corners, 1 << 31);
        prop_assert!(again.is_ok(), "{:?}", again.err());
        let again = Triangulation::new(&again.unwrap());
        let mesh = unsafe { &*self.membrane }.mesh();
        prop_assert_eq!(again.degrees(), mesh.degrees());
        prop_assert_eq!(again.num_edges(), mesh.num_edges());
        prop_assert_eq!(again.fingerprint(), mesh.fingerprint());
        Ok(())
    }

    fn make(&mut self, call: &Call) -> std::result::Result<(), TestCaseError> {
        let (subject, membrane) = (c"Fuzz".as_ptr(), self.membrane);
        let particles = (self.positions.len() / 3) as i64;
        match call {
            Call::Evaluate { terms, energies, forces } => {
                let (terms, _kept) = self.checked(terms)?;
                let mut sums: Vec<_> = terms.iter().map(|_| Contribution::default()).collect();
                let mut gradient = vec![0.0; self.positions.len()];
                let status = unsafe {
                    Helfrich_Membrane_evaluate(
                        subject,
                        membrane,
                        terms.as_ptr(),
                        terms.len() as i64,
                        particles,
                        self.positions.as_ptr(),
                        self.vectors(),
                        if *energies { sums.as_mut_ptr() } else { ptr::null_mut() },
                        if *forces { gradient.as_mut_ptr() } else { ptr::null_mut() },
                    )
                };
                if told(status)? && *energies {
                    prop_assert!(sums.iter().all(|sum| sum.energy.is_finite()), "{:?}", sums);
                }
            }
            Call::Virial(terms) => {
                let (terms, _kept) = self.checked(terms)?;
                let mut virial = [0.0; 9];
                told(unsafe {
                    Helfrich_Membrane_addVirial(
                        subject,
                        membrane,
                        terms.as_ptr(),
                        terms.len() as i64,
                        particles,
                        self.positions.as_ptr(),
                        self.vectors(),
                        virial.as_mut_ptr(),
                    )
                })?;
            }
            Call::Check(term) => {
                let (inputs, _kept) = self.inputs(std::slice::from_ref(term));
                told(unsafe { Helfrich_Membrane_checkTerm(subject, membrane, &inputs[0]) })?;
            }
            Call::Flip { terms, rules, attempts, demon, change } => {
                let (temperature, min_degree, max_degree, max_edge_length, is_demon) = *rules;
                let rules = FlipRules {
                    temperature,
                    min_degree,
                    max_degree,
                    max_edge_length,
                    demon: is_demon,
                };
                let (terms, _kept) = self.checked(terms)?;
                if !told(unsafe { Helfrich_Membrane_checkFlips(subject, membrane, &rules) })? {
                    return Ok(());
                }
                let mut state =
                    FlipState { key: [7, 9], demon_energy: *demon, ..FlipState::default() };
                let (mut made, mut forces) = (0, vec![0.0; self.positions.len()]);
                told(unsafe {
                    Helfrich_Membrane_flip(
                        subject,
                        membrane,
                        terms.as_ptr(),
                        terms.len() as i64,
                        particles,
                        self.positions.as_ptr(),
                        self.vectors(),
                        &rules,
                        *attempts,
                        &mut state,
                        &mut made,
                        if *change { forces.as_mut_ptr() } else { ptr::null_mut() },
                        ptr::null(),
                        0,
                    )
                })?;
                self.is_whole()?;
            }
            Call::Swap { terms, rules, attempts, kinds, demon } => {
                let rules = SwapRules { temperature: rules.0, demon: rules.1 };
                let (terms, _kept) = self.checked(terms)?;
                let mut state =
                    SwapState { key: [3, 5], demon_energy: *demon, ..SwapState::default() };
                let (mut made, mut sources) = (0, vec![0; kinds.len()]);
                let mut forces = vec![0.0; self.positions.len()];
                let fine = told(unsafe {
                    Helfrich_Membrane_swap(
                        subject,
                        membrane,
                        terms.as_ptr(),
                        terms.len() as i64,
                        particles,
                        self.positions.as_ptr(),
                        self.vectors(),
                        &rules,
                        *attempts,
                        &mut state,
                        kinds.as_ptr(),
                        sources.as_mut_ptr(),
                        Helfrich_Numbers_takeVersion(),
                        &mut made,
                        forces.as_mut_ptr(),
                    )
                })?;
                if fine {
                    let count = self.counts()[0];
                    let mut met = sources[..count].to_vec();
                    met.sort_unstable();
                    prop_assert_eq!(met, (0..count as u32).collect::<Vec<_>>());
                }
            }
            Call::SetTriangles(changes) => {
                let (before, corners) = (self.triangles(), self.changed(changes));
                let count = corners.len() as i64;
                let status = unsafe {
                    Helfrich_Membrane_setTriangles(
                        subject,
                        membrane,
                        corners.as_ptr().cast(),
                        count,
                    )
                };
                let expected = if told(status)? { corners } else { before };
                prop_assert_eq!(self.triangles(), expected);
            }
            Call::Restore { corners, order, flips } => {
                let (before, corners) = (self.triangles(), self.changed(corners));
                let count = self.counts()[0];
                let mut present = vec![0; count];
                unsafe { Helfrich_Membrane_order(membrane, present.as_mut_ptr()) };
                for (place, vertex) in order {
                    present[place % count] = *vertex;
                }
                let status = unsafe {
                    let corners = corners.as_ptr().cast();
                    Helfrich_Membrane_restore(subject, membrane, corners, present.as_ptr(), *flips)
                };
                let expected = if told(status)? { corners } else { before };
                prop_assert_eq!(self.triangles(), expected);
            }
            Call::Move(changes) => {
                let count = self.positions.len();
                changes.iter().for_each(|(place, value)| self.positions[place % count] = *value);
            }
            Call::Coincide(one, other) => {
                let count = self.positions.len() / 3;
                let (from, to) = (3 * (one % count), 3 * (other % count));
                self.positions.copy_within(from..from + 3, to);
            }
            Call::Scale(factor) => self.positions.iter_mut().for_each(|x| *x *= factor),
            Call::Box(vectors) => {
                let rows =
                    |v: &[f64; 9]| [[v[0], v[1], v[2]], [v[3], v[4], v[5]], [v[6], v[7], v[8]]];
                self.vectors = vectors.as_ref().map(rows);
            }
        }
        Ok(())
    }

    fn changed(&self, changes: &[(usize, usize, i32)]) -> Vec<[c_int; 3]> {
        let mut corners = self.triangles();
        let count = corners.len();
        for (triangle, corner, particle) in changes {
            corners[triangle % count][*corner] = *particle;
        }
        corners
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn calls_succeed_or_say_why_not(
        round in any::<bool>(),
        open in 0usize..3,
        extra in 0i64..3,
        noise in vec(-0.1f64..0.1, 45),
        calls in vec(call(), 1..12),
    ) {
        let (vertices, mut triangles) = if round { icosahedron() } else { octahedron() };
        triangles.drain(..open);
        let corners: Vec<_> = triangles.iter().map(|t| t.map(|v| v as c_int)).collect();
        let count = vertices.len() as i64 + extra;
        let others = (0..extra).map(|k| [5.0 + k as f64, 0.3, 0.2]);
        let positions = vertices.into_iter().chain(others).flatten().zip(&noise).map(|(x, y)| x + y);
        let mut membrane = ptr::null_mut();
        let made = unsafe {
            Helfrich_Membrane_create(
                c"Fuzz".as_ptr(), corners.as_ptr().cast(), corners.len() as i64, count, &mut membrane,
            )
        };
        prop_assert_eq!(made, 0);
        let mut bench = Bench { membrane, positions: positions.collect(), vectors: None };
        for call in &calls {
            bench.make(call)?;
        }
        bench.is_whole()?;
    }

    #[test]
    fn any_triangles_make_a_membrane_or_a_message(
        corners in vec(prop::array::uniform3(index(7)), 0..12),
        particles in prop_oneof![0i64..9, Just(i64::MAX), Just(1 << 31)],
    ) {
        let mut membrane = ptr::null_mut();
        let made = unsafe {
            Helfrich_Membrane_create(
                c"Fuzz".as_ptr(), corners.as_ptr().cast(), corners.len() as i64, particles, &mut membrane,
            )
        };
        if told(made)? {
            let bench = Bench { membrane, positions: Vec::new(), vectors: None };
            bench.is_whole()?;
        }
    }

    #[test]
    fn any_mesh_is_oriented_or_refused(
        vertices in vec(prop::array::uniform3(number()), 0..7),
        triangles in vec(prop::array::uniform3(prop_oneof![9 => 0i64..7, 1 => any::<i64>()]), 0..10),
        cell in prop::option::of(prop::array::uniform9(number())),
    ) {
        let mut triangles = triangles;
        told(unsafe {
            Helfrich_Mesh_orient(
                vertices.len() as i64, vertices.as_ptr().cast(), triangles.len() as i64,
                triangles.as_mut_ptr().cast(), cell.as_ref().map_or(ptr::null(), |cell| cell.as_ptr()),
            )
        })?;
    }

    /// What no program of ours asks for: the answer is a failure, and no end of the process.
    #[test]
    fn potentials_that_there_are_not(
        place in any::<i32>(), index in any::<i32>(), count in any::<i64>(), value in number(), name in "\\PC{0,20}",
    ) {
        let known = REGISTRY[place.unsigned_abs() as usize % REGISTRY.len()].name();
        for name in [known.to_owned(), name] {
            let name = std::ffi::CString::new(name).unwrap();
            let mut info = std::mem::MaybeUninit::uninit();
            let (mut what, mut text, mut found) = (ptr::null(), ptr::null(), 0);
            unsafe {
                told(Helfrich_Potential_parameter(name.as_ptr(), index, info.as_mut_ptr()))?;
                told(Helfrich_Potential_form(name.as_ptr(), index, &mut what, &mut text))?;
                told(Helfrich_Potential_switch(name.as_ptr(), index, &mut text))?;
                told(Helfrich_Potential_check(name.as_ptr(), index, value))?;
                told(Helfrich_Potential_find(name.as_ptr(), &mut found))?;
                Helfrich_Potential_hasKinds(name.as_ptr());
                told(Helfrich_Potential_checkNumbers(name.as_ptr(), [value; 6].as_ptr(), 6, ptr::null()))?;
            }
        }
        Helfrich_Potential_isContact(place);
        let mut membrane = ptr::null_mut();
        let status = unsafe {
            Helfrich_Membrane_create(c"Fuzz".as_ptr(), ptr::null(), count, 3, &mut membrane)
        };
        prop_assert_eq!(status, 1);
        let numbers = unsafe { Helfrich_Numbers_create(ptr::null(), [1.0; 3].as_ptr(), 3, ptr::null()) };
        let kept = Kept { field: Vec::new(), numbers };
        unsafe { Helfrich_Numbers_rearrange(kept.numbers, [2.0; 2].as_ptr(), 2, 7) };
    }

    /// Positions, velocities, forces and masses of any size, in any order of calls.
    #[test]
    fn time_steps_end(
        numbers in vec(number(), 54),
        masses in vec(prop_oneof![3 => 0.5f64..90.0, 1 => Just(0.0), 1 => number()], 6),
        settings in prop::array::uniform8(number()),
        round in vec(0u8..8, 1..12),
        corners in vec(prop::array::uniform3(index(6)), 0..3),
        is_periodic in 0..2,
    ) {
        let (vertices, triangles) = octahedron();
        let triangles: Vec<_> = triangles.iter().map(|t| t.map(|v| v as c_int)).collect();
        let near = vertices.into_iter().flatten().zip(&numbers);
        let mut positions: Vec<f64> = near.map(|(x, noise)| if noise.abs() < 2.5 { x } else { *noise }).collect();
        let mut velocities = numbers[18..36].to_vec();
        let forces = numbers[36..].to_vec();
        let arrays = ParticleArrays {
            num_particles: 6,
            positions: positions.as_mut_ptr(),
            velocities: velocities.as_mut_ptr(),
            forces: forces.as_ptr(),
        };
        let subject = c"Fuzz".as_ptr();
        let vectors = [[9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, settings[6]]];
        let vectors = if is_periodic == 1 { &vectors } else { ptr::null() };
        let [step, friction, kt, density, lag, time, ..] = settings;
        let mut stream = Stream { key: [1, 2], draws: u64::MAX - 3 };
        let (mut membrane, mut steps) = (ptr::null_mut(), ptr::null_mut());
        let (mut viscosity, mut variable) = (ptr::null_mut(), ptr::null_mut());
        unsafe {
            let count = triangles.len() as i64;
            told(Helfrich_Membrane_create(subject, triangles.as_ptr().cast(), count, 6, &mut membrane))?;
            told(dynamics::Helfrich_Dynamics_create(6, masses.as_ptr(), &mut steps))?;
            told(Helfrich_Viscosity_create(subject, membrane, 6, masses.as_ptr(), &mut viscosity))?;
            told(Helfrich_VariableMasses_create(subject, 6, masses.as_ptr(), density, &mut variable))?;
        }
        let team = ptr::null_mut();
        for call in round {
            let mut out = [0.0; 6];
            let bath = EdgeBath { friction, kt, lag };
            told(unsafe {
                match call {
                    0 => dynamics::Helfrich_Dynamics_verlet(steps, team, &arrays, step),
                    1 => dynamics::Helfrich_Dynamics_langevinMiddle(
                        steps, team, &arrays, &mut stream, step, friction, kt,
                    ),
                    2 => Helfrich_Viscosity_sweep(
                        subject, viscosity, membrane, 6, arrays.positions, arrays.velocities, vectors, &bath,
                        &mut stream,
                    ),
                    3 => {
                        let mut all = triangles.clone();
                        all.extend(&corners);
                        let num_triangles = all.len() as i64;
                        let sheet = SheetInput { corners: all.as_ptr().cast(), num_triangles, is_periodic };
                        Helfrich_VariableMasses_setSurfaces(subject, variable, &sheet, 1)
                    }
                    4 => Helfrich_VariableMasses_begin(subject, variable, team, &arrays, vectors, step),
                    5 => Helfrich_VariableMasses_finish(subject, variable, team, &arrays, vectors, step),
                    6 => Helfrich_VariableMasses_bathe(
                        subject, variable, team, &arrays, vectors, &mut stream, time, friction, kt,
                    ),
                    _ => Helfrich_VariableMasses_get(subject, variable, &arrays, vectors, out.as_mut_ptr()),
                }
            })?;
        }
        unsafe {
            Helfrich_Membrane_destroy(membrane);
            dynamics::Helfrich_Dynamics_destroy(steps);
            Helfrich_Viscosity_destroy(viscosity);
            Helfrich_VariableMasses_destroy(variable);
        }
    }
}
