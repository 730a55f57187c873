//! The engine on raw Vulkan, in worse weather than the example's: two frames are in flight all the time, and the validation
//! layer watches.

#[path = "../embed_vulkan/engine.rs"]
mod engine;
#[path = "../embed_vulkan/gpu.rs"]
mod gpu;
#[path = "../embed_vulkan/inside.rs"]
mod inside;
#[path = "../embed_vulkan/memory.rs"]
mod memory;
#[path = "../embed_vulkan/pipeline.rs"]
mod pipeline;
#[path = "../embed_vulkan/sets.rs"]
mod sets;

use engine::Engine;
use gpu::Gpu;
use inside::{import, share};
use tressfx_asset::builtin::Builtin;
use tressfx_backend_vulkan::{EngineCommands, VulkanBackend};
use tressfx_core::backend::{Backend, Format, Record, Run};
use tressfx_core::view::Pose;
use tressfx_examples::{Hair, Stage, head};

const SIZE: [u32; 2] = [96, 64];
const DT: f64 = 1.0 / 60.0;

/// An engine and the hair's backend inside; `None` where there is no adapter and `TRESSFX_NO_GPU` says that this is known.
fn engine(stage: &Stage) -> Option<(Engine, VulkanBackend)> {
    // Without the layer the test is worth less, and still runs.
    let opened = Gpu::open(true).or_else(|_| Gpu::open(false));
    if opened.is_err() && std::env::var_os("TRESSFX_NO_GPU").is_some() {
        return None;
    }
    let engine = Engine::new(opened.unwrap(), stage).unwrap();
    let gpu = share(&engine.gpu);
    Some((engine, gpu))
}

fn frame(engine: &mut Engine, gpu: &mut VulkanBackend, hair: &mut Hair, stage: &Stage, head: Pose) {
    let commands = engine.begin(&stage.shade(&head)).unwrap();
    // SAFETY: the engine has waited for the fences of the frames up to this one.
    unsafe { gpu.mark_finished(engine.finished()) };
    engine.draw_stage(commands);
    // SAFETY: it is being recorded, and is submitted below, before the next is recorded.
    let mut hair_commands = unsafe { EngineCommands::new(gpu, commands) };
    gpu.record(&mut hair_commands, hair.frame(DT, head, &stage.view, &stage.lights).unwrap()).unwrap();
    engine.develop(commands);
    engine.submit(commands, gpu.recorded()).unwrap();
    hair.observe(gpu).unwrap();
}

#[test]
fn targets_change_and_grooms_come_and_go_while_frames_are_in_flight() {
    let groom = Builtin::parse("wavy:200:8").unwrap();
    let stage = Stage::new(&groom, SIZE);
    let Some((mut engine, mut gpu)) = engine(&stage) else { return };
    let grown = |gpu: &mut VulkanBackend, engine: &Engine| {
        let targets = import(gpu, engine, SIZE).unwrap();
        Hair::new(gpu, &groom, &stage.view, Format::Rgba16F, targets).unwrap()
    };
    let mut hair = grown(&mut gpu, &engine);
    let mut peaks = Vec::new();
    for number in 1..=40u32 {
        if number % 3 == 0 {
            let targets = import(&mut gpu, &engine, SIZE).unwrap();
            hair.resize(&mut gpu, &stage.view, targets).unwrap();
        }
        if number % 8 == 0 {
            std::mem::replace(&mut hair, grown(&mut gpu, &engine)).destroy(&mut gpu);
            peaks.push(gpu.memory().bytes);
        }
        frame(&mut engine, &mut gpu, &mut hair, &stage, head(f64::from(number) * DT));
    }
    assert!(peaks.windows(2).all(|pair| pair[0] == pair[1]), "memory grows: {peaks:?}");
    let picture = engine.read_picture().unwrap();
    assert!(picture.chunks(4).any(|pixel| pixel[0] > pixel[2] + 30), "no hair is left in the picture");
    hair.destroy(&mut gpu);
    assert_eq!(gpu.memory().bytes, 0, "what was made is gone");
    drop(gpu);
    assert_eq!(engine.destroy().unwrap(), Vec::<String>::new());
}

#[test]
fn the_engine_may_keep_quiet_between_frames_and_run_lists_in_between() {
    let groom = Builtin::parse("straight:100:6").unwrap();
    let stage = Stage::new(&groom, SIZE);
    let Some((mut engine, mut gpu)) = engine(&stage) else { return };
    let targets = import(&mut gpu, &engine, SIZE).unwrap();
    let mut hair = Hair::new(&mut gpu, &groom, &stage.view, Format::Rgba16F, targets).unwrap();
    for number in 1..=6u32 {
        frame(&mut engine, &mut gpu, &mut hair, &stage, Pose::IDENTITY);
        // The backend submits one of its own, which waits, between two of the engine's that do not.
        let mut list = tressfx_core::pass::PassList::new();
        let ticket = hair.read_positions(&mut list);
        gpu.run(&list).unwrap();
        let positions: Vec<f32> = bytemuck::pod_collect_to_vec(&gpu.read(ticket).ready().unwrap());
        assert!(positions.iter().all(|x| x.is_finite()) && positions.iter().any(|&x| x != 0.0), "frame {number}");
    }
    hair.destroy(&mut gpu);
    drop(gpu);
    assert_eq!(engine.destroy().unwrap(), Vec::<String>::new());
}
