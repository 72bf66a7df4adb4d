//! Triangles as a user gives them: their indices checked, and the two half-edges of each edge found.

use crate::error::{Error, Result};

/// The most triangles: four numbers each, and some to spare, are counted with 32 bits.
const MOST_TRIANGLES: usize = (1 << 30) - 64;

/// One triangle's passage along one of its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct HalfEdge {
    /// The two ends, the smaller first, so that sorting brings partners together.
    pub ends: [u32; 2],
    /// Triangle and side, as a corner index.
    pub corner: u32,
    /// Whether the passage runs from the smaller end to the larger.
    pub ascending: bool,
}

/// Check indices, repeated corners and duplicates, and narrow the indices to 32 bits.
pub(super) fn checked_indices(triangles: &[[i64; 3]], count: usize) -> Result<Vec<[u32; 3]>> {
    if triangles.is_empty() {
        return Err(Error::EmptyMesh);
    }
    if triangles.len() > MOST_TRIANGLES {
        return Err(Error::Contract(format!(
            "a mesh can have {MOST_TRIANGLES} triangles at most, got {}",
            triangles.len()
        )));
    }
    let mut checked = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for &index in corners {
            if index < 0 || index as u64 >= count as u64 || index > u32::MAX as i64 {
                return Err(Error::IndexOutOfRange { triangle, index, count });
            }
        }
        let corners = corners.map(|index| index as u32);
        for k in 0..3 {
            if corners[k] == corners[(k + 1) % 3] {
                return Err(Error::RepeatedCorner { triangle, corners, vertex: corners[k] });
            }
        }
        checked.push(corners);
    }
    let mut keys: Vec<([u32; 3], usize)> = checked
        .iter()
        .enumerate()
        .map(|(triangle, corners)| {
            let mut key = *corners;
            key.sort_unstable();
            (key, triangle)
        })
        .collect();
    keys.sort_unstable();
    for pair in keys.windows(2) {
        if pair[0].0 == pair[1].0 {
            let (first, second) = (pair[0].1, pair[1].1);
            return Err(Error::DuplicateTriangle { first, second, corners: checked[first] });
        }
    }
    Ok(checked)
}

/// Match the two half-edges of every edge; the one of the lower triangle comes first. At a border there is no second.
///
/// Edges come in the order in which the triangles first mention them, which keeps the edges of
/// neighbouring triangles together in memory.
pub(super) fn paired_half_edges(
    triangles: &[[u32; 3]],
) -> Result<Vec<(HalfEdge, Option<HalfEdge>)>> {
    let mut halves = Vec::with_capacity(3 * triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for side in 0..3 {
            let (start, end) = (corners[side], corners[(side + 1) % 3]);
            halves.push(HalfEdge {
                ends: [start.min(end), start.max(end)],
                corner: (3 * triangle + side) as u32,
                ascending: start < end,
            });
        }
    }
    halves.sort_unstable();
    let mut pairs = Vec::with_capacity(halves.len() / 2);
    for group in halves.chunk_by(|a, b| a.ends == b.ends) {
        let triangle = |k: usize| group[k].corner as usize / 3;
        match group {
            [only] => pairs.push((*only, None)),
            [first, second] => pairs.push((*first, Some(*second))),
            _ => {
                return Err(Error::NonManifoldEdge {
                    edge: group[0].ends,
                    count: group.len(),
                    triangles: [triangle(0), triangle(1), triangle(2)],
                });
            }
        }
    }
    pairs.sort_unstable_by_key(|pair| pair.0.corner);
    Ok(pairs)
}

/// The triangle on the other side of an edge, and whether the two agree in orientation.
type Across = Option<(u32, bool)>;

/// The triangles on the other side of each triangle's edges 01, 12 and 20. The surface need not be oriented, but must be manifold at its edges.
pub(super) fn neighbours(triangles: &[[u32; 3]]) -> Result<Vec<[Across; 3]>> {
    let mut neighbours = vec![[None; 3]; triangles.len()];
    for (here, there) in paired_half_edges(triangles)? {
        let Some(there) = there else { continue };
        let agree = here.ascending != there.ascending;
        for (here, there) in [(here, there), (there, here)] {
            let corner = here.corner as usize;
            neighbours[corner / 3][corner % 3] = Some((there.corner / 3, agree));
        }
    }
    Ok(neighbours)
}
