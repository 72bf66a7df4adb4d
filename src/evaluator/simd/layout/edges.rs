//! What a layout knows of edges, which it has no list of; made when a term first asks.

use super::Layout;
use crate::lanes::BLOCK;
use crate::mesh::NONE;

impl Layout {
    /// For each step and lane, where the edge opposite the vertex in the triangle is a step of its own: the
    /// index of step and lane. Built when first asked for.
    pub fn opposite(&self) -> &[[u32; BLOCK]] {
        self.opposite.get_or_init(|| {
            let nothing = 4 * self.triangle_ids.len() as u32;
            let mut index_of_place = vec![0u32; nothing as usize];
            for (step, lanes) in self.places.iter().enumerate() {
                for (lane, &place) in lanes.iter().enumerate() {
                    let block = self.steps.partition_point(|&start| start as usize <= step) - 1;
                    let filling = block * BLOCK + lane >= self.num_vertices;
                    if place != nothing && !filling {
                        index_of_place[place as usize] = (step * BLOCK + lane) as u32;
                    }
                }
            }
            // The side opposite place k runs from place k + 1 to place k + 2.
            let of = |&place: &u32| match place {
                place if place == nothing => 0,
                place => index_of_place[(place & !3) as usize + ((place & 3) as usize + 1) % 3],
            };
            self.places.iter().map(|lanes| std::array::from_fn(|lane| of(&lanes[lane]))).collect()
        })
    }

    /// For each step and lane, the place of the edge among all edges in lexicographic order of the particles at their
    /// ends; [`NONE`] where the step has no dihedral angle: at borders, and where a ring has ended. Built when first asked
    /// for.
    pub fn edge_names(&self) -> &[[u32; BLOCK]] {
        self.edge_names.get_or_init(|| {
            let particle = |offset: u32| {
                let place = offset as usize / 4;
                let ghost = place.checked_sub(self.vertex_ids.len());
                self.particles[ghost.map_or(place, |ghost| self.ghosts.vertex_and_shift(ghost).0)]
            };
            let ends = |a: u32, b: u32| {
                let (a, b) = (particle(a), particle(b));
                [a.min(b), a.max(b)]
            };
            let mut all: Vec<[u32; 2]> = self
                .corners
                .iter()
                .flat_map(|block| {
                    (0..BLOCK).flat_map(move |lane| {
                        (0..3).map(move |k| ends(block[k][lane], block[(k + 1) % 3][lane]))
                    })
                })
                .collect();
            all.sort_unstable();
            all.dedup();
            let nothing = 4 * self.triangle_ids.len() as u32;
            let mut names = vec![[NONE; BLOCK]; self.places.len()];
            for vertex in 0..self.num_vertices {
                let (block, lane) = (vertex / BLOCK, vertex % BLOCK);
                let mut before = self.before[block][lane];
                for step in self.steps[block] as usize..self.steps[block + 1] as usize {
                    let place = self.places[step][lane];
                    if place == nothing {
                        break;
                    }
                    let triangle = place & !3;
                    // At its first edge, the ring of a vertex on a border has its first triangle on both sides.
                    if triangle != before {
                        let edge = ends(4 * vertex as u32, self.neighbours[step][lane]);
                        let name = all.binary_search(&edge).expect("a side of a triangle");
                        names[step][lane] = name as u32;
                    }
                    before = triangle;
                }
            }
            names
        })
    }
}
