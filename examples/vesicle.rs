//! A vesicle in Rust: read a mesh from an OFF file, simulate 1000 Verlet steps from rest, print energies.
//!
//! `cargo run --release --example vesicle -- MESH.off`

use nalgebra::Vector3;
use openmm_helfrich::ffi::Helfrich_register;
use openmm_helfrich::force::MembraneForce;
use openmm_helfrich::openmm::*;
use std::error::Error;
use std::ffi::CStr;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: vesicle MESH.off")?;
    let (vertices, triangles) = read_off(&std::fs::read_to_string(path)?)?;

    // The targets of area and volume are those of the mesh.
    let (mut area, mut volume) = (0.0, 0.0);
    for corners in &triangles {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        let normal = (b - a).cross(&(c - a));
        area += 0.5 * normal.norm();
        volume += a.dot(&normal) / 6.0;
    }
    let forces = [
        MembraneForce::new("BendingForce", &triangles, &[50.0, 0.0])?,
        MembraneForce::new("SurfaceAreaForce", &triangles, &[1.3, area])?,
        MembraneForce::new("EnclosedVolumeForce", &triangles, &[0.04, volume])?,
        MembraneForce::new("TriangleHeightForce", &triangles, &[20.0, 9.977])?,
    ];

    // SAFETY: OpenMM's C API is used as its manual says: every object is made, used and destroyed once,
    // and the System owns the forces.
    unsafe {
        let system = OpenMM_System_create();
        let positions = OpenMM_Vec3Array_create(vertices.len() as i32);
        for (index, vertex) in vertices.iter().enumerate() {
            OpenMM_System_addParticle(system, 50.0);
            let position = OpenMM_Vec3 { x: vertex.x, y: vertex.y, z: vertex.z };
            OpenMM_Vec3Array_set(positions, index as i32, position);
        }
        for force in forces {
            OpenMM_System_addForce(system, force.into_openmm());
        }
        let integrator = OpenMM_VerletIntegrator_create(0.2);
        // OpenMM chooses the platform Helfrich, which it knows of now.
        Helfrich_register();
        let context = OpenMM_Context_create(system, integrator.cast());
        let name = OpenMM_Platform_getName(OpenMM_Context_getPlatform(context));
        println!("# platform {}", CStr::from_ptr(name).to_str()?);
        OpenMM_Context_setPositions(context, positions);
        for step in [0, 500, 1000] {
            let energy = OpenMM_State_DataType_OpenMM_State_Energy as i32;
            let state = OpenMM_Context_getState(context, energy, 0);
            let potential = OpenMM_State_getPotentialEnergy(state);
            let kinetic = OpenMM_State_getKineticEnergy(state);
            println!("{step} {potential} {kinetic}");
            OpenMM_State_destroy(state);
            if step < 1000 {
                OpenMM_VerletIntegrator_step(integrator, 500);
            }
        }
        OpenMM_Context_destroy(context);
        OpenMM_VerletIntegrator_destroy(integrator);
        OpenMM_System_destroy(system);
        OpenMM_Vec3Array_destroy(positions);
    }
    Ok(())
}

type Mesh = (Vec<Vector3<f64>>, Vec<[i32; 3]>);

/// Vertices and triangles of a file in Geomview's OFF format.
fn read_off(text: &str) -> Result<Mesh, Box<dyn Error>> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let mut words = lines.flat_map(str::split_whitespace);
    if words.next() != Some("OFF") {
        return Err("not an OFF file".into());
    }
    let mut number = || -> Result<f64, Box<dyn Error>> {
        Ok(words.next().ok_or("the file is truncated")?.parse()?)
    };
    let (num_vertices, num_triangles, _edges) = (number()?, number()?, number()?);
    let mut vertices = Vec::new();
    for _ in 0..num_vertices as usize {
        vertices.push(Vector3::new(number()?, number()?, number()?));
    }
    let mut triangles = Vec::new();
    for _ in 0..num_triangles as usize {
        if number()? != 3.0 {
            return Err("the file has polygons that are no triangles".into());
        }
        triangles.push([number()? as i32, number()? as i32, number()? as i32]);
    }
    Ok((vertices, triangles))
}
