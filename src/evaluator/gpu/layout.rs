//! What a mesh is on a device, whoever brings it there: its connectivity, the sizes of its buffers, and its passes.

use super::Precision;
use super::frame::groups;
use super::interface::{Binding, FORCES_PER_TRIANGLE, NO_CORNER, SLOPES_PER_VERTEX};
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
pub fn items(binding: Binding, topology: &Topology, precision: Precision) -> Option<(usize, Needs)> {
    let (v, e) = (topology.num_vertices(), topology.edges.len());
    let t = topology.triangles.len();
    let always = Needs::empty();
    Some(match binding {
        Binding::Positions => (3 * v, always),
        Binding::CornerVertices | Binding::CornerEdges => (3 * t, always),
        Binding::EdgeCorners => (e, always),
        Binding::Rings => (v + 1 + 3 * t, always),
        Binding::TriangleGeometry => (t, always),
        Binding::CornerForces => (FORCES_PER_TRIANGLE as usize * t, always),
        // Two sums of area and volume for each group, and the derivatives with respect to them.
        Binding::Totals => match precision {
            Precision::Single => (2 * groups(t) + 1, always),
            Precision::Double => (groups(t) + 1, always),
        },
        Binding::EdgeGeometry => (e, Needs::EDGES.union(Needs::CURVATURES)),
        Binding::VertexSlopes => (v, Needs::VERTICES),
        Binding::VectorSlopes => (SLOPES_PER_VERTEX as usize * v, Needs::VECTORS),
        Binding::ThinTriangles => (1, always),
        Binding::Frame | Binding::Fields | Binding::Results => return None,
    })
}

/// A pass over the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    TrianglesForward,
    TrianglesForwardSummed,
    TotalsForward,
    EdgesForward,
    VerticesForward,
    TrianglesBackward,
    VerticesBackward,
}

impl Pass {
    /// In their order.
    pub const ALL: [Self; 7] = [
        Self::TrianglesForward,
        Self::TrianglesForwardSummed,
        Self::TotalsForward,
        Self::EdgesForward,
        Self::VerticesForward,
        Self::TrianglesBackward,
        Self::VerticesBackward,
    ];

    /// Its name in the shaders.
    pub const fn name(self) -> &'static CStr {
        match self {
            Self::TrianglesForward => c"triangles_forward",
            Self::TrianglesForwardSummed => c"triangles_forward_summed",
            Self::TotalsForward => c"totals_forward",
            Self::EdgesForward => c"edges_forward",
            Self::VerticesForward => c"vertices_forward",
            Self::TrianglesBackward => c"triangles_backward",
            Self::VerticesBackward => c"vertices_backward",
        }
    }
}

/// The passes of an evaluation in their order, with the number of elements of each.
pub fn passes(needs: Needs, forces: bool, topology: &Topology) -> SmallVec<[(Pass, usize); 6]> {
    let (vertices, triangles) = (topology.num_vertices(), topology.triangles.len());
    let totals = needs.contains(Needs::TOTALS);
    let all = [
        (!totals, Pass::TrianglesForward, triangles),
        (totals, Pass::TrianglesForwardSummed, triangles),
        (totals, Pass::TotalsForward, 1),
        (
            needs.intersects(Needs::EDGES | Needs::CURVATURES),
            Pass::EdgesForward,
            topology.edges.len(),
        ),
        (needs.contains(Needs::VERTICES), Pass::VerticesForward, vertices),
        (forces || needs.contains(Needs::TRIANGLES), Pass::TrianglesBackward, triangles),
        (forces, Pass::VerticesBackward, vertices),
    ];
    all.into_iter().filter(|(wanted, ..)| *wanted).map(|(_, pass, count)| (pass, count)).collect()
}
