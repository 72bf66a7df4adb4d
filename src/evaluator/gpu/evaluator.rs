//! The passes over a mesh on the device: one submission and one readback an evaluation.

use super::buffers::{Buffers, Demand, TAIL};
use super::device::Device;
use super::faults::{Fault, strikes};
use super::frame::{Frame, groups};
use super::interface::{Binding, GROUPS_ACROSS, Sink, Wishes};
use super::lattice::{Lattice, Scale};
use super::layout::passes;
use super::{Bytes, Precision, Reals};
use crate::error::{Error, Result};
use crate::mesh::Topology;
use crate::potentials::{Contribution, Request, Term};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

/// Evaluates any set of terms on one mesh, on a GPU.
///
/// Buffers live as long as this does. The device and its compiled shaders are shared with all others on the
/// same adapter. The same positions give the same bits: threads write to slots of their own elements and gather
/// in a fixed order, and sums are trees of fixed shape.
pub struct GpuEvaluator {
    topology: Arc<Topology>,
    device: Arc<Device>,
    precision: Precision,
    lattice: Lattice,
    frame: Frame,
    buffers: Buffers,
    stopwatch: Option<Stopwatch>,
}

/// Where the time of an evaluation went.
#[derive(Debug, Clone, Copy, Default)]
pub struct Timings {
    /// Converting positions and handing them to the driver.
    pub upload: Duration,
    /// From the begin of the first pass to the end of the last one, by the device's clock; zero if it has none.
    pub kernel: Duration,
    /// The rest: waiting for the device, copying back, adding to the forces.
    pub readback: Duration,
}

/// Timestamps of the device, for those who want [`Timings`].
struct Stopwatch {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    last: Timings,
}

/// How long a thread that wgpu has told of results may take to pass it on.
const ANSWER_TIME: Duration = Duration::from_secs(30);

impl GpuEvaluator {
    /// Buffers for a mesh on an adapter, by its index among all, or on the best one.
    ///
    /// # Errors
    /// There is no such adapter, it lacks something, or it has not enough memory.
    pub fn new(
        topology: Arc<Topology>,
        adapter: Option<usize>,
        precision: Precision,
    ) -> Result<Self> {
        let device = super::device::open(adapter, precision)?;
        device.pipelines(precision)?;
        if strikes(Fault::Memory) {
            let (adapter, vertices) = (device.adapter.name.clone(), topology.num_vertices());
            return Err(Error::OutOfDeviceMemory { adapter, vertices });
        }
        let buffers = Buffers::new(&device, &topology, precision)?;
        let lattice = Lattice::new(&topology, precision);
        let frame = Frame::new(false);
        Ok(Self { topology, device, precision, lattice, frame, buffers, stopwatch: None })
    }

    /// Go on with a mesh whose connectivity has changed: of the same vertices, with as many triangles.
    pub fn set_topology(&mut self, topology: Arc<Topology>) {
        self.buffers.write_topology(&self.device, &topology);
        self.topology = topology;
    }

    /// The name of the adapter and its driver.
    pub fn adapter(&self) -> (&str, &str) {
        (&self.device.adapter.name, &self.device.adapter.driver)
    }

    /// The numbers that it computes with.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Measure the evaluations from now on, if the device has a clock.
    pub fn measure(&mut self) {
        if !self.device.adapter.has_timestamps {
            return;
        }
        let queries = self.device.wgpu.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let resolved = self.device.wgpu.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 16,
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        self.stopwatch = Some(Stopwatch { queries, resolved, last: Timings::default() });
    }

    /// Where the time of the last evaluation went, if it was measured.
    pub fn timings(&self) -> Option<Timings> {
        self.stopwatch.as_ref().map(|stopwatch| stopwatch.last)
    }

    /// Evaluate terms at the positions of all particles, as
    /// [`Evaluator::evaluate`](crate::potentials::Evaluator::evaluate) does.
    ///
    /// Returns false, with nothing added to the forces, where the device cannot say what there is to be said:
    /// positions that are not finite, a triangle without area, or too thin for the device's precision, values or
    /// results beyond its range. The processor then computes, or names the culprit.
    ///
    /// # Errors
    /// Of the device: it was lost, or has not enough memory.
    pub fn evaluate(&mut self, request: Request) -> Result<bool> {
        let Request { terms, positions, energies: contributions, forces } = request;
        if terms.is_empty() {
            return Ok(true);
        }
        if strikes(Fault::Lost) {
            self.device.wgpu.destroy();
        }
        let start = Instant::now();
        let Some(scale) = self.lattice.place(&self.topology, positions) else { return Ok(false) };
        let (topology, precision) = (self.topology.clone(), self.precision);
        let wishes = if forces.is_some() { Wishes::FORCES } else { Wishes::empty() };
        if !self.frame.fill(&topology, precision, scale, terms, wishes, f64::INFINITY) {
            return Ok(false);
        }
        let real = precision.size();
        self.buffers.provide(
            &self.device,
            &Demand {
                frame: self.frame.bytes.len(),
                fields: self.frame.fields.len() * real,
                constants: self.frame.constants.bytes.len(),
                results: self.frame.num_results * real,
                needs: self.frame.needs,
            },
        )?;
        let first = if forces.is_some() { 0 } else { self.frame.sums_range(&topology).start };
        let bytes = (self.frame.num_results - first) * real;
        let device = self.device.clone();
        let uploaded = device.guarded(topology.num_vertices(), || {
            self.upload();
            let uploaded = Instant::now();
            self.submit(first * real, bytes, forces.is_some());
            uploaded
        })?;
        self.frame.fields_changed = false;
        self.frame.constants.changed = false;
        let computed = self.read(scale, terms, first, bytes, contributions, forces);
        if computed.is_ok() {
            self.buffers.readback.unmap();
        }
        if let Some(stopwatch) = &mut self.stopwatch {
            stopwatch.last.upload = uploaded - start;
            stopwatch.last.readback = uploaded.elapsed().saturating_sub(stopwatch.last.kernel);
        }
        computed
    }

    fn upload(&self) {
        let write = |binding, bytes: &[u8]| {
            self.device.queue.write_buffer(self.buffers.get(binding), 0, bytes);
        };
        write(Binding::Positions, self.lattice.bytes());
        write(Binding::Frame, &self.frame.bytes);
        if self.frame.fields_changed && !self.frame.fields.is_empty() {
            let mut bytes = Vec::with_capacity(self.frame.fields.len() * self.precision.size());
            let mut sink = Bytes { precision: self.precision, bytes: &mut bytes };
            self.frame.fields.iter().for_each(|value| sink.real(*value));
            write(Binding::Fields, &bytes);
        }
        let constants = &self.frame.constants;
        if constants.changed && !constants.bytes.is_empty() {
            write(Binding::Constants, &constants.bytes);
        }
    }

    /// All passes and the copy of `bytes` of the results from `begin` on, at once.
    fn submit(&self, begin: usize, bytes: usize, forces: bool) {
        let device = &self.device;
        let Ok(pipelines) = device.pipelines(self.precision) else { return };
        let mut encoder = device.wgpu.create_command_encoder(&Default::default());
        let thin = self.buffers.get(Binding::ThinTriangles);
        encoder.clear_buffer(thin, 0, None);
        let stopwatch = self.stopwatch.as_ref();
        let timestamp_writes = stopwatch.map(|watch| wgpu::ComputePassTimestampWrites {
            query_set: &watch.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        });
        let mut pass = encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
        pass.set_bind_group(0, &self.buffers.group, &[]);
        for (each, elements) in passes(self.frame.needs, true, forces, &self.topology) {
            let groups = groups(elements) as u32;
            pass.set_pipeline(&pipelines[each as usize]);
            pass.dispatch_workgroups(groups.min(GROUPS_ACROSS), groups.div_ceil(GROUPS_ACROSS), 1);
        }
        drop(pass);
        let (results, readback) = (self.buffers.get(Binding::Results), &self.buffers.readback);
        let tail = tail(bytes);
        encoder.copy_buffer_to_buffer(results, begin as u64, readback, 0, bytes as u64);
        encoder.copy_buffer_to_buffer(thin, 0, readback, tail as u64, 4);
        if let Some(watch) = stopwatch {
            encoder.resolve_query_set(&watch.queries, 0..2, &watch.resolved, 0);
            encoder.copy_buffer_to_buffer(&watch.resolved, 0, readback, tail as u64 + 8, 16);
        }
        device.queue.submit([encoder.finish()]);
    }

    /// Wait for the results and take them over.
    fn read(
        &mut self,
        scale: Scale,
        terms: &[Term],
        first: usize,
        bytes: usize,
        contributions: &mut [Contribution],
        forces: Option<&mut [f64]>,
    ) -> Result<bool> {
        let device = self.device.clone();
        let (send, received) = mpsc::channel();
        let mapped = device.guarded(self.topology.num_vertices(), || {
            self.buffers.readback.map_async(wgpu::MapMode::Read, .., move |result| {
                // If waiting has failed, nobody receives this.
                let _ = send.send(result);
            });
            let waited = device.wgpu.poll(wgpu::PollType::wait_indefinitely());
            // Another Context's thread may be the one that wgpu tells; it does so at once.
            waited.is_ok() && matches!(received.recv_timeout(ANSWER_TIME), Ok(Ok(())))
        })?;
        let view = self.buffers.readback.get_mapped_range(..).ok().filter(|_| mapped);
        let Some(view) = view else {
            let adapter = device.adapter.name.clone();
            let reason = "the results could not be read back".to_owned();
            return Err(Error::DeviceFailure { adapter, reason });
        };
        let tail = tail(bytes);
        if let Some(watch) = &mut self.stopwatch {
            let stamps: &[u64] = bytemuck::cast_slice(&view[tail + 8..][..16]);
            let ticks = stamps[1].saturating_sub(stamps[0]);
            let nanoseconds = ticks as f64 * f64::from(device.queue.get_timestamp_period());
            watch.last.kernel = Duration::from_nanos(nanoseconds as u64);
        }
        let thin: &[u32] = bytemuck::cast_slice(&view[tail..][..4]);
        if thin[0] != 0 {
            return Ok(false);
        }
        let results = Reals::new(self.precision, &view[..bytes]);
        self.frame.collect(scale, terms, &results, first, contributions);
        let finite = contributions.iter().all(|part| part.energy.is_finite());
        if !finite || (first == 0 && !self.forces_are_finite(&results)) {
            return Ok(false);
        }
        if let Some(forces) = forces {
            self.add_forces(&results, 1.0 / scale.unit, forces);
        }
        Ok(true)
    }

    fn forces_are_finite(&self, results: &Reals) -> bool {
        let count = 3 * self.topology.num_vertices();
        match results {
            Reals::Single(all) => all[..count].iter().all(|force| force.is_finite()),
            Reals::Double(all) => all[..count].iter().all(|force| force.is_finite()),
        }
    }

    fn add_forces(&self, results: &Reals, factor: f64, forces: &mut [f64]) {
        for (vertex, &particle) in self.topology.particles.iter().enumerate() {
            let force = &mut forces[3 * particle as usize..][..3];
            for axis in 0..3 {
                force[axis] += factor * results.get(3 * vertex + axis);
            }
        }
    }
}

/// Where the tail of the readback begins, which timestamps want to be a multiple of 8.
fn tail(bytes: usize) -> usize {
    const { assert!(TAIL >= 8 + 24) };
    bytes.next_multiple_of(8)
}
