//! The C API of the force classes, in the style of OpenMM's C wrapper: `Helfrich_BendingForce_create`
//! and so on. `wrappers/include/OpenMMHelfrichCWrapper.h` declares the same functions.
//!
//! A force is an `OpenMM_Force` that `OpenMM_System_addForce` takes. Functions that can fail return
//! 0 for success and 1 for failure, or a null pointer; [`crate::ffi::Helfrich_lastError`] has the message.
//!
//! They are made here, because a Rust library exports only Rust's own symbols; what they do is in
//! `wrappers/src/CApi.cpp`.

//!
//! # Safety
//! Every function takes pointers of C: a force made by one of the `create` functions and not yet
//! destroyed (or given to a System that still lives), texts that end with a NUL, and arrays of the
//! length that is passed beside them.

#![allow(non_snake_case, reason = "names follow OpenMM's C API")]
#![allow(clippy::missing_safety_doc, reason = "the safety of all functions is stated above")]

use crate::ffi::set_last_error;
use std::ffi::{CStr, c_char, c_double, c_int, c_void};

/// A force of this plugin: the address of an `OpenMM::Force`.
pub type Force = c_void;

unsafe extern "C" {
    fn helfrich_shim_createForce(
        class: *const c_char,
        triangles: *const c_int,
        num_triangles: c_int,
        values: *const c_double,
        num_values: c_int,
        form: c_int,
    ) -> *mut Force;
}

/// A force of any class; null if an argument is refused.
///
/// # Safety
/// `class` must end with a NUL, and `triangles` hold three values a triangle.
pub(crate) unsafe fn create(
    class: *const c_char,
    triangles: *const c_int,
    num_triangles: c_int,
    values: &[f64],
    form: c_int,
) -> *mut Force {
    let count = values.len() as c_int;
    unsafe {
        helfrich_shim_createForce(class, triangles, num_triangles, values.as_ptr(), count, form)
    }
}

/// Lets the shim report what it caught.
///
/// # Safety
/// `message` must end with a NUL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn helfrich_setLastError(message: *const c_char) {
    set_last_error(unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned());
}

/// Functions that only pass on to the shim.
macro_rules! forward {
    ($($(#[$doc:meta])* $name:ident => $shim:ident($($argument:ident: $type:ty),*) $(-> $result:ty)?;)*) => {
        unsafe extern "C" {
            $(fn $shim($($argument: $type),*) $(-> $result)?;)*
        }
        $($(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type),*) $(-> $result)? {
            unsafe { $shim($($argument),*) }
        })*
    };
}

forward! {
    /// Delete a force that no System owns.
    Helfrich_MembraneForce_destroy => helfrich_shim_destroyForce(force: *mut Force);
    /// Add a triangle; returns its index.
    Helfrich_MembraneForce_addTriangle =>
        helfrich_shim_addTriangle(force: *mut Force, particle1: c_int, particle2: c_int, particle3: c_int) -> c_int;
    /// The number of triangles.
    Helfrich_MembraneForce_getNumTriangles => helfrich_shim_getNumTriangles(force: *mut Force) -> c_int;
    /// Write the three corners of a triangle.
    Helfrich_MembraneForce_getTriangle =>
        helfrich_shim_getTriangle(force: *mut Force, index: c_int, corners: *mut c_int) -> c_int;
    /// Read a scalar by its name.
    Helfrich_MembraneForce_getParameterValue =>
        helfrich_shim_getValue(force: *mut Force, parameter: *const c_char, value: *mut c_double) -> c_int;
    /// Set a scalar by its name.
    Helfrich_MembraneForce_setParameterValue =>
        helfrich_shim_setValue(force: *mut Force, parameter: *const c_char, value: c_double) -> c_int;
    /// Give a scalar its own value for each vertex, triangle or particle.
    Helfrich_MembraneForce_setElementValues =>
        helfrich_shim_setElementValues(force: *mut Force, parameter: *const c_char, values: *const c_double, count: c_int) -> c_int;
    /// Set the particles that a ParticleSurfaceForce acts on.
    Helfrich_ParticleSurfaceForce_setParticles =>
        helfrich_shim_setParticles(force: *mut Force, particles: *const c_int, count: c_int) -> c_int;
    /// Set where the vertices are at rest, in ascending order of particle index, and in which periodic box; null for none.
    Helfrich_MembraneForce_setReference =>
        helfrich_shim_setReference(force: *mut Force, positions: *const c_double, num_vertices: c_int, box_vectors: *const c_double) -> c_int;
    /// Say to which domain each vertex belongs, in ascending order of particle index.
    Helfrich_LineTensionForce_setDomains =>
        helfrich_shim_setDomains(force: *mut Force, domains: *const c_int, num_vertices: c_int) -> c_int;
    /// Write the domain of each vertex as it is in a Context (an `OpenMM_Context`) now.
    Helfrich_LineTensionForce_getDomainsInContext =>
        helfrich_shim_getDomainsInContext(force: *mut Force, context: *mut c_void, domains: *mut c_int) -> c_int;
    /// Choose the variant of the potential.
    Helfrich_MembraneForce_setForm => helfrich_shim_setForm(force: *mut Force, form: c_int) -> c_int;
    /// Switch something on or off.
    Helfrich_MembraneForce_setSwitch =>
        helfrich_shim_setSwitch(force: *mut Force, name: *const c_char, on: c_int) -> c_int;
    /// Choose what computes the force: "cpu", "gpu", "gpu:single", "gpu:double", "auto", or "" for what the process
    /// has chosen.
    Helfrich_MembraneForce_setBackend =>
        helfrich_shim_setBackend(force: *mut Force, backend: *const c_char) -> c_int;
    /// Say whether the surface lives in the periodic box of the Context.
    Helfrich_MembraneForce_setUsesPeriodicBoundaryConditions =>
        helfrich_shim_setPeriodic(force: *mut Force, periodic: c_int) -> c_int;
    /// Whether it does.
    Helfrich_MembraneForce_usesPeriodicBoundaryConditions => helfrich_shim_usesPeriodic(force: *mut Force) -> c_int;
    /// Let a Context parameter take the place of a scalar.
    Helfrich_MembraneForce_setContextParameter =>
        helfrich_shim_setContextParameter(force: *mut Force, parameter: *const c_char, name: *const c_char) -> c_int;
    /// Ask for the derivative of the energy with respect to a Context parameter.
    Helfrich_MembraneForce_addEnergyParameterDerivative =>
        helfrich_shim_addEnergyParameterDerivative(force: *mut Force, name: *const c_char) -> c_int;
    /// Copy the scalars to a Context (an `OpenMM_Context`).
    Helfrich_MembraneForce_updateParametersInContext =>
        helfrich_shim_updateParametersInContext(force: *mut Force, context: *mut c_void) -> c_int;
    /// Write the three corners of each triangle as they are in a Context (an `OpenMM_Context`) now.
    Helfrich_MembraneForce_getTrianglesInContext =>
        helfrich_shim_getTrianglesInContext(force: *mut Force, context: *mut c_void, corners: *mut c_int) -> c_int;
    /// Write ∂E/∂ε of all membrane forces of a Context in some force groups, nine numbers row by row, kJ/mol.
    Helfrich_MembraneForce_getVirial =>
        helfrich_shim_getVirial(force: *mut Force, context: *mut c_void, groups: c_int, virial: *mut c_double) -> c_int;
    /// Connect the particles of a Context in another way.
    Helfrich_MembraneForce_setTrianglesInContext =>
        helfrich_shim_setTrianglesInContext(force: *mut Force, context: *mut c_void, corners: *const c_int, num_triangles: c_int) -> c_int;
    /// Write for each vertex of a Context the one whose values it has now.
    Helfrich_MembraneForce_getPermutationInContext =>
        helfrich_shim_getPermutationInContext(force: *mut Force, context: *mut c_void, permutation: *mut c_int) -> c_int;
    /// Let the vertices of a Context have each other's values.
    Helfrich_MembraneForce_setPermutationInContext =>
        helfrich_shim_setPermutationInContext(force: *mut Force, context: *mut c_void, permutation: *const c_int, num_vertices: c_int) -> c_int;
    /// Make a MonteCarloBondFlip; null if an argument is refused.
    Helfrich_MonteCarloBondFlip_create =>
        helfrich_shim_createMover(triangles: *const c_int, num_triangles: c_int, temperature: c_double, frequency: c_int, attempts_per_edge: c_double, min_degree: c_int, max_degree: c_int, max_edge_length: c_double) -> *mut Force;
    /// Copy frequency, attempts, bounds and ensemble to a Context.
    Helfrich_MonteCarloBondFlip_updateParametersInContext =>
        helfrich_shim_updateMover(force: *mut Force, context: *mut c_void) -> c_int;
    /// Read one of the statistics of a MonteCarloBondFlip in a Context by its name.
    Helfrich_MonteCarloBondFlip_getStatistic =>
        helfrich_shim_getStatistic(force: *mut Force, context: *mut c_void, name: *const c_char, value: *mut c_double) -> c_int;
    /// Make a MonteCarloDomainSwap; null if an argument is refused.
    Helfrich_MonteCarloDomainSwap_create =>
        helfrich_shim_createSwap(triangles: *const c_int, num_triangles: c_int, temperature: c_double, frequency: c_int, attempts_per_edge: c_double) -> *mut Force;
    /// Copy frequency, attempts and ensemble to a Context.
    Helfrich_MonteCarloDomainSwap_updateParametersInContext =>
        helfrich_shim_updateSwap(force: *mut Force, context: *mut c_void) -> c_int;
    /// Read one of the statistics of a MonteCarloDomainSwap in a Context by its name.
    Helfrich_MonteCarloDomainSwap_getStatistic =>
        helfrich_shim_getSwapStatistic(force: *mut Force, context: *mut c_void, name: *const c_char, value: *mut c_double) -> c_int;
    /// Make a MonteCarloMembraneTension; null if an argument is refused.
    Helfrich_MonteCarloMembraneTension_create =>
        helfrich_shim_createTension(temperature: c_double, tension: c_double, frequency: c_int, axes: c_int, pulling_force: c_double) -> *mut Force;
    /// Copy frequency and the number of adaptive moves to a Context.
    Helfrich_MonteCarloMembraneTension_updateParametersInContext =>
        helfrich_shim_updateTension(force: *mut Force, context: *mut c_void) -> c_int;
    /// Read one of the statistics of a MonteCarloMembraneTension in a Context by its name.
    Helfrich_MonteCarloMembraneTension_getStatistic =>
        helfrich_shim_getTensionStatistic(force: *mut Force, context: *mut c_void, name: *const c_char, value: *mut c_double) -> c_int;
    /// Make a SurfaceViscosityThermostat; null if an argument is refused.
    Helfrich_SurfaceViscosityThermostat_create =>
        helfrich_shim_createViscosity(triangles: *const c_int, num_triangles: c_int, friction: c_double, temperature: c_double, frequency: c_int) -> *mut Force;
    /// Copy the frequency to a Context.
    Helfrich_SurfaceViscosityThermostat_updateParametersInContext =>
        helfrich_shim_updateViscosity(force: *mut Force, context: *mut c_void) -> c_int;
    /// Name the Context parameter that holds the friction.
    Helfrich_SurfaceViscosityThermostat_setFrictionParameter =>
        helfrich_shim_setFrictionParameter(force: *mut Force, name: *const c_char) -> c_int;
}

/// `get` and `set` of values of a mover.
macro_rules! mover_values {
    ($class:ident as $shim:ident, $($name:ident: $type:ty),*) => { paste::paste! { forward! { $(
        #[doc = concat!("The ", stringify!($name), " of a ", stringify!($class), ".")]
        [<Helfrich_ $class _get $name>] => [<helfrich_shim_get $shim $name>](force: *mut Force) -> $type;
        #[doc = concat!("Set the ", stringify!($name), " of a ", stringify!($class), ".")]
        [<Helfrich_ $class _set $name>] => [<helfrich_shim_set $shim $name>](force: *mut Force, value: $type) -> c_int;
    )* } } };
}

mover_values! {
    MonteCarloBondFlip as Mover,
    DefaultTemperature: c_double, Frequency: c_int, AttemptsPerEdge: c_double, MinDegree: c_int, MaxDegree: c_int,
    MaxEdgeLength: c_double, Ensemble: c_int, RandomNumberSeed: c_int
}

mover_values! {
    MonteCarloDomainSwap as Swap,
    DefaultTemperature: c_double, Frequency: c_int, AttemptsPerEdge: c_double, Ensemble: c_int, RandomNumberSeed: c_int
}

mover_values! {
    MonteCarloMembraneTension as Tension,
    DefaultTemperature: c_double, DefaultTension: c_double, DefaultPullingForce: c_double, Frequency: c_int,
    Axes: c_int, ScaleMoleculesAsRigid: c_int, AdaptiveMoves: c_int, RandomNumberSeed: c_int
}

mover_values! {
    SurfaceViscosityThermostat as Viscosity,
    DefaultFriction: c_double, DefaultTemperature: c_double, Frequency: c_int, RandomNumberSeed: c_int
}

/// `create`, and `get` and `set` of each scalar, for a force class; what `create` does not take has a default.
macro_rules! force_class {
    ($class:ident($($parameter:ident),*) $($form:ident)? $(, $later:ident)*) => {
        paste::paste! {
            #[doc = concat!("Make a ", stringify!($class), "; null if an argument is refused.")]
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn [<Helfrich_ $class _create>](
                triangles: *const c_int,
                num_triangles: c_int,
                $([<$parameter:snake>]: c_double,)*
                $($form: c_int,)?
            ) -> *mut Force {
                let values = [$([<$parameter:snake>]),*];
                #[allow(unused_mut, unused_assignments)]
                let mut variant = 0;
                $(variant = $form;)?
                let class = concat!(stringify!($class), "\0").as_ptr().cast();
                unsafe { create(class, triangles, num_triangles, &values, variant) }
            }
            force_scalars!($class, $($parameter),* $(, $later)*);
        }
    };
}

/// `get` and `set` of the scalars of a force class.
macro_rules! force_scalars {
    ($class:ident, $($parameter:ident),*) => {
        paste::paste! {
            $(
                #[doc = concat!("The scalar ", stringify!($parameter), " of a ", stringify!($class), ".")]
                #[unsafe(no_mangle)]
                pub unsafe extern "C" fn [<Helfrich_ $class _get $parameter:camel>](force: *mut Force) -> c_double {
                    let mut value = f64::NAN;
                    let name = concat!(stringify!($parameter), "\0").as_ptr().cast();
                    unsafe { Helfrich_MembraneForce_getParameterValue(force, name, &mut value) };
                    value
                }

                #[doc = concat!("Set the scalar ", stringify!($parameter), " of a ", stringify!($class), ".")]
                #[unsafe(no_mangle)]
                pub unsafe extern "C" fn [<Helfrich_ $class _set $parameter:camel>](
                    force: *mut Force,
                    value: c_double,
                ) -> c_int {
                    let name = concat!(stringify!($parameter), "\0").as_ptr().cast();
                    unsafe { Helfrich_MembraneForce_setParameterValue(force, name, value) }
                }
            )*
        }
    };
}

force_class!(SurfaceAreaForce(modulus, target));
force_class!(EnclosedVolumeForce(modulus, target));
force_class!(BendingForce(rigidity, spontaneousCurvature) scheme);
force_class!(TriangleHeightForce(minHeight, epsilon));
force_class!(DihedralForce(stiffness) form, restAngle);
force_class!(TriangleAreaForce(modulus, target));
force_class!(PlaquetteAreaForce(stiffness, target));
force_class!(TriangleAreaRepulsionForce(minArea, epsilon));
force_class!(SurfaceRepulsionForce(distance, epsilon));
force_class!(ParticleSurfaceForce(distance, epsilon, adhesion, radius) attraction);
force_class!(EdgeTensionForce(tension));
force_class!(GaussianCurvatureForce(modulus));
force_class!(SkalakForce(shearModulus, areaModulus));
force_class!(LimForce(shearModulus, areaModulus) coefficients);
force_class!(PressureForce(pressure));
force_class!(SurfaceTensionForce(tension));
force_class!(OsmoticPressureForce(solutes, concentration, thermalEnergy));
force_class!(AreaDifferenceForce(modulus, target));
force_class!(NeoHookeanForce(shearModulus, areaModulus));
force_class!(LinearElasticForce(shearModulus, areaModulus));
force_class!(SpringForce(stiffness, ratio) form);
force_class!(LineTensionForce(tension));
