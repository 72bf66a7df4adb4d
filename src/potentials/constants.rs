//! Constants of triangles: what a potential makes of numbers that the user gives for each vertex, and of which vertices
//! are connected. They are made when either changes, and read in every step.

use super::{CONSTANTS, Term};
use crate::error::{Error, Result};
use crate::mesh::Triangulation;
use crate::mesh::cell::Cell;
use crate::mesh::geometry::{TriangleGeometry, Vec3};
use crate::real::{RECORD, Record};
use std::f64::consts::TAU;
use std::ffi::CStr;
use std::sync::atomic::{AtomicU64, Ordering};

/// The constants of a triangle for one potential, used or not.
pub type Constants = Record;
const _: () = assert!(CONSTANTS == RECORD);

/// What a potential wants to know of each vertex, and its constants of a triangle: by what there is at the corners and by
/// which sides are borders.
#[derive(Clone, Copy)]
pub enum MadeOf {
    /// A position at rest, nm; the corners make a triangle.
    Reference(fn(&TriangleGeometry, [bool; 3]) -> Constants),
    /// The number of a domain.
    Domains(fn([f64; 3], [bool; 3]) -> Constants),
    /// The value of the first parameter, zero on borders; and an energy that each triangle has for itself, the same for
    /// all, which is 2π times the sum of these values, by triangle.
    Values(fn([f64; 3], f64) -> Constants),
}

/// Where the constants of a triangle come from.
#[derive(Debug, Clone, Copy)]
pub struct Corners {
    /// Its vertices.
    pub vertices: [u32; 3],
    /// Whether they are on borders.
    pub are_outer: [bool; 3],
    /// Whether its sides are borders.
    pub on_border: [bool; 3],
}

/// What a force object has for each vertex.
#[derive(Debug)]
pub struct VertexNumbers {
    /// The numbers of one vertex after those of another, in ascending order of particle index.
    pub values: Vec<f64>,
    /// The vectors of the periodic box in which positions at rest are, nm, if there is one: sides are nearest images in it.
    pub vectors: Option<[[f64; 3]; 3]>,
    /// Which force object has them; 0 if none has.
    pub owner: u64,
    /// No others have the same number.
    pub version: u64,
}

impl VertexNumbers {
    /// Of terms that have none.
    pub const NONE: &Self = &Self { values: Vec::new(), vectors: None, owner: 0, version: 0 };

    /// Numbers of a new object, or of one that has had others.
    pub fn new(values: Vec<f64>, vectors: Option<[[f64; 3]; 3]>, owner: Option<u64>) -> Self {
        let version = Self::take_version();
        Self { values, vectors, owner: owner.unwrap_or(version), version }
    }

    /// A version that no others have.
    pub fn take_version() -> u64 {
        static LAST: AtomicU64 = AtomicU64::new(0);
        LAST.fetch_add(1, Ordering::Relaxed) + 1
    }
}

/// The constants of all triangles of a mesh, for one term.
#[derive(Debug, Default)]
pub struct TriangleConstants {
    /// In the order of the mesh; empty until they have been made.
    pub values: Vec<Constants>,
    /// What they have in common.
    pub common: Common,
    /// No other constants have the same number.
    pub version: u64,
}

/// What the constants of all triangles have in common, however they are connected.
#[derive(Debug, Default)]
pub struct Common {
    /// The periodic box of the reference, if there is one.
    pub cell: Option<Cell>,
    /// The energy that each triangle has for itself.
    pub share: f64,
}

impl TriangleConstants {
    /// Of terms that have none.
    pub const NONE: &Self =
        &Self { values: Vec::new(), common: Common { cell: None, share: 0.0 }, version: 0 };
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
    /// What the numbers of vertices are called, in XML and as an argument, and how many of them a vertex has; `None` if the
    /// values of a parameter take their place.
    pub fn numbers(self) -> Option<(&'static CStr, usize)> {
        match self {
            Self::Reference(_) => Some((c"reference", 3)),
            Self::Domains(_) => Some((c"domains", 1)),
            Self::Values(_) => None,
        }
    }

    /// Whether they come of what kind the vertices are, which neighbours can exchange.
    pub fn is_of_kinds(self) -> bool {
        matches!(self, Self::Domains(_) | Self::Values(_))
    }

    /// Refuse numbers that no vertex can have, or too few for the last one.
    ///
    /// # Errors
    /// Names the vertex, by its place among all.
    pub fn check(self, values: &[f64]) -> Result<()> {
        let Some((name, width)) = self.numbers() else { return Ok(()) };
        let name = name.to_string_lossy();
        let refuse = |message: String| Err(Error::Contract(message));
        if !values.len().is_multiple_of(width) {
            let all = values.len();
            return refuse(format!(
                "{name} needs {width} numbers for each vertex, got {all} in all"
            ));
        }
        for (vertex, row) in values.chunks(width).enumerate() {
            match row {
                [x, y, z] if !row.iter().all(|x| x.is_finite()) => {
                    return refuse(format!(
                        "{name} has vertex {vertex} at ({x}, {y}, {z}) nm, which is not finite"
                    ));
                }
                [domain] if !domain.is_finite() || domain.trunc() != *domain => {
                    return refuse(format!(
                        "{name} must be whole numbers, but vertex {vertex} has {domain}"
                    ));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// What the constants of all triangles have in common.
    ///
    /// # Errors
    /// Vectors that are no box.
    pub fn common(self, term: &Term, mesh: &Triangulation) -> Result<Common> {
        let mut common = Common::default();
        match self {
            Self::Reference(_) => {
                common.cell = term.numbers.vectors.map(Cell::new).transpose()?;
            }
            Self::Domains(_) => {}
            Self::Values(_) => {
                let inner = (0..mesh.num_vertices()).filter(|v| !mesh.is_border(*v as u32));
                let sum: f64 = inner.map(|vertex| self.part(term, vertex)).sum();
                common.share = sum / mesh.triangles().len() as f64;
            }
        }
        Ok(common)
    }

    /// What an inner vertex with the values of this one adds to [`Self::common`], times the number of triangles.
    pub fn part(self, term: &Term, vertex: usize) -> f64 {
        match self {
            Self::Reference(_) | Self::Domains(_) => 0.0,
            Self::Values(_) => TAU * term.value(0, vertex),
        }
    }

    /// The constants of a triangle.
    ///
    /// # Errors
    /// The triangle has no shape at rest.
    pub fn constants(
        self,
        term: &Term,
        corners: &Corners,
        common: &Common,
    ) -> std::result::Result<Constants, Flaw> {
        let &Corners { vertices, are_outer, on_border } = corners;
        let numbers = &term.numbers.values;
        match self {
            Self::Reference(make) => {
                Ok(make(&at_rest(numbers, common.cell.as_ref(), vertices)?, on_border))
            }
            Self::Domains(make) => {
                Ok(make(vertices.map(|vertex| numbers[vertex as usize]), on_border))
            }
            Self::Values(make) => {
                let value = |k: usize| match are_outer[k] {
                    true => 0.0,
                    false => term.value(0, vertices[k] as usize),
                };
                Ok(make([value(0), value(1), value(2)], common.share))
            }
        }
    }
}

/// The triangle that corners make in the reference.
fn at_rest(
    numbers: &[f64],
    cell: Option<&Cell>,
    corners: [u32; 3],
) -> std::result::Result<TriangleGeometry, Flaw> {
    let positions = numbers.as_chunks::<3>().0;
    let [a, mut b, mut c] = corners.map(|vertex| Vec3::from(positions[vertex as usize]));
    if let Some(cell) = cell {
        b += cell.shift(cell.nearest(&(b - a)));
        c += cell.shift(cell.nearest(&(c - a)));
    }
    let triangle = TriangleGeometry::new(&a, &b, &c);
    let lengths_squared = [0, 1, 2].map(|side| triangle.length_squared(side));
    if let Some(cell) = cell {
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
