//! Bond flips as one would first write them: lists of neighbours, and the energy of all that a flip touches before and
//! after it, number by number with an arc tangent an edge. To compare with, for the paper's forces.

type Point = [f64; 3];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Moduli and targets of bending, area, volume and heights.
pub struct Model {
    pub rigidity: f64,
    pub area: [f64; 2],
    pub volume: [f64; 2],
    pub heights: [f64; 2],
    pub temperature: f64,
    pub max_degree: usize,
}

/// A mesh at fixed positions.
pub struct PlainFlips {
    model: Model,
    points: Vec<Point>,
    /// The neighbours of each vertex, counter-clockwise.
    rings: Vec<Vec<usize>>,
    edges: Vec<[usize; 2]>,
    area: f64,
    volume: f64,
    random: u64,
    pub accepted: u64,
}

impl PlainFlips {
    pub fn new(model: Model, positions: &[f64], triangles: &[[i64; 3]]) -> Self {
        let points: Vec<Point> = positions.as_chunks::<3>().0.to_vec();
        let mut after = vec![std::collections::HashMap::new(); points.len()];
        for triangle in triangles {
            for k in 0..3 {
                let [a, b, c] = [0, 1, 2].map(|n| triangle[(k + n) % 3] as usize);
                after[a].insert(b, c);
            }
        }
        let ring = |next: &std::collections::HashMap<usize, usize>| {
            let start = *next.keys().min().expect("every vertex has triangles");
            let steps = std::iter::successors(Some(start), |vertex| Some(next[vertex]));
            steps.take(next.len()).collect::<Vec<_>>()
        };
        let rings: Vec<_> = after.iter().map(ring).collect();
        let pairs = rings.iter().enumerate();
        let edges = pairs.flat_map(|(i, ring)| ring.iter().map(move |&j| [i, j]));
        let edges = edges.filter(|[i, j]| i < j).collect();
        let (area, volume, random, accepted) = (0.0, 0.0, 0x9e37_79b9_7f4a_7c15, 0);
        let mut this = Self { model, points, rings, edges, area, volume, random, accepted };
        for triangle in triangles {
            let [a, b, c] = triangle.map(|vertex| vertex as usize);
            this.area += 0.5 * dot(this.normal(a, b, c), this.normal(a, b, c)).sqrt();
            this.volume += dot(this.points[a], this.normal(a, b, c)) / 6.0;
        }
        this
    }

    fn normal(&self, a: usize, b: usize, c: usize) -> Point {
        cross(minus(self.points[b], self.points[a]), minus(self.points[c], self.points[a]))
    }

    fn uniform(&mut self) -> f64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Bending energy of a vertex.
    fn bending(&self, vertex: usize) -> f64 {
        let ring = &self.rings[vertex];
        let (mut area, mut curvature) = (0.0, 0.0);
        for k in 0..ring.len() {
            let [before, here, after] =
                [k + ring.len() - 1, k, k + 1].map(|n| ring[n % ring.len()]);
            let left = self.normal(vertex, here, after);
            let right = self.normal(vertex, before, here);
            let edge = minus(self.points[here], self.points[vertex]);
            let length = dot(edge, edge).sqrt();
            let angle = (dot(edge, cross(right, left)) / length).atan2(dot(left, right));
            curvature += 0.5 * length * angle;
            area += dot(left, left).sqrt() / 6.0;
        }
        0.5 * self.model.rigidity * curvature * curvature / area
    }

    /// Energy of the heights of a triangle, its area, and its part of the volume.
    fn triangle(&self, a: usize, b: usize, c: usize) -> [f64; 3] {
        let [min_height, epsilon] = self.model.heights;
        let normal = self.normal(a, b, c);
        let twice_area = dot(normal, normal).sqrt();
        let energy: f64 = [(a, b), (b, c), (c, a)]
            .into_iter()
            .map(|(from, to)| {
                let side = minus(self.points[to], self.points[from]);
                let ratio = min_height * dot(side, side).sqrt() / twice_area;
                let x = ratio.powi(4);
                if x > 0.5 { epsilon * (x - 0.5) * (x - 0.5) } else { 0.0 }
            })
            .sum();
        [energy, 0.5 * twice_area, dot(self.points[a], normal) / 6.0]
    }

    /// All that depends on four vertices and two triangles.
    fn energy(&self, vertices: [usize; 4], triangles: [[usize; 3]; 2], totals: [f64; 2]) -> f64 {
        let spring = |[modulus, target]: [f64; 2], value: f64| {
            0.5 * modulus * (value - target) * (value - target) / target
        };
        let heights: f64 = triangles.iter().map(|&[a, b, c]| self.triangle(a, b, c)[0]).sum();
        vertices.iter().map(|&vertex| self.bending(vertex)).sum::<f64>()
            + heights
            + spring(self.model.area, totals[0])
            + spring(self.model.volume, totals[1])
    }

    fn turn(&mut self, [i, j, k, l]: [usize; 4]) {
        self.rings[i].retain(|&vertex| vertex != j);
        self.rings[j].retain(|&vertex| vertex != i);
        // Of k the neighbours i and j follow each other, and l comes between them; of l it is j, then k, then i.
        for (here, there, before) in [(k, l, i), (l, k, j)] {
            let ring = &mut self.rings[here];
            let place = ring.iter().position(|&vertex| vertex == before);
            ring.insert(place.expect("a tip knows the ends") + 1, there);
        }
    }

    /// Try so many flips.
    pub fn attempt(&mut self, count: u64) {
        for _ in 0..count {
            let index = (self.uniform() * self.edges.len() as f64) as usize;
            let [i, j] = self.edges[index];
            let ring = &self.rings[i];
            let at = ring.iter().position(|&vertex| vertex == j).expect("an edge has two ends");
            let (k, l) = (ring[(at + 1) % ring.len()], ring[(at + ring.len() - 1) % ring.len()]);
            let degree = |vertex: usize| self.rings[vertex].len();
            if degree(i).min(degree(j)) <= 3
                || degree(k).max(degree(l)) >= self.model.max_degree
                || self.rings[k].contains(&l)
            {
                continue;
            }
            let (old, new) = ([[i, j, k], [j, i, l]], [[i, l, k], [j, k, l]]);
            let sums = |triangles: [[usize; 3]; 2], which: usize| {
                triangles.iter().map(|&[a, b, c]| self.triangle(a, b, c)[which]).sum::<f64>()
            };
            let area = self.area + sums(new, 1) - sums(old, 1);
            let volume = self.volume + sums(new, 2) - sums(old, 2);
            let before = self.energy([i, j, k, l], old, [self.area, self.volume]);
            self.turn([i, j, k, l]);
            let after = self.energy([i, j, k, l], new, [area, volume]);
            if self.uniform() < ((before - after) / self.model.temperature).exp() {
                self.edges[index] = [k, l];
                (self.area, self.volume) = (area, volume);
                self.accepted += 1;
            } else {
                // Its reverse: kl turns back into ij.
                self.turn([k, l, j, i]);
            }
        }
    }
}
