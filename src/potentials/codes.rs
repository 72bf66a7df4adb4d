//! The numbers by which other languages know potentials: bits, forms and switches, and what they read.
//!
//! Shaders and C++ never state them on their own. build.rs includes this file: it writes the numbers as WGSL into
//! the shaders, and has the C++ compiler compare the enumerations of the headers with the lists here.

use bitflags::{Flags, bitflags};
use std::ffi::CStr;

/// The most scalars that a potential can have.
pub const MAX_PARAMETERS: usize = 4;

/// How many constants a triangle has for a potential: a cache line of them.
pub const CONSTANTS: usize = 8;

bitflags! {
    /// On which elements of the mesh a potential adds energy, and what it wants to know of them
    /// beyond areas, lengths and volume.
    #[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
    pub struct Needs: u32 {
        /// Adds energy of the total area, volume or mean curvature.
        const TOTALS = 1;
        /// Adds energy of each triangle's area and sides.
        const TRIANGLES = 2;
        /// Adds energy of each edge's dihedral angle.
        const EDGES = 4;
        /// Adds energy of each vertex' area and curvature.
        const VERTICES = 8;
        /// Wants Jülicher's curvature of the vertices.
        const CURVATURES = 16;
        /// Wants Voronoi areas or vectors of the vertices, and some of the next four of them.
        const VECTORS = 32;
        /// Wants the normals of the vertices.
        const NORMALS = 64;
        /// Wants the curvature vectors of Gompper and Kroll.
        const COTANGENTS = 128;
        /// Adds energy of the borders' length and turning.
        const BORDERS = 256;
        /// Adds energy of pairs that are near each other in space; `src/contact/` looks after them.
        const CONTACTS = 512;
        /// Wants the total of the curvatures of the vertices, too.
        const MEAN_CURVATURE = 1024;
        /// Wants the curvature vectors of Espriu.
        const UMBRELLAS = 2048;
        /// Wants the Voronoi areas of the vertices.
        const VORONOI_AREAS = 4096;
    }
}

const _: () = assert!(
    Needs::all().bits().count_ones() as usize == <Needs as Flags>::FLAGS.len(),
    "each of Needs is one bit, which no other has"
);

/// An energy and its derivatives with respect to the potential's scalars. The C++ shim reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Contribution {
    /// kJ/mol.
    pub energy: f64,
    /// ∂E/∂(parameter), in the order of `Potential::parameters`.
    pub by_parameter: [f64; MAX_PARAMETERS],
}

/// An enumeration with a list of all, and their names as the user writes them.
macro_rules! named {
    ($(#[$doc:meta])* $name:ident { $($variant:ident),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(clippy::upper_case_acronyms, reason = "names are as the user writes them")]
        pub enum $name {
            $(#[doc = concat!("`", stringify!($variant), "`")] $variant),*
        }

        impl $name {
            /// In the order of their numbers.
            pub const ALL: &[Self] = &[$(Self::$variant),*];
            /// In the same order.
            pub const NAMES: &[&CStr] = &[$(c_name(concat!(stringify!($variant), "\0"))),*];
        }
    };
}

const fn c_name(name: &str) -> &CStr {
    match CStr::from_bytes_with_nul(name.as_bytes()) {
        Ok(name) => name,
        Err(_) => panic!("a name ends with its only NUL"),
    }
}

named! {
    /// What functions of the C interface return that can fail; the last error has the message of a failure.
    #[must_use]
    #[repr(C)]
    Status { Success, Failure }
}

named! {
    /// The schemes of `BendingForce`; `bending.rs` has their formulas.
    Scheme { Julicher, GompperKroll, GompperKrollBarycentric, JulicherVoronoi, Espriu }
}

named! {
    /// The forms of `DihedralForce`; `dihedral.rs` has their formulas.
    Form { Quartic, Cosine, Exp, SmoothExp, SmoothExp46 }
}

named! {
    /// The forms of `SpringForce`; `spring.rs` has their formulas.
    SpringForm { Harmonic, WLCPower }
}

named! {
    /// The attractions of `ParticleSurfaceForce`; `particle_surface.rs` has their formulas.
    Attraction { WCA, LennardJones, NineThree }
}

named! {
    /// The coefficients of `LimForce`; `lim.rs` has them.
    Coefficients { Lim2002, Amoudruz2023 }
}

/// All forms: the class, its enumeration in C++, how shaders begin their constants (if they know them), and the names.
pub const FORMS: [(&str, &str, Option<&str>, &[&CStr]); 5] = [
    ("BendingForce", "Scheme", Some("SCHEME"), Scheme::NAMES),
    ("DihedralForce", "Form", Some("FORM"), Form::NAMES),
    ("LimForce", "Coefficients", Some("COEFFICIENTS"), Coefficients::NAMES),
    ("ParticleSurfaceForce", "Attraction", None, Attraction::NAMES),
    ("SpringForce", "Form", Some("SPRING"), SpringForm::NAMES),
];

/// The switches of `BendingForce`; the k-th is bit k.
pub const BENDING_SWITCHES: &[&CStr] = &[c"unsignedSpontaneousCurvature"];

/// The first of them: the linear term takes |c|.
pub const UNSIGNED: u32 = 1 << 0;
