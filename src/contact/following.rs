//! Lists after flips, and what is near at present during a round of flips.

use super::inner::sort;
use super::lists::{Far, Lists, Made, Pair, ascending, lowest_first};
use super::outer::{both, limits, triangle_sphere};
use super::rough::Rough;
use super::spheres::{Edge, Search, Sphere};
use crate::mesh::Triangulation;
use crate::mesh::closest::{Arms, crossing};
use crate::mesh::triangulation::Quad;

/// After so many flips the edges are sorted into boxes anew.
const MOST_NEW: usize = 200;

/// When more than one in so many triangles is new, lists are made anew.
const FEW: usize = 4;

impl Lists {
    /// Go over to the pairs of other triangles; false if too many of these are new.
    pub(super) fn follow_flips(&mut self, mesh: &Triangulation, made: &Made) -> bool {
        let changed = |(old, new): &(&[u32; 3], &[u32; 3])| old != new;
        let pairs = self.triangles.iter().zip(mesh.triangles()).filter(changed);
        let (mut old, mut new): (Vec<_>, Vec<_>) =
            pairs.map(|(old, new)| (lowest_first(*old), lowest_first(*new))).unzip();
        if FEW * new.len() > self.triangles.len() {
            return false;
        }
        self.triangles.clear();
        self.triangles.extend_from_slice(mesh.triangles());
        let [mut old_edges, mut new_edges] = [&old, &new].map(|triangles| {
            let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            sides.map(|[a, b]| ascending(a, b)).collect::<Vec<_>>()
        });
        keep_differences(&mut old, &mut new);
        keep_differences(&mut old_edges, &mut new_edges);
        self.leave_out(mesh.num_vertices(), &old, &old_edges);
        // Most were followed during the round of flips.
        old_edges.iter().for_each(|ends| self.take_edge(made, *ends));
        new_edges.iter().for_each(|ends| self.put_edge(made, *ends));
        let mut scratch = std::mem::take(&mut self.scratch);
        let search = &mut scratch[0].search;
        let mut far = std::mem::take(&mut self.far);
        let known = [0, 1].map(|kind| far[kind].len());
        self.pair_triangles(made, new.iter().copied(), search, &mut far[0]);
        self.pair_new_edges(made, &new_edges, search, &mut far[1]);
        self.scratch = scratch;
        let mut near = std::mem::take(&mut self.near);
        self.choose_some::<false>(made, &far[0][known[0]..], &mut near[0]);
        self.choose_some::<true>(made, &far[1][known[1]..], &mut near[1]);
        near.iter_mut().for_each(|near| sort(near));
        (self.far, self.near) = (far, near);
        true
    }

    /// Leave out all pairs of some triangles and of some edges, both ascending.
    fn leave_out(&mut self, num_vertices: usize, triangles: &[[u32; 3]], edges: &[[u32; 2]]) {
        let mut touched = vec![false; num_vertices];
        triangles.as_flattened().iter().for_each(|vertex| touched[*vertex as usize] = true);
        let touched = |vertex: u32| touched[vertex as usize];
        let has_gone =
            |a: u32, b: u32| touched(a) && touched(b) && edges.binary_search(&[a, b]).is_ok();
        let triangle_stays = |[_, a, b, c]: Pair| {
            let all = touched(a) && touched(b) && touched(c);
            !(all && triangles.binary_search(&[a, b, c]).is_ok())
        };
        let edges_stay = |[a, b, c, d]: Pair| !has_gone(a, b) && !has_gone(c, d);
        self.far[0].retain(|far| triangle_stays(far.pair));
        self.far[1].retain(|far| edges_stay(far.pair));
        self.near[0].retain(|pair| triangle_stays(*pair));
        self.near[1].retain(|pair| edges_stay(*pair));
    }

    /// Add the pairs of some edges, ascending, at the outer reference.
    fn pair_new_edges(
        &self,
        made: &Made,
        new: &[[u32; 2]],
        search: &mut Search,
        pairs: &mut Vec<Far>,
    ) {
        let (reach, slack) = limits(made.reach, self.edges.slack());
        let mut rough = Rough::<Pair, true>::new([0; 4]);
        let mut note = |pair, least| pairs.push(Far { pair, distance: least - slack });
        search.forget();
        for ends @ [a, b] in new {
            let sphere = self.edge_sphere(made.cell.as_ref(), *ends);
            let around = (&sphere.middle, sphere.radius());
            let part = self.own_part(*a);
            let middle = self.edges.find(around, made.reach, [*a, *b, *b], part, search);
            let half = sphere.half.map(|x| x as f32).into();
            let one = Edge { ends: *ends, middle, half };
            for place in &search.found {
                let other = self.edges.edge(*place as usize);
                // Of two new edges the one with the higher number adds the pair.
                if other.ends < *ends || new.binary_search(&other.ends).is_err() {
                    let arms = self.edges.arms(&one, &other);
                    let most = reach + sphere.room + self.outer.room_of(other.ends);
                    rough.push(both(*ends, other.ends), arms, most, &mut note);
                }
            }
        }
        rough.find(note);
    }

    fn take_edge(&mut self, made: &Made, ends: [u32; 2]) {
        let sphere = self.edge_sphere(made.cell.as_ref(), ends);
        self.edges.take(&sphere);
    }

    fn put_edge(&mut self, made: &Made, ends: [u32; 2]) {
        let sphere = self.edge_sphere(made.cell.as_ref(), ends);
        self.edges.put(&sphere);
        if self.edges.num_late() > MOST_NEW {
            let cell = made.cell.as_ref();
            let mut all = std::mem::take(&mut self.all);
            all.clear();
            all.extend(self.edges.all_ends().map(|ends| self.edge_sphere(cell, ends)));
            let size = made.reach + 2.0 * self.outer.largest() + 1.5 * made.median;
            self.edges.fill(cell, size, &all);
            self.all = all;
        }
    }

    /// The vertices within reach of a triangle at present, ascending.
    pub fn vertices_near_now(&self, corners: [u32; 3], search: &mut Search, found: &mut Vec<u32>) {
        found.clear();
        let Some(Made { reach, cell, .. }) = self.made_for else { return };
        let cell = cell.as_ref();
        let (points, middle, radius) = triangle_sphere(cell, &self.positions, corners);
        let part = self.own_part(corners[0]);
        // Vertices are in their balls around the places that the boxes have.
        search.forget();
        self.vertices.find((&middle, radius), reach, corners, part, search);
        found.extend(search.found.iter().map(|place| self.vertices.ends(*place as usize)[0]));
        found.retain(|vertex| {
            let at = &self.positions[*vertex as usize];
            Arms::new(cell, at, points.each_ref()).nearest().squared < reach * reach
        });
        found.sort_unstable();
    }

    /// The ends of all edges within reach of an edge at present, ascending.
    pub fn edges_near_now(&self, ends: [u32; 2], search: &mut Search, found: &mut Vec<[u32; 2]>) {
        found.clear();
        let Some(Made { reach, cell, .. }) = self.made_for else { return };
        let cell = cell.as_ref();
        let [a, b] = ends;
        let sphere = Sphere::of_edge(cell, &self.positions, ends, self.part(a), 0.0);
        let around = (&sphere.middle, sphere.radius());
        search.forget();
        self.edges.find(around, reach, [a, b, b], self.own_part(a), search);
        let at = |vertex: u32| &self.positions[vertex as usize];
        found.extend(search.found.iter().map(|place| self.edges.ends(*place as usize)));
        found.retain(|[p, q]| {
            crossing(cell, [at(a), at(b)], [at(*p), at(*q)]).squared < reach * reach
        });
        found.sort_unstable();
    }

    /// Replace the edge ij by kl.
    pub fn follow(&mut self, quad: &Quad) {
        let Some(made) = self.made_for else { return };
        let [i, j, k, l] = quad.vertices;
        self.take_edge(&made, ascending(i, j));
        self.put_edge(&made, ascending(k, l));
    }
}

/// Sort both, and keep in each what the other does not have.
fn keep_differences<T: Ord + Clone>(one: &mut Vec<T>, other: &mut Vec<T>) {
    for all in [&mut *one, &mut *other] {
        all.sort_unstable();
        all.dedup();
    }
    let before = one.clone();
    one.retain(|x| other.binary_search(x).is_err());
    other.retain(|x| before.binary_search(x).is_err());
}
