//! The terms of an evaluation as the shaders read them (`Frame` in `shaders/bindings.wgsl`; the two change
//! together), and where in the results each of them leaves its sums.

use super::lattice::Scale;
use super::{Precision, Reals, shaders};
use crate::mesh::Topology;
use crate::potentials::{Contribution, MAX_PARAMETERS, Needs, Potential, Term};
use std::ops::Range;

/// Threads of a workgroup; `GROUP_SIZE` in `shaders/sums.wgsl`.
pub const GROUP_SIZE: usize = 64;

/// Bits beyond those of [`Needs`]: DERIVATIVES and FORCES in `shaders/bindings.wgsl`.
const DERIVATIVES: u32 = 128;
const FORCES: u32 = 256;

const NO_FIELD: u32 = u32::MAX;

/// The kinds of elements in the order in which a term's sums are listed.
const KINDS: [Needs; 4] = [Needs::TOTALS, Needs::TRIANGLES, Needs::EDGES, Needs::VERTICES];

/// Workgroups for some elements.
pub fn groups(elements: usize) -> usize {
    elements.div_ceil(GROUP_SIZE)
}

/// The number by which the shaders know a potential: that of its file, whose stem is the name of its class as
/// Rust writes it, "triangle_height" for "TriangleHeightForce".
pub fn shader_of(potential: &dyn Potential) -> usize {
    let mut stem = String::new();
    for letter in potential.name().trim_end_matches("Force").chars() {
        if letter.is_uppercase() && !stem.is_empty() {
            stem.push('_');
        }
        stem.extend(letter.to_lowercase());
    }
    // A test demands a shader of every potential.
    shaders::POTENTIALS.iter().position(|known| *known == stem).unwrap_or(usize::MAX)
}

/// The sums of one term.
struct Sums {
    /// Where they begin, for each kind of element that has any, and of how many groups they are.
    places: [Option<(usize, usize)>; 4],
    derivatives: bool,
}

/// What an evaluation asks of the device.
pub struct Frame {
    /// What the shaders read.
    pub bytes: Vec<u8>,
    /// All that the terms need.
    pub needs: Needs,
    /// How many numbers the results have.
    pub num_results: usize,
    sums: Vec<Sums>,
    /// The values of single elements of all terms, end to end.
    pub fields: Vec<f64>,
    /// Whether `fields` differ from those of the last evaluation.
    pub fields_changed: bool,
}

impl Frame {
    pub fn new() -> Self {
        Self {
            bytes: Vec::new(),
            needs: Needs::empty(),
            num_results: 0,
            sums: Vec::new(),
            fields: Vec::new(),
            fields_changed: true,
        }
    }

    /// Write down the terms. False if a value does not fit the device's numbers.
    pub fn fill(
        &mut self,
        topology: &Topology,
        precision: Precision,
        scale: Scale,
        terms: &[Term],
        forces: bool,
    ) -> bool {
        self.update_fields(terms);
        self.needs =
            terms.iter().fold(Needs::empty(), |all, term| all | term.potential.needs(term));
        let counts = [topology.num_vertices(), topology.edges.len(), topology.triangles.len()]
            .map(|n| n as u32);
        let [num_vertices, num_edges, num_triangles] = counts;
        let needs = u32::from(self.needs.bits()) | if forces { FORCES } else { 0 };
        let quantum = (scale.quantum as f32).to_bits();
        let header =
            [num_vertices, num_edges, num_triangles, needs, terms.len() as u32, quantum, 0, 0];
        self.bytes.clear();
        self.bytes.extend_from_slice(bytemuck::cast_slice(&header));
        self.sums.clear();
        self.num_results = 3 * topology.num_vertices();
        let mut fits = true;
        let mut field_start = 0;
        for term in terms {
            fits &= self.put_term(topology, precision, scale, term, &mut field_start);
        }
        fits
    }

    /// Take over the values of single elements, if they are others than before.
    fn update_fields(&mut self, terms: &[Term]) {
        let fields = || terms.iter().flat_map(|term| term.fields);
        let mut rest = self.fields.as_slice();
        let same = fields().all(|field| match rest.split_at_checked(field.len()) {
            Some((known, after)) if known == field => {
                rest = after;
                true
            }
            _ => false,
        });
        if !same || !rest.is_empty() {
            // It stays so until they have been uploaded, which may be later than now.
            self.fields_changed = true;
            self.fields = fields().flatten().copied().collect();
        }
    }

    fn put_term(
        &mut self,
        topology: &Topology,
        precision: Precision,
        scale: Scale,
        term: &Term,
        field_start: &mut usize,
    ) -> bool {
        let needs = term.potential.needs(term);
        let derivatives = if term.wants_derivatives { DERIVATIVES } else { 0 };
        let values_of_sum = if term.wants_derivatives { 1 + MAX_PARAMETERS } else { 1 };
        let triangles = topology.triangles.len();
        let elements = [1, triangles, topology.edges.len(), topology.num_vertices()];
        let mut places = [None; 4];
        for (kind, place) in places.iter_mut().enumerate() {
            if needs.contains(KINDS[kind]) {
                let groups = groups(elements[kind]);
                *place = Some((self.num_results, groups));
                self.num_results += groups * values_of_sum;
            }
        }
        self.sums.push(Sums { places, derivatives: term.wants_derivatives });

        let number = shader_of(term.potential) as u32;
        let bits = u32::from(needs.bits()) | derivatives;
        let mut words = vec![number, term.form as u32, term.switches, bits];
        words.extend(places.map(|place| place.map_or(0, |(first, _)| first as u32)));
        for field in term.fields {
            words.push(if field.is_empty() { NO_FIELD } else { *field_start as u32 });
            *field_start += field.len();
        }
        let reference =
            if needs.contains(Needs::TOTALS) { reference(scale, term) } else { Some(0) };
        let limbs = reference.unwrap_or(0);
        words.extend((0..4).map(|limb| (limbs >> (32 * limb)) as u32));
        self.bytes.extend_from_slice(bytemuck::cast_slice(&words));
        let units = units(scale, term);
        for (value, unit) in term.values.iter().zip(units) {
            precision.put(&mut self.bytes, value / unit);
        }
        for unit in units {
            precision.put(&mut self.bytes, 1.0 / unit);
        }
        reference.is_some()
    }

    /// The energies and derivatives of the terms from the results, of which `results` begins at `first`.
    pub(super) fn collect(
        &self,
        scale: Scale,
        terms: &[Term],
        results: &Reals,
        first: usize,
        contributions: &mut [Contribution],
    ) {
        for ((term, sums), contribution) in terms.iter().zip(&self.sums).zip(contributions) {
            *contribution = Contribution::default();
            for (place, groups) in sums.places.iter().flatten() {
                contribution.energy += results.sum(place - first, *groups);
                if !sums.derivatives {
                    continue;
                }
                for (k, unit) in units(scale, term).into_iter().enumerate() {
                    let begin = place - first + (k + 1) * groups;
                    contribution.by_parameter[k] += results.sum(begin, *groups) / unit;
                }
            }
        }
    }

    /// The bytes of the results that hold sums.
    pub fn sums_range(&self, topology: &Topology) -> Range<usize> {
        3 * topology.num_vertices()..self.num_results
    }
}

/// What the device's unit of each parameter is in OpenMM's; energies keep theirs.
fn units(scale: Scale, term: &Term) -> [f64; MAX_PARAMETERS] {
    let parameters = term.potential.parameters();
    std::array::from_fn(|k| {
        parameters.get(k).map_or(1.0, |parameter| scale.unit.powi(parameter.length.into()))
    })
}

/// The target of a total area or volume, in whole numbers of the lattice: twice an area, six times a volume.
fn reference(scale: Scale, term: &Term) -> Option<u128> {
    let step = scale.quantum * scale.unit;
    let steps = match term.potential.parameters().get(1).map(|parameter| parameter.length) {
        Some(2) => 2.0 * term.values[1] / (step * step),
        Some(3) => 6.0 * term.values[1] / (step * step * step),
        _ => return None,
    };
    (steps < 2f64.powi(126)).then_some(steps.round() as u128)
}
