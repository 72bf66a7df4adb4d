//! The periodic box: nearest images and shifts.

use super::geometry::Vec3;
use crate::error::{Error, Result};

/// A periodic box in OpenMM's reduced form: a along x, b in the xy plane, c anywhere; none of them leans over by
/// more than half of another's length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// a, b and c, nm.
    vectors: [Vec3; 3],
    /// Half of the least distance between opposite faces, nm.
    half_width: f64,
}

/// How many boxes away positions may be: an [`Image`] has room for the ways from one to another.
pub const MOST_BOXES: f64 = 1e9;

/// How many times each of the box vectors.
pub type Image = [i32; 3];

/// One after another.
#[inline]
pub fn plus(one: Image, other: Image) -> Image {
    std::array::from_fn(|k| one[k].wrapping_add(other[k]))
}

/// The image that leads from `other` to `one`.
#[inline]
pub fn minus(one: Image, other: Image) -> Image {
    std::array::from_fn(|k| one[k].wrapping_sub(other[k]))
}

impl Cell {
    /// A box of three vectors.
    ///
    /// # Errors
    /// Vectors that are not finite, or not of OpenMM's form.
    pub fn new([a, b, c]: [[f64; 3]; 3]) -> Result<Self> {
        let finite = [a, b, c].as_flattened().iter().all(|x| x.is_finite());
        let form = a[1] == 0.0 && a[2] == 0.0 && b[2] == 0.0;
        if !(finite && form && a[0] > 0.0 && b[1] > 0.0 && c[2] > 0.0) {
            return Err(Error::Contract(format!(
                "the periodic box needs vectors (ax, 0, 0), (bx, by, 0) and (cx, cy, cz) with ax, by and cz above zero, \
                 got {a:?}, {b:?} and {c:?} nm"
            )));
        }
        let vectors = [a, b, c].map(Vec3::from);
        let volume = a[0] * b[1] * c[2];
        let width = |k: usize| volume / vectors[(k + 1) % 3].cross(&vectors[(k + 2) % 3]).norm();
        let half_width = 0.5 * width(0).min(width(1)).min(width(2));
        Ok(Self { vectors, half_width })
    }

    /// a, b and c, nm.
    pub fn vectors(&self) -> &[Vec3; 3] {
        &self.vectors
    }

    /// Half of the least distance between opposite faces, nm: what is shorter has one image that is that short, which
    /// [`Self::nearest`] finds.
    pub fn half_width(&self) -> f64 {
        self.half_width
    }

    /// The vector of an image, nm.
    #[inline]
    pub fn shift(&self, image: Image) -> Vec3 {
        let [a, b, c] = &self.vectors;
        a * f64::from(image[0]) + b * f64::from(image[1]) + c * f64::from(image[2])
    }

    /// What to add to a separation so that it becomes its shortest image; of a long one, some short image.
    #[inline]
    pub fn nearest(&self, separation: &Vec3) -> Image {
        self.image(separation, |x| -x.round_ties_even())
    }

    /// What to add to a position so that it lies in the brick of sides ax, by and cz that begins at the origin, as OpenMM
    /// wraps.
    #[inline]
    pub fn wrap(&self, position: &Vec3) -> Image {
        self.image(position, |x| -x.floor())
    }

    /// Whether a position is so many boxes away that the numbers of its image do not fit.
    pub fn is_too_far(&self, position: &Vec3) -> bool {
        let [a, b, c] = &self.vectors;
        // Coordinates along c, b and a, times what they would be divided by.
        let z = position.z;
        let y = position.y * c.z - z * c.y;
        let x = (position.x * c.z - z * c.x) * b.y - y * b.x;
        z.abs() >= MOST_BOXES * c.z
            || y.abs() >= MOST_BOXES * (b.y * c.z)
            || x.abs() >= MOST_BOXES * (a.x * b.y * c.z)
    }

    #[inline]
    fn image(&self, vector: &Vec3, count: impl Fn(f64) -> f64) -> Image {
        let [a, b, c] = &self.vectors;
        let mut rest = *vector;
        let k = count(rest.z / c.z);
        rest += c * k;
        let j = count(rest.y / b.y);
        rest += b * j;
        let i = count(rest.x / a.x);
        [i as i32, j as i32, k as i32]
    }
}

/// Why a particle is nowhere, if it is: its position is not finite, or too many boxes away.
#[inline]
pub fn nowhere(cell: Option<&Cell>, particle: u32, position: &Vec3) -> Option<Error> {
    if !position.iter().all(|x| x.is_finite()) {
        return Some(Error::NonFinitePosition { particle, position: (*position).into() });
    }
    let is_far = cell.is_some_and(|cell| cell.is_too_far(position));
    is_far.then(|| Error::FarPosition { particle, position: (*position).into() })
}

/// Refuse particles that are nowhere.
///
/// # Errors
/// Names the first of them.
pub fn check_places(cell: Option<&Cell>, particles: &[u32], positions: &[Vec3]) -> Result<()> {
    let mut all = positions.iter().zip(particles);
    all.find_map(|(at, particle)| nowhere(cell, *particle, at)).map_or(Ok(()), Err)
}

/// Where all particles of a System are.
#[derive(Debug, Clone, Copy)]
pub struct Configuration<'a> {
    /// x y z of one after the other, nm.
    pub positions: &'a [f64],
    /// The periodic box, if there is one; edges connect nearest images in it.
    pub cell: Option<&'a Cell>,
}

impl<'a> Configuration<'a> {
    /// Positions in a periodic box or none.
    pub fn new(positions: &'a [f64], cell: Option<&'a Cell>) -> Self {
        Self { positions, cell }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TRICLINIC: [[f64; 3]; 3] = [[5.0, 0.0, 0.0], [1.5, 6.0, 0.0], [-2.0, 2.5, 7.0]];

    proptest! {
        #[test]
        fn short_separations_are_found(
            direction in prop::array::uniform3(-1.0..1.0f64), length in 0.01..0.99f64,
            image in prop::array::uniform3(-3..4i32),
        ) {
            let cell = Cell::new(TRICLINIC).unwrap();
            let short = Vec3::from(direction).normalize() * length * cell.half_width();
            let found = cell.nearest(&(short + cell.shift(image)));
            prop_assert_eq!(found, image.map(|k| -k));
        }

        #[test]
        fn wrapped_positions_are_inside(position in prop::array::uniform3(-30.0..30.0f64)) {
            let cell = Cell::new(TRICLINIC).unwrap();
            let position = Vec3::from(position);
            let inside = position + cell.shift(cell.wrap(&position));
            for axis in 0..3 {
                let share = inside[axis] / cell.vectors()[axis][axis];
                prop_assert!((-1e-12..1.0 + 1e-12).contains(&share), "{inside}");
            }
        }
    }

    #[test]
    fn what_is_a_billion_boxes_away_is_too_far() {
        let cell = Cell::new(TRICLINIC).unwrap();
        for axis in 0..3 {
            for away in [1e3, 0.999e9, 1.001e9, 1e20, 1e300] {
                for sign in [1.0, -1.0] {
                    let at = cell.vectors()[axis] * (sign * away) + Vec3::new(1.0, 2.0, 3.0);
                    assert_eq!(cell.is_too_far(&at), away > 1e9, "{at}");
                }
            }
        }
    }

    #[test]
    fn the_width_is_that_between_faces() {
        let cell = Cell::new([[4.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 10.0]]).unwrap();
        assert_eq!(cell.half_width(), 2.0);
    }

    #[test]
    fn what_is_no_box_is_refused() {
        for (row, column, value) in [(0, 0, 0.0), (1, 1, -6.0), (0, 1, 0.1), (2, 2, f64::NAN)] {
            let mut vectors = TRICLINIC;
            vectors[row][column] = value;
            assert!(Cell::new(vectors).is_err());
        }
    }
}
