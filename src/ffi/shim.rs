//! The functions of the C++ shim, as the build reads them from `wrappers/src/Shim.h` and the header of the C API.

#![allow(dead_code, reason = "functions of single force classes are made of those for all")]
#![allow(non_snake_case, reason = "names follow OpenMM's C API")]

use crate::openmm::{OpenMM_Context, OpenMM_Force, OpenMM_Integrator};
use crate::potentials::codes::Status as Helfrich_Status;

include!(concat!(env!("OUT_DIR"), "/shim.rs"));
