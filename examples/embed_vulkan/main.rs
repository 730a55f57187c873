//! Hair in the frame of an engine on raw Vulkan. The engine owns instance, device, allocator, command buffers, images,
//! barriers and passes, and has two frames in flight; the hair writes its passes between two of the engine's.
//!
//! `cargo run --release -p tressfx-examples --example embed_vulkan -- [--validate] [OUT.png [GROOM [FRAMES [WIDTHxHEIGHT]]]]`

mod engine;
mod gpu;
mod memory;
mod pipeline;
mod sets;

use anyhow::{Result, ensure};
use tressfx_backend_vulkan::{Enabled, Import, VulkanBackend, VulkanDesc};
use tressfx_core::backend::{Backend, Format, Record, TextureDesc};
use tressfx_examples::{Args, Hair, Stage, head};
use tressfx_render::Targets;

use engine::Engine;
use gpu::Gpu;

/// Seconds from frame to frame.
const DT: f64 = 1.0 / 60.0;

fn main() -> Result<()> {
    let args = Args::read(std::env::args().skip(1), "embed_vulkan.png")?;
    let stage = Stage::new(&args.groom, args.size);
    let mut engine = Engine::new(Gpu::open(args.validate)?, &stage)?;
    let mut gpu = share(&engine.gpu);
    let targets = import(&mut gpu, &engine, args.size)?;
    let mut hair = Hair::new(&mut gpu, &args.groom, &stage.view, Format::Rgba16F, targets)?;

    for frame in 1..=args.frames {
        let head = head(f64::from(frame) * DT);
        let mut commands = engine.begin(&stage.shade(&head))?;
        engine.draw_stage(commands);
        gpu.record(&mut commands, hair.frame(DT, head, &stage.view, &stage.lights)?)?;
        engine.develop(commands);
        engine.submit(commands)?;
        hair.observe(&mut gpu)?;
    }

    let texels = engine.read_picture()?;
    image::save_buffer(&args.out, &texels, args.size[0], args.size[1], image::ColorType::Rgba8)?;
    println!("{}: {} frames on {}, {} barriers", args.out, args.frames, gpu.caps().adapter, gpu.barriers());

    // The hair goes before the device that it lives on.
    hair.destroy(&mut gpu);
    drop(gpu);
    let messages = engine.destroy()?;
    ensure!(messages.is_empty(), "the validation layer says: {}", messages.join("\n"));
    Ok(())
}

/// The hair on the engine's device.
fn share(engine: &Gpu) -> VulkanBackend {
    let desc = VulkanDesc {
        instance: engine.instance.clone(),
        physical_device: engine.physical_device,
        device: engine.device.clone(),
        queue: engine.queue,
        queue_family: engine.queue_family,
        allocator: engine.allocator.clone(),
        // The engine enabled nothing that is not required; so the shaders keep their accesses within bounds by themselves.
        enabled: Enabled { debug_utils: engine.is_watched(), ..Enabled::default() },
        pipeline_cache: None,
    };
    // SAFETY: they belong together and outlive the backend, the device has what is required, and one thread does
    // everything. All command buffers are submitted, in order.
    unsafe { VulkanBackend::new(desc) }
}

/// The engine's images, with the use in which the hair finds them and the use in which it leaves them.
fn import(gpu: &mut VulkanBackend, engine: &Engine, size: [u32; 2]) -> Result<Targets> {
    let light = TextureDesc { label: "engine.light", size, format: Format::Rgba16F };
    let depth = TextureDesc { label: "engine.depth", size, format: Format::Depth32F };
    // SAFETY: they are images of this device, made with these sizes and formats, to be drawn to and sampled; and they live
    // until the backend is gone.
    unsafe {
        Ok(Targets {
            // The engine has just drawn to it, and samples it next.
            color: gpu.import_texture(engine.light.image, &light, Import::COLOR_TARGET, Import::SAMPLED)?,
            // It stays a depth target: the engine might go on drawing.
            depth: gpu.import_texture(engine.depth.image, &depth, Import::DEPTH_TARGET, Import::DEPTH_TARGET)?,
        })
    }
}
