//! Any calls with any numbers: each succeeds or leaves a message, and a membrane stays one.
//!
//! `PROPTEST_CASES=100000 cargo test --release --lib ffi::fuzz` looks longer, and `PROPTEST_RNG_SEED` elsewhere.

mod bench;
mod wild;

use super::*;
use crate::dynamics::random::Stream;
use crate::potentials::REGISTRY;
use crate::test_meshes::{icosahedron, octahedron};
use bench::{Bench, Kept, told};
use proptest::collection::vec;
use proptest::prelude::*;
use std::ffi::c_int;
use std::ptr;
use wild::{call, index, number};

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
        prop_assert_eq!(made, Status::Success);
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
        prop_assert_eq!(status, Status::Failure);
        let numbers = unsafe { Helfrich_Numbers_create(ptr::null(), [1.0; 3].as_ptr(), 3, ptr::null()) };
        let kept = Kept { field: Vec::new(), numbers };
        told(unsafe { Helfrich_Numbers_rearrange(kept.numbers, [2.0; 2].as_ptr(), 2, 7) })?;
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
        let vectors = [9.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, settings[6]];
        let vectors = if is_periodic == 1 { vectors.as_ptr() } else { ptr::null() };
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
