//! The memory that a mesh has on a device, as long as its Context lives.

use super::Precision;
use super::device::Device;
use super::interface::Binding;
use super::layout::{connectivity, items};
use crate::error::{Error, Result};
use crate::mesh::Topology;
use crate::potentials::Needs;
use wgpu::BufferUsages as Usage;

/// How many bytes some of the buffers must have for an evaluation.
pub struct Demand {
    pub frame: usize,
    pub fields: usize,
    pub constants: usize,
    pub results: usize,
    pub needs: Needs,
}

/// Buffers in the order of their bindings, and one from which the processor reads.
pub struct Buffers {
    bound: [wgpu::Buffer; Binding::COUNT],
    pub readback: wgpu::Buffer,
    pub group: wgpu::BindGroup,
    /// The number of vertices, for messages.
    vertices: usize,
    /// For each intermediate result the needs that ask for it, and its size.
    optional: Vec<(Binding, Needs, usize)>,
}

/// Beside the results the processor reads the count of thin triangles and two timestamps.
pub const TAIL: usize = 32;

/// What the buffers of the shaders and that of the processor are for.
const STORED: Usage = Usage::STORAGE.union(Usage::COPY_DST).union(Usage::COPY_SRC);
const READ: Usage = Usage::MAP_READ.union(Usage::COPY_DST);

/// A buffer that nothing is in must have a size nevertheless.
const LEAST: usize = 256;

impl Buffers {
    /// # Errors
    /// The device has not enough memory, or does not allow buffers of this size.
    pub fn new(device: &Device, topology: &Topology, precision: Precision) -> Result<Self> {
        let v = topology.num_vertices();
        let of_mesh = Binding::ALL.map(|binding| {
            let (items, needs) = items(binding, topology, precision).unwrap_or_default();
            (binding, needs, items * binding.item().size(precision.size()))
        });
        let sizes = |binding: Binding| match of_mesh[binding as usize] {
            (_, needs, bytes) if needs.is_empty() => bytes,
            _ => LEAST,
        };
        let optional = of_mesh.into_iter().filter(|(_, needs, _)| !needs.is_empty()).collect();
        check_limits(device, v, Binding::ALL.into_iter().map(sizes).max().unwrap_or(0))?;
        let buffers = device.guarded(v, || {
            let bound = std::array::from_fn(|k| create(device, sizes(Binding::ALL[k]), STORED));
            let readback = create(device, LEAST, READ);
            let group = bind(device, &bound);
            Self { bound, readback, group, vertices: v, optional }
        })?;
        buffers.write_topology(device, topology);
        Ok(buffers)
    }

    pub fn get(&self, binding: Binding) -> &wgpu::Buffer {
        &self.bound[binding as usize]
    }

    /// Make what is too small for an evaluation larger.
    ///
    /// # Errors
    /// As for [`Buffers::new`].
    pub fn provide(&mut self, device: &Device, demand: &Demand) -> Result<()> {
        let mut wanted = vec![
            (Binding::Frame, demand.frame),
            (Binding::Fields, demand.fields),
            (Binding::Constants, demand.constants),
            (Binding::Results, demand.results),
        ];
        for &(binding, needs, size) in &self.optional {
            if demand.needs.intersects(needs) {
                wanted.push((binding, size));
            }
        }
        wanted.retain(|(binding, size)| self.get(*binding).size() < *size as u64);
        let reads = (demand.results + TAIL) as u64;
        if wanted.is_empty() && self.readback.size() >= reads {
            return Ok(());
        }
        let largest = wanted.iter().map(|(_, size)| *size).max().unwrap_or(0);
        check_limits(device, self.vertices, largest)?;
        let (bound, readback, group) = device.guarded(self.vertices, || {
            let mut bound = self.bound.clone();
            for (binding, size) in wanted {
                bound[binding as usize] = create(device, size, STORED);
            }
            let mut readback = self.readback.clone();
            if readback.size() < reads {
                readback = create(device, reads as usize, READ);
            }
            let group = bind(device, &bound);
            (bound, readback, group)
        })?;
        // Only what has been made in full takes the place of what there was.
        (self.bound, self.readback, self.group) = (bound, readback, group);
        Ok(())
    }

    /// Bring triangles, edges and rings to the device.
    pub fn write_topology(&self, device: &Device, topology: &Topology) {
        for (binding, words) in connectivity(topology) {
            device.queue.write_buffer(self.get(binding), 0, bytemuck::cast_slice(&words));
        }
    }
}

/// Refuse what the device does not bind before wgpu does, whose message knows nothing of meshes.
fn check_limits(device: &Device, vertices: usize, largest: usize) -> Result<()> {
    let limits = device.wgpu.limits();
    let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    if largest as u64 <= most {
        return Ok(());
    }
    Err(Error::AdapterLacks {
        adapter: device.adapter.name.clone(),
        lack: format!(
            "has buffers of {} MB at most, but a mesh of {vertices} vertices needs one of {} MB",
            most >> 20,
            largest >> 20
        ),
    })
}

fn create(device: &Device, size: usize, usage: Usage) -> wgpu::Buffer {
    let size = size.max(LEAST).next_multiple_of(16) as u64;
    device.wgpu.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size,
        usage,
        mapped_at_creation: false,
    })
}

fn bind(device: &Device, buffers: &[wgpu::Buffer]) -> wgpu::BindGroup {
    let entries: Vec<_> = buffers
        .iter()
        .enumerate()
        .map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding: binding as u32,
            resource: buffer.as_entire_binding(),
        })
        .collect();
    device.wgpu.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &device.layout,
        entries: &entries,
    })
}
