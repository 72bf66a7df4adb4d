//! Constants of triangles: what a potential makes of numbers that the user gives for each vertex, and of which vertices
//! are connected. They are made when either changes, and read in every step.

use super::CONSTANTS;
use crate::error::{Error, Result};
use crate::mesh::cell::Cell;
use crate::mesh::geometry::{TriangleGeometry, Vec3};
use std::ffi::CStr;
use std::sync::atomic::{AtomicU64, Ordering};

/// The constants of a triangle for one potential, used or not.
pub type Constants = [f64; CONSTANTS];

/// What a potential wants to know of each vertex, and its constants of a triangle: by what there is at the corners and by
/// which sides are borders.
#[derive(Clone, Copy)]
pub enum MadeOf {
    /// A position at rest, nm; the corners make a triangle.
    Reference(fn(&TriangleGeometry, [bool; 3]) -> Constants),
    /// The number of a domain.
    Domains(fn([f64; 3], [bool; 3]) -> Constants),
}

/// The numbers of vertices that a term has.
#[derive(Debug, Clone, Copy, Default)]
pub struct VertexNumbers<'a> {
    /// Those of one vertex after those of another, in ascending order of particle index.
    pub values: &'a [f64],
    /// The periodic box in which positions at rest are, if there is one: sides are nearest images in it then.
    pub cell: Option<Cell>,
    /// Which object has them; no other has the same number.
    pub owner: u64,
    /// Changes when its numbers do.
    pub version: u64,
}

impl<'a> VertexNumbers<'a> {
    /// Numbers of an object of their own.
    pub fn new(values: &'a [f64], cell: Option<Cell>) -> Self {
        // Those of the C interface begin with 1.
        static LAST: AtomicU64 = AtomicU64::new(1 << 63);
        Self { values, cell, owner: LAST.fetch_add(1, Ordering::Relaxed), version: 0 }
    }
}

/// The constants of all triangles of a mesh, for one term.
#[derive(Debug, Clone, Copy, Default)]
pub struct TriangleConstants<'a> {
    /// In the order of the mesh; empty until they have been made.
    pub values: &'a [Constants],
    /// No other constants have the same number.
    pub version: u64,
}

/// Why a triangle has no shape at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flaw {
    /// Its corners are in one line.
    Flat,
    /// In the periodic box of the reference a side has no image that is certainly the nearest.
    Long {
        /// Its number.
        side: usize,
        /// nm.
        length: f64,
    },
}

/// A share of the square of its longest side, below which nothing is left of a triangle's area but rounding.
const LEAST_AREA: f64 = 1e-12;

impl MadeOf {
    /// What the numbers are called, in XML and as an argument.
    pub fn name(self) -> &'static CStr {
        match self {
            Self::Reference(_) => c"reference",
            Self::Domains(_) => c"domains",
        }
    }

    /// How many of them a vertex has.
    pub fn width(self) -> usize {
        match self {
            Self::Reference(_) => 3,
            Self::Domains(_) => 1,
        }
    }

    /// Whether the numbers say of what kind a vertex is, so that neighbours can exchange them.
    pub fn is_of_kinds(self) -> bool {
        matches!(self, Self::Domains(_))
    }

    /// Refuse numbers that no vertex can have, or too few for the last one.
    ///
    /// # Errors
    /// Names the vertex, by its place among all.
    pub fn check(self, values: &[f64]) -> Result<()> {
        let name = self.name().to_string_lossy();
        let refuse = |message: String| Err(Error::Contract(message));
        if !values.len().is_multiple_of(self.width()) {
            return refuse(format!(
                "{name} needs {} numbers for each vertex, got {} in all",
                self.width(),
                values.len()
            ));
        }
        for (vertex, row) in values.chunks(self.width()).enumerate() {
            match (self, row) {
                (Self::Reference(_), row) if !row.iter().all(|x| x.is_finite()) => {
                    return refuse(format!(
                        "{name} has vertex {vertex} at ({}, {}, {}) nm, which is not finite",
                        row[0], row[1], row[2]
                    ));
                }
                (Self::Domains(_), [domain]) if domain.trunc() != *domain => {
                    return refuse(format!(
                        "{name} must be whole numbers, but vertex {vertex} has {domain}"
                    ));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The constants of a triangle.
    ///
    /// # Errors
    /// Its shape at rest is none.
    pub fn constants(
        self,
        numbers: &VertexNumbers,
        corners: [u32; 3],
        on_border: [bool; 3],
    ) -> std::result::Result<Constants, Flaw> {
        match self {
            Self::Domains(make) => {
                Ok(make(corners.map(|vertex| numbers.values[vertex as usize]), on_border))
            }
            Self::Reference(make) => Ok(make(&at_rest(numbers, corners)?, on_border)),
        }
    }
}

/// The triangle that corners make in the reference.
fn at_rest(
    numbers: &VertexNumbers,
    corners: [u32; 3],
) -> std::result::Result<TriangleGeometry, Flaw> {
    let positions = numbers.values.as_chunks::<3>().0;
    let [a, mut b, mut c] = corners.map(|vertex| Vec3::from(positions[vertex as usize]));
    if let Some(cell) = &numbers.cell {
        b += cell.shift(cell.nearest(&(b - a)));
        c += cell.shift(cell.nearest(&(c - a)));
    }
    let triangle = TriangleGeometry::new(&a, &b, &c);
    let lengths_squared = [0, 1, 2].map(|side| triangle.length_squared(side));
    if let Some(cell) = &numbers.cell {
        let limit = cell.half_width();
        if let Some(side) = (0..3).find(|side| lengths_squared[*side] >= limit * limit) {
            return Err(Flaw::Long { side, length: lengths_squared[side].sqrt() });
        }
    }
    let longest = lengths_squared.into_iter().fold(0.0, f64::max);
    match triangle.twice_area > LEAST_AREA * longest {
        true => Ok(triangle),
        false => Err(Flaw::Flat),
    }
}
