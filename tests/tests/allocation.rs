//! An allocation that fails half way, whichever it is: what was made before goes again, and what was there stays as it was.

use tressfx_conformance::failing::Failing;
use tressfx_conformance::sim::{random_asset, random_strands, strands_of};
use tressfx_core::asset::HairAsset;
use tressfx_core::backend::{Backend, Caps, DepthOrder, Format};
use tressfx_core::glam::Vec3;
use tressfx_core::null::NullBackend;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::view::{Camera, Pose};
use tressfx_render::{
    Counters, Fill, HairRenderer, Material, OwnLook, PpllDesc, RenderDesc, SectionDraw, ShadedStrands, ShortCutDesc,
    StrandInfo, Technique, TilesDesc,
};
use tressfx_sim::{HairSim, SectionDesc, SimParams, Solver};

fn backend() -> Failing<NullBackend> {
    Failing::new(NullBackend::new(Caps::webgpu_default()))
}

#[test]
fn strand_buffers() {
    let mut backend = backend();
    let shape = StrandShape { guides: 5, follows: 1, vertices: 4 };
    let (made, failures) = backend.fail_everywhere(|backend| StrandBuffers::new(backend, shape, Vec3::ZERO));
    assert_eq!(failures, 3);
    made.destroy(&mut backend);
    assert_eq!(backend.living(), (0, 0));
}

#[test]
fn a_simulation_and_its_parameters() {
    let mut backend = backend();
    let strands = [random_strands(8, 8, 1, 1), random_strands(4, 6, 0, 2)];
    let [rods, published] = strands.each_ref().map(|strands| SectionDesc::new(strands, SimParams::default()));
    let descs = [published.with_solver(Solver::TressFx), rods];
    let (mut sim, failures) = backend.fail_everywhere(|backend| HairSim::new(backend, &mut PassList::new(), &descs, 1));
    assert!(failures > 20, "{failures} creations");
    let before = backend.living();
    // Other iterations are another kernel; kernels stay for sections that may need them again.
    let params = SimParams { local_iterations: 7, length_iterations: 5, global_stiffness: 0.4, ..SimParams::default() };
    let ((), failures) = backend.fail_everywhere(|backend| sim.set_params(backend, 0, params.clone()));
    assert!(failures > 0, "new pipelines");
    assert_eq!(backend.living().0, before.0 + failures, "nothing but the new kernels is left");
    sim.destroy(&mut backend);
    assert_eq!(backend.living(), (0, 0));
}

#[test]
fn a_renderer_of_each_technique() {
    let techniques: [Technique; 4] = [
        PpllDesc::default().fill(Fill::Raster).into(),
        PpllDesc::default().cap(4).into(),
        ShortCutDesc::default().into(),
        ShortCutDesc::default().ordered(true).fill(Fill::Raster).into(),
    ];
    for technique in techniques {
        let mut backend = backend();
        let desc = RenderDesc::new([64, 48], Format::Rgba16F).technique(technique);
        let (mut renderer, failures) = backend.fail_everywhere(|backend| HairRenderer::new(backend, &desc));
        assert!(failures > 6, "{failures} creations");
        let (before, bytes) = (backend.living(), renderer.technique_bytes());
        let ((), failures) = backend.fail_everywhere(|backend| renderer.resize(backend, [96, 64]));
        assert!(failures > 1, "{failures} creations");
        assert!(backend.living().0 == before.0 && backend.living().1 > before.1, "as many, and larger");
        assert_eq!(backend.living().1 - before.1, renderer.technique_bytes() - bytes);
        renderer.destroy(&mut backend);
        assert_eq!(backend.living(), (0, 0));
    }
}

#[test]
fn what_looks_for_hidden_hair() {
    let techniques: [Technique; 3] = [
        PpllDesc::default().skips_hidden(true).into(),
        PpllDesc::default().skips_hidden(true).max_node_bytes(16 * 8).into(),
        ShortCutDesc::default().skips_hidden(true).into(),
    ];
    for technique in techniques {
        let mut backend = backend();
        let desc = RenderDesc::new([64, 48], Format::Rgba16F).technique(technique);
        let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
        let strands = random_strands(8, 8, 1, 1);
        let buffers = StrandBuffers::new(&mut backend, StrandShape::of(&strands), Vec3::ZERO).unwrap();
        let section = ShadedStrands::new(&mut backend, buffers, StrandInfo::new(&strands)).unwrap();
        let view = Camera::around(&[Vec3::NEG_ONE, Vec3::ONE], [64, 48]).view([64, 48]).unwrap();
        let material = Material::default();
        let draws = [SectionDraw::new(&section, &material, Pose::IDENTITY)];
        let (before, bytes) = (backend.living(), renderer.technique_bytes());
        let ((), failures) = backend.fail_everywhere(|backend| renderer.grow_to_predicted(backend, &view, &draws));
        assert!(failures > 6, "{failures} creations");
        assert_eq!(backend.living().1 - before.1, renderer.technique_bytes() - bytes, "all that was made is there");
        assert!(backend.living().0 > before.0 + 6, "and not freed again: {:?}, {before:?}", backend.living());
        section.destroy(&mut backend);
        renderer.destroy(&mut backend);
        buffers.destroy(&mut backend);
        assert_eq!(backend.living(), (0, 0));
    }
}

/// Several kinds of it at once: none goes while another one cannot be made smaller.
#[test]
fn tiles_that_give_back_memory() {
    let desc = RenderDesc::new([640, 360], Format::Rgba16F).technique(TilesDesc::default());
    let many = Counters { wanted: 1 << 20, tiles_with_hair: 3000, vertices: 1 << 20, ..Counters::default() };
    // Colours, references, and two buffers of vertices.
    for (creations, succeeds) in [(0, false), (1, false), (2, false), (3, false), (4, true)] {
        let mut backend = backend();
        let mut renderer = HairRenderer::new(&mut backend, &desc).unwrap();
        renderer.draw(&mut PassList::new(), &[], &[]).unwrap();
        assert!(renderer.grow_to_measured(&mut backend, &many).unwrap());
        let bytes = renderer.technique_bytes();
        let refused = (0..500).any(|_| {
            renderer.draw(&mut PassList::new(), &[], &[]).unwrap();
            let before = (backend.living(), renderer.technique_bytes());
            backend.after = Some(creations);
            let measured = renderer.grow_to_measured(&mut backend, &Counters::default());
            assert_eq!(measured.is_err(), backend.after.take().is_none());
            let same = (backend.living(), renderer.technique_bytes()) == before;
            assert!(same || measured.is_ok(), "after {creations} creations");
            measured.is_err()
        });
        assert_eq!(refused, !succeeds, "after {creations} creations");
        assert!(refused || renderer.technique_bytes() < bytes / 2, "all of it is smaller");
        renderer.destroy(&mut backend);
        assert_eq!(backend.living(), (0, 0));
    }
}

#[test]
fn a_renderer_its_size_and_its_sections() {
    let mut backend = backend();
    let desc = RenderDesc::new([64, 48], Format::Rgba16F);
    let (mut renderer, failures) = backend.fail_everywhere(|backend| HairRenderer::new(backend, &desc));
    assert!(failures > 6, "{failures} creations");
    let before = backend.living();
    let ((), failures) = backend.fail_everywhere(|backend| renderer.resize(backend, [96, 64]));
    assert!(failures > 1, "{failures} creations");
    assert!(backend.living().0 == before.0 && backend.living().1 > before.1, "as many, and larger");
    let (before, capacity) = (backend.living(), renderer.capacity());
    let many = Counters { wanted: 8 * capacity, ..Counters::default() };
    let (_, failures) = backend.fail_everywhere(|backend| renderer.grow_to_measured(backend, &many));
    assert_eq!(failures, 2, "the new nodes, in two buffers; the old ones stay where they cannot be made");
    assert!(renderer.capacity() > capacity && backend.living().0 == before.0);
    let too_many = Counters { wanted: u32::MAX, ..Counters::default() };
    let (_, failures) = backend.fail_everywhere(|backend| renderer.grow_to_measured(backend, &too_many));
    assert!(failures > 4, "kernels and memory that bound the lists: {failures} creations");
    let lists = PpllDesc::default().k(12);
    let ((), failures) = backend.fail_everywhere(|backend| renderer.retune(backend, lists));
    assert!(failures > 1, "a kernel, and memory for more of a pixel: {failures} creations");
    let strands = random_strands(8, 8, 1, 1);
    let info = StrandInfo::new(&strands);
    let buffers = StrandBuffers::new(&mut backend, StrandShape::of(&strands), Vec3::ZERO).unwrap();
    let (section, failures) = backend.fail_everywhere(|backend| ShadedStrands::new(backend, buffers, info.clone()));
    assert!(failures > 1, "{failures} creations");
    let wild = HairAsset { strand_thickness: Some((0..8).map(|i| i as f32).collect()), ..random_asset(8, 8, 1) };
    let look = OwnLook::of(&strands_of(wild, 1)).with_colors(vec![[0.5; 4]; 64]);
    section.destroy(&mut backend);
    let (section, failures) = backend.fail_everywhere(|backend| {
        let section = ShadedStrands::new(backend, buffers, info.clone())?;
        section.with_own_look(backend, &mut PassList::new(), &look)
    });
    assert!(failures > 6, "{failures} creations, those of the strands too");
    let tiles = RenderDesc::new([64, 48], Format::Rgba16F).technique(TilesDesc::default()).own_colors(true);
    let mut tiles = HairRenderer::new(&mut backend, &tiles).unwrap();
    let camera = Camera { depth: DepthOrder::Standard, ..Camera::around(&[Vec3::NEG_ONE, Vec3::ONE], [64, 48]) };
    let (view, material) = (camera.view([64, 48]).unwrap(), Material::default());
    let draws = [SectionDraw::new(&section, &material, Pose::IDENTITY)];
    let ((), failures) = backend.fail_everywhere(|backend| tiles.grow_to_predicted(backend, &view, &draws));
    assert_eq!(failures, 0, "few vertices and references have room");
    let (_, failures) = backend.fail_everywhere(|backend| tiles.grow_to_measured(backend, &many));
    assert_eq!(failures, 0, "they have room");
    let (_, failures) = backend.fail_everywhere(|backend| tiles.grow_to_measured(backend, &too_many));
    assert_eq!(failures, 1, "more references");
    // Memory is given back, and a smaller buffer has to be made for that.
    for renderer in [&mut renderer, &mut tiles] {
        let before = renderer.technique_bytes();
        let mut refused = 0;
        for frame in 0..500 {
            renderer.draw(&mut PassList::new(), &[], &[]).unwrap();
            let mut measure = |backend: &mut dyn Backend| renderer.grow_to_measured(backend, &Counters::default());
            match frame {
                0..250 => refused += backend.fail_everywhere(measure).1,
                _ => drop(measure(&mut backend).unwrap()),
            }
        }
        assert!(refused > 0 && renderer.technique_bytes() < before, "{refused} refused");
    }
    tiles.destroy(&mut backend);
    section.destroy(&mut backend);
    renderer.destroy(&mut backend);
    buffers.destroy(&mut backend);
    assert_eq!(backend.living(), (0, 0));
}
