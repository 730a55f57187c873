//! What is raw Vulkan's alone: barriers, the validation layer, memory, the pipeline cache, what passes cost.

use std::path::PathBuf;

use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::show::{Scene, Show};
use tressfx_conformance::sim::real;
use tressfx_core::backend::{Backend, BufferDesc, ReadBack, Run};
use tressfx_core::error::Error;
use tressfx_core::hazards;
use tressfx_core::pass::PassList;
use tressfx_render::{Fill, PpllDesc, ShortCutDesc, Technique};

const SIZE: [u32; 2] = [160, 90];

fn watched() -> VulkanOptions {
    VulkanOptions { validation: true, ..Default::default() }
}

/// `None` where there is no adapter and `TRESSFX_NO_GPU` says that this is known.
fn vulkan(options: &VulkanOptions) -> Option<VulkanBackend> {
    match VulkanBackend::headless_with(options) {
        Ok(backend) => Some(backend),
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn file(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("vulkan");
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

#[test]
fn the_validation_layer_has_nothing_to_say_about_600_frames() {
    let Some(backend) = vulkan(&watched()) else { return };
    let mut show = Show::new(backend, &Scene::builtin("wavy:120:16", SIZE));
    // Each run answers what the layer said about it.
    show.play(600);
    assert!(show.picture().1.pixels_with_hair > 100);
}

#[test]
fn the_validation_layer_has_nothing_to_say_about_any_technique() {
    let shortcut = ShortCutDesc::default();
    let techniques: [Technique; 4] = [
        PpllDesc::default().fill(Fill::Raster).into(),
        shortcut.into(),
        shortcut.fill(Fill::Raster).into(),
        shortcut.k(8).ordered(true).into(),
    ];
    for technique in techniques {
        let Some(backend) = vulkan(&watched()) else { return };
        let scene = Scene { technique, ..Scene::builtin("wavy:120:16", SIZE) };
        let mut show = Show::new(backend, &scene);
        show.play(60);
        assert!(show.picture().1.pixels_with_hair > 100, "{technique:?}");
    }
}

#[test]
fn without_barriers_the_validation_layer_says_so_and_names_the_pass() {
    let Some(mut backend) = vulkan(&watched()) else { return };
    let scene = Scene::builtin("wavy:120:16", SIZE);
    backend.leave_out_barriers(true);
    let buffer = BufferDesc::storage("test.source", 256);
    let [source, middle] = [0, 1].map(|_| backend.create_buffer(&buffer).unwrap());
    let mut list = PassList::new();
    list.upload(source, 0, &[7u32; 64]);
    list.copy(source, middle, 256);
    let said = backend.run(&list).unwrap_err().to_string();
    assert!(said.contains("SYNC-HAZARD-") && said.contains("vkCmdCopyBuffer"), "{said}");
    let frame = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| Show::new(backend, &scene).play(1)));
    assert!(frame.is_err(), "a frame of hair without barriers passes unnoticed");
}

/// The barriers that a frame in a row of frames records, and how many of its commands have to wait.
fn barriers_and_waits(scene: &Scene) -> Option<[usize; 2]> {
    let mut show = Show::new(vulkan(&VulkanOptions::default())?, scene);
    show.play(2);
    let mut list = PassList::new();
    show.record(&mut list);
    let before = show.backend.barriers();
    show.backend.run(&list).unwrap();
    let recorded = (show.backend.barriers() - before) as usize;
    // Twice the same list: in the second, every command has the first list before it.
    let mut twice = list.clone();
    list.commands().iter().for_each(|command| twice.push(command.clone()));
    let waits = hazards::of_list(&twice).split_off(list.commands().len());
    let waiting = waits.iter().filter(|waits| !waits.is_empty()).count();
    Some([recorded, waiting])
}

#[test]
fn a_frame_records_a_barrier_for_each_command_that_waits_and_no_other() {
    let mut scenes = vec![Scene::builtin("long:400:16", SIZE)];
    scenes.extend(real("tressfx41_ratboy/Ratboy_mohawk.tfx").map(|strands| Scene::new("mohawk", strands, SIZE)));
    for technique in [ShortCutDesc::default().into(), PpllDesc::default().fill(Fill::Raster).into()] {
        scenes.push(Scene { technique, ..scenes[0].clone() });
    }
    for scene in scenes {
        let Some([recorded, waiting]) = barriers_and_waits(&scene) else { return };
        println!("{}: {recorded} barriers", scene.name);
        assert_eq!(recorded, waiting, "{}", scene.name);
    }
}

#[test]
fn readers_of_one_buffer_do_not_wait_for_each_other() {
    let Some(mut backend) = vulkan(&watched()) else { return };
    let buffer = BufferDesc::storage("test.read", 64);
    let buffer = backend.create_buffer(&buffer).unwrap();
    let mut list = PassList::new();
    list.upload(buffer, 0, &[3u32; 16]);
    backend.run(&list).unwrap();
    let before = backend.barriers();
    let mut list = PassList::new();
    for part in 0..3 {
        list.read_buffer(buffer, 16 * part, 16);
    }
    backend.run(&list).unwrap();
    assert_eq!(backend.barriers() - before, 2, "the first reader waits for the upload, and the CPU for all readers");
}

#[test]
fn memory_that_is_not_there_is_an_error_and_the_backend_goes_on() {
    let Some(mut backend) = vulkan(&watched()) else { return };
    let bytes = backend.caps().max_buffer_bytes.min(backend.caps().max_storage_binding_bytes) & !3;
    if backend.caps().adapter.contains("Cpu") {
        eprintln!("skipped: a software device promises memory that it does not have");
        return;
    }
    let mut made = Vec::new();
    // No machine has room for so many of the largest.
    let error = (0..4096).find_map(|_| {
        let desc = BufferDesc::storage("test.large", bytes);
        backend.create_buffer(&desc).map(|id| made.push(id)).err()
    });
    let Some(error) = error else { panic!("4096 buffers of {bytes} bytes") };
    assert!(matches!(error, Error::OutOfMemory { label: "test.large", .. }), "{error}");
    assert_eq!(backend.memory().bytes, made.len() as u64 * bytes);
    made.into_iter().for_each(|id| backend.destroy(id.into()));
    let small = backend.create_buffer(&BufferDesc::storage("test.small", 16));
    let mut list = PassList::new();
    let ticket = list.read_buffer(small.unwrap(), 0, 16);
    backend.run(&list).unwrap();
    assert_eq!(backend.read(ticket), ReadBack::Ready(vec![0; 16]));
}

#[test]
fn a_pipeline_cache_is_kept_and_a_broken_one_is_made_anew() {
    let path = file("pipelines.cache");
    let _ = std::fs::remove_file(&path);
    let options = VulkanOptions { pipeline_cache: Some(path.clone()), ..watched() };
    let scene = Scene::builtin("wavy:40:8", SIZE);
    let shown = || vulkan(&options).map(|backend| Show::new(backend, &scene).play(1));
    let Some(()) = shown() else { return };
    let whole = std::fs::read(&path).unwrap();
    assert!(whole.len() >= 48, "{} bytes are less than the headers", whole.len());
    let mut flipped = whole.clone();
    *flipped.last_mut().unwrap() ^= 1;
    let mut foreign = whole.clone();
    foreign[16 + 20] ^= 1;
    for broken in [&whole[..whole.len() / 2], &flipped, &foreign, b"", &[0xff; 4096]] {
        std::fs::write(&path, broken).unwrap();
        shown();
        assert_ne!(std::fs::read(&path).unwrap(), broken, "it is written anew");
    }
    shown();
}

#[test]
fn invocations_are_counted_where_they_are_asked_for() {
    let counted = VulkanOptions { statistics: true, ..watched() };
    let scene = Scene::builtin("wavy:40:8", SIZE);
    for (options, asked) in [(counted, true), (watched(), false)] {
        let Some(backend) = vulkan(&options) else { return };
        let mut show = Show::new(backend, &scene);
        show.play(2);
        let timings = show.backend.timings();
        let tangents = timings.iter().find(|timing| timing.label == "hair.sim.tangents").expect("it runs");
        // For each of 8 vertices a group of 64 threads, of which 40 have a strand.
        assert_eq!(tangents.invocations, asked.then_some(8 * 64));
        let scene = timings.iter().find(|timing| timing.label == "test.scene").expect("it runs");
        assert_eq!(scene.invocations.is_some_and(|count| count >= u64::from(SIZE[0] * SIZE[1])), asked);
        assert!(timings.is_sorted_by(|a, b| a.begin <= b.begin) && timings.iter().all(|timing| timing.bytes > 0));
    }
}
