//! Finding an adapter and opening a device.

use std::future::Future;
use std::task::{Context, Poll, Waker};

use tressfx_core::backend::{Caps, Format};
use tressfx_core::error::{Error, Result};
use tressfx_core::pass::Grid;
use wgpu::{DeviceType, Features, Limits};

use crate::tables::storage_texture;

/// What a device of one's own is opened with, where the adapter has it.
const WANTED: Features = Features::TIMESTAMP_QUERY
    .union(Features::RG11B10UFLOAT_RENDERABLE)
    .union(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES);

/// How a device of one's own is opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WgpuOptions {
    /// A part of the adapter's name, in whatever case; without it the fastest is taken.
    pub adapter: Option<String>,
}

/// The adapters of the system, as people name them: `NAME (API, kind, driver)`.
pub fn adapters() -> Vec<String> {
    pollster::block_on(all_adapters()).iter().map(|adapter| describe(&adapter.get_info())).collect()
}

async fn all_adapters() -> Vec<wgpu::Adapter> {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    let backends = descriptor.backends;
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters = instance.enumerate_adapters(backends).await;
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

/// Opens the adapter that is asked for: the first whose description contains the name, or the fastest.
pub(crate) async fn open(options: &WgpuOptions) -> Result<(wgpu::Device, wgpu::Queue)> {
    let wanted = options.adapter.as_deref();
    let adapters = all_adapters().await;
    let names: Vec<String> = adapters.iter().map(|adapter| describe(&adapter.get_info())).collect();
    let matches = |name: &str| wanted.is_none_or(|wanted| name.to_lowercase().contains(&wanted.to_lowercase()));
    let index = names.iter().position(|name| matches(name)).ok_or_else(|| none(wanted, &names))?;
    let adapter = &adapters[index];
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("tressfx"),
        required_features: adapter.features() & WANTED,
        required_limits: limits(&adapter.limits()),
        ..Default::default()
    };
    let opened = adapter.request_device(&descriptor).await;
    opened.map_err(|error| Error::NoAdapter { message: format!("{} could not be opened: {error}", names[index]) })
}

/// WebGPU's default limits, and more memory and wider targets where the adapter has them.
fn limits(offered: &Limits) -> Limits {
    Limits {
        max_buffer_size: offered.max_buffer_size,
        max_storage_buffer_binding_size: offered.max_storage_buffer_binding_size,
        max_texture_dimension_2d: offered.max_texture_dimension_2d,
        max_color_attachment_bytes_per_sample: offered.max_color_attachment_bytes_per_sample,
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
    let features = device.features();
    let mut caps = Caps::webgpu_default();
    let info = device.adapter_info();
    caps.adapter = describe(&info);
    caps.is_cpu = info.device_type == DeviceType::Cpu;
    caps.compute = limits.max_compute_workgroups_per_dimension >= Grid::MAX_GROUPS;
    caps.fragment_writes = writes_in_fragments(device);
    caps.r11g11b10_targets = features.contains(Features::RG11B10UFLOAT_RENDERABLE);
    caps.max_storage_buffers_per_stage = limits.max_storage_buffers_per_shader_stage;
    caps.max_storage_textures_per_stage = limits.max_storage_textures_per_shader_stage;
    caps.read_write_textures = reads_what_it_writes(device);
    caps.max_storage_binding_bytes = limits.max_storage_buffer_binding_size;
    caps.max_uniform_binding_bytes = limits.max_uniform_buffer_binding_size;
    let alignments = [limits.min_storage_buffer_offset_alignment, limits.min_uniform_buffer_offset_alignment];
    caps.binding_alignment = alignments.into_iter().max().unwrap_or(1).max(1).into();
    caps.max_buffer_bytes = limits.max_buffer_size;
    caps.max_texture_size = limits.max_texture_dimension_2d;
    // WebGPU counts bytes as well: each format of the contract takes 8 at most.
    caps.max_color_targets = limits.max_color_attachments.min(limits.max_color_attachment_bytes_per_sample / 8);
    caps.max_group_threads = limits.max_compute_invocations_per_workgroup;
    caps.max_group_size =
        [limits.max_compute_workgroup_size_x, limits.max_compute_workgroup_size_y, limits.max_compute_workgroup_size_z];
    caps.max_group_memory_bytes = limits.max_compute_workgroup_storage_size;
    caps.timestamps = features.contains(Features::TIMESTAMP_QUERY);
    caps
}

/// Whether fragment shaders can write.
fn writes_in_fragments(device: &wgpu::Device) -> bool {
    let written = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: false },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    can_bind(device, wgpu::ShaderStages::FRAGMENT, written)
}

/// Whether compute passes can read what they write of textures, of all formats that are storage. Without the feature some formats of some adapters can be bound so, but what is
/// asked for is all or nothing.
fn reads_what_it_writes(device: &wgpu::Device) -> bool {
    let can = |format| {
        let ty = storage_texture(format, wgpu::StorageTextureAccess::ReadWrite);
        ty.is_ok_and(|ty| can_bind(device, wgpu::ShaderStages::COMPUTE, ty))
    };
    device.features().contains(Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
        && Format::ALL.into_iter().filter(|format| format.is_storage()).all(can)
}

/// Whether stages can be given a binding. Only adapters say so, and an engine hands over its device alone; so a layout is tried.
fn can_bind(device: &wgpu::Device, visibility: wgpu::ShaderStages, ty: wgpu::BindingType) -> bool {
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let entry = wgpu::BindGroupLayoutEntry { binding: 0, visibility, ty, count: None };
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("hair.probe"), entries: &[entry] };
    drop(device.create_bind_group_layout(&descriptor));
    // Where the answer is not there at once, the device is a browser's, and it can.
    let mut caught = std::pin::pin!(scope.pop());
    !matches!(caught.as_mut().poll(&mut Context::from_waker(Waker::noop())), Poll::Ready(Some(_)))
}
