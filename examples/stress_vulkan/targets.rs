//! The engine's images, which it draws to together with the hair, and which live until nobody uses them any more.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::PoisonError;

use anyhow::Result;
use tressfx_backend_vulkan::ash::vk;
use tressfx_backend_vulkan::gpu_allocator::MemoryLocation;
use tressfx_backend_vulkan::gpu_allocator::vulkan::{Allocation, AllocationCreateDesc, AllocationScheme};
use tressfx_backend_vulkan::{EngineUse, VulkanBackend};
use tressfx_core::backend::{Format, TextureDesc, TextureUses};
use tressfx_core::id::Resource;
use tressfx_render::Targets;

use crate::gpu::Gpu;

/// Light and depth of one size, and room for a copy of the light.
pub(crate) struct Images {
    pub(crate) size: [u32; 2],
    pub(crate) light: vk::Image,
    pub(crate) depth: vk::Image,
    pub(crate) copy: vk::Buffer,
    memory: Vec<Allocation>,
    /// Under which the hair knows them, or knew them.
    ids: RefCell<Vec<Resource>>,
}

/// Images that were replaced.
#[derive(Default)]
pub(crate) struct Replaced(Vec<Rc<Images>>);

impl Images {
    pub(crate) fn new(gpu: &Gpu, size: [u32; 2]) -> Result<Self> {
        use vk::ImageUsageFlags as I;
        let copied = I::TRANSFER_SRC | I::TRANSFER_DST | I::SAMPLED;
        let mut memory = Vec::new();
        let light = gpu.image(size, vk::Format::R16G16B16A16_SFLOAT, I::COLOR_ATTACHMENT | copied, &mut memory)?;
        let depth = gpu.image(size, vk::Format::D32_SFLOAT, I::DEPTH_STENCIL_ATTACHMENT | copied, &mut memory)?;
        let bytes = 8 * u64::from(size[0]) * u64::from(size[1]);
        let info = vk::BufferCreateInfo::default().size(bytes).usage(vk::BufferUsageFlags::TRANSFER_DST);
        // SAFETY: the device is alive, and the memory is as the buffer requires.
        let copy = unsafe {
            let copy = gpu.device.create_buffer(&info, None)?;
            let requirements = gpu.device.get_buffer_memory_requirements(copy);
            let bytes = gpu.allocate(requirements, MemoryLocation::GpuToCpu, true)?;
            gpu.device.bind_buffer_memory(copy, bytes.memory(), bytes.offset())?;
            memory.push(bytes);
            copy
        };
        Ok(Self { size, light, depth, copy, memory, ids: RefCell::default() })
    }

    /// The images, as the hair finds them and leaves them. Each groom has ids of its own: one list leaves them as the next
    /// finds them.
    pub(crate) fn import(&self, hair: &mut VulkanBackend) -> Result<Targets> {
        let uses = TextureUses::TARGET | TextureUses::SAMPLED;
        let light = TextureDesc::new("engine.light", self.size, Format::Rgba16F).with_uses(uses);
        let depth = TextureDesc::new("engine.depth", self.size, Format::Depth32F).with_uses(uses);
        let (color, tested) = (EngineUse::COLOR_TARGET, EngineUse::DEPTH_TARGET);
        // SAFETY: they are images of this device, made so, and live until the backend says that it uses them no more.
        let targets = unsafe {
            let color = hair.import_texture(self.light, &light, color, color)?;
            Targets::new(color, hair.import_texture(self.depth, &depth, tested, tested)?)
        };
        self.ids.borrow_mut().extend([Resource::from(targets.color), targets.depth.into()]);
        Ok(targets)
    }
}

impl Replaced {
    pub(crate) fn add(&mut self, images: Rc<Images>) {
        self.0.push(images);
    }

    /// Frees what nobody uses any more.
    pub(crate) fn free(&mut self, gpu: &Gpu, hair: &VulkanBackend) {
        let unused = |images: &mut Rc<Images>| {
            Rc::strong_count(images) == 1 && !images.ids.borrow().iter().any(|&id| hair.uses(id))
        };
        for images in self.0.extract_if(.., unused) {
            if let Some(images) = Rc::into_inner(images) {
                gpu.destroy(images);
            }
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Gpu {
    fn allocate(
        &self,
        requirements: vk::MemoryRequirements,
        location: MemoryLocation,
        linear: bool,
    ) -> Result<Allocation> {
        let allocation_scheme = AllocationScheme::GpuAllocatorManaged;
        let desc = AllocationCreateDesc { name: "engine", requirements, location, linear, allocation_scheme };
        Ok(self.allocator.lock().unwrap_or_else(PoisonError::into_inner).allocate(&desc)?)
    }

    /// An image that both queues use.
    fn image(
        &self,
        [width, height]: [u32; 2],
        format: vk::Format,
        usage: vk::ImageUsageFlags,
        memory: &mut Vec<Allocation>,
    ) -> Result<vk::Image> {
        let families = [self.frames.1, self.copies.1];
        let mut info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(format)
            .extent(vk::Extent3D { width, height, depth: 1 })
            .mip_levels(1)
            .array_layers(1)
            .samples(vk::SampleCountFlags::TYPE_1)
            .usage(usage);
        if families[0] != families[1] {
            info = info.sharing_mode(vk::SharingMode::CONCURRENT).queue_family_indices(&families);
        }
        // SAFETY: the device is alive, and the memory is as the image requires.
        unsafe {
            let image = self.device.create_image(&info, None)?;
            let bytes =
                self.allocate(self.device.get_image_memory_requirements(image), MemoryLocation::GpuOnly, false)?;
            self.device.bind_image_memory(image, bytes.memory(), bytes.offset())?;
            memory.push(bytes);
            Ok(image)
        }
    }

    pub(crate) fn destroy(&self, images: Images) {
        // SAFETY: nobody uses them any more.
        unsafe {
            self.device.destroy_image(images.light, None);
            self.device.destroy_image(images.depth, None);
            self.device.destroy_buffer(images.copy, None);
        }
        for memory in images.memory {
            // It fails for memory of another allocator only.
            let _ = self.allocator.lock().unwrap_or_else(PoisonError::into_inner).free(memory);
        }
    }
}
