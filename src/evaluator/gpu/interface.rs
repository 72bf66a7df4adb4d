//! What the processor and a device must agree on: bits, sizes, bindings, and the records that one writes and the
//! other reads.
//!
//! All of it is stated here and nowhere else. build.rs includes this file, writes it as WGSL before the shaders, and
//! compares with naga's layout of the result (`shaders/constants.rs`).

use crate::potentials::{MAX_PARAMETERS, Needs};
use bitflags::{Flags, bitflags};

bitflags! {
    /// What is wanted of a term or an evaluation, as bits beside those of [`Needs`].
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub struct Wishes: u32 {
        /// Separations are those of nearest images in [`Binding::BoxVectors`].
        const PERIODIC = 1 << 28;
        /// Energy of the vertices that are on no border only.
        const INNER = 1 << 29;
        /// The derivatives with respect to the scalars.
        const DERIVATIVES = 1 << 30;
        /// Forces.
        const FORCES = 1 << 31;
    }
}

const _: () = assert!(
    Needs::all().bits() & Wishes::all().bits() == 0
        && Wishes::all().bits().count_ones() as usize == <Wishes as Flags>::FLAGS.len(),
    "no bit has two meanings"
);

/// Constants with a list of them.
macro_rules! numbers {
    ($($(#[$doc:meta])* $name:ident = $value:expr;)*) => {
        $($(#[$doc])* pub const $name: u32 = $value;)*
        /// All of them.
        pub const NUMBERS: &[(&str, u32)] = &[$((stringify!($name), $name)),*];
    };
}

numbers! {
    /// Threads of a workgroup.
    GROUP_SIZE = 64;
    /// The most workgroups of a row.
    GROUPS_ACROSS = 32_768;
    /// In place of the second corner of an edge at a border.
    NO_CORNER = u32::MAX;
    /// Where a scalar has no values of single elements.
    NO_FIELD = u32::MAX;
    /// Scalars of a term, used or not.
    PARAMETERS = MAX_PARAMETERS as u32;
    /// Constants that a triangle has in [`Binding::Constants`] for a term.
    CONSTANTS = crate::potentials::CONSTANTS as u32;
    /// Numbers that a vertex has in [`Binding::VectorPartials`].
    PARTIALS_PER_VERTEX = 9;
    /// Numbers that a triangle has in [`Binding::CornerForces`].
    FORCES_PER_TRIANGLE = 9;
    /// Half of the steps of the lattice across the widest part are 2 to this power: the sides of triangles stay below 2³⁰
    /// steps, so that the products of two fit 62 bits and their differences 63.
    HALF_WIDTH_BITS = 29;
    /// The most groups that share a block of threads on OpenMM's platforms.
    GROUPS_OF_BLOCK = 4;
    /// Words of the state that OpenMM's platforms keep: two extents, which take turns, and then the faults.
    STATE_SIZE = 3;
    STATE_FAULTS = 2;
    /// A position is not finite, or no size of a mesh.
    FAULT_POSITION = 1;
    /// A target of a total is too large for the lattice.
    FAULT_TARGET = 2;
    /// A triangle is thin, and perhaps without area.
    FAULT_THIN = 4;
    /// An energy or a derivative is no finite number.
    FAULT_ENERGY = 8;
    /// Places in the `sums` of a [`TermRecord`].
    SUMS_OF_TOTALS = 0;
    SUMS_OF_TRIANGLES = 1;
    SUMS_OF_EDGES = 2;
    SUMS_OF_VERTICES = 3;
}

/// The kinds of elements in the order in which a term's sums are listed.
pub const KINDS: [Needs; 4] = {
    let mut kinds = [Needs::empty(); 4];
    kinds[SUMS_OF_TOTALS as usize] = Needs::TOTALS;
    kinds[SUMS_OF_TRIANGLES as usize] = Needs::TRIANGLES;
    kinds[SUMS_OF_EDGES as usize] = Needs::EDGES;
    kinds[SUMS_OF_VERTICES as usize] = Needs::VERTICES;
    kinds
};

/// Takes a record to pieces, in the device's order.
pub trait Sink {
    /// 32 bits as they are.
    fn word(&mut self, word: u32);
    /// A number, which is rounded to the device's precision.
    fn real(&mut self, value: f64);
}

/// The type of a field, here and in WGSL.
pub trait Field {
    /// Its name there.
    const WGSL: &'static str;
    /// Its words and its real numbers.
    const SIZE: (usize, usize);
    /// Hand it over.
    fn put(&self, sink: &mut impl Sink);
}

macro_rules! field {
    ($type:ty, $wgsl:literal, $size:expr, |$value:ident, $sink:ident| $put:expr) => {
        impl Field for $type {
            const WGSL: &'static str = $wgsl;
            const SIZE: (usize, usize) = $size;
            fn put(&self, $sink: &mut impl Sink) {
                let $value = self;
                $put
            }
        }
    };
}

field!(u32, "u32", (1, 0), |value, sink| sink.word(*value));
field!(f32, "f32", (1, 0), |value, sink| sink.word(value.to_bits()));
field!([u32; 2], "vec2<u32>", (2, 0), |words, sink| words.iter().for_each(|x| sink.word(*x)));
field!([u32; 4], "vec4<u32>", (4, 0), |words, sink| words.iter().for_each(|x| sink.word(*x)));
field!([f64; 4], "vec4r", (0, 4), |reals, sink| reals.iter().for_each(|x| sink.real(*x)));

/// A field's name, its type in WGSL, and its words and real numbers.
pub type FieldInfo = (&'static str, &'static str, (usize, usize));

/// A structure that a device reads, without gaps.
macro_rules! record {
    ($(#[$doc:meta])* $name:ident { $($(#[$note:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        pub struct $name {
            $($(#[$note])* pub $field: $type,)*
        }

        impl $name {
            /// What it is made of.
            pub const FIELDS: &[FieldInfo] = &[$((
                stringify!($field),
                <$type as Field>::WGSL,
                <$type as Field>::SIZE,
            )),*];

            /// Hand it over.
            pub fn put(&self, sink: &mut impl Sink) {
                $(self.$field.put(sink);)*
            }
        }
    };
}

record! {
    /// What a frame begins with; the records of its terms follow.
    FrameRecord {
        num_vertices: u32,
        num_edges: u32,
        num_triangles: u32,
        /// Bits of [`Needs`] of any term, and of [`Wishes`].
        needs: u32,
        num_terms: u32,
        /// The spacing of the lattice on which positions are whole numbers (single precision).
        quantum: f32,
        /// The square of a length that no side of a triangle may have.
        longest_squared: f32,
        /// Terms begin at a multiple of the size of four doubles.
        padding: u32,
    }
}

// Lengths are in units of a power of two near the mean edge, so that no square of a square leaves the range of single
// precision for any size of mesh; parameters and results are scaled here.
record! {
    /// A term.
    TermRecord {
        /// Which potential, as build.rs numbers the files of `shaders/potentials/`.
        potential: u32,
        form: u32,
        switches: u32,
        /// Bits of [`Needs`] and [`Wishes`].
        needs: u32,
        /// Where in the results the sums of each of [`KINDS`] go.
        sums: [u32; 4],
        /// Where in the fields the values of single elements begin, [`NO_FIELD`] where there are none.
        field_starts: [u32; MAX_PARAMETERS],
        /// From where a total is measured, as a whole number of the units of its sum, two's complement.
        reference: [u32; 4],
        /// Where in the constants of triangles its own begin.
        constants_start: u32,
        /// Values begin at a multiple of the size of four doubles.
        padding: u32,
        more_padding: [u32; 2],
        most_padding: [u32; 4],
        values: [f64; MAX_PARAMETERS],
        /// What one unit of a field is.
        field_units: [f64; MAX_PARAMETERS],
    }
}

/// What a buffer holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Item {
    /// A [`FrameRecord`] with its [`TermRecord`]s.
    Frame,
    Word,
    WordPair,
    Real,
    RealQuad,
    /// In single precision the sum of two numbers, else one.
    Constant,
    /// A whole number in single precision, else a real one.
    Coordinate,
    /// A sum in 128 bits: a whole number in single precision, else two real ones.
    Total,
    /// A number that threads count up together.
    Counter,
}

impl Item {
    /// The type of the buffer in WGSL. The files of each precision have the aliases.
    pub const fn wgsl(self) -> &'static str {
        match self {
            Self::Frame => "Frame",
            Self::Word => "array<u32>",
            Self::WordPair => "array<vec2<u32>>",
            Self::Real => "array<real>",
            Self::RealQuad => "array<vec4r>",
            Self::Constant => "array<constant>",
            Self::Coordinate => "array<coordinate>",
            Self::Total => "array<total>",
            Self::Counter => "atomic<u32>",
        }
    }

    /// Bytes of one, where a real number has `real` bytes; a frame's depend on its terms.
    pub const fn size(self, real: usize) -> usize {
        match self {
            Self::Frame => 0,
            Self::Word | Self::Counter => 4,
            Self::WordPair | Self::Constant => 8,
            Self::Real | Self::Coordinate => real,
            Self::RealQuad => 4 * real,
            Self::Total => 16,
        }
    }
}

/// The buffers: one bind group, the same for all passes. The number of a binding is its place in this list.
macro_rules! bindings {
    ($($(#[$doc:meta])* $name:ident: $access:literal $item:ident;)*) => {
        /// The binding of each buffer.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Binding {
            $($(#[$doc])* $name,)*
        }

        impl Binding {
            /// How many there are.
            pub const COUNT: usize = [$(Self::$name),*].len();
            /// In the order of their numbers.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$name),*];
            /// Their names, how shaders access them, and what is in them.
            pub const INFO: [(&str, &str, Item); Self::COUNT] =
                [$((stringify!($name), $access, Item::$item)),*];
        }
    };
}

bindings! {
    Frame: "read" Frame;
    /// Three a vertex.
    Positions: "read" Coordinate;
    /// Of the periodic box a, b and c, in the units of positions.
    BoxVectors: "read" Coordinate;
    /// Corner 3 t + k is the k-th corner of triangle t; here is the vertex there.
    CornerVertices: "read" Word;
    /// The edge from each corner to the next.
    CornerEdges: "read" Word;
    /// The corners from which an edge leaves in its left and its right triangle.
    EdgeCorners: "read" WordPair;
    /// Where the corners of each vertex begin, then the corners themselves.
    Rings: "read" Word;
    /// Values of single elements.
    Fields: "read" Real;
    /// Constants of triangles, term by term.
    Constants: "read" Constant;
    /// Normal and twice the area.
    TriangleGeometry: "read_write" RealQuad;
    /// l², φ / l, and the bending moment per length of potentials of the angle.
    EdgeGeometry: "read_write" RealQuad;
    /// ∂E/∂ barycentric area, Voronoi area and curvature of each vertex.
    VertexPartials: "read_write" RealQuad;
    /// ∂E/∂ cotangent vector, umbrella vector and normal sum.
    VectorPartials: "read_write" Real;
    CornerForces: "read_write" Real;
    /// `shaders/totals_*.wgsl` say what.
    Totals: "read_write" Total;
    /// Forces, three numbers a vertex, then the sums of the terms, group by group.
    Results: "read_write" Real;
    /// The number of triangles that are too thin for this precision.
    ThinTriangles: "read_write" Counter;
}

impl Binding {
    /// What is in it.
    pub const fn item(self) -> Item {
        Self::INFO[self as usize].2
    }

    /// Whether shaders only read it.
    pub fn is_read_only(self) -> bool {
        Self::INFO[self as usize].1 == "read"
    }
}
