//! Code without `unsafe` that breaks every rule of the contract: errors, nothing recorded, and not a word from the APIs. To be
//! run in release too; the rules cost no debug build.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_backend_wgpu::{WgpuBackend, wgpu};
use tressfx_conformance::rules::{World, broken_descriptions, broken_lists, mistakes, random_list};
use tressfx_conformance::run_and_read;
use tressfx_core::backend::{Backend, BufferDesc, Record, Run};
use tressfx_core::error::{Error, Result};
use tressfx_core::pass::{Load, PassList, RasterPass};

mod support;

/// How many random lists are run.
const RANDOM: std::ops::Range<u64> = 1_000..3_000;

/// Gives every broken list to `record`, then random ones; says how many there were of each, and how many of those were sound.
fn hold<B: Run>(
    backend: &mut B,
    another: &mut B,
    mut record: impl FnMut(&mut B, &PassList) -> Result<()>,
) -> [usize; 3] {
    let (complaints, descriptions) = broken_descriptions(backend);
    assert!(complaints.is_empty(), "{complaints:#?}");
    let world = World::new(backend, another);
    let broken = broken_lists(&world, mistakes(&world, true));
    for broken in &broken {
        let complaint = broken.complaint(&record(backend, &broken.list));
        assert_eq!(complaint, None);
    }
    let (marker, bytes) = world.marker();
    let mut list = PassList::new();
    let ticket = list.read_buffer(marker, 0, bytes);
    assert!(run_and_read(backend, &list, ticket).iter().all(|&byte| byte == 0), "something of a broken list was done");
    let mut sound = 0;
    for seed in RANDOM {
        let list = random_list(&world, seed);
        match record(backend, &list) {
            Ok(()) => sound += 1,
            Err(Error::Rule { .. }) => {}
            Err(error) => panic!("seed {seed}: {error}: {list:?}"),
        }
    }
    // Names are for people: whatever is in them, they break nothing.
    let named = backend.create_buffer(&BufferDesc::storage("rules.\0name", 16)).unwrap();
    list.scope(Some("a \0 scope".into()));
    list.raster(RasterPass::new("rules.\0pass").depth(world.depth(), Load::Clear(1.0)));
    list.clear(named, 0, 16);
    let ticket = list.read_buffer(marker, 0, bytes);
    assert!(run_and_read(backend, &list, ticket).iter().all(|&byte| byte == 0), "it works as before");
    println!(
        "{} broken lists, {descriptions} broken descriptions, {sound} of {} random lists run",
        broken.len(),
        RANDOM.count()
    );
    [broken.len(), descriptions, sound]
}

/// What is asked for, and what of it must be sound or broken for the test to say something.
fn assert_enough([lists, descriptions, sound]: [usize; 3]) {
    assert!(lists >= 600 && descriptions >= 40, "{lists} lists, {descriptions} descriptions");
    assert!((500..1900).contains(&sound), "{sound} random lists are sound");
}

#[test]
fn raw_vulkan_under_validation() {
    let open = || VulkanBackend::headless_with(&VulkanOptions { validation: true, ..Default::default() });
    let (mut backend, mut another) = match (open(), open()) {
        (Ok(backend), Ok(another)) => (backend, another),
        (Err(error), _) | (_, Err(error)) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            return tressfx_conformance::suite::say_skipped("rules", &error.to_string());
        }
        (Err(error), _) | (_, Err(error)) => panic!("{error}"),
    };
    // Each run answers what the layer has said.
    assert_enough(hold(&mut backend, &mut another, |backend, list| backend.run(list)));
}

/// Two backends, and how often their devices had something to say that nobody was asked about.
fn watched() -> Option<([WgpuBackend; 2], Arc<AtomicUsize>)> {
    let backends = [*support::gpu()?, *support::gpu()?];
    let said = Arc::new(AtomicUsize::new(0));
    for backend in &backends {
        let said = said.clone();
        backend.device().on_uncaptured_error(Arc::new(move |error| {
            eprintln!("{error}");
            said.fetch_add(1, Ordering::Relaxed);
        }));
    }
    Some((backends, said))
}

#[test]
fn wgpu_on_a_queue_of_its_own() {
    let Some(([mut backend, mut another], said)) = watched() else { return };
    assert_enough(hold(&mut backend, &mut another, |backend, list| backend.run(list)));
    assert_eq!(said.load(Ordering::Relaxed), 0, "uncaptured errors");
}

#[test]
fn wgpu_in_an_encoder_of_an_engine() {
    let Some(([mut backend, mut another], said)) = watched() else { return };
    let record = |backend: &mut WgpuBackend, list: &PassList| {
        let mut encoder = backend.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let recorded = backend.record(&mut encoder, list);
        // Of a broken list nothing is in the encoder.
        backend.queue().submit([encoder.finish()]);
        recorded
    };
    assert_enough(hold(&mut backend, &mut another, record));
    assert_eq!(said.load(Ordering::Relaxed), 0, "uncaptured errors");
}

/// What is held on every backend is held by core: so it is on one that runs nothing.
#[test]
fn on_the_backend_that_runs_nothing() {
    use tressfx_core::backend::Caps;
    use tressfx_core::null::NullBackend;
    let [mut backend, mut another] = [(); 2].map(|()| NullBackend::new(Caps::webgpu_default()));
    let (complaints, _) = broken_descriptions(&mut backend);
    assert!(complaints.is_empty(), "{complaints:#?}");
    let world = World::new(&mut backend, &mut another);
    let broken = broken_lists(&world, mistakes(&world, true));
    let passes = backend.ran.len();
    for broken in &broken {
        assert_eq!(broken.complaint(&backend.run(&broken.list)), None);
    }
    assert_eq!(backend.ran.len(), passes, "nothing of them has run");
    assert!(backend.memory().bytes > 0 && broken.len() >= 600, "{} lists", broken.len());
}
