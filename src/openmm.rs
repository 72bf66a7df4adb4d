//! OpenMM's C API, as bindgen reads it from the OpenMMCWrapper.h of the OpenMM that the build found.
//!
//! The names are OpenMM's: `OpenMM_System_create`, `OpenMM_Context_getState` and so on.

#![allow(missing_docs, reason = "documented in OpenMM's own manual")]
#![allow(non_camel_case_types, non_upper_case_globals, non_snake_case)]
#![allow(clippy::all, clippy::pedantic)]

include!(concat!(env!("OUT_DIR"), "/openmm.rs"));
