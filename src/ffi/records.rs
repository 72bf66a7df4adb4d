//! The structures that cross the border to C++, as the build reads them from `CoreFunctions.h` and
//! `HelfrichDynamics.h` (`wrappers/declarations.rs`), and the names that these have for Rust's own.

#![allow(missing_docs, reason = "bindgen leaves out the comments of some")]

pub(super) use crate::dynamics::integrate::Dynamics as HelfrichDynamics;
pub(super) use crate::dynamics::random::Stream as HelfrichStream;
pub(super) use crate::dynamics::variable_mass::VariableMasses as HelfrichVariableMasses;
pub(super) use crate::dynamics::viscosity::Viscosity as HelfrichViscosity;
pub(super) use crate::evaluator::gpu::native::Native as HelfrichNative;
pub(super) use crate::membrane::{Crowd as HelfrichCrowd, Membrane as HelfrichMembrane};
pub(super) use crate::moves::{FlipRules as HelfrichFlipRules, FlipState as HelfrichFlipState};
pub(super) use crate::moves::{SwapRules as HelfrichSwapRules, SwapState as HelfrichSwapState};
pub(super) use crate::potentials::codes::Status as Helfrich_Status;
pub(super) use crate::potentials::{
    Contribution as HelfrichContribution, VertexNumbers as HelfrichNumbers,
};
pub(super) use crate::team::Team as HelfrichTeam;

include!(concat!(env!("OUT_DIR"), "/records.rs"));

pub use self::{
    HelfrichEdgeBath as EdgeBath, HelfrichFollower as FollowerInput,
    HelfrichNativeBuffer as NativeBuffer, HelfrichNativePass as NativePass,
    HelfrichNativePlan as NativePlan, HelfrichParameterInfo as ParameterInfo,
    HelfrichParticleArrays as ParticleArrays, HelfrichSheet as SheetInput,
    HelfrichTerm as TermInput, HelfrichTurn as TurnInput,
};

/// The same of Rust's own as the headers have them.
mod of_headers {
    include!(concat!(env!("OUT_DIR"), "/layouts.rs"));
}

/// Compiles only if the structures have the same fields with the same types at the same places, and no others.
macro_rules! same_layout {
    ($($kind:ident { $($field:ident),* })*) => {$(
        const _: () = {
            use std::mem::offset_of;
            const _: fn(of_headers::$kind) -> $kind = |from| $kind { $($field: from.$field),* };
            assert!(size_of::<$kind>() == size_of::<of_headers::$kind>());
            $(assert!(offset_of!($kind, $field) == offset_of!(of_headers::$kind, $field));)*
        };
    )*};
}

same_layout! {
    HelfrichContribution { energy, by_parameter }
    HelfrichStream { key, draws }
    HelfrichFlipRules { temperature, min_degree, max_degree, max_edge_length, demon }
    HelfrichFlipState {
        key, attempts, accepted, by_border, by_degree, by_length, by_shape, by_energy, by_edge, demon_energy
    }
    HelfrichSwapRules { temperature, demon }
    HelfrichSwapState { key, attempts, accepted, by_kind, by_energy, demon_energy }
}
