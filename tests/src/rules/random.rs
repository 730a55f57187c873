//! Random lists: most of what they name is sound, and some of it is not. What a backend does not refuse, it must run.

use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Command, Count, Draw, Grid, Groups, Load, PassList, RasterPass, Viewport};
use tressfx_core::shader::{Binding, Bindings, Sampler};

use super::passes::{looked, mixed, run, triangle};
use super::world::{BYTES, Passes, World};

/// Numbers that are the same everywhere (splitmix64, Steele et al. 2014).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    fn below(&mut self, count: u64) -> u64 {
        self.next() % count
    }

    /// Once in so many times.
    fn once_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len() as u64) as usize]
    }
}

/// How seldom something is wrong: once in so many choices.
const SELDOM: u64 = 40;

/// A list of a few commands; the same for the same seed.
pub fn random_list(world: &World, seed: u64) -> PassList {
    let mut dice = Dice(seed);
    let base = world.sound();
    let count = 1 + dice.below(8);
    let commands = (0..count).map(|_| command(world, &mut dice)).collect();
    base.with_commands(commands)
}

fn buffer(world: &World, dice: &mut Dice) -> BufferId {
    if dice.once_in(SELDOM) {
        return dice.of(&[world.gone, world.foreign, world.copy_source, world.copy_target, world.storage]);
    }
    dice.of(&[world.buffer, world.other])
}

fn texture(world: &World, dice: &mut Dice, sound: &[TextureId]) -> TextureId {
    if dice.once_in(SELDOM) {
        let unfit = [world.gone_texture, world.foreign_texture, world.sampled, world.target, world.depth, world.uint];
        return dice.of(&unfit);
    }
    dice.of(sound)
}

/// A place or a size within a buffer.
fn bytes(dice: &mut Dice) -> u64 {
    match dice.below(SELDOM) {
        0 => dice.of(&[2, u64::MAX - 3, BYTES + 4, u64::MAX / 2]),
        1..5 => dice.of(&[0, BYTES, BYTES - 4]),
        _ => 4 * dice.below(BYTES / 8),
    }
}

fn command(world: &World, dice: &mut Dice) -> Command {
    let mut list = PassList::new();
    match dice.below(9) {
        0 => {
            let (dst, offset, end) = (buffer(world, dice), bytes(dice), 4 * dice.below(33) as usize);
            list.push(Command::Upload { dst, offset, data: 4 * dice.below(end as u64 / 4 + 1) as usize..end });
        }
        1 => list.clear(buffer(world, dice), bytes(dice), bytes(dice)),
        2 => {
            let (src, dst) = (buffer(world, dice), buffer(world, dice));
            let (src_offset, dst_offset) = (bytes(dice), bytes(dice));
            list.push(Command::Copy { src, src_offset, dst, dst_offset, bytes: bytes(dice) });
        }
        3 => {
            let row_bytes = if dice.once_in(SELDOM) { 100 } else { 256 * (1 + dice.below(2) as u32) };
            let dst =
                texture(world, dice, &[world.color, world.second, world.half, world.wide, world.float, world.uint]);
            list.copy_to_texture(buffer(world, dice), bytes(dice) / 8 * 8, row_bytes, dst);
        }
        4 => drop(list.read_buffer(buffer(world, dice), bytes(dice), bytes(dice))),
        5 => {
            let src =
                texture(world, dice, &[world.color, world.half, world.depth, world.uint, world.float, world.wide]);
            list.read_texture(src);
        }
        6 | 7 => match &world.passes {
            Some(passes) => return compute(world, passes, dice),
            None => list.clear(world.buffer, 0, 4),
        },
        _ => match &world.passes {
            Some(passes) => return raster(world, passes, dice),
            None => list.clear(world.buffer, 4, 4),
        },
    }
    list.commands()[0].clone()
}

/// A part of a buffer that is bound.
fn part(world: &World, dice: &mut Dice, sound: BufferId) -> Binding {
    let id = if dice.once_in(SELDOM) { buffer(world, dice) } else { sound };
    let aligned = BYTES / world.alignment.max(256);
    match dice.below(8) {
        0..3 => id.into(),
        3..7 => id.range(world.alignment.max(256) * dice.below(aligned), 64 + 4 * dice.below(40)),
        _ => id.range(bytes(dice), bytes(dice)),
    }
}

fn groups(world: &World, dice: &mut Dice) -> Groups {
    match dice.below(12) {
        0 => Groups::Grid(Grid([dice.below(3) as u32, 1, 65_535 + dice.below(2) as u32 * dice.below(2) as u32])),
        // The marker holds nothing but zeros.
        1 | 2 => Groups::Indirect { buffer: world.marker, offset: bytes(dice) },
        _ => Groups::Grid(Grid([dice.below(4) as u32, 1 + dice.below(3) as u32, 1])),
    }
}

fn compute(world: &World, passes: &Passes, dice: &mut Dice) -> Command {
    let how = groups(world, dice);
    let sound = [world.color, world.second, world.half, world.sampled];
    match dice.below(4) {
        0 => {
            let [uniform, input, output] = mixed(world);
            let input = if dice.once_in(2) { part(world, dice, world.buffer) } else { input };
            let output = if dice.once_in(2) { part(world, dice, world.other) } else { output };
            run(&passes.mix, &[uniform, input, output], how)
        }
        1 => run(&passes.twice, &[part(world, dice, world.buffer), part(world, dice, world.other)], how),
        2 => {
            let mut bindings = looked(world);
            bindings[0] = texture(world, dice, &sound).into();
            bindings[1] = texture(world, dice, &sound).into();
            bindings[2] = dice.of(&[Sampler::Linear, Sampler::Nearest]).into();
            bindings[5] = part(world, dice, world.other);
            run(&passes.look, &bindings, how)
        }
        _ => {
            let read = texture(world, dice, &sound);
            run(&passes.store, &[passes.stored.into(), read.into()], how)
        }
    }
}

fn raster(world: &World, passes: &Passes, dice: &mut Dice) -> Command {
    let color = texture(world, dice, &[world.color, world.second, passes.stored, world.target]);
    let load = match dice.below(SELDOM) {
        0 => Load::Clear([f32::NAN; 4]),
        n if n % 2 == 0 => Load::Keep,
        _ => Load::Clear([0.25; 4]),
    };
    let mut pass = RasterPass::new("rules.random").color(color, load);
    if dice.once_in(3) {
        pass = pass.depth(world.depth, dice.of(&[Load::Keep, Load::Clear(1.0), Load::Clear(0.0)]));
    }
    if dice.once_in(3) {
        let most = if dice.once_in(SELDOM) { 12 } else { 5 };
        let mut edge = || dice.below(most) as u32;
        pass = pass.viewport(Viewport { origin: [edge(), edge()], size: [1 + edge() / 2, 1 + edge() / 2] });
    }
    for _ in 0..dice.below(4) {
        let has_depth = pass.depth.is_some();
        pass = pass.draw(draw(world, passes, dice, has_depth));
    }
    Command::Raster(pass)
}

fn draw(world: &World, passes: &Passes, dice: &mut Dice, has_depth: bool) -> Draw {
    let uniform = part(world, dice, world.uniform);
    let sound = [world.color, world.second, world.half, world.sampled];
    let picture = [texture(world, dice, &sound).into(), dice.of(&[Sampler::Linear, Sampler::Nearest]).into()];
    let mut draw = match dice.below(6) {
        _ if has_depth && !dice.once_in(SELDOM) => triangle(&passes.deep, &[uniform]),
        0 | 1 => triangle(&passes.fill, &[uniform]),
        2 => triangle(&passes.sample, &picture),
        3 => triangle(&passes.pull, &[part(world, dice, world.buffer)]),
        4 => match &passes.write {
            Some(write) => triangle(write, &[part(world, dice, world.other)]),
            None => triangle(&passes.two, &[]),
        },
        _ => Draw::new(&passes.fill, &Bindings::new(&[uniform]), dice.below(4) as u32, dice.below(3) as u32),
    };
    if dice.once_in(4) {
        draw.count = Count::Indirect { buffer: world.marker, offset: bytes(dice) };
    }
    draw
}
