//! Where the driver refuses something half way, or loses the device: nothing is left behind, and every answer is an error.

use std::sync::Arc;

use tressfx_backend_vulkan::ash::vk;
use tressfx_conformance::embed::Embed;
use tressfx_core::backend::{
    Backend, Blend, BufferDesc, ComputeDesc, Format, Owner, RasterDesc, ReadBack, Record, Run, TextureDesc,
};
use tressfx_core::error::{Error, Result};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Sampler, Shader, ShaderSource, Specialization};

use super::Game;
use super::promises::game;

const SAMPLE: ShaderSource = ShaderSource {
    label: "test.sample",
    root: (
        "root",
        "@group(0) @binding(0) var<uniform> factor: vec4<f32>;
        @group(0) @binding(1) var picture: texture_2d<f32>;
        @group(0) @binding(2) var linear: sampler;
        @group(0) @binding(3) var<storage, read_write> values: array<f32>;
        @compute @workgroup_size(4) fn sample(@builtin(local_invocation_index) i: u32) {
            values[i] = factor.x * textureSampleLevel(picture, linear, vec2<f32>(0.5), 0.0).x;
        }",
    ),
    library: &[],
};

const DRAW: ShaderSource = ShaderSource {
    label: "test.draw",
    root: (
        "root",
        "@vertex fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
            return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.5, 1.0);
        }
        @fragment fn paint() -> @location(0) vec4<f32> { return vec4<f32>(0.5); }",
    ),
    library: &[],
};

fn shader(source: &ShaderSource) -> Arc<Shader> {
    Arc::new(Shader::new(source, &Specialization::new()).unwrap())
}

/// A list that needs one of everything.
fn everything(backend: &mut dyn Backend, shaders: &[Arc<Shader>; 2]) -> Result<PassList> {
    let factor = backend.create_buffer(&BufferDesc::uniform("test.factor", 16))?;
    let values = backend.create_buffer(&BufferDesc::storage("test.values", 16))?;
    let picture = backend.create_texture(&TextureDesc::new("test.picture", [16, 16], Format::Rgba8))?;
    let kernel = backend.create_compute(&ComputeDesc::new(shaders[0].clone()))?;
    let desc = RasterDesc::new(shaders[1].clone()).target(Format::Rgba8, Blend::Over);
    let pipeline = backend.create_raster(&desc)?;
    let sampler = Sampler::Linear.into();
    let named =
        [("factor", factor.into()), ("picture", picture.into()), ("linear", sampler), ("values", values.into())];
    let bindings = kernel.bind(&named)?;
    let mut list = PassList::new();
    list.upload(factor, 0, &[1.0f32; 4]);
    let draw = Draw::new(&pipeline, &pipeline.bind(&[])?, 3, 1);
    list.raster(RasterPass::new("test.draw").color(picture, Load::Clear([0.0; 4])).draw(draw));
    list.compute(&kernel, &bindings, Grid([1; 3]));
    list.read_buffer(values, 0, 16);
    list.read_texture(picture);
    Ok(list)
}

/// Makes everything, runs it, records it for the engine, and frees it.
fn use_everything(game: &mut Game, shaders: &[Arc<Shader>; 2]) -> Result<()> {
    let (list, owner) = Owner::build(&mut game.hair, |backend| everything(backend, shaders))?;
    let ran = game.hair.run(&list);
    let mut encoder = game.begin();
    let recorded = ran.and_then(|()| game.hair.record(&mut encoder, &list));
    match recorded {
        Ok(()) => game.submit(encoder),
        Err(_) => game.discard(encoder),
    }
    owner.destroy(&mut game.hair);
    recorded
}

#[test]
fn what_is_refused_half_way_leaves_nothing_behind() {
    let Some(mut game) = game() else { return };
    let shaders = [shader(&SAMPLE), shader(&DRAW)];
    let mut refused = 0;
    loop {
        game.hair.plant_failure(refused, vk::Result::ERROR_OUT_OF_DEVICE_MEMORY);
        let answer = use_everything(&mut game, &shaders);
        if game.hair.unplant_failure() {
            answer.unwrap();
            break;
        }
        let error = answer.expect_err("something was refused");
        assert!(matches!(error, Error::OutOfMemory { .. }), "call {refused}: {error}");
        assert_eq!(game.hair.memory().bytes, 0, "call {refused}");
        game.wait();
        refused += 1;
    }
    println!("{refused} calls were refused");
    assert!(refused > 30, "{refused} calls can fail");
    game.wait();
    assert_eq!(game.hair.memory().bytes, 0);
    // What is left on the device is said at its end.
    let Game { hair, engine, .. } = game;
    drop(hair);
    assert_eq!(engine.allocated(), 0);
}

#[test]
fn a_lost_device_is_an_error_everywhere_and_nothing_is_awaited_from_it() {
    let shaders = [shader(&SAMPLE), shader(&DRAW)];
    for call in (0..).step_by(5) {
        let Some(mut game) = game() else { return };
        let values = game.hair.create_buffer(&BufferDesc::storage("test.values", 16)).unwrap();
        let mut list = PassList::new();
        let ticket = list.read_buffer(values, 0, 16);
        // Recorded, and not submitted before the device is lost.
        let mut encoder = game.begin();
        game.hair.record(&mut encoder, &list).unwrap();
        assert_eq!(game.hair.read(ticket), ReadBack::Pending);
        game.submit(encoder);
        game.hair.plant_failure(call, vk::Result::ERROR_DEVICE_LOST);
        let answer = use_everything(&mut game, &shaders);
        if game.hair.unplant_failure() {
            answer.unwrap();
            game.wait();
            return;
        }
        for answer in [answer, use_everything(&mut game, &shaders), game.hair.run(&list)] {
            assert!(matches!(answer, Err(Error::DeviceLost { .. })), "call {call}: {answer:?}");
        }
        assert_ne!(game.hair.read(ticket), ReadBack::Pending, "call {call}");
        game.wait();
    }
}
