//! A small engine on raw Vulkan, without hair in it yet: its device under the eyes of the validation layer, its memory, its
//! command buffers.

use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex};

use tressfx_backend_vulkan::ash::{self, ext, vk};
use tressfx_backend_vulkan::gpu_allocator::MemoryLocation;
use tressfx_backend_vulkan::gpu_allocator::vulkan::{
    Allocation, AllocationCreateDesc, AllocationScheme, Allocator, AllocatorCreateDesc,
};
use tressfx_backend_vulkan::{Enabled, VulkanDesc, lock_loader};

/// A device and everything that the engine made from it. It panics at its end if the validation layer had something to say
/// that nobody took.
pub(crate) struct Engine {
    _entry: ash::Entry,
    instance: ash::Instance,
    debug: ext::debug_utils::Instance,
    messenger: vk::DebugUtilsMessengerEXT,
    /// Where the messages go; the callback has its address.
    messages: Arc<Mutex<Vec<String>>>,
    physical_device: vk::PhysicalDevice,
    pub(crate) device: ash::Device,
    queue: vk::Queue,
    family: u32,
    pool: vk::CommandPool,
    /// `None` once it has given its memory back.
    allocator: Option<Arc<Mutex<Allocator>>>,
    buffers: Vec<(vk::Buffer, Allocation)>,
    images: Vec<(vk::Image, vk::ImageView, Allocation)>,
}

impl Engine {
    pub(crate) fn new() -> Result<Self, String> {
        let _alone = lock_loader();
        // SAFETY: the loader is what the system has; it stays as long as the engine.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| error.to_string())?;
        let instance = instance(&entry)?;
        let messages = Arc::new(Mutex::new(Vec::new()));
        let debug = ext::debug_utils::Instance::new(&entry, &instance);
        let messenger = listen(&debug, &messages)?;
        let (physical_device, family) = adapter(&instance)?;
        let device = device(&instance, physical_device, family)?;
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.clone(),
            device: device.clone(),
            physical_device,
            debug_settings: Default::default(),
            buffer_device_address: false,
            allocation_sizes: Default::default(),
        });
        let allocator = Some(Arc::new(Mutex::new(allocator.map_err(|error| error.to_string())?)));
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(family);
        // SAFETY: the family has one queue, and it was asked for.
        let (queue, pool) = unsafe { (device.get_device_queue(family, 0), device.create_command_pool(&info, None)) };
        let pool = pool.map_err(|error| error.to_string())?;
        let (buffers, images) = (Vec::new(), Vec::new());
        Ok(Self {
            _entry: entry,
            instance,
            debug,
            messenger,
            messages,
            physical_device,
            device,
            queue,
            family,
            pool,
            allocator,
            buffers,
            images,
        })
    }

    /// What a backend is told about the engine.
    pub(crate) fn desc(&self) -> VulkanDesc {
        let (instance, device, allocator) = (self.instance.clone(), self.device.clone(), self.allocator.clone());
        let queue = (self.queue, self.family);
        let mut desc = VulkanDesc::new(instance, self.physical_device, device, queue, allocator.unwrap());
        desc.enabled = Enabled { debug_utils: true, ..Enabled::default() };
        desc
    }

    /// What the validation layer said since the last call.
    pub(crate) fn said(&self) -> Vec<String> {
        std::mem::take(&mut self.messages.lock().unwrap())
    }

    #[track_caller]
    pub(crate) fn assert_silent(&self) {
        assert_eq!(self.said(), [""; 0], "the validation layer is heard");
    }

    /// Bytes that were taken from the allocator and not given back, by whomever.
    pub(crate) fn allocated(&self) -> u64 {
        self.allocator.as_ref().unwrap().lock().unwrap().generate_report().total_allocated_bytes
    }

    fn allocate(&self, requirements: vk::MemoryRequirements, location: MemoryLocation, linear: bool) -> Allocation {
        let allocation_scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name: "engine", requirements, location, linear, allocation_scheme };
        self.allocator.as_ref().unwrap().lock().unwrap().allocate(&desc).unwrap()
    }

    /// A buffer with content.
    pub(crate) fn buffer(&mut self, bytes: &[u8]) -> vk::Buffer {
        let copied = vk::BufferUsageFlags::TRANSFER_SRC | vk::BufferUsageFlags::TRANSFER_DST;
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER | copied;
        let info = vk::BufferCreateInfo::default().size(bytes.len() as u64).usage(usage);
        // SAFETY: the device is alive, and what is bound together is new.
        unsafe {
            let buffer = self.device.create_buffer(&info, None).unwrap();
            let requirements = self.device.get_buffer_memory_requirements(buffer);
            let mut memory = self.allocate(requirements, MemoryLocation::CpuToGpu, true);
            self.device.bind_buffer_memory(buffer, memory.memory(), memory.offset()).unwrap();
            memory.mapped_slice_mut().unwrap()[..bytes.len()].copy_from_slice(bytes);
            self.buffers.push((buffer, memory));
            buffer
        }
    }

    /// A texture without content, and a view of it.
    pub(crate) fn image(&mut self, size: [u32; 2], format: vk::Format) -> (vk::Image, vk::ImageView) {
        let drawn = match format {
            vk::Format::D32_SFLOAT => vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            _ => vk::ImageUsageFlags::COLOR_ATTACHMENT,
        };
        let copied = vk::ImageUsageFlags::TRANSFER_SRC | vk::ImageUsageFlags::TRANSFER_DST;
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width: size[0], height: size[1], depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(drawn | vk::ImageUsageFlags::SAMPLED | copied);
        // SAFETY: the device is alive, and what is bound together is new.
        unsafe {
            let image = self.device.create_image(&info, None).unwrap();
            let requirements = self.device.get_image_memory_requirements(image);
            let memory = self.allocate(requirements, MemoryLocation::GpuOnly, false);
            self.device.bind_image_memory(image, memory.memory(), memory.offset()).unwrap();
            let info = vk::ImageViewCreateInfo::default()
                .image(image)
                .view_type(vk::ImageViewType::TYPE_2D)
                .format(format)
                .subresource_range(whole(format));
            let view = self.device.create_image_view(&info, None).unwrap();
            self.images.push((image, view, memory));
            (image, view)
        }
    }

    /// A command buffer that is being recorded.
    pub(crate) fn begin(&self) -> vk::CommandBuffer {
        let info = vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
        let once = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the pool is alive.
        unsafe {
            let commands = self.device.allocate_command_buffers(&info).unwrap()[0];
            self.device.begin_command_buffer(commands, &once).unwrap();
            commands
        }
    }

    /// Submits a command buffer and does not wait.
    pub(crate) fn submit(&self, commands: vk::CommandBuffer) {
        let commands = [vk::CommandBufferSubmitInfo::default().command_buffer(commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&commands)];
        // SAFETY: it is being recorded, and the queue is used by this thread only.
        unsafe {
            self.device.end_command_buffer(commands[0].command_buffer).unwrap();
            self.device.queue_submit2(self.queue, &submit, vk::Fence::null()).unwrap();
        }
    }

    /// Waits for everything that was submitted.
    pub(crate) fn wait(&self) {
        // SAFETY: the queue is used by this thread only.
        unsafe { self.device.queue_wait_idle(self.queue) }.unwrap();
    }

    /// Throws a command buffer away.
    pub(crate) fn discard(&self, commands: vk::CommandBuffer) {
        // SAFETY: it was never submitted.
        unsafe { self.device.free_command_buffers(self.pool, &[commands]) };
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        // SAFETY: everything has run, and a backend on the device is gone by now.
        unsafe {
            self.device.device_wait_idle().unwrap();
            let allocator = self.allocator.take().unwrap();
            for (buffer, memory) in self.buffers.drain(..) {
                self.device.destroy_buffer(buffer, None);
                allocator.lock().unwrap().free(memory).unwrap();
            }
            for (image, view, memory) in self.images.drain(..) {
                self.device.destroy_image_view(view, None);
                self.device.destroy_image(image, None);
                allocator.lock().unwrap().free(memory).unwrap();
            }
            drop(allocator);
            self.device.destroy_command_pool(self.pool, None);
            let _alone = lock_loader();
            // What is left on the device by now is said here.
            self.device.destroy_device(None);
            self.debug.destroy_debug_utils_messenger(self.messenger, None);
            self.instance.destroy_instance(None);
        }
        if !std::thread::panicking() {
            self.assert_silent();
        }
    }
}

/// The only level and layer of a texture.
pub(crate) fn whole(format: vk::Format) -> vk::ImageSubresourceRange {
    let depth = format == vk::Format::D32_SFLOAT;
    let aspect_mask = if depth { vk::ImageAspectFlags::DEPTH } else { vk::ImageAspectFlags::COLOR };
    vk::ImageSubresourceRange { aspect_mask, level_count: 1, layer_count: 1, ..Default::default() }
}

fn instance(entry: &ash::Entry) -> Result<ash::Instance, String> {
    let (layers, extensions) = ([c"VK_LAYER_KHRONOS_validation".as_ptr()], [ext::debug_utils::NAME.as_ptr()]);
    let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_3);
    let mut features = vk::ValidationFeaturesEXT::default()
        .enabled_validation_features(&[vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION]);
    let info = vk::InstanceCreateInfo::default()
        .application_info(&application)
        .enabled_layer_names(&layers)
        .enabled_extension_names(&extensions)
        .push_next(&mut features);
    // SAFETY: all pointers live until the call is over.
    unsafe { entry.create_instance(&info, None) }.map_err(|error| format!("no instance with validation: {error}"))
}

fn listen(
    debug: &ext::debug_utils::Instance,
    messages: &Arc<Mutex<Vec<String>>>,
) -> Result<vk::DebugUtilsMessengerEXT, String> {
    use vk::{DebugUtilsMessageSeverityFlagsEXT as Severity, DebugUtilsMessageTypeFlagsEXT as Kind};
    let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(Severity::WARNING | Severity::ERROR)
        .message_type(Kind::GENERAL | Kind::VALIDATION | Kind::PERFORMANCE)
        .pfn_user_callback(Some(on_message))
        .user_data(Arc::as_ptr(messages).cast_mut().cast());
    // SAFETY: the messages outlive the messenger.
    unsafe { debug.create_debug_utils_messenger(&info, None) }.map_err(|error| error.to_string())
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer gives valid data, and `messages` is what `listen` gave it.
    let (data, messages) = unsafe { (&*data, &*messages.cast_const().cast::<Mutex<Vec<String>>>()) };
    // SAFETY: the message is a C string or null.
    let text = unsafe { data.message_as_c_str() }.map_or_else(Default::default, CStr::to_string_lossy);
    // SAFETY: as above.
    let name = unsafe { data.message_id_name_as_c_str() }.map_or_else(Default::default, CStr::to_string_lossy);
    messages.lock().unwrap().push(format!("{name} {text}"));
    vk::FALSE
}

/// The first adapter with Vulkan 1.3, and its first family with graphics and compute.
fn adapter(instance: &ash::Instance) -> Result<(vk::PhysicalDevice, u32), String> {
    let both = vk::QueueFlags::GRAPHICS | vk::QueueFlags::COMPUTE;
    // SAFETY: the instance is alive.
    let found = unsafe { instance.enumerate_physical_devices() }.unwrap_or_default().into_iter().find_map(|adapter| {
        // SAFETY: as above.
        let (properties, families) = unsafe {
            let properties = instance.get_physical_device_properties(adapter);
            (properties, instance.get_physical_device_queue_family_properties(adapter))
        };
        let family = families.iter().position(|family| family.queue_flags.contains(both))?;
        (properties.api_version >= vk::API_VERSION_1_3).then_some((adapter, family as u32))
    });
    found.ok_or_else(|| String::from("no adapter with Vulkan 1.3"))
}

fn device(instance: &ash::Instance, adapter: vk::PhysicalDevice, family: u32) -> Result<ash::Device, String> {
    let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0])];
    let mut core13 = vk::PhysicalDeviceVulkan13Features::default().synchronization2(true).dynamic_rendering(true);
    let info = vk::DeviceCreateInfo::default().queue_create_infos(&queues).push_next(&mut core13);
    // SAFETY: the features are those that the backend requires, and all pointers live until the call is over.
    unsafe { instance.create_device(adapter, &info, None) }.map_err(|error| error.to_string())
}
