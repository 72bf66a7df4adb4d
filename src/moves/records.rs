//! What C++ tells movers, and what it keeps for them.
//!
//! `src/ffi/records.rs` compares them with the structures of `CoreFunctions.h`.

/// What flips may do. The C++ shim fills it in.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlipRules {
    /// kJ/mol; above zero.
    pub temperature: f64,
    /// The fewest neighbours of a vertex, 3 or more.
    pub min_degree: i32,
    /// The most.
    pub max_degree: i32,
    /// The longest that a new edge may be, nm; 0 for any.
    pub max_edge_length: f64,
    /// Whether a demon pays and takes the energy, in place of a bath.
    pub demon: i32,
}

/// The state of a mover. C++ holds it and writes it into checkpoints.
///
/// A flip that is refused is counted at the first of these that it fails: a border, degrees, length, shape, energy, and
/// whether the new edge exists.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FlipState {
    /// The seed, and a number that tells movers of the same seed apart.
    pub key: [u32; 2],
    /// How many flips have been tried, which is also how many random numbers have been used.
    pub attempts: u64,
    /// How many were made.
    pub accepted: u64,
    /// How many were refused for an edge that is a border,
    pub by_border: u64,
    /// for a vertex that would have too few or too many neighbours,
    pub by_degree: u64,
    /// for the length of the new edge,
    pub by_length: u64,
    /// for a new triangle without area, or an energy that is no number,
    pub by_shape: u64,
    /// for the energy,
    pub by_energy: u64,
    /// because the new edge was there already.
    pub by_edge: u64,
    /// What the demon has, kJ/mol.
    pub demon_energy: f64,
}

/// How neighbours exchange what they are. The C++ shim fills it in.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SwapRules {
    /// kJ/mol; above zero.
    pub temperature: f64,
    /// Whether a demon pays and takes the energy, in place of a bath.
    pub demon: i32,
}

/// The state of a mover of this kind. C++ holds it and writes it into checkpoints.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SwapState {
    /// The seed, and a number that tells movers of the same seed apart.
    pub key: [u32; 2],
    /// How many edges have been chosen, which is also how many random numbers have been used.
    pub attempts: u64,
    /// How many exchanges were made.
    pub accepted: u64,
    /// How many were none, since both ends were alike,
    pub by_kind: u64,
    /// or were refused for the energy.
    pub by_energy: u64,
    /// What the demon has, kJ/mol.
    pub demon_energy: f64,
}
