//! Which GPUs there are.

use super::Precision;
use super::faults::{Fault, strikes};
use super::interface::Binding;
use crate::error::{Error, Result};
use std::sync::OnceLock;
use wgpu::{DeviceType, Features};

/// Storage buffers that the shaders bind at once.
const STORAGE_BUFFERS: u32 = Binding::COUNT as u32;

/// A GPU, or a driver that computes on the processor like one.
#[derive(Debug, Clone)]
pub struct Adapter {
    pub(super) wgpu: wgpu::Adapter,
    /// As its driver calls it.
    pub name: String,
    /// The driver and its version.
    pub driver: String,
    /// "Vulkan", "Metal" or "DirectX 12".
    pub interface: &'static str,
    /// "discrete", "integrated", "virtual", "software" or "other".
    pub kind: &'static str,
    /// Whether it computes in double precision.
    pub has_double: bool,
    /// Whether it tells how long a pass takes.
    pub has_timestamps: bool,
}

impl Adapter {
    fn new(wgpu: wgpu::Adapter) -> Self {
        let (info, features) = (wgpu.get_info(), wgpu.features());
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        let interface = match info.backend {
            wgpu::Backend::Vulkan => "Vulkan",
            wgpu::Backend::Metal => "Metal",
            wgpu::Backend::Dx12 => "DirectX 12",
            _ => "other",
        };
        let kind = match info.device_type {
            DeviceType::DiscreteGpu => "discrete",
            DeviceType::IntegratedGpu => "integrated",
            DeviceType::VirtualGpu => "virtual",
            DeviceType::Cpu => "software",
            DeviceType::Other => "other",
        };
        Self {
            name: info.name,
            driver,
            interface,
            kind,
            has_double: features.contains(Features::SHADER_F64),
            has_timestamps: features.contains(Features::TIMESTAMP_QUERY),
            wgpu,
        }
    }

    /// Whether the processor does the work, which our own code for the processor does better.
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }

    /// Refuse an adapter that cannot run the shaders.
    ///
    /// # Errors
    /// Says what it lacks.
    pub fn check(&self, precision: Precision) -> Result<()> {
        let lacks = |lack: String| Err(Error::AdapterLacks { adapter: self.name.clone(), lack });
        let buffers = self.wgpu.limits().max_storage_buffers_per_shader_stage;
        if buffers < STORAGE_BUFFERS {
            return lacks(format!("binds {buffers} buffers at once, {STORAGE_BUFFERS} are needed"));
        }
        if precision == Precision::Double && !self.has_double {
            return lacks("does not compute in double precision".to_owned());
        }
        Ok(())
    }

    /// Discrete before integrated before software.
    fn rank(&self) -> usize {
        ["discrete", "integrated", "virtual", "other", "software"]
            .iter()
            .position(|kind| *kind == self.kind)
            .unwrap_or(usize::MAX)
    }
}

fn instance() -> &'static wgpu::Instance {
    static INSTANCE: OnceLock<wgpu::Instance> = OnceLock::new();
    INSTANCE.get_or_init(|| {
        wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12,
            // A release build asks drivers for no debugging aids.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        })
    })
}

/// All adapters, the most promising first. The drivers are asked once.
pub fn all() -> &'static [Adapter] {
    static FOUND: OnceLock<Vec<Adapter>> = OnceLock::new();
    if strikes(Fault::Adapter) {
        return &[];
    }
    FOUND.get_or_init(|| {
        let found = pollster::block_on(instance().enumerate_adapters(wgpu::Backends::all()));
        let mut adapters: Vec<_> = found.into_iter().map(Adapter::new).collect();
        adapters.sort_by_key(Adapter::rank);
        adapters
    })
}

/// The adapter of an index into [`all`], or the best one.
///
/// # Errors
/// There is none.
pub fn find(index: Option<usize>) -> Result<(usize, &'static Adapter)> {
    let adapters = all();
    let index = index.unwrap_or(0);
    adapters.get(index).map(|adapter| (index, adapter)).ok_or_else(|| {
        let found = match adapters.len() {
            0 => "no adapter was found".to_owned(),
            count => format!("there is no adapter {index} among {count}"),
        };
        Error::NoAdapter { found }
    })
}
