//! What a mesh is on a device, whoever brings it there: its connectivity, the sizes of its buffers, and its passes.

use super::Precision;
use super::frame::groups;
use super::interface::{Binding, FORCES_PER_TRIANGLE, NO_CORNER, PARTIALS_PER_VERTEX};
use crate::mesh::{NONE, Topology};
use crate::potentials::Needs;
use smallvec::SmallVec;
use std::ffi::CStr;

/// Triangles, edges and rings as the shaders read them.
pub fn connectivity(topology: &Topology) -> [(Binding, Vec<u32>); 4] {
    let corners = topology.edges.iter().enumerate().flat_map(|(index, edge)| {
        edge.triangles.map(|triangle| {
            if triangle == NONE {
                return NO_CORNER;
            }
            let sides = &topology.triangle_edges[triangle as usize];
            let side = sides.iter().position(|side| *side as usize == index);
            3 * triangle + side.unwrap_or(0) as u32
        })
    });
    let rings = topology.offsets.iter().chain(&topology.corners).copied();
    [
        (Binding::CornerVertices, topology.triangles.as_flattened().to_vec()),
        (Binding::CornerEdges, topology.triangle_edges.as_flattened().to_vec()),
        (Binding::EdgeCorners, corners.collect()),
        (Binding::Rings, rings.collect()),
    ]
}

/// How many items a buffer has that depends on the mesh only, and what asks for it; `None` for all others.
pub fn items(
    binding: Binding,
    topology: &Topology,
    precision: Precision,
) -> Option<(usize, Needs)> {
    let (v, e) = (topology.num_vertices(), topology.edges.len());
    let t = topology.triangles.len();
    let always = Needs::empty();
    Some(match binding {
        Binding::Positions => (3 * v, always),
        Binding::BoxVectors => (9, always),
        Binding::CornerVertices | Binding::CornerEdges => (3 * t, always),
        Binding::EdgeCorners => (e, always),
        Binding::Rings => (v + 1 + 3 * t, always),
        Binding::TriangleGeometry => (t, always),
        Binding::CornerForces => (FORCES_PER_TRIANGLE as usize * t, always),
        // Sums for each group of triangles and of edges, and what comes of them.
        Binding::Totals => match precision {
            Precision::Single => (2 * groups(t) + 2 + groups(e), always),
            Precision::Double => (groups(t) + 3 + groups(e), always),
        },
        Binding::EdgeGeometry => (e, Needs::EDGES.union(Needs::CURVATURES)),
        Binding::VertexPartials => (v, Needs::VERTICES),
        Binding::VectorPartials => (PARTIALS_PER_VERTEX as usize * v, Needs::VECTORS),
        Binding::ThinTriangles => (1, always),
        Binding::Frame | Binding::Fields | Binding::Constants | Binding::Results => return None,
    })
}

macro_rules! passes {
    ($($name:ident $text:literal,)*) => {
        /// A pass over the mesh. Those that are "summed" leave energies too.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Pass {
            $($name,)*
        }

        impl Pass {
            /// All of them.
            pub const ALL: [Self; [$(Self::$name),*].len()] = [$(Self::$name),*];

            /// Its name in the shaders.
            pub const fn name(self) -> &'static CStr {
                match self {
                    $(Self::$name => $text,)*
                }
            }
        }
    };
}

passes! {
    TrianglesForward c"triangles_forward",
    TrianglesForwardSummed c"triangles_forward_summed",
    EdgesForward c"edges_forward",
    EdgesForwardSummed c"edges_forward_summed",
    MeanCurvatureOfEdges c"mean_curvature_of_edges",
    MeanCurvatureForward c"mean_curvature_forward",
    TotalsForward c"totals_forward",
    VerticesForward c"vertices_forward",
    VerticesForwardSummed c"vertices_forward_summed",
    TrianglesBackward c"triangles_backward",
    TrianglesBackwardSummed c"triangles_backward_summed",
    VerticesBackward c"vertices_backward",
}

/// The passes of an evaluation in their order, with the number of elements of each: of energies, of forces, or of both.
pub fn passes(
    needs: Needs,
    energies: bool,
    forces: bool,
    topology: &Topology,
) -> SmallVec<[(Pass, usize); 8]> {
    let (vertices, triangles) = (topology.num_vertices(), topology.triangles.len());
    let mut passes = SmallVec::new();
    let mut add = |wanted, silent, summed, elements| {
        if wanted {
            passes.push((if energies { summed } else { silent }, elements));
        }
    };
    let totals = needs.contains(Needs::TOTALS);
    let first = if totals { Pass::TrianglesForwardSummed } else { Pass::TrianglesForward };
    add(true, first, first, triangles);
    let edges = needs.intersects(Needs::EDGES | Needs::CURVATURES);
    add(edges, Pass::EdgesForward, Pass::EdgesForwardSummed, topology.edges.len());
    if needs.contains(Needs::MEAN_CURVATURE) {
        let [first, second] = [Pass::MeanCurvatureOfEdges, Pass::MeanCurvatureForward];
        add(true, first, first, topology.edges.len());
        add(true, second, second, 1);
    }
    add(totals, Pass::TotalsForward, Pass::TotalsForward, 1);
    let of_vertices = needs.contains(Needs::VERTICES);
    add(of_vertices, Pass::VerticesForward, Pass::VerticesForwardSummed, vertices);
    let backward = forces || energies && needs.contains(Needs::TRIANGLES);
    add(backward, Pass::TrianglesBackward, Pass::TrianglesBackwardSummed, triangles);
    add(forces, Pass::VerticesBackward, Pass::VerticesBackward, vertices);
    passes
}
