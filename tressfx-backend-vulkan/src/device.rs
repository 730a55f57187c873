//! Opening a device, or sharing an engine's.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use ash::prelude::VkResult;
use ash::{ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use tressfx_core::backend::Caps;
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::shader::SpirvOptions;

use crate::faults::Faults;
use crate::instance::{Instance, describe, names};
use crate::label::lock_loader;

/// How a device of one's own is opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct VulkanOptions {
    /// A part of the adapter's name, in whatever case; without it the fastest is taken.
    pub adapter: Option<String>,
    /// Whether the validation layer watches, with synchronization validation: [`run`](tressfx_core::backend::Run::run)
    /// and everything that creates answers its messages as errors.
    pub validation: bool,
    /// Whether shader invocations are counted: see [`Timing`](tressfx_core::backend::Timing).
    pub statistics: bool,
    /// Where compiled pipelines are kept from one run to the next. A file that is missing, broken or from another driver is
    /// ignored and written anew.
    pub pipeline_cache: Option<PathBuf>,
}

/// An engine's device.
#[non_exhaustive]
pub struct VulkanDesc {
    /// The instance that the device was made from.
    pub instance: ash::Instance,
    /// The adapter that the device was made from.
    pub physical_device: vk::PhysicalDevice,
    /// The device: Vulkan 1.3 with `synchronization2` and `dynamicRendering`.
    pub device: ash::Device,
    /// A queue with graphics and compute: what is recorded goes to it.
    pub queue: vk::Queue,
    /// Its family.
    pub queue_family: u32,
    /// Where memory is taken from.
    pub allocator: Arc<Mutex<Allocator>>,
    /// What was enabled on the device, beside what is required.
    pub enabled: Enabled,
    /// See [`VulkanOptions::pipeline_cache`].
    pub pipeline_cache: Option<PathBuf>,
}

impl VulkanDesc {
    /// A device on which nothing was enabled but what is required.
    pub fn new(
        instance: ash::Instance,
        physical_device: vk::PhysicalDevice,
        device: ash::Device,
        (queue, queue_family): (vk::Queue, u32),
        allocator: Arc<Mutex<Allocator>>,
    ) -> Self {
        let (enabled, pipeline_cache) = (Enabled::default(), None);
        Self { instance, physical_device, device, queue, queue_family, allocator, enabled, pipeline_cache }
    }
}

/// Features that are used where they are enabled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Enabled {
    /// `fragmentStoresAndAtomics`.
    pub fragment_writes: bool,
    /// `independentBlend`: targets of one pass may blend differently.
    pub independent_blend: bool,
    /// `robustBufferAccess2` of VK_EXT_robustness2: shaders need no checks of their own.
    pub robust_buffers: bool,
    /// `robustImageAccess2` of VK_EXT_robustness2.
    pub robust_images: bool,
    /// `pipelineStatisticsQuery`; shader invocations are counted where it is set.
    pub statistics: bool,
    /// VK_EXT_debug_utils, an extension of the instance: objects and passes are named.
    pub debug_utils: bool,
}

/// A device and what belongs to it. Everything that lives on the device holds it.
pub(crate) struct Gpu {
    pub(crate) instance: ash::Instance,
    pub(crate) physical_device: vk::PhysicalDevice,
    pub(crate) device: ash::Device,
    pub(crate) queue: vk::Queue,
    pub(crate) queue_family: u32,
    pub(crate) allocator: Arc<Mutex<Allocator>>,
    pub(crate) debug: Option<ext::debug_utils::Device>,
    pub(crate) enabled: Enabled,
    pub(crate) properties: vk::PhysicalDeviceProperties,
    /// Why the device is gone, once it is.
    pub(crate) lost: OnceLock<String>,
    pub(crate) faults: Faults,
    /// `None` where an engine's device is shared, which is not ours to destroy.
    owned: Option<Instance>,
}

impl std::fmt::Debug for Gpu {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        out.debug_struct("Gpu").field("adapter", &describe(&self.properties)).finish_non_exhaustive()
    }
}

impl Gpu {
    /// # Safety
    /// As [`VulkanBackend::new`](crate::VulkanBackend::new).
    pub(crate) unsafe fn share(desc: VulkanDesc) -> Self {
        let VulkanDesc { instance, physical_device, device, queue, queue_family, allocator, enabled, .. } = desc;
        let debug = enabled.debug_utils.then(|| ext::debug_utils::Device::new(&instance, &device));
        // SAFETY: the caller promises that they belong together.
        let properties = unsafe { instance.get_physical_device_properties(physical_device) };
        Self {
            instance,
            physical_device,
            device,
            queue,
            queue_family,
            allocator,
            debug,
            enabled,
            properties,
            lost: OnceLock::new(),
            faults: Faults::default(),
            owned: None,
        }
    }

    pub(crate) fn open(options: &VulkanOptions) -> Result<Self> {
        let _alone = lock_loader();
        let started = Instance::start(options.validation)?;
        let (physical_device, device, queue_family, enabled) = open_device(&started, options)?;
        // SAFETY: the family has one queue at least, and it was asked for.
        let queue = unsafe { device.get_device_queue(queue_family, 0) };
        let allocator = match Allocator::new(&memory_of(&started.instance, physical_device, &device)) {
            Ok(allocator) => Arc::new(Mutex::new(allocator)),
            Err(error) => {
                // SAFETY: nothing was made from it.
                unsafe { device.destroy_device(None) };
                return Err(Error::Backend { label: "allocator", message: error.to_string() });
            }
        };
        let instance = started.instance.clone();
        let mut desc = VulkanDesc::new(instance, physical_device, device, (queue, queue_family), allocator);
        desc.enabled = enabled;
        // SAFETY: they were made from each other.
        let mut gpu = unsafe { Self::share(desc) };
        gpu.owned = Some(started);
        Ok(gpu)
    }

    /// Makes and names an object.
    pub(crate) fn create<T: vk::Handle + Copy>(
        &self,
        label: Label,
        make: impl FnOnce(&ash::Device) -> VkResult<T>,
    ) -> Result<T> {
        let made = self.faults.next().and_then(|()| make(&self.device));
        let made = made.map_err(|code| self.failed(code, label, 0))?;
        self.name(made, label);
        Ok(made)
    }

    /// Waits until a device of our own has finished with everything. An engine's says so by itself.
    pub(crate) fn finish_own(&self) {
        if self.owned.is_some() {
            // SAFETY: nobody else has the queue. A lost device has finished too.
            let _ = unsafe { self.device.queue_wait_idle(self.queue) };
        }
    }

    /// What the validation layer said since the last call.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.owned.as_ref().map_or_else(Vec::new, Instance::messages)
    }

    /// What SPIR-V is written for on this device.
    pub(crate) fn spirv(&self) -> SpirvOptions {
        SpirvOptions {
            version: (1, 6),
            robust_buffers: self.enabled.robust_buffers,
            robust_textures: self.enabled.robust_images,
            names: self.debug.is_some() && cfg!(debug_assertions),
        }
    }

    /// Whether queues of the family can write timestamps.
    fn times(&self) -> bool {
        // SAFETY: the instance is alive.
        let families = unsafe { self.instance.get_physical_device_queue_family_properties(self.physical_device) };
        families.get(self.queue_family as usize).is_some_and(|family| family.timestamp_valid_bits > 0)
    }

    pub(crate) fn caps(&self) -> Caps {
        let limits = &self.properties.limits;
        let mut more = vk::PhysicalDeviceMaintenance4Properties::default();
        let mut all = vk::PhysicalDeviceProperties2::default().push_next(&mut more);
        // SAFETY: Vulkan 1.3 has both structures.
        unsafe { self.instance.get_physical_device_properties2(self.physical_device, &mut all) };
        let storage_buffers = limits
            .max_per_stage_descriptor_storage_buffers
            .min(limits.max_descriptor_set_storage_buffers)
            .min(limits.max_per_stage_resources);
        let mut caps = Caps::webgpu_default();
        caps.adapter = describe(&self.properties);
        caps.is_cpu = self.properties.device_type == vk::PhysicalDeviceType::CPU;
        caps.fragment_writes = self.enabled.fragment_writes;
        caps.r11g11b10_targets = self.draws_to(vk::Format::B10G11R11_UFLOAT_PACK32);
        // Some devices say a million, which no set of ours is ever to be tried with.
        caps.max_storage_buffers_per_stage = storage_buffers.min(64);
        caps.max_storage_textures_per_stage =
            limits.max_per_stage_descriptor_storage_images.min(limits.max_descriptor_set_storage_images).min(16);
        // Vulkan asks for it of the formats that are storage.
        caps.read_write_textures = true;
        caps.max_storage_binding_bytes = limits.max_storage_buffer_range.into();
        caps.max_uniform_binding_bytes = limits.max_uniform_buffer_range.into();
        caps.binding_alignment =
            limits.min_storage_buffer_offset_alignment.max(limits.min_uniform_buffer_offset_alignment).max(4);
        caps.max_buffer_bytes = more.max_buffer_size;
        caps.max_texture_size = limits.max_image_dimension2_d;
        caps.max_color_targets = limits.max_color_attachments.min(limits.max_fragment_output_attachments);
        caps.max_group_threads = limits.max_compute_work_group_invocations;
        caps.max_group_size = limits.max_compute_work_group_size;
        caps.max_group_memory_bytes = limits.max_compute_shared_memory_size;
        caps.timestamps = self.times();
        caps
    }

    /// Whether a colour target may be of a format, and blend.
    fn draws_to(&self, format: vk::Format) -> bool {
        // SAFETY: the instance is alive.
        let found = unsafe { self.instance.get_physical_device_format_properties(self.physical_device, format) };
        let wanted = vk::FormatFeatureFlags::COLOR_ATTACHMENT | vk::FormatFeatureFlags::COLOR_ATTACHMENT_BLEND;
        found.optimal_tiling_features.contains(wanted)
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // An engine's device stays; our own goes, and its instance after it.
        let Some(instance) = self.owned.take() else { return };
        // The allocator gives its memory back while the device is still there.
        let mut allocator = self.allocator.lock().unwrap_or_else(PoisonError::into_inner);
        if let Ok(empty) = Allocator::new(&memory_of(&self.instance, self.physical_device, &self.device)) {
            drop(std::mem::replace(&mut *allocator, empty));
        }
        let _alone = lock_loader();
        // SAFETY: all that was made from the device is gone, since it held this.
        unsafe { self.device.destroy_device(None) };
        drop(instance);
    }
}

fn memory_of(
    instance: &ash::Instance,
    physical_device: vk::PhysicalDevice,
    device: &ash::Device,
) -> AllocatorCreateDesc {
    AllocatorCreateDesc {
        instance: instance.clone(),
        device: device.clone(),
        physical_device,
        debug_settings: Default::default(),
        buffer_device_address: false,
        allocation_sizes: Default::default(),
    }
}

type Opened = (vk::PhysicalDevice, ash::Device, u32, Enabled);

fn open_device(started: &Instance, options: &VulkanOptions) -> Result<Opened> {
    let instance = &started.instance;
    let (physical_device, name) = started.pick(options.adapter.as_deref())?;
    let refuse = |why: String| Error::NoAdapter { message: format!("{name} could not be opened: {why}") };
    // SAFETY: the instance is alive.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical_device) };
    let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    let family = families.iter().position(|family| family.queue_flags.contains(both));
    let family = family.ok_or_else(|| refuse(String::from("no queue takes graphics and compute")))? as u32;
    // SAFETY: as above.
    let extensions = unsafe { instance.enumerate_device_extension_properties(physical_device) }.unwrap_or_default();
    let robust = names(&extensions).contains(ext::robustness2::NAME);

    let mut robustness = vk::PhysicalDeviceRobustness2FeaturesEXT::default();
    let mut core13 = vk::PhysicalDeviceVulkan13Features::default();
    let mut have = vk::PhysicalDeviceFeatures2::default().push_next(&mut core13);
    if robust {
        have = have.push_next(&mut robustness);
    }
    // SAFETY: the structures are of Vulkan 1.3 and of an extension that is there.
    unsafe { instance.get_physical_device_features2(physical_device, &mut have) };
    let have = have.features;
    if core13.synchronization2 == vk::FALSE || core13.dynamic_rendering == vk::FALSE {
        return Err(refuse(String::from("synchronization2 or dynamicRendering is missing")));
    }
    let enabled = Enabled {
        fragment_writes: have.fragment_stores_and_atomics == vk::TRUE,
        independent_blend: have.independent_blend == vk::TRUE,
        robust_buffers: robustness.robust_buffer_access2 == vk::TRUE,
        robust_images: robustness.robust_image_access2 == vk::TRUE,
        statistics: options.statistics && have.pipeline_statistics_query == vk::TRUE,
        debug_utils: started.debug_utils,
    };
    let features = vk::PhysicalDeviceFeatures::default()
        .robust_buffer_access(have.robust_buffer_access == vk::TRUE)
        .independent_blend(enabled.independent_blend)
        .fragment_stores_and_atomics(enabled.fragment_writes)
        // What a shader writes as the first instance of a draw is not ours to know.
        .draw_indirect_first_instance(have.draw_indirect_first_instance == vk::TRUE)
        .pipeline_statistics_query(enabled.statistics);
    let mut core13 = vk::PhysicalDeviceVulkan13Features::default().synchronization2(true).dynamic_rendering(true);
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
    let wanted = [ext::robustness2::NAME.as_ptr()];
    let mut robustness = vk::PhysicalDeviceRobustness2FeaturesEXT::default()
        .robust_buffer_access2(enabled.robust_buffers)
        .robust_image_access2(enabled.robust_images);
    let mut info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(if robust { &wanted } else { &[] })
        .enabled_features(&features)
        .push_next(&mut core13);
    if robust {
        info = info.push_next(&mut robustness);
    }
    // SAFETY: everything that is asked for is offered.
    let device = unsafe { instance.create_device(physical_device, &info, None) };
    Ok((physical_device, device.map_err(|error| refuse(error.to_string()))?, family, enabled))
}
