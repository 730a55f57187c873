//! Mistakes in compute and raster passes.

use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Command, ComputePass, Draw, Grid, Groups, Load, RasterPass, Viewport};
use tressfx_core::shader::{Binding, Bindings, Kernel, RasterPipeline, Sampler};

use super::Mistakes;
use super::world::{BYTES, Passes, World};

pub(super) const ONE: Groups = Groups::Grid(Grid([1; 3]));
const NO_BUFFER: &str = "is no buffer of this backend";
const NO_TEXTURE: &str = "is no texture of this backend";
const OUTSIDE: &str = "it has 4096";

pub(super) fn mistakes(world: &World, passes: &Passes, found: &mut Mistakes) {
    grids(world, passes, found);
    kernels(world, passes, found);
    buffers(world, passes, found);
    textures(world, passes, found);
    aliases(world, passes, found);
    targets(world, found);
    viewports(world, found);
    draws(world, passes, found);
}

/// A pass of a kernel.
pub(super) fn run(kernel: &Kernel, bindings: &[Binding], groups: Groups) -> Command {
    Command::Compute(ComputePass::new(kernel.clone(), Bindings::new(bindings), groups))
}

/// What `mix` binds.
pub(super) fn mixed(world: &World) -> [Binding; 3] {
    [world.uniform.range(0, 16), world.buffer.into(), world.other.into()]
}

/// What `look` binds.
pub(super) fn looked(world: &World) -> [Binding; 6] {
    let (color, half, depth) = (world.color.into(), world.half.into(), world.depth.into());
    [color, half, Sampler::Linear.into(), world.uint.into(), depth, world.other.into()]
}

fn grids(world: &World, passes: &Passes, found: &mut Mistakes) {
    for axis in 0..3 {
        for groups in [Grid::MAX_GROUPS + 1, u32::MAX] {
            let mut grid = [1; 3];
            grid[axis] = groups;
            let command = run(&passes.mix, &mixed(world), Groups::Grid(Grid(grid)));
            found.add(format!("{groups} groups along axis {axis}"), command, "exceeds 65535 groups");
        }
    }
    let mut add = |what: &str, buffer, offset, says| {
        let bindings = [world.uniform.range(0, 16), world.storage.into(), world.other.into()];
        let command = run(&passes.mix, &bindings, Groups::Indirect { buffer, offset });
        found.add(format!("number of groups: {what}"), command, says);
    };
    add("an odd offset", world.buffer, 6, "6 is not a multiple of 4");
    add("past the end", world.buffer, BYTES - 8, OUTSIDE);
    add("an offset that overflows", world.buffer, u64::MAX - 3, OUTSIDE);
    add("a buffer for something else", world.copy_source, 0, "was not made for");
    add("a buffer that is gone", world.gone, 0, NO_BUFFER);
    add("a buffer of another", world.foreign, 0, NO_BUFFER);
    add("bound as well", world.other, 0, "is bound in the same pass");
}

fn kernels(world: &World, passes: &Passes, found: &mut Mistakes) {
    let forged = |pipeline, shader: &Kernel| Kernel { pipeline, shader: shader.shader.clone() };
    for (what, kernel, says) in [
        ("a kernel that is gone", passes.gone_kernel.clone(), "is no compute pipeline of this backend"),
        ("a kernel of another", passes.foreign_kernel.clone(), "is no compute pipeline of this backend"),
        ("a raster pipeline as a kernel", forged(passes.fill.pipeline, &passes.mix), "is no compute pipeline"),
        ("the shader of another kernel", forged(passes.twice.pipeline, &passes.mix), "was made from another shader"),
        ("the same shader, made again", forged(passes.mix.pipeline, &passes.foreign_kernel), "from another shader"),
    ] {
        found.add(what, run(&kernel, &mixed(world), ONE), says);
    }
}

/// Mistakes in one binding of `mix`.
fn buffers(world: &World, passes: &Passes, found: &mut Mistakes) {
    let sound = mixed(world);
    let mut add = |what: &str, place: usize, binding: Binding, says| {
        let mut bindings = sound;
        bindings[place] = binding;
        let name = ["params", "input", "output"][place];
        found.add(format!("`{name}`: {what}"), run(&passes.mix, &bindings, ONE), says);
    };
    let rest = |id: BufferId, offset| Binding::Buffer { id, offset, bytes: None };
    for place in 0..3 {
        let (fit, unfit) = if place == 0 { (world.uniform, world.buffer) } else { (world.buffer, world.uniform) };
        let fit = if place == 2 { world.other } else { fit };
        let unaligned = world.alignment / 2;
        if unaligned >= 4 {
            add("an offset that is not aligned", place, fit.range(unaligned, 256), "is not a multiple of");
        }
        add("an odd offset", place, fit.range(1, 256), "is not a multiple of");
        add("a size that is no multiple of 4", place, fit.range(0, 254), "254 bytes");
        add("nothing", place, fit.range(0, 0), "0 bytes of");
        add("past the end", place, fit.range(BYTES - 256, 512), OUTSIDE);
        add("behind the end", place, fit.range(2 * BYTES, 256), OUTSIDE);
        add("all from the end on", place, rest(fit, BYTES), "0 bytes of");
        add("all from behind the end on", place, rest(fit, 2 * BYTES), OUTSIDE);
        add("an offset that overflows", place, fit.range(u64::MAX - 255, 256), OUTSIDE);
        add("a size that overflows", place, fit.range(256, u64::MAX - 255), OUTSIDE);
        add("a buffer for something else", place, unfit.into(), "was not made for");
        add("a buffer for copies alone", place, world.copy_target.into(), "was not made for");
        add("a buffer that is gone", place, world.gone.into(), NO_BUFFER);
        add("a buffer of another", place, world.foreign.into(), NO_BUFFER);
        add("a texture", place, world.color.into(), "bound is Texture");
        add("a sampler", place, Sampler::Nearest.into(), "bound is Sampler");
    }
    add("less than the shader reads", 0, world.uniform.range(0, 12), "12 bytes of `uniform`, the shader reads 16");
    add("less than the shader reads", 1, world.buffer.range(0, 60), "60 bytes of `buffer`, the shader reads 64");
    if let Some(large) = passes.large_uniform {
        add("more than the device binds", 0, large.into(), "the device binds");
    }
    found.add("no bindings", run(&passes.mix, &[], ONE), "0 of 3 bindings");
    found.add("a binding too few", run(&passes.mix, &sound[..2], ONE), "2 of 3 bindings");
    let more = [&sound[..], &[world.storage.into()]].concat();
    found.add("a binding too many", run(&passes.mix, &more, ONE), "4 of 3 bindings");
}

/// Mistakes in one binding of `look` and `store`.
fn textures(world: &World, passes: &Passes, found: &mut Mistakes) {
    let mut add = |what: &str, place: usize, binding: Binding, says| {
        let mut bindings = looked(world);
        bindings[place] = binding;
        let name = ["plain", "filtered", "how", "ints", "depths", "output"][place];
        found.add(format!("`{name}`: {what}"), run(&passes.look, &bindings, ONE), says);
    };
    for place in [0, 1, 3, 4] {
        add("a texture that is gone", place, world.gone_texture.into(), NO_TEXTURE);
        add("a texture of another", place, world.foreign_texture.into(), NO_TEXTURE);
        add("a texture that is drawn to alone", place, world.target.into(), "was not made for");
        add("a buffer", place, world.storage.into(), "bound is Buffer");
        add("a sampler", place, Sampler::Linear.into(), "bound is Sampler");
    }
    add("a texture", 2, world.color.into(), "bound is Texture");
    add("a buffer", 2, world.buffer.into(), "bound is Buffer");
    for (place, texture, format) in [
        (0, world.uint, "has the format R32Uint"),
        (0, world.depth, "has the format Depth32F"),
        (1, world.float, "has the format R32F"),
        (1, world.uint, "has the format R32Uint"),
        (1, world.depth, "has the format Depth32F"),
        (3, world.color, "has the format Rgba8"),
        (3, world.float, "has the format R32F"),
        (4, world.color, "has the format Rgba8"),
        (4, world.float, "has the format R32F"),
    ] {
        add(format, place, texture.into(), format);
    }
    let mut add = |what: &str, written: Binding, says| {
        found.add(format!("`written`: {what}"), run(&passes.store, &[written, world.sampled.into()], ONE), says);
    };
    add("a texture that is not written", world.color.into(), "was not made for");
    add("a texture of another", world.foreign_texture.into(), NO_TEXTURE);
    add("a buffer", world.buffer.into(), "bound is Buffer");
}

/// What is written must not be bound twice.
fn aliases(world: &World, passes: &Passes, found: &mut Mistakes) {
    let alias = "are the same resource, and it is written";
    let uniform = mixed(world)[0];
    let ranges = [world.other.range(0, 256), world.other.range(2048, 256)];
    for (what, command) in [
        ("read and written", run(&passes.mix, &[uniform, world.other.into(), world.other.into()], ONE)),
        ("read and written in two parts", run(&passes.mix, &[uniform, ranges[0], ranges[1]], ONE)),
        ("written twice", run(&passes.twice, &[world.other.into(), world.other.into()], ONE)),
        ("written in two parts", run(&passes.twice, &ranges, ONE)),
        ("a texture read and written", run(&passes.store, &[passes.stored.into(), passes.stored.into()], ONE)),
    ] {
        found.add(what, command, alias);
    }
}

const BLACK: Load<[f32; 4]> = Load::Clear([0.0; 4]);

fn pass() -> RasterPass {
    RasterPass::new("rules.pass")
}

/// Mistakes in targets, in passes without draws.
fn targets(world: &World, found: &mut Mistakes) {
    let color = |id: TextureId| pass().color(id, BLACK);
    let mut add = |what: &str, pass, says| found.add(what, Command::Raster(pass), says);
    add("no target", pass(), "has no target");
    add("a target that is gone", color(world.gone_texture), NO_TEXTURE);
    add("a target of another", color(world.foreign_texture), NO_TEXTURE);
    add("a target that is not drawn to", color(world.sampled), "was not made for");
    add("a target twice", color(world.color).color(world.color, Load::Keep), "is a target twice");
    add("targets of two sizes", color(world.color).color(world.wide, BLACK), "has the size [128, 4]");
    add("depth of another size", color(world.wide).depth(world.depth, Load::Keep), "has the size [8, 8]");
    add("depth as a colour", color(world.depth), "is no such target");
    add("a colour as depth", pass().depth(world.color, Load::Keep), "is no such target");
    add("depth that is gone", color(world.color).depth(world.gone_texture, Load::Keep), NO_TEXTURE);
    add("depth of another", color(world.color).depth(world.foreign_texture, Load::Keep), NO_TEXTURE);
    for value in [-0.1, 1.1, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let pass = pass().depth(world.depth, Load::Clear(value));
        add(&format!("depth cleared to {value}"), pass, "it is from 0 to 1");
    }
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let pass = pass().color(world.color, Load::Clear([0.0, 0.0, value, 0.0]));
        add(&format!("a colour cleared to {value}"), pass, "is not finite");
    }
    for value in [-1.0, 0.5, 4_294_967_296.0] {
        let pass = pass().color(world.uint, Load::Clear([value, 0.0, 0.0, 0.0]));
        add(&format!("an integer cleared to {value}"), pass, "is no unsigned integer");
    }
}

fn viewports(world: &World, found: &mut Mistakes) {
    for (origin, size) in [
        ([0, 0], [9, 8]),
        ([0, 0], [8, 9]),
        ([8, 0], [1, 8]),
        ([0, 7], [8, 2]),
        ([0, 0], [0, 8]),
        ([0, 0], [8, 0]),
        ([u32::MAX, 0], [1, 8]),
        ([4, 0], [u32::MAX - 1, 8]),
    ] {
        let pass = pass().color(world.color, BLACK).viewport(Viewport { origin, size });
        let what = format!("a viewport at {origin:?} of {size:?}");
        found.add(what, Command::Raster(pass), "is empty or leaves targets");
    }
}

/// A draw of a triangle.
pub(super) fn triangle(pipeline: &RasterPipeline, bindings: &[Binding]) -> Draw {
    Draw::new(pipeline, &Bindings::new(bindings), 3, 1)
}

fn draws(world: &World, passes: &Passes, found: &mut Mistakes) {
    let uniform = [world.uniform.range(0, 16)];
    let fill = |pipeline: &RasterPipeline| triangle(pipeline, &uniform);
    let forged = |pipeline, like: &RasterPipeline| RasterPipeline { pipeline, shader: like.shader.clone() };
    let on = |target, draw| pass().color(target, BLACK).draw(draw);
    let mut add = |what: &str, pass, says| found.add(what, Command::Raster(pass), says);
    let none = "is no raster pipeline of this backend";
    add("a pipeline that is gone", on(world.color, fill(&passes.gone_pipeline)), none);
    add("a pipeline of another", on(world.color, fill(&passes.foreign_pipeline)), none);
    add("a kernel as a pipeline", on(world.color, fill(&forged(passes.mix.pipeline, &passes.fill))), none);
    let other = forged(passes.deep.pipeline, &passes.two);
    add("the shader of another pipeline", on(world.color, fill(&other)), "was made from another shader");
    add("another format", on(world.half, fill(&passes.fill)), "it was made for targets of [Rgba8]");
    add("a target too many", on(world.color, fill(&passes.fill)).color(world.second, BLACK), "it was made for targets");
    add("a target too few", on(world.color, triangle(&passes.two, &[])), "it was made for targets");
    add("no depth", on(world.color, fill(&passes.deep)), "the pass has no depth");
    let deep = on(world.color, fill(&passes.fill)).depth(world.depth, Load::Clear(1.0));
    add("depth that the pipeline has not", deep, "the pass has a depth");
    let second = on(world.color, fill(&passes.fill)).draw(triangle(&passes.fill, &[]));
    add("the second draw", second, "draw 1, `fill`: 0 of 1 bindings");
    add("a texture for a uniform", on(world.color, triangle(&passes.fill, &[world.second.into()])), "bound is Texture");
    let odd = triangle(&passes.fill, &[world.uniform.range(2, 16)]);
    add("an odd offset", on(world.color, odd), "is not a multiple of");
    let short = triangle(&passes.fill, &[world.uniform.range(0, 8)]);
    add("less than the shader reads", on(world.color, short), "the shader reads 16");
    let sampled = |texture: TextureId| triangle(&passes.sample, &[texture.into(), Sampler::Linear.into()]);
    add("its own target", on(world.color, sampled(world.color)), "is drawn to and bound in the same pass");
    add("a texture that is gone", on(world.color, sampled(world.gone_texture)), NO_TEXTURE);
    add("a texture that is not filtered", on(world.color, sampled(world.float)), "has the format R32F");
    indirect_draws(world, passes, found);
    fragment_writes(world, passes, found);
    let begin = pass();
    let many = (0..=world.max_targets).fold(begin, |pass, _| pass.color(world.color, BLACK));
    found.add("more targets than there are", Command::Raster(many), "");
}

fn indirect_draws(world: &World, passes: &Passes, found: &mut Mistakes) {
    let bindings = Bindings::new(&[world.uniform.range(0, 16)]);
    let mut add = |what: &str, buffer, offset, says| {
        let draw = Draw::indirect(&passes.fill, &bindings, buffer, offset);
        found.add(
            format!("an indirect draw: {what}"),
            Command::Raster(pass().color(world.color, BLACK).draw(draw)),
            says,
        );
    };
    add("an odd offset", world.buffer, 2, "2 is not a multiple of 4");
    add("past the end", world.buffer, BYTES - 12, OUTSIDE);
    add("an offset that overflows", world.buffer, u64::MAX - 3, OUTSIDE);
    add("a buffer for something else", world.copy_source, 0, "was not made for");
    add("a buffer that is gone", world.gone, 0, NO_BUFFER);
    add("a buffer of another", world.foreign, 0, NO_BUFFER);
}

/// What fragments write is used in no other way in the pass.
fn fragment_writes(world: &World, passes: &Passes, found: &mut Mistakes) {
    let Some(write) = &passes.write else { return };
    let alike = "is written and read in the same pass";
    let written = triangle(write, &[world.other.into()]);
    let read = triangle(&passes.pull, &[world.other.into()]);
    let begin = || pass().color(world.color, BLACK).draw(written.clone());
    found.add("written, then read", Command::Raster(begin().draw(read.clone())), alike);
    let turned = pass().color(world.color, BLACK).draw(read).draw(written.clone());
    found.add("read, then written", Command::Raster(turned), alike);
    let bindings = Bindings::new(&[world.uniform.range(0, 16)]);
    let counted = Draw::indirect(&passes.fill, &bindings, world.other, 0);
    found.add("written, then counts", Command::Raster(begin().draw(counted)), alike);
}
