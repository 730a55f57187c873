//! Hair in the frame of an engine on wgpu. The engine owns device, queue, encoder, textures and passes; the hair writes its
//! passes between two of them.
//!
//! `cargo run --release -p tressfx-examples --example embed_wgpu -- [OUT.png [GROOM [FRAMES [WIDTHxHEIGHT]]]]`

mod engine;

use anyhow::{Result, ensure};
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::{Backend, Format, Record};
use tressfx_examples::{Args, Hair, Stage, head};
use tressfx_render::Targets;

use engine::Engine;

/// Seconds from frame to frame.
const DT: f64 = 1.0 / 60.0;

fn main() -> Result<()> {
    let args = Args::read(std::env::args().skip(1), "embed_wgpu.png")?;
    ensure!(!args.validate, "--validate is for embed_vulkan: wgpu validates everything anyway");
    let stage = Stage::new(&args.groom, args.size);
    let engine = Engine::new(&stage)?;

    // Clones of device and queue are the same device and queue. Textures stay the engine's.
    let mut gpu = WgpuBackend::new(engine.device.clone(), engine.queue.clone());
    let color = gpu.import_texture("engine.light", engine.light.clone())?;
    let depth = gpu.import_texture("engine.depth", engine.depth.clone())?;
    let mut hair = Hair::new(&mut gpu, &args.groom, &stage.view, Format::Rgba16F, Targets::new(color, depth))?;

    for frame in 1..=args.frames {
        let head = head(f64::from(frame) * DT);
        let mut encoder = engine.begin(&stage.shade(&head));
        engine.draw_stage(&mut encoder);
        gpu.record(&mut encoder, hair.frame(DT, head, &stage.view, &stage.lights)?)?;
        engine.develop(&mut encoder);
        engine.queue.submit([encoder.finish()]);
        hair.observe(&mut gpu)?;
    }

    let texels = engine.read_picture()?;
    image::save_buffer(&args.out, &texels, args.size[0], args.size[1], image::ColorType::Rgba8)?;
    hair.destroy(&mut gpu);
    println!("{}: {} frames on {}", args.out, args.frames, gpu.caps().adapter);
    Ok(())
}
