//! Monte Carlo moves of a membrane: what they propose, and what that costs in energy.
//!
//! [`local`] computes the energy of any terms around a change, from the formulas that the evaluators use;
//! [`flips`] are moves of the connectivity, and [`swaps`] of what the vertices are.

mod draws;
mod elements;
mod fetch;
pub mod flips;
mod hinges;
pub mod local;
pub mod records;
pub mod swaps;

pub use flips::{Round, Touched};
pub use records::{FlipRules, FlipState, SwapRules, SwapState};
pub use swaps::SwapRound;
