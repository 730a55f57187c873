//! The engine's device: a queue for frames, a second one where the device has it, the validation layer, and a count of every
//! call that waits.

use std::ffi::{CStr, c_void};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use anyhow::{Context, Result};
use tressfx_backend_vulkan::ash::{Device, Entry, Instance, ext, vk};
use tressfx_backend_vulkan::gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use tressfx_backend_vulkan::{Enabled, VulkanBackend, VulkanDesc};

/// Calls that wait for a device or a queue, by whomever.
static IDLE_WAITS: AtomicU64 = AtomicU64::new(0);
/// Calls that wait for fences.
static FENCE_WAITS: AtomicU64 = AtomicU64::new(0);
/// The driver's own functions, which the counted ones call.
static DRIVER: OnceLock<Waits> = OnceLock::new();

struct Waits {
    device: vk::PFN_vkDeviceWaitIdle,
    queue: vk::PFN_vkQueueWaitIdle,
    fences: vk::PFN_vkWaitForFences,
}

/// How often anybody has waited for a device or a queue, and for fences.
pub(crate) fn waits() -> [u64; 2] {
    [&IDLE_WAITS, &FENCE_WAITS].map(|count| count.load(Ordering::Relaxed))
}

unsafe extern "system" fn device_wait_idle(device: vk::Device) -> vk::Result {
    IDLE_WAITS.fetch_add(1, Ordering::Relaxed);
    // SAFETY: as the caller promises.
    DRIVER.get().map_or(vk::Result::SUCCESS, |driver| unsafe { (driver.device)(device) })
}

unsafe extern "system" fn queue_wait_idle(queue: vk::Queue) -> vk::Result {
    IDLE_WAITS.fetch_add(1, Ordering::Relaxed);
    // SAFETY: as above.
    DRIVER.get().map_or(vk::Result::SUCCESS, |driver| unsafe { (driver.queue)(queue) })
}

unsafe extern "system" fn wait_for_fences(
    device: vk::Device,
    count: u32,
    fences: *const vk::Fence,
    all: vk::Bool32,
    timeout: u64,
) -> vk::Result {
    FENCE_WAITS.fetch_add(1, Ordering::Relaxed);
    // SAFETY: as above.
    DRIVER.get().map_or(vk::Result::SUCCESS, |driver| unsafe { (driver.fences)(device, count, fences, all, timeout) })
}

/// A queue and its family.
pub(crate) type Queue = (vk::Queue, u32);

/// Everything that an engine starts with. It frees nothing where it fails on the way: the program ends then.
pub(crate) struct Gpu {
    instance: Instance,
    physical_device: vk::PhysicalDevice,
    pub(crate) device: Device,
    /// For frames, with the hair in them.
    pub(crate) frames: Queue,
    /// For copies; the same where the device has one queue.
    pub(crate) copies: Queue,
    pub(crate) allocator: Arc<Mutex<Allocator>>,
    watch: Option<Watch>,
    /// The loader stays as long as anything of Vulkan is used.
    _entry: Entry,
}

/// What listens to the validation layer.
struct Watch {
    debug: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    messages: Arc<Mutex<Vec<String>>>,
}

impl Gpu {
    pub(crate) fn open(validate: bool) -> Result<Self> {
        // SAFETY: the loader is the system's.
        let entry = unsafe { Entry::load() }.context("no Vulkan: install a driver, or a software Vulkan")?;
        let instance = instance(&entry, validate)?;
        let watch = validate.then(|| Watch::new(&entry, &instance)).transpose()?;
        let (physical_device, families) = pick(&instance)?;
        let [frames, copies] = families;
        let device = device(&instance, physical_device, families)?;
        // SAFETY: the device was made with these queues.
        let [frames, copies] = unsafe {
            let second = if copies.1 == 1 { 1 } else { 0 };
            [(frames.0, 0), (copies.0, second)].map(|(family, index)| (device.get_device_queue(family, index), family))
        };
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        })?;
        let allocator = Arc::new(Mutex::new(allocator));
        Ok(Self { instance, physical_device, device, frames, copies, allocator, watch, _entry: entry })
    }

    /// The hair on this device.
    pub(crate) fn share(&self) -> VulkanBackend {
        let (instance, device, allocator) = (self.instance.clone(), self.device.clone(), self.allocator.clone());
        let mut desc = VulkanDesc::new(instance, self.physical_device, device, self.frames, allocator);
        desc.enabled = Enabled { debug_utils: self.watch.is_some(), ..Enabled::default() };
        // SAFETY: they belong together and outlive the backend, the device has what is required, and one thread does
        // everything. The engine waits for its last frame before the backend goes.
        unsafe { VulkanBackend::new(desc) }
    }

    /// Bytes that were taken from the allocator and not given back, by whomever.
    pub(crate) fn allocated(&self) -> u64 {
        self.allocator.lock().unwrap_or_else(PoisonError::into_inner).generate_report().total_allocated_bytes
    }

    /// Frees everything and says what the validation layer had to say. Nothing that was made from the device may be left.
    pub(crate) fn close(self) -> Vec<String> {
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

/// A family of queues, and how many others it has beside those that are in use.
type Family = (u32, u32);

/// The first adapter with Vulkan 1.3 and a queue for graphics and compute, a real GPU before a software one; and the family of
/// its second queue: another one, or the same where it has two, or the same queue.
fn pick(instance: &Instance) -> Result<(vk::PhysicalDevice, [Family; 2])> {
    let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    let copies = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE | vk::QueueFlags::TRANSFER;
    // SAFETY: the instance is alive.
    let mut adapters = unsafe { instance.enumerate_physical_devices() }?;
    // SAFETY: as above.
    let properties = |adapter| unsafe { instance.get_physical_device_properties(adapter) };
    adapters.retain(|&adapter| properties(adapter).api_version >= vk::API_VERSION_1_3);
    adapters.sort_by_key(|&adapter| properties(adapter).device_type == vk::PhysicalDeviceType::CPU);
    let with_queues = |adapter| {
        // SAFETY: as above.
        let families = unsafe { instance.get_physical_device_queue_family_properties(adapter) };
        let frames = families.iter().position(|family| family.queue_flags.contains(both))?;
        let mut others = families.iter().enumerate().filter(|&(index, _)| index != frames);
        let other = others.find(|(_, family)| family.queue_flags.intersects(copies)).map(|(index, _)| index as u32);
        let same = (frames as u32, u32::from(families[frames].queue_count > 1));
        Some((adapter, [(frames as u32, 0), other.map_or(same, |family| (family, 0))]))
    };
    adapters.into_iter().find_map(with_queues).context("no adapter with Vulkan 1.3")
}

/// A device with what the hair requires, and timeline semaphores.
fn device(instance: &Instance, adapter: vk::PhysicalDevice, [frames, copies]: [Family; 2]) -> Result<Device> {
    let priorities = [1.0, 1.0];
    let queues = |family, count: usize| {
        vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities[..count])
    };
    let queues = match frames.0 == copies.0 {
        true => vec![queues(frames.0, 1 + copies.1 as usize)],
        false => vec![queues(frames.0, 1), queues(copies.0, 1)],
    };
    let mut core12 = vk::PhysicalDeviceVulkan12Features::default().timeline_semaphore(true);
    let mut core13 = vk::PhysicalDeviceVulkan13Features::default().synchronization2(true).dynamic_rendering(true);
    let info =
        vk::DeviceCreateInfo::default().queue_create_infos(&queues).push_next(&mut core12).push_next(&mut core13);
    // SAFETY: all pointers live until the call is over.
    let made = unsafe { instance.create_device(adapter, &info, None) }?;
    let driver = made.fp_v1_0();
    let waits =
        Waits { device: driver.device_wait_idle, queue: driver.queue_wait_idle, fences: driver.wait_for_fences };
    // One device a process.
    let _ = DRIVER.set(waits);
    let find = instance.fp_v1_0().get_device_proc_addr;
    // SAFETY: the functions are the device's own; those that wait have counting ones of the same kind before them.
    let counted = unsafe {
        Device::load_with(
            |name| match name.to_bytes() {
                b"vkDeviceWaitIdle" => device_wait_idle as *const c_void,
                b"vkQueueWaitIdle" => queue_wait_idle as *const c_void,
                b"vkWaitForFences" => wait_for_fences as *const c_void,
                _ => find(made.handle(), name.as_ptr()).map_or(std::ptr::null(), |found| found as *const c_void),
            },
            made.handle(),
        )
    };
    Ok(counted)
}

impl Watch {
    fn new(entry: &Entry, instance: &Instance) -> Result<Self> {
        use vk::{DebugUtilsMessageSeverityFlagsEXT as Severity, DebugUtilsMessageTypeFlagsEXT as Type};
        let debug = ext::debug_utils::Instance::new(entry, instance);
        let messages = Arc::new(Mutex::new(Vec::new()));
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(Severity::WARNING | Severity::ERROR)
            .message_type(Type::GENERAL | Type::VALIDATION | Type::PERFORMANCE)
            .pfn_user_callback(Some(on_message))
            .user_data(Arc::as_ptr(&messages).cast_mut().cast());
        // SAFETY: the extension is enabled, and the messages outlive the messenger.
        let messenger = unsafe { debug.create_debug_utils_messenger(&info, None) }?;
        Ok(Self { debug, messenger, messages })
    }

    fn end(self) -> Vec<String> {
        // SAFETY: the instance is alive, and nobody else ends it.
        unsafe { self.debug.destroy_debug_utils_messenger(self.messenger, None) };
        std::mem::take(&mut self.messages.lock().unwrap_or_else(PoisonError::into_inner))
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
