//! An order of the vertices in which neighbours on the surface are near each other.

use super::Triangulation;

/// All vertices, breadth first, component by component, each from a vertex that is far from another.
pub fn breadth_first(mesh: &Triangulation) -> Vec<u32> {
    let count = mesh.num_vertices();
    let mut order: Vec<u32> = Vec::with_capacity(count);
    // 0: unseen; 1: seen by the walk that looks for the rim; 2: numbered.
    let mut seen = vec![0u8; count];
    let mut neighbours = Vec::new();
    let mut walk = |start: u32, mark: u8, seen: &mut [u8], order: &mut Vec<u32>| {
        let mut head = order.len();
        order.push(start);
        seen[start as usize] = mark;
        while head < order.len() {
            mesh.neighbours(order[head], &mut neighbours);
            head += 1;
            for &other in &neighbours {
                if seen[other as usize] < mark {
                    seen[other as usize] = mark;
                    order.push(other);
                }
            }
        }
    };
    for vertex in 0..count {
        if seen[vertex] == 0 {
            let start = order.len();
            walk(vertex as u32, 1, &mut seen, &mut order);
            let rim = order[order.len() - 1];
            order.truncate(start);
            walk(rim, 2, &mut seen, &mut order);
        }
    }
    order
}
