//! The engine's device, and the validation layer that watches it.

use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, Result};
use tressfx_backend_vulkan::ash::{Device, Entry, Instance, ext, vk};
use tressfx_backend_vulkan::gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};

/// Everything that an engine starts with. It frees nothing where it fails on the way: the program ends then.
pub(crate) struct Gpu {
    pub(crate) instance: Instance,
    pub(crate) physical_device: vk::PhysicalDevice,
    pub(crate) device: Device,
    pub(crate) queue: vk::Queue,
    pub(crate) queue_family: u32,
    pub(crate) allocator: Arc<Mutex<Allocator>>,
    watch: Option<Watch>,
    /// The loader stays as long as anything of Vulkan is used.
    _entry: Entry,
}

/// What listens to the validation layer.
struct Watch {
    debug: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    messages: Box<Mutex<Vec<String>>>,
}

impl Gpu {
    pub(crate) fn open(validate: bool) -> Result<Self> {
        // SAFETY: the loader is the system's.
        let entry = unsafe { Entry::load() }.context("no Vulkan: install a driver, or a software Vulkan")?;
        let instance = instance(&entry, validate)?;
        let watch = validate.then(|| Watch::new(&entry, &instance)).transpose()?;
        let (physical_device, queue_family) = pick(&instance)?;
        let device = device(&instance, physical_device, queue_family)?;
        // SAFETY: the device was made with one queue of this family.
        let queue = unsafe { device.get_device_queue(queue_family, 0) };
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        })?;
        let allocator = Arc::new(Mutex::new(allocator));
        Ok(Self { instance, physical_device, device, queue, queue_family, allocator, watch, _entry: entry })
    }

    /// Whether the validation layer watches.
    pub(crate) fn is_watched(&self) -> bool {
        self.watch.is_some()
    }

    /// Frees everything and says what the validation layer had to say. Nothing that was made from the device may be left.
    pub(crate) fn destroy(self) -> Vec<String> {
        drop(self.allocator);
        // SAFETY: the allocator was the last thing that lived on the device.
        unsafe { self.device.destroy_device(None) };
        let messages = self.watch.map_or_else(Vec::new, Watch::end);
        // SAFETY: as for the device.
        unsafe { self.instance.destroy_instance(None) };
        messages
    }
}

fn instance(entry: &Entry, validate: bool) -> Result<Instance> {
    let application = vk::ApplicationInfo::default().application_name(c"engine").api_version(vk::API_VERSION_1_3);
    let layers = [c"VK_LAYER_KHRONOS_validation".as_ptr()];
    let extensions = [ext::debug_utils::NAME.as_ptr()];
    let hazards = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
    let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&hazards);
    let mut info = vk::InstanceCreateInfo::default().application_info(&application);
    if validate {
        info = info.enabled_layer_names(&layers).enabled_extension_names(&extensions).push_next(&mut features);
    }
    // SAFETY: all pointers live until the call is over.
    unsafe { entry.create_instance(&info, None) }.context("no instance: --validate needs vulkan-validationlayers")
}

/// The first adapter with Vulkan 1.3 and a queue for graphics and compute; a real GPU before a software one.
fn pick(instance: &Instance) -> Result<(vk::PhysicalDevice, u32)> {
    let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    // SAFETY: the instance is alive.
    let mut adapters = unsafe { instance.enumerate_physical_devices() }?;
    // SAFETY: as above.
    let properties = |adapter| unsafe { instance.get_physical_device_properties(adapter) };
    adapters.retain(|&adapter| properties(adapter).api_version >= vk::API_VERSION_1_3);
    adapters.sort_by_key(|&adapter| properties(adapter).device_type == vk::PhysicalDeviceType::CPU);
    let with_queue = |adapter| {
        // SAFETY: as above.
        let families = unsafe { instance.get_physical_device_queue_family_properties(adapter) };
        let family = families.iter().position(|family| family.queue_flags.contains(both))?;
        Some((adapter, family as u32))
    };
    adapters.into_iter().find_map(with_queue).context("no adapter with Vulkan 1.3")
}

/// A device with what the hair requires and nothing else.
fn device(instance: &Instance, adapter: vk::PhysicalDevice, family: u32) -> Result<Device> {
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
    let mut core13 = vk::PhysicalDeviceVulkan13Features::default().synchronization2(true).dynamic_rendering(true);
    let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).push_next(&mut core13);
    // SAFETY: all pointers live until the call is over.
    Ok(unsafe { instance.create_device(adapter, &info, None) }?)
}

impl Watch {
    fn new(entry: &Entry, instance: &Instance) -> Result<Self> {
        use vk::{DebugUtilsMessageSeverityFlagsEXT as Severity, DebugUtilsMessageTypeFlagsEXT as Type};
        let debug = ext::debug_utils::Instance::new(entry, instance);
        let messages = Box::new(Mutex::new(Vec::new()));
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(Severity::WARNING | Severity::ERROR)
            .message_type(Type::GENERAL | Type::VALIDATION | Type::PERFORMANCE)
            .pfn_user_callback(Some(on_message))
            .user_data(std::ptr::from_ref::<Mutex<Vec<String>>>(&messages).cast_mut().cast());
        // SAFETY: the extension is enabled, and the messages outlive the messenger.
        let messenger = unsafe { debug.create_debug_utils_messenger(&info, None) }?;
        Ok(Self { debug, messenger, messages })
    }

    fn end(self) -> Vec<String> {
        // SAFETY: the instance is alive, and nobody else ends it.
        unsafe { self.debug.destroy_debug_utils_messenger(self.messenger, None) };
        self.messages.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer gives valid data, and `messages` is what `Watch::new` gave it.
    let (data, messages) = unsafe { (&*data, &*messages.cast_const().cast::<Mutex<Vec<String>>>()) };
    // SAFETY: the message is a C string or null.
    let text = unsafe { data.message_as_c_str() }.map_or_else(Default::default, CStr::to_string_lossy);
    messages.lock().unwrap_or_else(PoisonError::into_inner).push(text.into_owned());
    vk::FALSE
}
