//! Hair in the frame of an engine on raw Vulkan. The engine owns instance, device, allocator, command buffers, images,
//! barriers and passes, and has two frames in flight; the hair writes its passes between two of the engine's.
//!
//! `cargo run --release -p tressfx-examples --example embed_vulkan -- [--validate] [OUT.png [GROOM [FRAMES [WIDTHxHEIGHT]]]]`

mod engine;
mod gpu;
mod inside;
mod memory;
mod pipeline;
mod sets;

use anyhow::{Result, ensure};
use tressfx_backend_vulkan::EngineCommands;
use tressfx_core::backend::{Backend, Format, Record};
use tressfx_examples::{Args, Hair, Stage, head};

use engine::Engine;
use gpu::Gpu;
use inside::{import, share};

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
        let commands = engine.begin(&stage.shade(&head))?;
        // SAFETY: the engine has waited for the frame before the last: it is over, and what it used may go.
        unsafe { gpu.mark_finished(engine.finished()) };
        engine.draw_stage(commands);
        // SAFETY: it is being recorded, and is submitted below, before the next is recorded.
        let mut hair_commands = unsafe { EngineCommands::new(&gpu, commands) };
        gpu.record(&mut hair_commands, hair.frame(DT, head, &stage.view, &stage.lights)?)?;
        engine.develop(commands);
        engine.submit(commands, gpu.recorded())?;
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
