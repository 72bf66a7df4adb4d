//! The plugin inside a Rust program: a System read from XML through OpenMM's C API must have the
//! energies and forces of the evaluator called directly.

use openmm_helfrich::evaluator::CpuEvaluator;
use openmm_helfrich::ffi::registerKernelFactories;
use openmm_helfrich::mesh::Topology;
use openmm_helfrich::openmm::*;
use openmm_helfrich::potentials::{Contribution, Evaluator, Request, Term};
use std::ffi::CString;
use std::sync::Arc;

/// Particles of the System; the first and the last belong to no membrane.
const NUM_PARTICLES: usize = 8;

/// An octahedron, each vertex moved by another amount: symmetry would hide errors.
const POSITIONS: [[f64; 3]; NUM_PARTICLES] = [
    [9.0, 9.0, 9.0],
    [1.1, 0.1, -0.2],
    [-0.9, 0.2, 0.1],
    [0.1, 1.3, 0.0],
    [-0.2, -1.0, 0.2],
    [0.2, 0.1, 0.8],
    [0.0, -0.1, -1.2],
    [-9.0, 0.0, 9.0],
];

const TRIANGLES: [[i64; 3]; 8] =
    [[1, 3, 5], [3, 2, 5], [2, 4, 5], [4, 1, 5], [3, 1, 6], [2, 3, 6], [4, 2, 6], [1, 4, 6]];

/// Names and values of the scalars of a force.
type Scalars = [(&'static str, f64); 2];

/// The forces of a vesicle, by their classes. All of them count on this mesh.
const FORCES: [(&str, Scalars); 4] = [
    ("SurfaceAreaForce", [("modulus", 1.3), ("target", 5.0)]),
    ("EnclosedVolumeForce", [("modulus", 0.7), ("target", 1.0)]),
    ("BendingForce", [("rigidity", 50.0), ("spontaneousCurvature", 0.3)]),
    ("TriangleHeightForce", [("minHeight", 1.2), ("epsilon", 4.0)]),
];

/// The System as XML, each force in a group of its own.
fn system_xml() -> CString {
    let triangles: String = TRIANGLES
        .iter()
        .map(|[a, b, c]| format!(r#"<Triangle p1="{a}" p2="{b}" p3="{c}"/>"#))
        .collect();
    let force = |(group, (name, scalars)): (usize, &(&str, Scalars))| {
        let [(n0, v0), (n1, v1)] = scalars;
        format!(
            r#"<Force type="Helfrich{name}" version="1" forceGroup="{group}" name="{name}">
                 <Parameters>
                   <Parameter name="{n0}" value="{v0}"/><Parameter name="{n1}" value="{v1}"/>
                 </Parameters>
                 <EnergyParameterDerivatives/>
                 <Triangles>{triangles}</Triangles>
               </Force>"#
        )
    };
    let forces: String = FORCES.iter().enumerate().map(force).collect();
    let particles = r#"<Particle mass="50"/>"#.repeat(NUM_PARTICLES);
    let text = format!(
        r#"<System openmmVersion="8.6.1" type="System" version="1">
             <PeriodicBoxVectors>
               <A x="2" y="0" z="0"/><B x="0" y="2" z="0"/><C x="0" y="0" z="2"/>
             </PeriodicBoxVectors>
             <Particles>{particles}</Particles>
             <Constraints/>
             <Forces>{forces}</Forces>
           </System>"#
    );
    // Forms have names of their own ("scheme"), which only the classes that have forms accept.
    let text = text.replace(r#"name="BendingForce">"#, r#"name="BendingForce" scheme="Julicher">"#);
    CString::new(text).unwrap()
}

/// Energy and forces of the groups in a mask, from OpenMM's Reference platform.
fn through_openmm(groups: i32) -> (f64, Vec<[f64; 3]>) {
    let xml = system_xml();
    // SAFETY: the C API is used as its header says; every object is destroyed after its last use.
    unsafe {
        let system = OpenMM_XmlSerializer_deserializeSystem(xml.as_ptr());
        assert_eq!(OpenMM_System_getNumForces(system), FORCES.len() as i32);
        let integrator = OpenMM_VerletIntegrator_create(0.1);
        let platform = OpenMM_Platform_getPlatformByName(c"Reference".as_ptr());
        let context = OpenMM_Context_create_2(system, integrator.cast(), platform);
        let positions = OpenMM_Vec3Array_create(NUM_PARTICLES as i32);
        for (index, &[x, y, z]) in POSITIONS.iter().enumerate() {
            OpenMM_Vec3Array_set(positions, index as i32, OpenMM_Vec3 { x, y, z });
        }
        OpenMM_Context_setPositions(context, positions);
        let types =
            OpenMM_State_DataType_OpenMM_State_Energy | OpenMM_State_DataType_OpenMM_State_Forces;
        let state = OpenMM_Context_getState_2(context, types as i32, 0, groups);
        let energy = OpenMM_State_getPotentialEnergy(state);
        let array = OpenMM_State_getForces(state);
        let force = |index| {
            let vector = *OpenMM_Vec3Array_get(array, index);
            [vector.x, vector.y, vector.z]
        };
        let forces = (0..NUM_PARTICLES as i32).map(force).collect();
        OpenMM_State_destroy(state);
        OpenMM_Vec3Array_destroy(positions);
        OpenMM_Context_destroy(context);
        OpenMM_VerletIntegrator_destroy(integrator);
        OpenMM_System_destroy(system);
        (energy, forces)
    }
}

/// Energy and forces of some terms, from the evaluator.
fn directly(terms: &[Term]) -> (f64, Vec<[f64; 3]>) {
    let topology = Arc::new(Topology::new(&TRIANGLES, NUM_PARTICLES).unwrap());
    let mut contributions = vec![Contribution::default(); terms.len()];
    let mut forces = [[0.0; 3]; NUM_PARTICLES];
    CpuEvaluator::new(topology)
        .evaluate(
            Request::new(terms, POSITIONS.as_flattened())
                .with_energies(&mut contributions)
                .with_forces(forces.as_flattened_mut()),
        )
        .unwrap();
    (contributions.iter().map(|part| part.energy).sum(), forces.to_vec())
}

/// One test, because the plugin may be registered only once in a process.
#[test]
fn openmm_and_the_evaluator_agree() {
    registerKernelFactories();
    let terms: Vec<Term> = FORCES
        .iter()
        .map(|(name, [(_, first), (_, second)])| Term::new(name, 0, &[*first, *second]).unwrap())
        .collect();
    let each = (0..terms.len()).map(|k| (1 << k, &terms[k..=k]));
    for (groups, terms) in each.chain([(-1, &terms[..])]) {
        let (energy, forces) = through_openmm(groups);
        let (expected, expected_forces) = directly(terms);
        assert!(expected > 0.1, "group {groups} is not tested by an energy of {expected}");
        assert!((energy / expected - 1.0).abs() < 1e-14, "{groups}: {energy} {expected}");
        let largest = expected_forces.as_flattened().iter().fold(0.0f64, |all, f| all.max(f.abs()));
        assert!(largest > 0.1);
        for (found, expected) in forces.as_flattened().iter().zip(expected_forces.as_flattened()) {
            assert!((found - expected).abs() < 1e-14 * largest, "{groups}: {found} {expected}");
        }
        for foreign in [0, NUM_PARTICLES - 1] {
            assert_eq!(forces[foreign], [0.0; 3]);
        }
    }
}
