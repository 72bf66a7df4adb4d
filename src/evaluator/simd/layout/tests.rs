//! That a layout has every element in one place, and rings that close.

use super::*;
use crate::mesh::Topology;
use crate::mesh::numbering::breadth_first;
use crate::mesh::triangulation::Turn;
use crate::test_meshes::icosahedron;

fn icosahedral() -> Layout {
    let mesh = Triangulation::new(&Topology::new(&icosahedron().1, 12).unwrap());
    Layout::new(&mesh, &breadth_first(&mesh))
}

#[test]
fn an_update_is_as_good_as_a_new_layout() {
    let mut mesh = Triangulation::new(&Topology::new(&icosahedron().1, 12).unwrap());
    let order = breadth_first(&mesh);
    let mut layout = Layout::new(&mesh, &order);
    for half in [0, 7, 33, 12] {
        mesh.flip(&mesh.quad(half), Turn::Left);
        layout.update(&mesh, &order);
        let anew = Layout::new(&mesh, &order);
        assert_eq!(layout.vertex_ids, anew.vertex_ids);
        assert_eq!(layout.triangle_ids, anew.triangle_ids);
        assert_eq!((&layout.neighbours, &layout.places), (&anew.neighbours, &anew.places));
        assert_eq!((&layout.steps, &layout.corners), (&anew.steps, &anew.corners));
        assert_eq!(layout.opposite(), anew.opposite());
        let particles = |triangle: [(u32, Vec3); 3]| triangle.map(|(particle, _)| particle);
        assert!(layout.triangles().into_iter().map(particles).eq(mesh.triangles().iter().copied()));
    }
}

#[test]
fn every_element_has_one_place() {
    let layout = icosahedral();
    let mut vertices = layout.vertex_ids[..12].to_vec();
    vertices.sort_unstable();
    assert_eq!(vertices, (0..12).collect::<Vec<_>>());
    let mut triangles = layout.triangle_ids[..20].to_vec();
    triangles.sort_unstable();
    assert_eq!(triangles, (0..20).collect::<Vec<_>>());
    assert_eq!(layout.corners.len(), 3);
    assert_eq!(layout.steps, [0, 6, 12]);
}

#[test]
fn rings_close_and_steps_know_their_triangles() {
    let layout = icosahedral();
    let opposite = layout.opposite();
    for index in 0..12 {
        let (block, lane) = (index / BLOCK, index % BLOCK);
        let steps = layout.steps[block] as usize..layout.steps[block + 1] as usize - 1;
        assert_eq!(layout.neighbours[steps.start][lane], layout.neighbours[steps.end][lane]);
        for step in steps {
            let triangle = layout.places[step][lane] as usize / 4;
            let place = layout.places[step][lane] as usize % 4;
            let corners =
                layout.corners[triangle / BLOCK].map(|lanes| lanes[triangle % BLOCK] as usize);
            assert_eq!(corners[place], 4 * index);
            assert_eq!(corners[(place + 1) % 3] as u32, layout.neighbours[step][lane]);
            assert_eq!(corners[(place + 2) % 3] as u32, layout.neighbours[step + 1][lane]);
            let facing = opposite[step][lane] as usize;
            let start = layout.neighbours[facing / BLOCK][facing % BLOCK];
            assert_eq!(corners[(place + 2) % 3] as u32, start);
        }
    }
}
