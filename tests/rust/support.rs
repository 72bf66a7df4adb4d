//! Meshes and terms for the tests of the evaluators.

use openmm_helfrich::membrane::Membrane;
use openmm_helfrich::mesh::Cell;
use openmm_helfrich::potentials::{
    Domain, MadeOf, Needs, Potential, REGISTRY, Term, VertexNumbers,
};

/// Positions of all particles, x y z of one after the other, and triangles.
pub type Mesh = (Vec<f64>, Vec<[i64; 3]>);

/// A grid of `rings` × `sectors` quadrilaterals round a spheroid, halved into triangles, with two poles:
/// vertices of many degrees and triangles of many shapes. `noise` moves every coordinate.
pub fn spheroid(rings: i64, sectors: i64, noise: &mut impl FnMut() -> f64) -> Mesh {
    let mut positions = Vec::new();
    let mut add = |x: f64, y: f64, z: f64| {
        for (coordinate, stretch) in [x, y, z].into_iter().zip([10.0, 12.0, 7.0]) {
            positions.push(coordinate * stretch * (1.0 + 0.04 * noise()) + 5.0);
        }
    };
    add(0.0, 0.0, 1.0);
    for ring in 1..=rings {
        let polar = std::f64::consts::PI * ring as f64 / (rings + 1) as f64;
        for sector in 0..sectors {
            let azimuth = std::f64::consts::TAU * sector as f64 / sectors as f64;
            add(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos());
        }
    }
    add(0.0, 0.0, -1.0);
    let south = 1 + rings * sectors;
    let at = |ring: i64, sector: i64| 1 + ring * sectors + sector.rem_euclid(sectors);
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, at(0, sector), at(0, sector + 1)]);
        for ring in 0..rings - 1 {
            let (a, b) = (at(ring, sector), at(ring, sector + 1));
            let (c, d) = (at(ring + 1, sector), at(ring + 1, sector + 1));
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        triangles.push([south, at(rings - 1, sector + 1), at(rings - 1, sector)]);
    }
    (positions, triangles)
}

/// A torus of `around` × `along` quadrilaterals, halved into triangles.
pub fn torus(around: i64, along: i64, noise: &mut impl FnMut() -> f64) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let at = |i: i64, j: i64| along * i.rem_euclid(around) + j.rem_euclid(along);
    for i in 0..around {
        for j in 0..along {
            let [u, v] = [i as f64 / around as f64, j as f64 / along as f64]
                .map(|part| std::f64::consts::TAU * part);
            let wide = 9.0 + 4.0 * v.cos();
            let point = [wide * u.cos(), wide * u.sin(), 4.0 * v.sin()];
            positions.extend(point.map(|x| x + 0.3 * noise()));
            let (p, q, r, s) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    (positions, triangles)
}

/// A mesh without the triangles at some particles, which belong to nothing then.
pub fn without((positions, mut triangles): Mesh, particles: &[i64]) -> Mesh {
    triangles.retain(|triangle| !triangle.iter().any(|particle| particles.contains(particle)));
    (positions, triangles)
}

/// Two meshes beside each other.
pub fn beside((mut positions, mut triangles): Mesh, (others, more): Mesh) -> Mesh {
    let count = (positions.len() / 3) as i64;
    positions.extend(others.iter().map(|x| x + 40.0));
    triangles.extend(more.iter().map(|triangle| triangle.map(|v| v + count)));
    (positions, triangles)
}

/// Meshes with borders: a disk, an annulus, an open and a closed part in either order, a torus with a hole, a fan of
/// border vertices about a single inner one, a strip without any inner vertex, and many tiles.
pub fn open_meshes(seed: u64) -> Vec<Mesh> {
    let mut noise = random(seed);
    let disk = without(spheroid(6, 9, &mut noise), &[0]);
    let annulus = without(spheroid(6, 9, &mut noise), &[0, 55]);
    let closed = spheroid(5, 7, &mut noise);
    let cap: Vec<i64> = (8..57).collect();
    let middle = [0].into_iter().chain(1..8).chain(22..30).collect::<Vec<_>>();
    vec![
        disk.clone(),
        annulus,
        beside(disk.clone(), closed.clone()),
        beside(closed, disk),
        without(torus(7, 6, &mut noise), &[11]),
        without(spheroid(6, 7, &mut noise), &cap),
        without(spheroid(4, 7, &mut noise), &middle),
        without(spheroid(24, 30, &mut noise), &[0, 200, 300, 333, 551, 720]),
    ]
}

/// The potentials of borders, which evaluators leave to whoever calls them.
pub fn border_terms() -> Vec<Term<'static>> {
    vec![
        Term::new("EdgeTensionForce", 0, &[1.2]).unwrap(),
        Term::new("GaussianCurvatureForce", 0, &[-3.0]).unwrap(),
    ]
}

/// Terms of elements that make sense on a surface with borders.
pub fn open_terms(mesh: &Mesh, wants_derivatives: bool) -> Vec<Term<'static>> {
    open(terms_on(mesh, wants_derivatives))
}

/// The terms that make sense on a surface with borders.
pub fn open(mut terms: Vec<Term<'static>>) -> Vec<Term<'static>> {
    terms.retain(|term| !term.potential.needs_outside());
    terms
}

/// All terms of elements, those that know each vertex of a mesh, too.
pub fn terms_on(mesh: &Mesh, wants_derivatives: bool) -> Vec<Term<'static>> {
    terms_in(mesh, None, wants_derivatives)
}

/// The same where the mesh is in a periodic box.
pub fn terms_in(mesh: &Mesh, cell: Option<Cell>, wants_derivatives: bool) -> Vec<Term<'static>> {
    let mut terms = all_terms(wants_derivatives);
    terms.extend(
        terms_of_vertices(mesh, cell).into_iter().map(|term| Term { wants_derivatives, ..term }),
    );
    equipped(&mesh.1, mesh.0.len() / 3, &terms)
}

/// Terms with numbers for each vertex: a reference that the mesh is strained against, and domains.
pub fn terms_of_vertices(mesh: &Mesh, cell: Option<Cell>) -> Vec<Term<'static>> {
    let mut vertices: Vec<_> = mesh.1.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let position =
        |vertex: i64| nalgebra::Vector3::from_column_slice(&mesh.0[3 * vertex as usize..][..3]);
    // By some share of its shortest edge.
    let mut least = vec![f64::INFINITY; mesh.0.len() / 3];
    for [a, b] in mesh.1.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]) {
        let length = (position(a) - position(b)).norm();
        for vertex in [a, b] {
            least[vertex as usize] = length.min(least[vertex as usize]);
        }
    }
    let mut noise = random(77);
    let at_rest = |vertex: &i64| {
        let (place, share) = (position(*vertex), 0.15 * least[*vertex as usize]);
        [0, 1, 2].map(|k| place[k] + share * noise())
    };
    let at_rest: Vec<f64> = vertices.iter().flat_map(at_rest).collect();
    let vectors = cell.map(|cell| cell.vectors().map(Into::into));
    let numbers =
        |values, vectors| &*Box::leak(Box::new(VertexNumbers::new(values, vectors, None)));
    let reference = numbers(at_rest, vectors);
    let domains: Vec<f64> = vertices.iter().map(|vertex| (vertex * 7 % 4 - 1) as f64).collect();
    let domains = numbers(domains, None);
    let moduli: Vec<f64> = vertices.iter().map(|_| 2.0 * noise() - 1.0).collect();
    let mut by_vertex = Term::new("GaussianCurvatureForce", 0, &[1.0]).unwrap();
    by_vertex.fields[0] = moduli.leak();
    by_vertex.numbers = numbers(Vec::new(), None);
    let mut terms = Vec::new();
    for potential in REGISTRY {
        let made_of = potential.constants(&Term::of(potential));
        let numbers = match made_of.and_then(MadeOf::numbers) {
            Some((_, 3)) => reference,
            Some(_) => domains,
            None => continue,
        };
        terms.extend(usual_terms(potential).into_iter().map(|term| Term { numbers, ..term }));
    }
    terms.push(by_vertex);
    terms
}

/// The same terms with their constants of triangles on some mesh.
pub fn equipped<'a>(triangles: &[[i64; 3]], particles: usize, terms: &[Term<'a>]) -> Vec<Term<'a>> {
    let membrane = Box::leak(Box::new(Membrane::new(triangles, particles).unwrap()));
    membrane.equip(terms).unwrap().0.to_vec()
}

/// Numbers in [−1, 1) from a seed.
pub fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A potential in every form, with values that fit triangles whose sides are some 3 nm long.
fn usual_terms(potential: &'static dyn Potential) -> Vec<Term<'static>> {
    let parameters = potential.parameters().iter().enumerate();
    let values: Vec<f64> = parameters
        .map(|(index, parameter)| match (parameter.domain, parameter.default) {
            (Domain::Share, _) => 0.4,
            (_, Some(default)) => default,
            // Different ones, so that none is taken for another.
            _ if parameter.energy != 0 => 2.0 + index as f64,
            _ => 3f64.powi(parameter.length.into()),
        })
        .collect();
    let forms = 0..potential.forms().map_or(1, |(_, names)| names.len());
    forms.map(|form| Term::new(potential.name(), form, &values).unwrap()).collect()
}

/// Every potential of elements and totals in every form, with values that make it act on the meshes of these tests; all
/// with or all without the derivatives with respect to their scalars.
pub fn all_terms(wants_derivatives: bool) -> Vec<Term<'static>> {
    let mut terms = Vec::new();
    let mut add = |name, form, values: &[f64]| terms.push(Term::new(name, form, values).unwrap());
    for form in 0..5 {
        for spontaneous in [0.0, 0.13, -0.2] {
            add("BendingForce", form, &[2.0, spontaneous]);
        }
        add("DihedralForce", form, &[1.5, 0.0]);
        add("DihedralForce", form, &[1.5, -0.4]);
    }
    // Scales of the whole surface.
    add("SurfaceAreaForce", 0, &[3.0, 900.0]);
    add("EnclosedVolumeForce", 0, &[0.7, 3000.0]);
    add("PlaquetteAreaForce", 0, &[4.0, 1000.0]);
    add("PressureForce", 0, &[0.6]);
    add("SurfaceTensionForce", 0, &[-1.4]);
    add("OsmoticPressureForce", 0, &[500.0, 0.2, 2.5]);
    add("AreaDifferenceForce", 0, &[0.3, 90.0]);
    for potential in REGISTRY {
        let needs = potential.needs(&Term::of(potential));
        let is_elsewhere = needs.intersects(Needs::CONTACTS | Needs::BORDERS)
            || potential.constants(&Term::of(potential)).is_some();
        if !is_elsewhere && terms.iter().all(|term| term.potential.name() != potential.name()) {
            terms.extend(usual_terms(potential));
        }
    }
    for index in 0..terms.len() {
        if terms[index].potential.name() == "BendingForce" && terms[index].values[1] != 0.0 {
            let mut unsigned = terms[index];
            unsigned.switches = 1;
            terms.push(unsigned);
        }
    }
    for term in &mut terms {
        term.wants_derivatives = wants_derivatives;
    }
    terms
}
