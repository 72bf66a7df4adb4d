//! An open GPU with its compiled shaders, shared by all Contexts that use it.

use super::adapters::{self, Adapter};
use super::interface::Binding;
use super::layout::Pass;
use super::{Precision, shaders};
use crate::error::{Error, Result};
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};
use wgpu::{BufferBindingType, ErrorFilter, Features};

/// A pipeline for each of [`Pass::ALL`].
pub(super) type Pipelines = [wgpu::ComputePipeline; Pass::ALL.len()];

/// A device that is open.
pub struct Device {
    pub(super) wgpu: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) layout: wgpu::BindGroupLayout,
    /// What the device was opened on.
    pub adapter: &'static Adapter,
    single: OnceLock<Pipelines>,
    double: OnceLock<Pipelines>,
    /// Why the device was lost, once it is.
    lost: Arc<Mutex<Option<String>>>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// The devices that are open, by the index of their adapter.
fn open_devices() -> MutexGuard<'static, HashMap<usize, Arc<Device>>> {
    static OPEN: OnceLock<Mutex<HashMap<usize, Arc<Device>>>> = OnceLock::new();
    lock(OPEN.get_or_init(Mutex::default))
}

/// The device of an adapter, opened if need be, or again if it was lost.
///
/// # Errors
/// No such adapter, or one that cannot run the shaders.
pub fn open(adapter: Option<usize>, precision: Precision) -> Result<Arc<Device>> {
    let (index, adapter) = adapters::find(adapter)?;
    adapter.check(precision)?;
    let mut devices = open_devices();
    if let Some(device) = devices.get(&index).filter(|device| lock(&device.lost).is_none()) {
        return Ok(device.clone());
    }
    let device = Arc::new(Device::new(adapter)?);
    devices.insert(index, device.clone());
    Ok(device)
}

impl Device {
    fn new(adapter: &'static Adapter) -> Result<Self> {
        let wanted = Features::SHADER_F64 | Features::TIMESTAMP_QUERY;
        let request = adapter.wgpu.request_device(&wgpu::DeviceDescriptor {
            label: Some("openmm-helfrich"),
            required_features: adapter.wgpu.features() & wanted,
            required_limits: adapter.wgpu.limits(),
            ..Default::default()
        });
        let (wgpu, queue) = pollster::block_on(request).map_err(|error| Error::DeviceFailure {
            adapter: adapter.name.clone(),
            reason: error.to_string(),
        })?;
        let lost = Arc::new(Mutex::new(None));
        let reasons = lost.clone();
        wgpu.set_device_lost_callback(move |reason, message| {
            lock(&reasons).get_or_insert_with(|| format!("{reason:?}: {message}"));
        });
        // Errors are looked for where they can arise; one that comes out of nowhere must not end the process.
        wgpu.on_uncaptured_error(Arc::new(|error| eprintln!("openmm-helfrich: {error}")));
        let entries: Vec<_> = Binding::ALL
            .into_iter()
            .map(|binding| wgpu::BindGroupLayoutEntry {
                binding: binding as u32,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: BufferBindingType::Storage { read_only: binding.is_read_only() },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        let layout = wgpu.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: None,
            entries: &entries,
        });
        let (single, double) = (OnceLock::new(), OnceLock::new());
        Ok(Self { wgpu, queue, layout, adapter, single, double, lost })
    }

    /// The passes of a precision, compiled when they are first asked for.
    pub(super) fn pipelines(&self, precision: Precision) -> Result<&Pipelines> {
        let (slot, source) = match precision {
            Precision::Single => (&self.single, shaders::SINGLE),
            Precision::Double => (&self.double, shaders::DOUBLE),
        };
        if let Some(pipelines) = slot.get() {
            return Ok(pipelines);
        }
        let made = self.guarded(0, || self.compile(source))?;
        Ok(slot.get_or_init(|| made))
    }

    fn compile(&self, source: &str) -> Pipelines {
        let module = self.wgpu.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("openmm-helfrich"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = self.wgpu.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&self.layout)],
            immediate_size: 0,
        });
        let pass = |name| {
            self.wgpu.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(name),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        Pass::ALL.map(|each| pass(each.name().to_str().unwrap_or_default()))
    }

    /// Run something and turn what wgpu says against it into an error. `vertices` is for messages.
    pub(super) fn guarded<T>(&self, vertices: usize, body: impl FnOnce() -> T) -> Result<T> {
        let adapter = || self.adapter.name.clone();
        let memory = self.wgpu.push_error_scope(ErrorFilter::OutOfMemory);
        let internal = self.wgpu.push_error_scope(ErrorFilter::Internal);
        let validation = self.wgpu.push_error_scope(ErrorFilter::Validation);
        // wgpu panics where a device that is lost does not answer any more.
        let result = match catch_unwind(AssertUnwindSafe(body)) {
            Ok(result) => result,
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
                let reason = text.unwrap_or("wgpu gave up").to_owned();
                return Err(match lock(&self.lost).clone() {
                    Some(reason) => Error::LostDevice { adapter: adapter(), reason },
                    None => Error::DeviceFailure { adapter: adapter(), reason },
                });
            }
        };
        let faults = [
            pollster::block_on(validation.pop()),
            pollster::block_on(internal.pop()),
            pollster::block_on(memory.pop()),
        ];
        if let Some(reason) = lock(&self.lost).clone() {
            return Err(Error::LostDevice { adapter: adapter(), reason });
        }
        match faults.into_iter().flatten().next() {
            None => Ok(result),
            Some(wgpu::Error::OutOfMemory { .. }) => {
                Err(Error::OutOfDeviceMemory { adapter: adapter(), vertices })
            }
            Some(error) => {
                let reason = error.to_string();
                Err(Error::DeviceFailure { adapter: adapter(), reason })
            }
        }
    }
}
