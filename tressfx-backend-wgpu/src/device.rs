//! Finding an adapter and opening a device.

use std::sync::{Arc, Mutex, PoisonError};

use tressfx_core::backend::Caps;
use tressfx_core::error::{Error, Result};
use wgpu::{DeviceType, Features, Limits};

/// The adapters of the system, as people name them: `NAME (API, kind, driver)`.
pub fn adapters() -> Vec<String> {
    found().iter().map(|adapter| describe(&adapter.get_info())).collect()
}

fn found() -> Vec<wgpu::Adapter> {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    let backends = descriptor.backends;
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters = pollster::block_on(instance.enumerate_adapters(backends));
    adapters.sort_by_key(|adapter| speed(adapter.get_info().device_type));
    adapters
}

/// Fastest first.
fn speed(kind: DeviceType) -> u32 {
    match kind {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    }
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    format!("{} ({}, {:?}, {})", info.name, info.backend, info.device_type, driver.trim())
}

/// Opens the fastest adapter, or the first whose description contains `wanted`.
pub(crate) fn open(wanted: Option<&str>) -> Result<(wgpu::Device, wgpu::Queue)> {
    let adapters = found();
    let names: Vec<String> = adapters.iter().map(|adapter| describe(&adapter.get_info())).collect();
    let matches = |name: &str| wanted.is_none_or(|wanted| name.to_lowercase().contains(&wanted.to_lowercase()));
    let index = names.iter().position(|name| matches(name)).ok_or_else(|| none(wanted, &names))?;
    let adapter = &adapters[index];
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("tressfx"),
        required_features: adapter.features() & Features::TIMESTAMP_QUERY,
        required_limits: limits(&adapter.limits()),
        ..Default::default()
    };
    pollster::block_on(adapter.request_device(&descriptor))
        .map_err(|error| Error::NoAdapter { message: format!("{} could not be opened: {error}", names[index]) })
}

/// WebGPU's default limits, and more memory where the adapter has it.
fn limits(offered: &Limits) -> Limits {
    Limits {
        max_buffer_size: offered.max_buffer_size,
        max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
        max_texture_dimension_2d: offered.max_texture_dimension_2d,
        ..Limits::defaults()
    }
    .or_worse_values_from(offered)
}

fn none(wanted: Option<&str>, names: &[String]) -> Error {
    let message = match (wanted, names) {
        (_, []) => String::from(
            "no graphics adapter was found: Vulkan, Metal and Direct3D 12 were tried. Install the driver of the graphics \
             card, or a software Vulkan: on Debian and Ubuntu `apt-get install mesa-vulkan-drivers libvulkan1`",
        ),
        (Some(wanted), names) => format!("no adapter is named `{wanted}`; there are: {}", names.join("; ")),
        (None, _) => unreachable!("without a name every adapter matches"),
    };
    Error::NoAdapter { message }
}

/// What the device can do.
pub(crate) fn caps(device: &wgpu::Device) -> Caps {
    let limits = device.limits();
    Caps {
        adapter: describe(&device.adapter_info()),
        compute: true,
        raster: true,
        read_back: true,
        fragment_writes: true,
        max_storage_buffers_per_stage: limits.max_storage_buffers_per_shader_stage,
        max_storage_binding_bytes: limits.max_storage_buffer_binding_size,
        max_buffer_bytes: limits.max_buffer_size,
        max_texture_edge: limits.max_texture_dimension_2d,
        timestamps: device.features().contains(Features::TIMESTAMP_QUERY),
    }
}

/// Filled with the reason once the device is lost.
pub(crate) fn watch_for_loss(device: &wgpu::Device) -> Arc<Mutex<Option<String>>> {
    let lost = Arc::new(Mutex::new(None));
    let reason = lost.clone();
    device.set_device_lost_callback(move |kind, message| {
        *reason.lock().unwrap_or_else(PoisonError::into_inner) = Some(format!("{kind:?}: {message}"));
    });
    lost
}
