//! What raw Vulkan promises an engine beside what every backend does: uses of imports, memory. The validation layer sees what
//! is wrong with a use within one command buffer, so the engine does what it was promised right behind the list.

use tressfx_backend_vulkan::ash::{Device, vk};
use tressfx_backend_vulkan::{EngineUse, VulkanBackend};
use tressfx_conformance::embed::{ADD_ONE, Embed, TEXTURE_SIZE, compute};
use tressfx_core::backend::{Backend, BufferDesc, Format, ReadBack, Record, Run, TextureDesc};
use tressfx_core::error::Error;
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Grid, Load, PassList, RasterPass};

use super::engine::whole;
use super::{COPIED, FRESH, Game, first_texel};

/// What an engine does with a texture of its own, or with its view, and a buffer beside.
struct Use {
    import: EngineUse,
    format: Format,
    command: fn(&Device, vk::CommandBuffer, (vk::Image, vk::ImageView), vk::Buffer),
}

const USES: [Use; 4] = [
    Use {
        import: EngineUse { access: vk::AccessFlags2::TRANSFER_READ, ..COPIED },
        format: Format::Rgba8,
        command: copy,
    },
    Use {
        import: EngineUse {
            access: vk::AccessFlags2::TRANSFER_WRITE,
            layout: vk::ImageLayout::TRANSFER_DST_OPTIMAL,
            ..COPIED
        },
        format: Format::Rgba8,
        command: clear,
    },
    Use { import: EngineUse::COLOR_TARGET, format: Format::Rgba8, command: draw },
    Use { import: EngineUse::DEPTH_TARGET, format: Format::Depth32F, command: draw_depth },
];

fn copy(device: &Device, commands: vk::CommandBuffer, (image, _): (vk::Image, vk::ImageView), buffer: vk::Buffer) {
    let regions = [first_texel()];
    // SAFETY: the command buffer is being recorded, outside of a render pass, and all of it lives as long as the engine.
    unsafe {
        device.cmd_copy_image_to_buffer(commands, image, vk::ImageLayout::TRANSFER_SRC_OPTIMAL, buffer, &regions)
    };
}

fn clear(device: &Device, commands: vk::CommandBuffer, (image, _): (vk::Image, vk::ImageView), _: vk::Buffer) {
    let (color, range) = (vk::ClearColorValue::default(), [whole(vk::Format::R8G8B8A8_UNORM)]);
    // SAFETY: as above.
    unsafe { device.cmd_clear_color_image(commands, image, vk::ImageLayout::TRANSFER_DST_OPTIMAL, &color, &range) };
}

/// A target that keeps what it holds.
fn target(view: vk::ImageView, layout: vk::ImageLayout) -> vk::RenderingAttachmentInfo<'static> {
    vk::RenderingAttachmentInfo::default()
        .image_view(view)
        .image_layout(layout)
        .load_op(vk::AttachmentLoadOp::LOAD)
        .store_op(vk::AttachmentStoreOp::STORE)
}

fn rendering() -> vk::RenderingInfo<'static> {
    let extent = vk::Extent2D { width: TEXTURE_SIZE[0], height: TEXTURE_SIZE[1] };
    vk::RenderingInfo::default().render_area(vk::Rect2D { extent, ..Default::default() }).layer_count(1)
}

fn draw(device: &Device, commands: vk::CommandBuffer, (_, view): (vk::Image, vk::ImageView), _: vk::Buffer) {
    let targets = [target(view, vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)];
    // SAFETY: as above.
    unsafe {
        device.cmd_begin_rendering(commands, &rendering().color_attachments(&targets));
        device.cmd_end_rendering(commands);
    }
}

fn draw_depth(device: &Device, commands: vk::CommandBuffer, (_, view): (vk::Image, vk::ImageView), _: vk::Buffer) {
    let target = target(view, vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
    // SAFETY: as above.
    unsafe {
        device.cmd_begin_rendering(commands, &rendering().depth_attachment(&target));
        device.cmd_end_rendering(commands);
    }
}

/// A list that draws to a texture.
fn drawing(texture: TextureId, format: Format) -> PassList {
    let mut list = PassList::new();
    let pass = RasterPass::new("test.draw");
    list.raster(match format.is_depth() {
        true => pass.depth(texture, Load::Clear(0.5)),
        false => pass.color(texture, Load::Clear([1.0; 4])),
    });
    list
}

/// What the validation layer says where a list leaves a texture in the use of one, and the engine goes on with the use of the
/// other. What the engine did comes before the next list as well.
fn said(promised: &Use, used: &Use) -> Option<Vec<String>> {
    let mut game = game()?;
    let format = if used.format.is_depth() { vk::Format::D32_SFLOAT } else { vk::Format::R8G8B8A8_UNORM };
    let image = game.engine.image(TEXTURE_SIZE, format);
    let desc = TextureDesc::new("engine", TEXTURE_SIZE, used.format);
    let mut encoder = game.begin();
    let commands = encoder.raw();
    for initial_use in [FRESH, used.import] {
        // SAFETY: the image is as it is described, and lives as long as the engine.
        let texture = unsafe { game.hair.import_texture(image.0, &desc, initial_use, promised.import) }.unwrap();
        game.hair.record(&mut encoder, &drawing(texture, used.format)).unwrap();
        let buffer = game.engine.buffer(&[0; 16]);
        (used.command)(&game.engine.device, commands, image, buffer);
    }
    game.engine.submit(commands);
    game.engine.wait();
    Some(game.engine.said())
}

/// `None` where there is no device and `TRESSFX_NO_GPU` says that this is known.
pub(crate) fn game() -> Option<Game> {
    match Game::new() {
        Ok(game) => Some(game),
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn a_texture_comes_back_in_the_use_that_was_promised() {
    for each in &USES {
        let Some(said) = said(each, each) else { return };
        assert_eq!(said, [""; 0], "{:?}", each.import);
    }
}

#[test]
fn a_texture_that_comes_back_in_another_use_is_noticed() {
    for used in &USES {
        for promised in USES.iter().filter(|promised| promised.import != used.import) {
            let Some(said) = said(promised, used) else { return };
            assert!(!said.is_empty(), "{:?} for {:?}", promised.import, used.import);
        }
    }
}

/// The layouts are right, and only the stages are not. Of copies only: the layer 1.3.239 does not hold what targets of dynamic
/// rendering load and store against what was done before.
#[test]
fn a_texture_that_comes_back_too_early_is_noticed() {
    for used in &USES[..2] {
        let (stage, access) = (vk::PipelineStageFlags2::VERTEX_SHADER, vk::AccessFlags2::SHADER_READ);
        let early = Use { import: EngineUse { stage, access, ..used.import }, ..*used };
        let Some(said) = said(&early, used) else { return };
        assert!(said.iter().any(|said| said.contains("SYNC-HAZARD")), "{:?}: {said:?}", used.import);
    }
}

#[test]
fn a_buffer_that_is_not_in_the_promised_use_is_noticed() {
    for (initial_use, final_use, fine) in
        [(COPIED, COPIED, true), (EngineUse::COMPUTE, COPIED, false), (COPIED, EngineUse::COMPUTE, false)]
    {
        let Some(mut game) = game() else { return };
        let buffer = game.engine.buffer(&[0; 16]);
        let desc = BufferDesc::storage("engine", 16);
        // SAFETY: it has 16 bytes and lives as long as the engine.
        let id = unsafe { game.hair.import_buffer(buffer, &desc, initial_use, final_use) }.unwrap();
        game.buffers.insert(id, buffer);
        let mut list = PassList::new();
        list.upload(id, 0, &[1u32; 4]);
        let mut commands = game.begin();
        game.clear_word(&mut commands, id, 0);
        game.hair.record(&mut commands, &list).unwrap();
        game.clear_word(&mut commands, id, 1);
        game.engine.submit(commands.raw());
        game.engine.wait();
        let said = game.engine.said();
        assert_eq!(said.is_empty(), fine, "{initial_use:?}, {final_use:?}: {said:?}");
        assert!(said.iter().all(|said| said.contains("SYNC-HAZARD-WRITE-AFTER-WRITE")), "{said:?}");
    }
}

#[test]
fn a_list_that_does_not_name_an_import_leaves_it_alone() {
    let Some(mut game) = game() else { return };
    let texture = game.texture();
    let before = game.hair.barriers();
    let mut commands = game.begin();
    game.hair.record(&mut commands, &PassList::new()).unwrap();
    game.submit(commands);
    game.wait();
    assert_eq!(game.hair.barriers(), before);
    game.hair.destroy(texture.into());
}

fn buffer(hair: &mut VulkanBackend, bytes: u64) -> BufferId {
    hair.create_buffer(&BufferDesc::storage("test.buffer", bytes)).unwrap()
}

/// Fifty lists, so many of them in flight, each with a buffer that is destroyed right after it was recorded.
fn passing(game: &mut Game, in_flight: u32) {
    for i in 0..50 {
        let passing = buffer(&mut game.hair, 1024);
        let mut list = PassList::new();
        list.upload(passing, 0, &[i; 256]);
        let ticket = list.read_buffer(passing, 0, 1024);
        let mut commands = game.begin();
        game.hair.record(&mut commands, &list).unwrap();
        game.hair.destroy(passing.into());
        game.engine.submit(commands.raw());
        if i % in_flight == 0 {
            game.wait();
            assert_eq!(game.hair.read(ticket), ReadBack::Ready(bytemuck::cast_slice::<u32, u8>(&[i; 256]).to_vec()));
        }
    }
    game.wait();
}

/// Waits until nothing of the allocator's is in use. Lists of tests beside this one may keep what was destroyed for a while.
fn assert_all_given_back(game: &mut Game) {
    for _ in 0..600 {
        game.wait();
        if game.engine.allocated() == 0 {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    panic!("{} bytes are still in use", game.engine.allocated());
}

#[test]
fn all_memory_is_given_back() {
    let Some(mut game) = game() else { return };
    let large = buffer(&mut game.hair, 8 << 20);
    let mut list = PassList::new();
    list.upload(large, 0, &vec![1u8; 8 << 20]);
    game.hair.run(&list).unwrap();
    game.hair.destroy(large.into());
    assert_eq!(game.hair.memory().bytes, 0, "it does not count any more, though the list still names it");
    assert!(game.engine.allocated() >= 8 << 20);
    drop(list);
    assert_all_given_back(&mut game);
    passing(&mut game, 3);
    passing(&mut game, 50);
    assert_eq!(game.hair.memory().bytes, 0);
    let Game { hair, engine, .. } = game;
    drop(hair);
    assert_eq!(engine.allocated(), 0);
}

#[test]
fn a_command_buffer_of_another_device_is_refused() {
    let (Some(mut one), Some(mut other)) = (game(), game()) else { return };
    let mut commands = one.begin();
    let error = other.hair.record(&mut commands, &PassList::new()).unwrap_err();
    assert!(matches!(error, Error::Rule { .. }), "{error}");
    one.discard(commands);
}

#[test]
fn ids_of_another_backend_are_refused() {
    let (Some(mut one), Some(mut other)) = (game(), game()) else { return };
    let theirs = buffer(&mut other.hair, 16);
    let _mine = buffer(&mut one.hair, 16);
    let mut list = PassList::new();
    list.upload(theirs, 0, &[1u32; 4]);
    let mut commands = one.begin();
    let error = one.hair.record(&mut commands, &list).unwrap_err();
    assert!(error.to_string().contains("of this backend"), "{error}");
    one.hair.destroy(theirs.into());
    assert_eq!(other.hair.memory().bytes, 16, "it is not the other's to destroy");
    one.engine.submit(commands.raw());
    one.wait();
}

#[test]
fn descriptor_pools_are_used_again() {
    let Some(mut game) = game() else { return };
    let kernel = compute(&mut game.hair, &ADD_ONE);
    let mut pools = Vec::new();
    for _ in 0..6 {
        let buffers: Vec<_> = (0..300).map(|_| buffer(&mut game.hair, 16)).collect();
        let mut list = PassList::new();
        for &values in &buffers {
            list.compute(&kernel, &kernel.bind(&[("values", values.into())]).unwrap(), Grid([1; 3]));
        }
        let mut commands = game.begin();
        game.hair.record(&mut commands, &list).unwrap();
        game.engine.submit(commands.raw());
        drop(list);
        buffers.into_iter().for_each(|values| game.hair.destroy(values.into()));
        // Lists of tests beside this one may keep what was destroyed for a while.
        for _ in 0..600 {
            game.wait();
            if game.engine.allocated() == 0 {
                break;
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        pools.push(game.hair.descriptor_pools());
    }
    assert_eq!(pools, [1; 6], "what is empty is used again, and one such pool is kept");
}
