//! Mistakes in uploads, clears, copies and read-backs.

use tressfx_core::id::BufferId;
use tressfx_core::pass::{Command, PassList};

use super::Mistakes;
use super::world::{BYTES, World};

/// No multiple of 4 is larger.
const HUGE: u64 = u64::MAX - 3;

pub(super) fn mistakes(world: &World, found: &mut Mistakes) {
    let ticket = PassList::new().read_buffer(world.buffer, 0, 4);
    let upload = |dst, offset, bytes: u64| Command::Upload { dst, offset, data: 0..(bytes as usize).min(128) };
    let clear = |dst, offset, bytes| Command::Clear { dst, offset, bytes };
    let from = |src, src_offset, bytes| Command::Copy { src, src_offset, dst: world.other, dst_offset: 0, bytes };
    let to = |dst, dst_offset, bytes| Command::Copy { src: world.other, src_offset: 0, dst, dst_offset, bytes };
    let read = |src, offset, bytes| Command::ReadBuffer { src, offset, bytes, ticket };
    uploads(world, found);
    ranges("upload", world, found, world.copy_source, false, upload);
    ranges("clear", world, found, world.copy_source, true, clear);
    ranges("copy from", world, found, world.copy_target, true, from);
    ranges("copy to", world, found, world.copy_source, true, to);
    ranges("read", world, found, world.copy_target, true, read);
    found.add("copy to itself", from(world.other, 64, 16), "to itself");
    let far = Command::Copy { src: world.buffer, src_offset: 2048, dst: world.buffer, dst_offset: 0, bytes: 16 };
    found.add("copy within a buffer", far, "to itself");
    rows(world, found);
    let read = |src| Command::ReadTexture { src, ticket };
    found.add("read a texture that is not copied from", read(world.target), "was not made for");
    found.add("read a texture that is gone", read(world.gone_texture), "is no texture of this backend");
    found.add("read a texture of another", read(world.foreign_texture), "is no texture of this backend");
}

/// Mistakes in a part of a buffer. `unfit` is a buffer that was not made for this.
fn ranges(
    name: &str,
    world: &World,
    found: &mut Mistakes,
    unfit: BufferId,
    any_size: bool,
    command: impl Fn(BufferId, u64, u64) -> Command,
) {
    let mut add = |what: &str, id, offset, bytes, says| {
        found.add(format!("{name}: {what}"), command(id, offset, bytes), says);
    };
    let outside = "it has 4096";
    add("past the end by a word", world.buffer, BYTES - 12, 16, outside);
    add("behind the end", world.buffer, BYTES + 4, 4, outside);
    add("nothing, behind the end", world.buffer, BYTES + 4, 0, outside);
    add("an offset that overflows", world.buffer, HUGE, 4, outside);
    add("an offset that overflows to the start", world.buffer, HUGE, 8, outside);
    add("an odd offset", world.buffer, 2, 4, "2 is not a multiple of 4");
    add("a buffer for something else", unfit, 0, 4, "was not made for");
    add("a buffer for shaders alone", world.storage, 0, 4, "was not made for");
    add("a buffer that is gone", world.gone, 0, 4, "is no buffer of this backend");
    add("a buffer of another backend", world.foreign, 0, 4, "is no buffer of this backend");
    add("an odd size", world.buffer, 0, 6, "6 is not a multiple of 4");
    if any_size {
        add("more than there is", world.buffer, 0, BYTES + 4, outside);
        add("a size that overflows", world.buffer, 8, HUGE, outside);
        add("the largest size", world.buffer, 0, HUGE, outside);
    }
}

/// Mistakes in what an upload takes from its list, which holds 128 bytes.
fn uploads(world: &World, found: &mut Mistakes) {
    let mut add = |what: &str, data| {
        let command = Command::Upload { dst: world.buffer, offset: 0, data };
        found.add(format!("upload: {what}"), command, "of a list that holds 128");
    };
    add("bytes past the end of the list", 124..132);
    add("bytes behind the end of the list", 256..260);
    add("bytes beyond all memory", usize::MAX - 3..usize::MAX);
    #[allow(clippy::reversed_empty_ranges, reason = "that is the mistake")]
    add("bytes that end before they begin", 8..4);
}

/// Mistakes in copies to textures.
fn rows(world: &World, found: &mut Mistakes) {
    let command = |src, offset, row_bytes, dst| Command::CopyToTexture { src, offset, row_bytes, dst };
    let mut add = |what: &str, command, says| found.add(format!("copy to texture: {what}"), command, says);
    // Eight rows of 32 bytes; and four of 512.
    let sound = |offset, row_bytes| command(world.buffer, offset, row_bytes, world.color);
    add("an offset between texels", sound(4, 256), "offset 4");
    add("rows that are not aligned", sound(0, 100), "rows of 100");
    add("rows of nothing", sound(0, 0), "rows of 0 bytes");
    add("rows that are too short", command(world.buffer, 0, 256, world.wide), "rows of 256 bytes, `wide` has 512");
    add("past the end", sound(BYTES - 7 * 256 - 24, 256), "it has 4096");
    add("rows that are too far apart", sound(0, 1024), "it has 4096");
    add("rows as far apart as can be", sound(0, u32::MAX - 255), "it has 4096");
    add("an offset that overflows", sound(u64::MAX - 7, 256), "it has 4096");
    add("a texture of depth", command(world.buffer, 0, 256, world.depth), "was not made for");
    add("a texture that is not copied to", command(world.buffer, 0, 256, world.target), "was not made for");
    add("a texture that is gone", command(world.buffer, 0, 256, world.gone_texture), "is no texture of this backend");
    add("a texture of another", command(world.buffer, 0, 256, world.foreign_texture), "is no texture of this backend");
    add("a buffer that is not copied from", command(world.copy_target, 0, 256, world.color), "was not made for");
    add("a buffer that is gone", command(world.gone, 0, 256, world.color), "is no buffer of this backend");
    add("a buffer of another", command(world.foreign, 0, 256, world.color), "is no buffer of this backend");
}
