//! What was recorded and never ran, on raw Vulkan: nothing waits for it, whether the engine says so or not.

use tressfx_conformance::embed::Embed;
use tressfx_core::backend::{Backend, BufferDesc, Format, ReadBack, Record, TextureDesc};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Load, PassList, RasterPass, Ticket};

use super::Game;
use super::promises::game;

fn buffer(game: &mut Game) -> BufferId {
    game.hair.create_buffer(&BufferDesc::storage("test.buffer", 16)).unwrap()
}

fn texture(game: &mut Game) -> TextureId {
    game.hair.create_texture(&TextureDesc::new("test.texture", [64, 2], Format::Rgba8)).unwrap()
}

/// Fills a buffer and draws to a texture, and reads the buffer back.
fn list(values: BufferId, texture: TextureId, value: u32) -> (PassList, Ticket) {
    let mut list = PassList::new();
    list.upload(values, 0, &[value; 4]);
    list.raster(RasterPass::new("test.clear").color(texture, Load::Clear([0.5; 4])));
    list.read_texture(texture);
    let ticket = list.read_buffer(values, 0, 16);
    (list, ticket)
}

fn bytes(value: u32) -> ReadBack {
    ReadBack::Ready(value.to_ne_bytes().repeat(4))
}

#[test]
fn what_was_thrown_away_has_failed_and_holds_nothing_up() {
    let Some(mut game) = game() else { return };
    let (values, texture) = (buffer(&mut game), texture(&mut game));
    let (first, ran) = list(values, texture, 1);
    let mut encoder = game.begin();
    game.hair.record(&mut encoder, &first).unwrap();
    game.submit(encoder);
    // Two recordings in one command buffer, which is thrown away while the one before it may still run.
    let [(second, failed), (third, also)] = [2, 3].map(|value| list(values, texture, value));
    let mut encoder = game.begin();
    game.hair.record(&mut encoder, &second).unwrap();
    game.hair.record(&mut encoder, &third).unwrap();
    assert_eq!(game.hair.read(failed), ReadBack::Pending);
    game.discard(encoder);
    assert_eq!([failed, also].map(|ticket| game.hair.read(ticket)), [ReadBack::Failed, ReadBack::Failed]);
    // The first is not over; what it uses is still there, and it can be read once it has run.
    let mut last = PassList::new();
    let now = last.read_buffer(values, 0, 16);
    let mut encoder = game.begin();
    game.hair.record(&mut encoder, &last).unwrap();
    game.submit(encoder);
    game.wait();
    assert_eq!([ran, now].map(|ticket| game.hair.read(ticket)), [bytes(1), bytes(1)]);
}

#[test]
fn an_engine_that_only_retires_what_it_threw_away_goes_on() {
    let Some(mut game) = game() else { return };
    let (values, texture) = (buffer(&mut game), texture(&mut game));
    let (thrown, failed) = list(values, texture, 7);
    for _ in 0..3 {
        let mut encoder = game.begin();
        game.hair.record(&mut encoder, &thrown).unwrap();
        game.engine.discard(encoder.raw());
        // SAFETY: it was never submitted.
        unsafe { game.hair.mark_finished(game.hair.recorded()) };
        assert_eq!(game.hair.read(failed), ReadBack::Failed);
    }
    // The buffer is still to be filled with zeros, and the texture has no layout yet.
    let mut next = PassList::new();
    let zeros = next.read_buffer(values, 0, 16);
    next.read_texture(texture);
    let mut encoder = game.begin();
    game.hair.record(&mut encoder, &next).unwrap();
    game.submit(encoder);
    game.wait();
    assert_eq!(game.hair.read(zeros), bytes(0));
}

#[test]
fn a_resource_that_is_gone_is_not_brought_back_with_what_was_thrown_away() {
    let Some(mut game) = game() else { return };
    let texture = texture(&mut game);
    for value in 0..20 {
        let values = buffer(&mut game);
        let (thrown, _) = list(values, texture, value);
        let mut encoder = game.begin();
        game.hair.record(&mut encoder, &thrown).unwrap();
        game.hair.destroy(values.into());
        drop(thrown);
        // What was destroyed is let go of here.
        game.hair.record(&mut encoder, &PassList::new()).unwrap();
        game.discard(encoder);
        assert_eq!(game.hair.memory().bytes, 64 * 2 * 4);
    }
    game.wait();
}
