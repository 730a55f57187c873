//! Core's hazards against a model of memory that knows nothing of them: random lists, in which every access must come after all
//! that it conflicts with, by the waits that were asked for, and no wait may be left out.

use std::collections::HashMap;
use std::sync::Arc;

use proptest::prelude::*;
use tressfx_core::backend::{Backend, Blend, BufferDesc, ComputeDesc, Format, RasterDesc, TextureDesc};
use tressfx_core::hazards::{Access, Hazards, Wait};
use tressfx_core::id::{BufferId, Resource, TextureId};
use tressfx_core::null::NullBackend;
use tressfx_core::pass::{Command, Draw, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Binding, Kernel, RasterPipeline, Shader, ShaderSource, Specialization};

/// The single kinds of access; a set of them is a mask of their places.
const KINDS: [Access; 8] = [
    Access::COMPUTE_READ,
    Access::COMPUTE_WRITE,
    Access::RASTER_READ,
    Access::RASTER_WRITE,
    Access::COPY_READ,
    Access::COPY_WRITE,
    Access::TARGET,
    Access::INDIRECT_READ,
];
const COMPUTE_READ: u8 = 1;
const COMPUTE_WRITE: u8 = 1 << 1;
const RASTER_READ: u8 = 1 << 2;
const RASTER_WRITE: u8 = 1 << 3;
const COPY_READ: u8 = 1 << 4;
const COPY_WRITE: u8 = 1 << 5;
const TARGET: u8 = 1 << 6;
const INDIRECT_READ: u8 = 1 << 7;
const WRITES: u8 = COMPUTE_WRITE | RASTER_WRITE | COPY_WRITE | TARGET;

fn mask(access: Access) -> u8 {
    (0..8).filter(|&kind| access.contains(KINDS[kind])).fold(0, |mask, kind| mask | 1 << kind)
}

/// Something that was done to a resource: an access, or, without kinds, a change of layout.
#[derive(Clone, Copy, Debug)]
struct Event {
    kinds: u8,
    writes: bool,
    /// Accesses of these kinds come after it from now on, and see what it wrote.
    before: u8,
}

/// What is known about a memory in which nothing is in order unless it was waited for.
#[derive(Clone, Debug, Default)]
struct Memory {
    events: HashMap<Resource, Vec<Event>>,
    layouts: HashMap<Resource, u8>,
}

/// How a texture must lie for an access; 0 for buffers, which lie in one way.
fn layout(resource: Resource, kinds: u8) -> u8 {
    match resource {
        Resource::Buffer(_) => 0,
        Resource::Texture(_) if kinds & TARGET != 0 => TARGET,
        Resource::Texture(_) if kinds & COPY_WRITE != 0 => COPY_WRITE,
        Resource::Texture(_) if kinds & COPY_READ != 0 => COPY_READ,
        Resource::Texture(_) if kinds & COMPUTE_WRITE != 0 => COMPUTE_WRITE,
        Resource::Texture(_) => RASTER_READ | COMPUTE_READ,
    }
}

impl Memory {
    /// Waits, and changes the layout where the access to come asks for it.
    fn wait(&mut self, wait: &Wait) -> Result<(), String> {
        let (earlier, later) = (mask(wait.earlier), mask(wait.later));
        let events = self.events.entry(wait.resource).or_default();
        let mut all = true;
        for event in events.iter_mut() {
            // What is waited for, and what came before something that is waited for.
            let waited = event.kinds != 0 && event.kinds & !earlier == 0 || event.before & earlier != 0;
            event.before |= if waited { later } else { 0 };
            all &= waited;
        }
        let wanted = layout(wait.resource, later);
        if self.layouts.insert(wait.resource, wanted).unwrap_or(0) != wanted {
            events.push(Event { kinds: 0, writes: true, before: later });
            return if all { Ok(()) } else { Err(format!("{wait:?} changes the layout under somebody")) };
        }
        Ok(())
    }

    /// Accesses a resource, or says what it races with.
    fn access(&mut self, resource: Resource, kinds: u8) -> Result<(), String> {
        let events = self.events.entry(resource).or_default();
        let conflicts = |event: &&Event| (event.writes || kinds & WRITES != 0) && kinds & !event.before != 0;
        if let Some(event) = events.iter().find(conflicts) {
            return Err(format!("{resource:?}: {kinds:b} races with {event:?}"));
        }
        if self.layouts.get(&resource).copied().unwrap_or(0) != layout(resource, kinds) {
            return Err(format!("{resource:?} does not lie as {kinds:b} takes it"));
        }
        events.push(Event { kinds, writes: kinds & WRITES != 0, before: 0 });
        Ok(())
    }
}

const BUFFERS: usize = 3;
const TEXTURES: usize = 2;

/// One command, by the places of its resources.
#[derive(Clone, Debug)]
enum Step {
    Upload(usize),
    Clear(usize),
    Copy(usize, usize),
    CopyToTexture(usize, usize),
    ReadBuffer(usize),
    ReadTexture(usize),
    Turn(usize, usize),
    Change(usize),
    Indirect(usize, usize),
    Load(usize, usize),
    Store(usize),
    Raster(usize, Vec<Drawn>),
}

/// One draw.
#[derive(Clone, Debug)]
enum Drawn {
    Paint(usize),
    Change(usize),
    Indirect(usize),
    Sample,
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let buffer = 0..BUFFERS;
    let texture = 0..TEXTURES;
    // Two buffers that differ.
    let pair = (0..BUFFERS, 1..BUFFERS).prop_map(|(one, other)| (one, (one + other) % BUFFERS));
    let drawn = prop_oneof![
        buffer.clone().prop_map(Drawn::Paint),
        buffer.clone().prop_map(Drawn::Change),
        buffer.clone().prop_map(Drawn::Indirect),
        Just(Drawn::Sample),
    ];
    let step = prop_oneof![
        buffer.clone().prop_map(Step::Upload),
        buffer.clone().prop_map(Step::Clear),
        pair.clone().prop_map(|(one, other)| Step::Copy(one, other)),
        buffer.clone().prop_map(Step::ReadBuffer),
        texture.clone().prop_map(Step::ReadTexture),
        pair.clone().prop_map(|(one, other)| Step::Turn(one, other)),
        buffer.clone().prop_map(Step::Change),
        pair.prop_map(|(one, other)| Step::Indirect(one, other)),
        (texture.clone(), buffer.clone()).prop_map(|(one, other)| Step::Load(one, other)),
        (buffer, texture.clone()).prop_map(|(one, other)| Step::CopyToTexture(one, other)),
        texture.clone().prop_map(Step::Store),
        (texture, prop::collection::vec(drawn, 0..3)).prop_map(|(target, drawn)| Step::Raster(target, drawn)),
    ];
    prop::collection::vec(step, 1..40)
}

/// Resources and kernels.
struct World {
    buffers: [BufferId; BUFFERS],
    textures: [TextureId; TEXTURES],
    turn: Kernel,
    change: Kernel,
    load: Kernel,
    store: Kernel,
    paint: RasterPipeline,
    change_drawn: RasterPipeline,
    sample: RasterPipeline,
}

const INPUT: &str = "@group(0) @binding(0) var<storage, read> input: array<u32>;";
const OUTPUT: &str = "@group(0) @binding(1) var<storage, read_write> output: array<u32>;";
const PICTURE: &str = "@group(0) @binding(0) var picture: texture_2d<f32>;";
const STORED: &str = "@group(0) @binding(0) var stored: texture_storage_2d<rgba8unorm, write>;";

fn shader(declarations: &[&str], stages: &str) -> Arc<Shader> {
    let text = format!("{}\n{stages}", declarations.concat()).leak();
    let source = ShaderSource { label: "test.kernel", root: ("root", text), library: &[] };
    Arc::new(Shader::new(&source, &Specialization::new()).unwrap())
}

/// A compute pipeline of declarations and one statement.
fn compute(backend: &mut NullBackend, declarations: &[&str], statement: &str) -> Kernel {
    let stage = format!("@compute @workgroup_size(1) fn main() {{ {statement} }}");
    backend.create_compute(&ComputeDesc::new(shader(declarations, &stage))).unwrap()
}

/// A raster pipeline of a declaration and one statement of its fragments.
fn raster(backend: &mut NullBackend, declaration: &str, statement: &str) -> RasterPipeline {
    let stages = format!(
        "@vertex fn vertex() -> @builtin(position) vec4<f32> {{ return vec4<f32>(); }}
        @fragment fn fragment() -> @location(0) vec4<f32> {{ {statement} return vec4<f32>(); }}"
    );
    let desc = RasterDesc::new(shader(&[declaration], &stages)).target(Format::Rgba8, Blend::Replace);
    backend.create_raster(&desc).unwrap()
}

impl World {
    fn new() -> Self {
        let mut backend = NullBackend::default();
        let buffer = BufferDesc::indirect("test.buffer", 16);
        let texture = TextureDesc::new("test.texture", [4, 4], Format::Rgba8).storage();
        Self {
            buffers: [(); BUFFERS].map(|()| backend.create_buffer(&buffer).unwrap()),
            textures: [(); TEXTURES].map(|()| backend.create_texture(&texture).unwrap()),
            turn: compute(&mut backend, &[INPUT, OUTPUT], "output[0] = input[0];"),
            change: compute(&mut backend, &[OUTPUT], "output[0] = 1u;"),
            load: compute(&mut backend, &[PICTURE, OUTPUT], "output[0] = u32(textureLoad(picture, vec2<u32>(), 0).x);"),
            store: compute(&mut backend, &[STORED], "textureStore(stored, vec2<u32>(), vec4<f32>());"),
            paint: raster(&mut backend, INPUT, "let x = input[0];"),
            change_drawn: raster(&mut backend, OUTPUT, "output[0] = 1u;"),
            sample: raster(&mut backend, PICTURE, "let x = textureLoad(picture, vec2<u32>(), 0);"),
        }
    }

    /// The command of a step, and what it does to what.
    fn command(&self, step: &Step) -> (Command, Vec<(Resource, u8)>) {
        let buffer = |i: &usize| Resource::from(self.buffers[*i]);
        let texture = |i: &usize| Resource::from(self.textures[*i]);
        let mut list = PassList::new();
        let mut run = |kernel: &Kernel, bindings: &[(&str, Resource)]| {
            let bindings: Vec<(&str, Binding)> = bindings.iter().map(|&(name, id)| (name, id.into())).collect();
            list.compute(kernel, &kernel.bind(&bindings).unwrap(), Grid([1; 3]));
        };
        let accesses = match step {
            Step::Upload(i) => {
                list.upload(self.buffers[*i], 0, &[1u32]);
                vec![(buffer(i), COPY_WRITE)]
            }
            Step::Clear(i) => {
                list.clear(self.buffers[*i], 0, 4);
                vec![(buffer(i), COPY_WRITE)]
            }
            Step::Copy(i, j) => {
                list.copy(self.buffers[*i], self.buffers[*j], 4);
                vec![(buffer(i), COPY_READ), (buffer(j), COPY_WRITE)]
            }
            Step::ReadBuffer(i) => {
                list.read_buffer(self.buffers[*i], 0, 4);
                vec![(buffer(i), COPY_READ)]
            }
            Step::ReadTexture(i) => {
                list.read_texture(self.textures[*i]);
                vec![(texture(i), COPY_READ)]
            }
            Step::Turn(i, j) => {
                run(&self.turn, &[("input", buffer(i)), ("output", buffer(j))]);
                vec![(buffer(i), COMPUTE_READ), (buffer(j), COMPUTE_READ | COMPUTE_WRITE)]
            }
            Step::Change(i) => {
                run(&self.change, &[("output", buffer(i))]);
                vec![(buffer(i), COMPUTE_READ | COMPUTE_WRITE)]
            }
            Step::Indirect(i, j) => {
                let bindings = self.change.bind(&[("output", buffer(j).into())]).unwrap();
                list.compute_indirect(&self.change, &bindings, self.buffers[*i], 0);
                vec![(buffer(i), INDIRECT_READ), (buffer(j), COMPUTE_READ | COMPUTE_WRITE)]
            }
            Step::Load(i, j) => {
                run(&self.load, &[("picture", texture(i)), ("output", buffer(j))]);
                vec![(texture(i), COMPUTE_READ), (buffer(j), COMPUTE_READ | COMPUTE_WRITE)]
            }
            Step::Store(i) => {
                run(&self.store, &[("stored", texture(i))]);
                vec![(texture(i), COMPUTE_WRITE)]
            }
            Step::CopyToTexture(i, j) => {
                list.copy_to_texture(self.buffers[*i], 0, 256, self.textures[*j]);
                vec![(buffer(i), COPY_READ), (texture(j), COPY_WRITE)]
            }
            Step::Raster(target, drawn) => return self.raster(*target, drawn),
        };
        (list.commands()[0].clone(), accesses)
    }

    fn raster(&self, target: usize, drawn: &[Drawn]) -> (Command, Vec<(Resource, u8)>) {
        // What is drawn to is not sampled.
        let other = Resource::from(self.textures[(target + 1) % TEXTURES]);
        let mut accesses: HashMap<Resource, u8> = HashMap::from([(self.textures[target].into(), TARGET)]);
        let draws = drawn.iter().map(|drawn| {
            if let Drawn::Indirect(i) = drawn {
                let counts = self.buffers[*i];
                *accesses.entry(counts.into()).or_default() |= INDIRECT_READ;
                accesses.entry(other).and_modify(|kinds| *kinds |= RASTER_READ).or_insert(RASTER_READ);
                let bindings = self.sample.bind(&[("picture", other.into())]).unwrap();
                return Draw::indirect(&self.sample, &bindings, counts, 0);
            }
            let (pipeline, name, resource, kinds) = match drawn {
                Drawn::Paint(i) => (&self.paint, "input", self.buffers[*i].into(), RASTER_READ),
                Drawn::Change(i) => (&self.change_drawn, "output", self.buffers[*i].into(), RASTER_READ | RASTER_WRITE),
                Drawn::Sample | Drawn::Indirect(_) => (&self.sample, "picture", other, RASTER_READ),
            };
            *accesses.entry(resource).or_default() |= kinds;
            Draw::new(pipeline, &pipeline.bind(&[(name, resource.into())]).unwrap(), 3, 1)
        });
        let draws = draws.collect();
        let mut pass = RasterPass::new("test.raster").color(self.textures[target], Load::Keep);
        pass.draws = draws;
        (Command::Raster(pass), accesses.into_iter().collect())
    }
}

/// Goes through a list: what was asked for is enough, and each wait is asked for with reason.
fn check(world: &World, steps: &[Step]) -> Result<(), String> {
    let (mut hazards, mut memory) = (Hazards::default(), Memory::default());
    for (place, step) in steps.iter().enumerate() {
        let (command, accesses) = world.command(step);
        let waits = hazards.waits_before(&command);
        for (resource, kinds) in accesses {
            let at = |why: String| format!("command {place}, {step:?}: {why}");
            let mut of_resource = waits.iter().filter(|wait| wait.resource == resource);
            if let Some(wait) = of_resource.next() {
                let without = memory.clone().access(resource, kinds);
                if without.is_ok() || mask(wait.later) != kinds || of_resource.next().is_some() {
                    return Err(at(format!("nobody needs {wait:?}")));
                }
                memory.wait(wait).map_err(at)?;
            }
            memory.access(resource, kinds).map_err(at)?;
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_conflict_is_waited_for_and_nothing_else(steps in steps()) {
        thread_local!(static WORLD: World = World::new());
        WORLD.with(|world| check(world, &steps)).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn the_model_sees_a_wait_that_is_missing() {
    let world = World::new();
    let buffer = Resource::from(world.buffers[0]);
    let mut memory = Memory::default();
    memory.access(buffer, COPY_WRITE).unwrap();
    assert!(memory.clone().access(buffer, COMPUTE_READ).is_err(), "nothing was waited for");
    let wait = Wait { resource: buffer, earlier: Access::COPY_WRITE, later: Access::COMPUTE_READ };
    memory.wait(&wait).unwrap();
    memory.access(buffer, COMPUTE_READ).unwrap();
    assert!(memory.clone().access(buffer, RASTER_READ).is_err(), "other stages have not seen it");
    assert!(memory.clone().access(buffer, COPY_WRITE).is_err(), "it is still being read");
}
