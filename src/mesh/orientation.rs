//! The orientation of a surface, every triangle counter-clockwise seen from outside: mending it, and telling where it
//! is the opposite.

use super::Triangulation;
use super::cell::Cell;
use super::geometry::{Totals, Vec3};
use super::pairing::{checked_indices, neighbours};
use super::topology::Topology;
use crate::error::{Error, Result};
use nalgebra::Vector3;
use std::collections::HashMap;

/// Coordinates, nm, whose cubes may overflow.
const FARTHEST: f64 = 1e100;

/// How much of a triangle's height rounding may have made, as a share of the coordinates.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Validate a mesh and turn its triangles so that each closed component has positive volume. A component with borders, or
/// whose volume is lost in rounding, keeps the orientation of its first triangle.
///
/// Neighbours are made to agree by walking over the surface, so the shape need not be star-shaped;
/// what remains, one sign for each closed component, is decided by the sign of the component's volume.
/// The order of the triangles and the first corner of each stay as they are. In a periodic box, corners are nearest
/// images of each other, and a component that spans the box keeps the orientation of its first triangle.
///
/// # Errors
/// All of [`Topology::new`], and: coordinates that are not finite or of 1e100 nm or more, vertices without triangles or in
/// the same place, triangles without area, surfaces that are not orientable, edges that are not shorter than half the
/// width of the box.
pub fn oriented(
    vertices: &[[f64; 3]],
    triangles: &[[i64; 3]],
    cell: Option<&Cell>,
) -> Result<Vec<[i64; 3]>> {
    for (vertex, position) in vertices.iter().enumerate() {
        if !position.iter().all(|x| x.is_finite()) {
            return Err(Error::NonFiniteVertex { vertex, position: *position });
        }
        if position.iter().any(|x| x.abs() >= FARTHEST) {
            return Err(Error::FarVertex { vertex, position: *position });
        }
    }
    let corners = checked_indices(triangles, vertices.len())?;
    check_vertices(vertices, &corners)?;
    let neighbours = neighbours(&corners)?;

    let mut flipped: Vec<Option<bool>> = vec![None; corners.len()];
    let mut result = triangles.to_vec();
    for seed in 0..corners.len() {
        if flipped[seed].is_some() {
            continue;
        }
        let (component, closed) = walk(seed, &neighbours, &mut flipped).map_err(|triangles| {
            let shared: Vec<u32> = corners[triangles[0]]
                .into_iter()
                .filter(|v| corners[triangles[1]].contains(v))
                .collect();
            Error::NonOrientable { edge: [shared[0], shared[1]], triangles }
        })?;
        let (places, spans) = in_one_piece(&component, &corners, vertices, cell)?;
        let (mut six_volumes, mut products) = (0.0, 0.0);
        for (&triangle, [a, b, c]) in component.iter().zip(places) {
            let sides = [b - a, c - a];
            let normal = sides[0].cross(&sides[1]);
            if !normal.norm_squared().is_finite() {
                return Err(Error::OverflownTriangle { triangle, corners: corners[triangle] });
            }
            // A height that is lost in the rounding of coordinates is none.
            let given = corners[triangle].map(|vertex| Vec3::from(vertices[vertex as usize]));
            let (far, longest) = (largest(given), largest([sides[0], sides[1], c - b]));
            if normal.norm() <= ROUNDING * far * longest {
                return Err(Error::DegenerateTriangle { triangle, corners: corners[triangle] });
            }
            let sign = if flipped[triangle] == Some(true) { -1.0 } else { 1.0 };
            six_volumes += sign * a.dot(&normal);
            products += a.norm() * sides[0].norm() * sides[1].norm();
        }
        // More than a sum of so many products may be off.
        let rounding = (component.len() + 8) as f64 * f64::EPSILON * products;
        let inward = closed && !spans && six_volumes < -rounding;
        for &triangle in &component {
            if (flipped[triangle] == Some(true)) != inward {
                result[triangle].swap(1, 2);
            }
        }
    }
    Topology::new(&result, vertices.len())?;
    Ok(result)
}

/// A surface encloses nothing, flat or crumpled, if its volume is below this share of a sphere's of the same area. That
/// is less than what 10⁵ equal spheres have together, or a tube 10⁵ times as long as wide.
const NOTHING: f64 = 1e-3;

/// Whether a surface is turned inside out at the positions of all particles, and its area and volume: the volume is
/// below zero, and not only as that of a flat sheet may be. `None` if positions are not finite.
pub fn is_inside_out(mesh: &Triangulation, positions: &[f64]) -> Option<(bool, Totals)> {
    let position =
        |particle: u32| Vector3::from_column_slice(&positions[3 * particle as usize..][..3]);
    let origin = position(mesh.particles()[0]);
    let (mut twice_area, mut six_volumes) = (0.0, 0.0);
    for triangle in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.particles_of(triangle).map(|p| position(p) - origin);
        let normal = (b - a).cross(&(c - a));
        twice_area += normal.norm();
        six_volumes += a.dot(&normal);
    }
    let totals = Totals { area: 0.5 * twice_area, volume: six_volumes / 6.0, ..Totals::default() };
    // π d³ / 6 of a sphere of area π d².
    let sphere = totals.area.powf(1.5) / (36.0 * std::f64::consts::PI).sqrt();
    sphere.is_finite().then_some((totals.volume < -NOTHING * sphere, totals))
}

fn largest(vectors: [Vec3; 3]) -> f64 {
    vectors.iter().fold(0.0, |most: f64, vector| most.max(vector.norm()))
}

/// Visit the component of `seed` and note which of its triangles must be flipped to agree with it. Returns the
/// component, and whether it is closed. Fails with the two triangles that cannot agree.
fn walk(
    seed: usize,
    neighbours: &[[Option<(u32, bool)>; 3]],
    flipped: &mut [Option<bool>],
) -> std::result::Result<(Vec<usize>, bool), [usize; 2]> {
    flipped[seed] = Some(false);
    let (mut component, mut closed) = (vec![seed], true);
    let mut next = 0;
    while let Some(&triangle) = component.get(next) {
        next += 1;
        let here = flipped[triangle] == Some(true);
        for across in neighbours[triangle] {
            let Some((neighbour, agree)) = across else {
                closed = false;
                continue;
            };
            let neighbour = neighbour as usize;
            let wanted = here == agree;
            match flipped[neighbour] {
                None => {
                    flipped[neighbour] = Some(wanted);
                    component.push(neighbour);
                }
                Some(found) if found != wanted => return Err([triangle, neighbour]),
                Some(_) => {}
            }
        }
    }
    Ok((component, closed))
}

/// The corners of the triangles of a component relative to its first one, nm, and whether it spans the box.
///
/// Each triangle but the first shares a corner with one before it.
fn in_one_piece(
    component: &[usize],
    corners: &[[u32; 3]],
    vertices: &[[f64; 3]],
    cell: Option<&Cell>,
) -> Result<(Vec<[Vec3; 3]>, bool)> {
    let at = |vertex: u32| Vec3::from(vertices[vertex as usize]);
    let first = corners[component[0]][0];
    let Some(cell) = cell else {
        let relative = |triangle: &usize| corners[*triangle].map(|v| at(v) - at(first));
        return Ok((component.iter().map(relative).collect(), false));
    };
    let mut known = HashMap::from([(first, Vec3::zeros())]);
    let (mut places, mut spans) = (Vec::with_capacity(component.len()), false);
    for &triangle in component {
        let trio = corners[triangle];
        let from = (0..3).find(|&k| known.contains_key(&trio[k])).unwrap_or(0);
        let begin = known[&trio[from]];
        let place = trio.map(|v| {
            let separation = at(v) - at(trio[from]);
            begin + separation + cell.shift(cell.nearest(&separation))
        });
        for k in 0..3 {
            let (edge, length) =
                ([trio[k], trio[(k + 1) % 3]], (place[(k + 1) % 3] - place[k]).norm());
            if length >= cell.half_width() {
                if let Some(particle) = edge.into_iter().find(|v| cell.is_too_far(&at(*v))) {
                    return Err(Error::FarPosition { particle, position: at(particle).into() });
                }
                let (limit, vectors) = (cell.half_width(), cell.vectors().map(<[f64; 3]>::from));
                return Err(Error::LongEdge { edge, length, limit, vectors: Box::new(vectors) });
            }
            let before = *known.entry(trio[k]).or_insert(place[k]);
            spans |= (before - place[k]).norm() > cell.half_width();
        }
        places.push(place);
    }
    Ok((places, spans))
}

/// Every vertex must be used, and be the only one in its place.
fn check_vertices(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<()> {
    let mut used = vec![false; vertices.len()];
    for &vertex in triangles.iter().flatten() {
        used[vertex as usize] = true;
    }
    if let Some(vertex) = used.iter().position(|used| !used) {
        return Err(Error::UnusedVertex { vertex });
    }
    let mut seen = HashMap::with_capacity(vertices.len());
    for (vertex, position) in vertices.iter().enumerate() {
        // Adding zero turns −0 into 0, so that equal coordinates have equal bits.
        let key = position.map(|x| (x + 0.0).to_bits());
        if let Some(first) = seen.insert(key, vertex) {
            return Err(Error::RepeatedVertex { first, second: vertex, position: *position });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_meshes::{icosahedron, octahedron};

    #[test]
    fn any_mixture_of_orientations_is_mended() {
        let (vertices, good) = icosahedron();
        for pattern in [0b1u32, 0b10110111001, 0xfffff, 0x55555] {
            let mut mixed = good.clone();
            for (triangle, corners) in mixed.iter_mut().enumerate() {
                if pattern >> triangle & 1 == 1 {
                    corners.swap(1, 2);
                }
            }
            assert_eq!(oriented(&vertices, &mixed, None).unwrap(), good);
        }
    }

    #[test]
    fn components_are_oriented_one_by_one() {
        let (mut vertices, mut triangles) = octahedron();
        let good: Vec<_> =
            triangles.iter().copied().chain(triangles.iter().map(|t| t.map(|v| v + 6))).collect();
        triangles.extend(triangles.clone().iter().map(|t| [t[0] + 6, t[2] + 6, t[1] + 6]));
        vertices.extend(vertices.clone().iter().map(|v| [v[0] + 5.0, v[1] * 2.0, v[2]]));
        assert_eq!(oriented(&vertices, &triangles, None).unwrap(), good);
    }

    #[test]
    fn an_open_component_keeps_the_orientation_of_its_first_triangle() {
        let (vertices, mut good) = icosahedron();
        good.truncate(19);
        let turned: Vec<_> = good.iter().map(|t| [t[0], t[2], t[1]]).collect();
        for wanted in [good, turned] {
            let mut mixed = wanted.clone();
            for triangle in [3, 4, 11, 18] {
                mixed[triangle].swap(1, 2);
            }
            assert_eq!(oriented(&vertices, &mixed, None).unwrap(), wanted);
        }
    }

    #[test]
    fn a_component_whose_volume_is_lost_keeps_the_orientation_of_its_first_triangle() {
        let (mut vertices, good) = icosahedron();
        let at = |vertex: i64| Vec3::from(vertices[vertex as usize]);
        let fan = good.iter().filter(|triangle| triangle.contains(&11));
        let area = fan
            .fold(Vec3::zeros(), |sum, &[a, b, c]| sum + (at(b) - at(a)).cross(&(at(c) - at(a))));
        let away = area.cross(&Vec3::new(0.3, -0.5, 0.8)) * 1e12;
        vertices[11] = away.into();
        let turned: Vec<_> = good.iter().map(|t| [t[0], t[2], t[1]]).collect();
        for wanted in [good, turned] {
            assert_eq!(oriented(&vertices, &wanted, None).unwrap(), wanted);
        }
    }

    #[test]
    fn vertices_may_be_wrapped_into_a_box_each_by_itself() {
        let (mut vertices, good) = icosahedron();
        let cell = Cell::new([[9.0, 0.0, 0.0], [2.0, 8.0, 0.0], [-3.0, 1.0, 7.0]]).unwrap();
        for (vertex, position) in vertices.iter_mut().enumerate() {
            let image = [vertex as i32 % 3 - 1, vertex as i32 % 4 - 2, 5 - vertex as i32];
            *position = (Vec3::from(*position) + cell.shift(image)).into();
        }
        let mixed: Vec<_> = good
            .iter()
            .enumerate()
            .map(|(k, t)| if k % 3 == 0 { [t[0], t[2], t[1]] } else { *t })
            .collect();
        assert_eq!(oriented(&vertices, &mixed, Some(&cell)).unwrap(), good);
        let small = Cell::new([[2.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 9.0]]).unwrap();
        let error = oriented(&vertices, &mixed, Some(&small)).unwrap_err().to_string();
        assert!(error.contains("shorter than 1.000000 nm, half of its least width"), "{error}");
    }

    /// The minimal triangulation of the projective plane: ten triangles on six vertices.
    #[test]
    fn the_projective_plane_is_not_orientable() {
        let triangles = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ];
        let vertices: Vec<_> =
            (0..6).map(|k| [f64::from(k), f64::from(k * k), f64::from(k * k * k)]).collect();
        assert!(matches!(oriented(&vertices, &triangles, None), Err(Error::NonOrientable { .. })));
    }

    #[test]
    fn a_surface_is_inside_out_where_its_volume_says_so() {
        let (vertices, good) = octahedron();
        let swapped: Vec<_> = good.iter().map(|t| [t[0], t[2], t[1]]).collect();
        let [outward, inward] =
            [good, swapped].map(|t| Triangulation::new(&Topology::new(&t, 6).unwrap()));
        for (shift, stretch) in [(0.0, 1.0), (1e3, 0.01), (-50.0, 100.0)] {
            let place = |z: f64, [x, y, w]: [f64; 3]| [x, y, z * w].map(|x| x * stretch + shift);
            let placed = |z: f64| vertices.iter().flat_map(|v| place(z, *v)).collect::<Vec<_>>();
            let (is, totals) = is_inside_out(&inward, &placed(1.0)).unwrap();
            assert!(is && (totals.volume / stretch.powi(3) + 4.0 / 3.0).abs() < 1e-6);
            assert!((totals.area / (stretch * stretch) - 12f64.sqrt() * 2.0).abs() < 1e-6);
            assert!(!is_inside_out(&outward, &placed(1.0)).unwrap().0);
            // Mirrored, and as flat as a sheet.
            assert!(is_inside_out(&outward, &placed(-1.0)).unwrap().0);
            for (z, flat) in [(0.0, true), (1e-6, true), (0.1, false)] {
                assert_eq!(is_inside_out(&inward, &placed(z)).unwrap().0, !flat);
            }
        }
        let mut lost = vertices.as_flattened().to_vec();
        lost[4] = f64::NAN;
        assert!(is_inside_out(&inward, &lost).is_none());
    }

    #[test]
    fn vertices_are_checked() {
        let (mut vertices, triangles) = octahedron();
        vertices.push([9.0, 9.0, 9.0]);
        assert_eq!(oriented(&vertices, &triangles, None), Err(Error::UnusedVertex { vertex: 6 }));
        vertices.pop();
        let kept = vertices[3];
        vertices[3] = vertices[1];
        assert!(matches!(
            oriented(&vertices, &triangles, None),
            Err(Error::RepeatedVertex { first: 1, second: 3, .. })
        ));
        vertices[3] = [kept[0], f64::NAN, 0.0];
        assert!(matches!(
            oriented(&vertices, &triangles, None),
            Err(Error::NonFiniteVertex { vertex: 3, .. })
        ));
    }

    #[test]
    fn a_triangle_on_a_line_is_refused() {
        let (mut vertices, triangles) = octahedron();
        let [a, b, c] = triangles[0].map(|v| v as usize);
        for (along, push) in [(3.0, [0.0; 3]), (0.3, [0.0; 3]), (0.3, [2e-16, -1e-16, 3e-16])] {
            vertices[c] = std::array::from_fn(|k| {
                along * vertices[a][k] + (1.0 - along) * vertices[b][k] + push[k]
            });
            assert!(matches!(
                oriented(&vertices, &triangles, None),
                Err(Error::DegenerateTriangle { triangle: 0, .. })
            ));
        }
        vertices[c][0] += 1e-14;
        vertices[c][1] += 1e-14;
        vertices[c][2] += 1e-14;
        assert!(oriented(&vertices, &triangles, None).is_ok());
    }
}
