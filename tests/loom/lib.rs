//! Every order in which threads of a team can meet, as loom tries them.
//!
//! A model fails if a thread reads what another may write at the same time, if all threads wait, or if an assertion
//! does not hold, in any order that the atomics of the team allow.

#![cfg(test)]

mod models;
mod stand_ins;
#[path = "../../src/team/mod.rs"]
#[allow(dead_code, unused_imports, reason = "models need a part")]
mod team;
