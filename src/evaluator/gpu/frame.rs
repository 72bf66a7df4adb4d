//! The terms of an evaluation as the shaders read them, and where in the results each of them leaves its sums.

use super::interface::{
    FrameRecord, GROUP_SIZE, Item, KINDS, NO_FIELD, SUMS_OF_EDGES, SUMS_OF_TOTALS,
    SUMS_OF_TRIANGLES, SUMS_OF_VERTICES, TermRecord, Wishes,
};
use super::lattice::Scale;
use super::{Bytes, Precision, Reals, shaders};
use crate::mesh::Topology;
use crate::potentials::{
    CONSTANTS, Contribution, Element, MAX_PARAMETERS, Needs, Potential, Term, Total,
};
use std::ops::Range;

/// Workgroups for some elements.
pub fn groups(elements: usize) -> usize {
    elements.div_ceil(GROUP_SIZE as usize)
}

/// The number by which the shaders know a potential.
pub fn shader_of(potential: &dyn Potential) -> usize {
    // A test demands a shader of every potential.
    shaders::POTENTIALS.iter().position(|name| *name == potential.name()).unwrap_or(usize::MAX)
}

/// The sums of one term.
struct TermSums {
    /// Where they begin, for each kind of element that has any, and of how many groups they are.
    places: [Option<(usize, usize)>; KINDS.len()],
    derivatives: bool,
}

/// The constants of triangles of all terms that have any, end to end.
pub struct FrameConstants {
    /// As the shaders read them.
    pub bytes: Vec<u8>,
    /// Whether they differ from those of the last evaluation.
    pub changed: bool,
    /// The terms' versions of them, and the unit of length.
    versions: Vec<u64>,
    unit: f64,
}

/// What an evaluation asks of the device.
pub struct Frame {
    /// What the shaders read.
    pub bytes: Vec<u8>,
    /// All that the terms need.
    pub needs: Needs,
    /// How many numbers the results have.
    pub num_results: usize,
    sums: Vec<TermSums>,
    /// The values of single elements of all terms, end to end, as they were given and as shaders find them.
    given: Vec<f64>,
    pub fields: Vec<f64>,
    /// Whether `fields` differ from those of the last evaluation.
    pub fields_changed: bool,
    /// What terms have for triangles.
    pub constants: FrameConstants,
    /// Whether the device computes the terms of borders too, triangle by triangle; otherwise the processor does.
    has_borders: bool,
}

impl Frame {
    pub fn new(has_borders: bool) -> Self {
        Self {
            bytes: Vec::new(),
            needs: Needs::empty(),
            num_results: 0,
            sums: Vec::new(),
            given: Vec::new(),
            fields: Vec::new(),
            fields_changed: true,
            constants: FrameConstants {
                bytes: Vec::new(),
                changed: true,
                versions: Vec::new(),
                unit: 0.0,
            },
            has_borders,
        }
    }

    /// Write down the terms; `longest` is a length that no side of a triangle may have, in the device's units. False if a
    /// value does not fit the device's numbers.
    pub fn fill(
        &mut self,
        topology: &Topology,
        precision: Precision,
        scale: Scale,
        terms: &[Term],
        wishes: Wishes,
        longest: f64,
    ) -> bool {
        self.update_fields(topology, terms);
        self.constants.update(terms, precision, scale.unit);
        self.needs = terms.iter().fold(Needs::empty(), |all, term| all | self.needs_of(term));
        self.bytes.clear();
        FrameRecord {
            num_vertices: topology.num_vertices() as u32,
            num_edges: topology.edges.len() as u32,
            num_triangles: topology.triangles.len() as u32,
            needs: self.needs.bits() | wishes.bits(),
            num_terms: terms.len() as u32,
            quantum: scale.quantum as f32,
            // Where the processor looks at edges, their lengths have no bound here.
            longest_squared: (longest * longest).min(f64::from(f32::MAX)) as f32,
            padding: 0,
        }
        .put(&mut Bytes { precision, bytes: &mut self.bytes });
        self.sums.clear();
        self.num_results = 3 * topology.num_vertices();
        let mut fits = true;
        let mut starts = Starts::default();
        for term in terms {
            fits &= self.put_term(topology, precision, scale, term, &mut starts);
        }
        fits
    }

    /// What a term needs here.
    fn needs_of(&self, term: &Term) -> Needs {
        let mut needs = term.potential.needs(term);
        if needs.contains(Needs::BORDERS) && self.has_borders {
            needs |= Needs::TRIANGLES;
        }
        needs
    }

    /// Take over the values of single elements, if they are others than before.
    fn update_fields(&mut self, topology: &Topology, terms: &[Term]) {
        let fields = || terms.iter().flat_map(|term| term.fields);
        let mut rest = self.given.as_slice();
        let same = fields().all(|field| match rest.split_at_checked(field.len()) {
            Some((known, after)) if known == field => {
                rest = after;
                true
            }
            _ => false,
        });
        if !same || !rest.is_empty() {
            // It stays true until they have been uploaded, which may be in a later evaluation.
            self.fields_changed = true;
            self.given = fields().flatten().copied().collect();
            self.fields.clone_from(&self.given);
            self.arrange_edges(topology, terms);
        }
    }

    /// Bring the values of edges into the order of the topology; those on borders have none.
    fn arrange_edges(&mut self, topology: &Topology, terms: &[Term]) {
        let mut names = Vec::new();
        let mut start = 0;
        for term in terms {
            let per = term.potential.parameters().iter().map(|parameter| parameter.per);
            for (per, field) in per.chain(std::iter::repeat(None)).zip(term.fields) {
                if per == Some(Element::Edge) && !field.is_empty() {
                    if names.is_empty() {
                        names = topology.edge_names();
                    }
                    for (value, &name) in self.fields[start..].iter_mut().zip(&names) {
                        *value = field.get(name as usize).copied().unwrap_or(0.0);
                    }
                }
                start += field.len();
            }
        }
    }

    fn put_term(
        &mut self,
        topology: &Topology,
        precision: Precision,
        scale: Scale,
        term: &Term,
        starts: &mut Starts,
    ) -> bool {
        let needs = self.needs_of(term);
        let mut wishes = Wishes::empty();
        wishes.set(Wishes::DERIVATIVES, term.wants_derivatives);
        wishes.set(Wishes::INNER, !term.potential.acts_at_borders());
        let values_of_sum = if term.wants_derivatives { 1 + MAX_PARAMETERS } else { 1 };
        let mut elements = [0; KINDS.len()];
        elements[SUMS_OF_TOTALS as usize] = 1;
        elements[SUMS_OF_TRIANGLES as usize] = topology.triangles.len();
        elements[SUMS_OF_EDGES as usize] = topology.edges.len();
        elements[SUMS_OF_VERTICES as usize] = topology.num_vertices();
        let mut places = [None; KINDS.len()];
        for (kind, place) in places.iter_mut().enumerate() {
            if needs.contains(KINDS[kind]) {
                let groups = groups(elements[kind]);
                *place = Some((self.num_results, groups));
                self.num_results += groups * values_of_sum;
            }
        }
        self.sums.push(TermSums { places, derivatives: term.wants_derivatives });

        let field_starts = term.fields.map(|field| {
            let start = if field.is_empty() { NO_FIELD } else { starts.fields as u32 };
            starts.fields += field.len();
            start
        });
        let constants_start = starts.constants as u32;
        starts.constants += CONSTANTS * term.constants.values.len();
        let reference =
            if needs.contains(Needs::TOTALS) { reference(scale, term) } else { Some(0) };
        let limbs = reference.unwrap_or(0);
        let units = units(scale, term);
        TermRecord {
            potential: shader_of(term.potential) as u32,
            form: term.form as u32,
            switches: term.switches,
            needs: needs.bits() | wishes.bits(),
            sums: places.map(|place| place.map_or(0, |(first, _)| first as u32)),
            field_starts,
            reference: std::array::from_fn(|limb| (limbs >> (32 * limb)) as u32),
            constants_start,
            padding: 0,
            more_padding: [0; 2],
            most_padding: [0; 4],
            values: std::array::from_fn(|k| term.values[k] / units[k]),
            field_units: units.map(|unit| 1.0 / unit),
        }
        .put(&mut Bytes { precision, bytes: &mut self.bytes });
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

    /// Where the sums are: first, length, the number of the derivative or −1 for the energy, and the power of two that
    /// brings them into OpenMM's units. `derivatives` has these numbers for each scalar of each term.
    pub fn runs(
        &self,
        scale: Scale,
        terms: &[Term],
        derivatives: &[[i32; MAX_PARAMETERS]],
    ) -> Vec<[i32; 4]> {
        let mut runs = Vec::new();
        for ((term, sums), numbers) in terms.iter().zip(&self.sums).zip(derivatives) {
            let units = units(scale, term);
            for &(first, groups) in sums.places.iter().flatten() {
                runs.push([first as i32, groups as i32, -1, 0]);
                let wanted = (0..MAX_PARAMETERS).filter(|k| sums.derivatives && numbers[*k] >= 0);
                runs.extend(wanted.map(|k| {
                    let begin = first + (k + 1) * groups;
                    [begin as i32, groups as i32, numbers[k], -(units[k].log2() as i32)]
                }));
            }
        }
        runs
    }

    /// The bytes of the results that hold sums.
    pub fn sums_range(&self, topology: &Topology) -> Range<usize> {
        3 * topology.num_vertices()..self.num_results
    }
}

/// Where in the fields and constants those of the next term begin.
#[derive(Default)]
struct Starts {
    fields: usize,
    constants: usize,
}

impl FrameConstants {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.bytes.len() / Item::Constant.size(0)
    }

    /// Take over those of some terms in a unit of length, if they are others than before.
    fn update(&mut self, terms: &[Term], precision: Precision, unit: f64) {
        let with = || terms.iter().filter(|term| !term.constants.values.is_empty());
        let versions = || with().map(|term| term.constants.version);
        if versions().eq(self.versions.iter().copied()) && unit == self.unit {
            return;
        }
        // It stays true until they have been uploaded, which may be in a later evaluation.
        self.changed = true;
        self.versions = versions().collect();
        self.unit = unit;
        self.bytes.clear();
        for term in with() {
            let scales =
                term.potential.constant_lengths().map(|length| unit.powi((-length).into()));
            for values in &term.constants.values {
                for (value, scale) in values.iter().zip(scales) {
                    self.put(precision, value * scale);
                }
            }
        }
    }

    fn put(&mut self, precision: Precision, value: f64) {
        match precision {
            Precision::Double => self.bytes.extend_from_slice(&value.to_ne_bytes()),
            Precision::Single => {
                let high = value as f32;
                let low = (value - f64::from(high)) as f32;
                self.bytes.extend_from_slice(&high.to_ne_bytes());
                self.bytes.extend_from_slice(&low.to_ne_bytes());
            }
        }
    }
}

/// What the device's unit of each parameter is in OpenMM's; energies keep theirs.
fn units(scale: Scale, term: &Term) -> [f64; MAX_PARAMETERS] {
    let parameters = term.potential.parameters();
    std::array::from_fn(|k| {
        parameters.get(k).map_or(1.0, |parameter| scale.unit.powi(parameter.length.into()))
    })
}

/// The value from which a term measures a total, in the whole numbers that the shaders sum: twice an area and six times a
/// volume on the lattice, and 2³² times a mean curvature.
fn reference(scale: Scale, term: &Term) -> Option<u128> {
    let step = scale.quantum * scale.unit;
    let steps = match term.potential.reference(term)? {
        Total::Area(area) => 2.0 * area / (step * step),
        Total::Volume(volume) => 6.0 * volume / (step * step * step),
        Total::MeanCurvature(length) => length / scale.unit * 2f64.powi(32),
    };
    (steps.abs() < 2f64.powi(126)).then_some(steps.round() as i128 as u128)
}
