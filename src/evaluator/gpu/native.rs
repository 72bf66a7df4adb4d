//! Evaluations that OpenMM's GPU platforms do themselves, in their own buffers and with their own compilers.
//!
//! The program is the same modules as everywhere, written in OpenMM's dialect (`shaders/dialect/`), between
//! `shaders/openmm_prelude.c` and `shaders/openmm_kernels.c`. Here is what the host decides: which buffers there are, what
//! is in them and which passes run; `wrappers/src/NativeDevice.cpp` does it.

use super::frame::{Frame, groups};
use super::interface::{Binding, HALF_WIDTH_BITS, Wishes};
use super::lattice::{Scale, connected_parts};
use super::layout::{Pass, connectivity, items, passes};
use super::{Bytes, Precision, Sink, shaders};
use crate::error::{Error, Result};
use crate::mesh::Configuration;
use crate::mesh::geometry::Vec3;
use crate::mesh::{Cell, Topology, Triangulation};
use crate::potentials::{MAX_PARAMETERS, Needs, Potential, Term, Total};
use std::ffi::CStr;

/// What one evaluation asks of the device.
#[derive(Default)]
pub struct Plan {
    /// A buffer for each of `Binding::ALL`.
    pub buffers: Vec<Buffer>,
    /// The passes, and how many groups each has.
    pub passes: Vec<(&'static CStr, usize)>,
    /// A target of each term that is not 0: its lower and its higher half, its power of two, and the power of lengths that it is;
    /// all 0 if there is none.
    pub targets: Vec<[i32; 4]>,
    /// The lattice reaches 2 to this power to both sides, nm; [`BY_POSITIONS`] where the device has to find out.
    pub extent: i32,
    /// Sums in the results: first, length, the derivative or −1 for the energy, and a power of two to multiply with.
    pub runs: Vec<[i32; 4]>,
    /// Changes with `targets` and `runs`.
    pub version: u64,
}

/// In place of a power of two that depends on positions.
pub const BY_POSITIONS: i32 = i32::MIN;

/// What is asked of an evaluation.
pub struct Wanted<'a> {
    /// The periodic box, if there is one.
    pub cell: Option<&'a Cell>,
    /// Energies, or derivatives with respect to scalars.
    pub energies: bool,
    /// Forces.
    pub forces: bool,
    /// For each scalar of each term the number of the derivative that it adds to, or −1.
    pub derivatives: &'a [[i32; MAX_PARAMETERS]],
}

/// A buffer of a device.
#[derive(Default)]
pub struct Buffer {
    /// Bytes of an item.
    pub item: usize,
    /// The number of items.
    pub items: usize,
    /// What the host has for it, if anything.
    pub data: Vec<u8>,
    /// Changes with the data; 0 if there are none.
    pub version: u64,
}

impl Buffer {
    fn set(&mut self, data: &[u8]) {
        if self.data != data || self.version == 0 {
            self.data.clear();
            self.data.extend_from_slice(data);
            self.version += 1;
        }
    }
}

/// A membrane that a platform evaluates.
pub struct Native {
    precision: Precision,
    topology: Option<Topology>,
    /// Of the connectivity that `topology` is of.
    generation: u64,
    frame: Frame,
    /// The unit of length, nm, as a power of two, once positions have been seen.
    unit: Option<i32>,
    plan: Plan,
    /// The particle of each vertex, and the first vertex of its connected part.
    particles: Vec<u32>,
    anchors: Vec<u32>,
}

/// The program of a precision, without what OpenMM defines before it.
pub fn source(precision: Precision) -> &'static CStr {
    match precision {
        Precision::Single => shaders::SINGLE_PROGRAM,
        Precision::Double => shaders::DOUBLE_PROGRAM,
    }
}

/// Whether a platform can evaluate a potential: those of contacts are computed on the processor, and in a periodic box
/// volumes, for which a surface has to be in one piece.
pub fn is_native(potential: &'static dyn Potential, is_periodic: bool) -> bool {
    let wants_one_piece = is_periodic && potential.needs_outside();
    !wants_one_piece && !potential.needs(&Term::of(potential)).contains(Needs::CONTACTS)
}

impl Native {
    /// Of no membrane yet.
    pub fn new(precision: Precision) -> Self {
        Self {
            precision,
            topology: None,
            generation: 0,
            frame: Frame::new(true),
            unit: None,
            plan: Plan::default(),
            particles: Vec::new(),
            anchors: Vec::new(),
        }
    }

    /// Choose the unit of length by the positions of all particles: a power of two near the mean edge, so that no square of
    /// a square leaves the range of single precision. As it is a power of two, no bit depends on it.
    pub fn set_unit(&mut self, mesh: &Triangulation, at: Configuration) {
        let position = |vertex: u32| {
            let first = 3 * mesh.particles()[vertex as usize] as usize;
            Vec3::from_column_slice(&at.positions[first..][..3])
        };
        let mut sum = 0.0;
        for half in mesh.edges() {
            let (a, b) = (mesh.origin(half), mesh.origin(crate::mesh::triangulation::next(half)));
            let way = position(b) - position(a);
            let shift = at.cell.map(|cell| cell.shift(cell.nearest(&way)));
            sum += (way + shift.unwrap_or_default()).norm();
        }
        let mean = sum / mesh.num_edges().max(1) as f64;
        let is_sane = (1e-20..1e20).contains(&mean);
        self.unit = Some(if is_sane { mean.log2().round() as i32 } else { 0 });
    }

    /// Whether the unit of length has been chosen.
    pub fn has_unit(&self) -> bool {
        self.unit.is_some()
    }

    /// The unit of length as a power of two, nm.
    pub fn unit(&self) -> i32 {
        self.unit.unwrap_or(0)
    }

    /// The particle of each vertex, and the first vertex of its connected part.
    pub fn vertices(&self) -> (&[u32], &[u32]) {
        (&self.particles, &self.anchors)
    }

    /// Say what an evaluation of terms takes. `generation` changes with the connectivity of the mesh.
    ///
    /// # Errors
    /// A target of a total is beyond all sizes.
    pub fn plan(
        &mut self,
        mesh: &Triangulation,
        generation: u64,
        terms: &[Term],
        wanted: &Wanted,
    ) -> Result<()> {
        let &Wanted { cell, energies, forces, derivatives } = wanted;
        if self.topology.is_none() || self.generation != generation {
            self.set_topology(Topology::of(mesh));
            self.generation = generation;
        }
        // The device finds the spacing of its lattice by itself.
        let unit = self.unit();
        let scale = Scale { unit: 2f64.powi(unit), quantum: 1.0 };
        let Self { precision, topology: Some(topology), frame, plan, .. } = self else {
            return Err(Error::Contract("has no mesh".to_owned()));
        };
        let mut wishes = Wishes::empty();
        wishes.set(Wishes::FORCES, forces);
        wishes.set(Wishes::PERIODIC, cell.is_some());
        // What is flagged here the processor looks at, with the exact bound.
        let longest = cell.map_or(f64::INFINITY, |cell| 0.999 * cell.half_width() / scale.unit);
        if !frame.fill(topology, *precision, scale, terms, wishes, longest) {
            let names: Vec<_> = terms.iter().map(|term| term.potential.name()).collect();
            return Err(Error::Contract(format!(
                "a target of {} is too large for a GPU platform; check its unit, or set the backend \
                 \"cpu\"",
                names.join(", ")
            )));
        }
        let real = precision.size();
        plan.buffers.resize_with(Binding::COUNT, Buffer::default);
        for binding in Binding::ALL {
            let buffer = &mut plan.buffers[binding as usize];
            let (count, needs) = match binding {
                Binding::Frame => (frame.bytes.len() / 4, Needs::empty()),
                Binding::Fields => (frame.fields.len(), Needs::empty()),
                Binding::Constants => (frame.constants.len(), Needs::empty()),
                Binding::Results => (frame.num_results, Needs::empty()),
                _ => items(binding, topology, *precision).unwrap_or_default(),
            };
            buffer.item = if binding == Binding::Frame { 4 } else { binding.item().size(real) };
            if needs.is_empty() || frame.needs.intersects(needs) {
                buffer.items = buffer.items.max(count);
            }
            // OpenMM has no arrays without items.
            buffer.items = buffer.items.max(1);
        }
        plan.buffers[Binding::Frame as usize].set(&frame.bytes);
        plan.extent = cell.map_or(BY_POSITIONS, extent);
        if let Some(cell) = cell {
            let buffer = &mut plan.buffers[Binding::BoxVectors as usize];
            buffer.set(&box_vectors(cell, *precision, unit));
        }
        if std::mem::take(&mut frame.fields_changed) && !frame.fields.is_empty() {
            let mut bytes = Vec::with_capacity(frame.fields.len() * real);
            let mut sink = Bytes { precision: *precision, bytes: &mut bytes };
            frame.fields.iter().for_each(|value| sink.real(*value));
            plan.buffers[Binding::Fields as usize].set(&bytes);
        }
        let constants = &mut frame.constants;
        if std::mem::take(&mut constants.changed) && !constants.bytes.is_empty() {
            plan.buffers[Binding::Constants as usize].set(&constants.bytes);
        }
        plan.passes.clear();
        plan.passes.extend(
            passes(frame.needs, energies, forces, topology)
                .into_iter()
                // The platform's kernel takes forces from corners to OpenMM's array.
                .filter(|(pass, _)| *pass != Pass::VerticesBackward)
                .map(|(pass, elements)| (pass.name(), groups(elements))),
        );
        let targets = terms.iter().map(target).collect();
        // Without energies nobody reads them.
        let runs = energies.then(|| frame.runs(scale, terms, derivatives));
        let runs = runs.unwrap_or_else(|| std::mem::take(&mut plan.runs));
        if plan.version == 0 || plan.targets != targets || plan.runs != runs && energies {
            plan.version += 1;
        }
        (plan.targets, plan.runs) = (targets, runs);
        Ok(())
    }

    /// What the last call of [`Self::plan`] has found.
    pub fn last_plan(&self) -> &Plan {
        &self.plan
    }

    fn set_topology(&mut self, topology: Topology) {
        self.plan.buffers.resize_with(Binding::COUNT, Buffer::default);
        for (binding, words) in connectivity(&topology) {
            self.plan.buffers[binding as usize].set(bytemuck::cast_slice(&words));
        }
        let (parts, count) = connected_parts(&topology);
        let mut first = vec![u32::MAX; count];
        self.anchors.clear();
        for (vertex, part) in parts.iter().enumerate() {
            let first = &mut first[*part as usize];
            *first = (*first).min(vertex as u32);
            self.anchors.push(*first);
        }
        self.particles.clone_from(&topology.particles);
        self.topology = Some(topology);
    }
}

/// The power of two that half of the box' sides are below, nm: positions are taken where they are that near.
fn extent(cell: &Cell) -> i32 {
    let [a, b, c] = cell.vectors();
    (0.5 * a.x.max(b.y).max(c.z)).log2().floor() as i32 + 1
}

/// The vectors of a box as shaders read them.
fn box_vectors(cell: &Cell, precision: Precision, unit: i32) -> Vec<u8> {
    let components = cell.vectors().iter().flat_map(|vector| vector.iter());
    match precision {
        Precision::Single => {
            let steps = 2f64.powi(HALF_WIDTH_BITS as i32 - extent(cell));
            components.flat_map(|x| ((x * steps).round() as i32).to_ne_bytes()).collect()
        }
        Precision::Double => {
            let scale = 2f64.powi(-unit);
            components.flat_map(|x| (x * scale).to_ne_bytes()).collect()
        }
    }
}

/// The value from which a term measures a total as m 2ᵖ nmᵏ: twice an area, six times a volume; all 0 if there is none.
fn target(term: &Term) -> [i32; 4] {
    let (value, power): (f64, _) = match term.potential.reference(term) {
        Some(Total::Area(area)) => (2.0 * area, 2),
        Some(Total::Volume(volume)) => (6.0 * volume, 3),
        // Of a mean curvature the frame has it, since the lattice does not matter there.
        Some(Total::MeanCurvature(_)) | None => return [0; 4],
    };
    let bits = value.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    if exponent == 0 {
        return [0; 4];
    }
    let mantissa = bits & ((1 << 52) - 1) | 1 << 52;
    [mantissa as i32, (mantissa >> 32) as i32, exponent - 1075, power]
}
