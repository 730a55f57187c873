//! A groom on its way from simulation to picture, on any backend: what compares backends, and what counts and times whole
//! frames.

use glam::Vec3;
use tressfx_asset::builtin::Builtin;
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::{Format, Run, TextureDesc};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Camera, View};
use tressfx_render::{
    Counters, HairRenderer, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets, Technique,
    ViewDraw,
};
use tressfx_sim::{Collider, HairSim, SectionDesc, SimParams, Solver};

use crate::run_and_read;
use crate::scene::{SceneMesh, ScenePass, coarse_shadows, lights};
use crate::sim::Motion;

/// What the colour target holds: bytes as a screen takes them.
const TARGET: Format = Format::Rgba8Srgb;

/// What is shown, and how.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name in messages.
    pub name: String,
    /// The hair.
    pub strands: Strands,
    /// What rendering asks for beside: it takes a while to be found.
    pub info: StrandInfo,
    /// What it collides with.
    pub capsules: Vec<Capsule>,
    /// What it grows on.
    pub mesh: Option<Mesh>,
    /// How it moves.
    pub motion: Motion,
    /// How stiff it is.
    pub params: SimParams,
    /// What moves it.
    pub solver: Solver,
    /// How it looks.
    pub material: Material,
    /// Where it is seen from, as a direction from its middle; `Vec3::Z` is its face.
    pub from: Vec3,
    /// How near the eye is, as a share of the distance at which everything is in the picture.
    pub distance: f32,
    /// How fragments are sorted and blended.
    pub technique: Technique,
    /// Width and height of the picture.
    pub size: [u32; 2],
}

impl Scene {
    /// Strands at their defaults, from in front.
    pub fn new(name: &str, strands: Strands, size: [u32; 2]) -> Self {
        Self {
            name: name.to_owned(),
            motion: Motion::wild(&strands),
            info: StrandInfo::new(&strands),
            strands,
            capsules: Vec::new(),
            mesh: None,
            params: SimParams::default(),
            solver: Solver::default(),
            material: Material::default(),
            from: Vec3::Z,
            distance: 1.0,
            technique: Technique::default(),
            size,
        }
    }

    /// A built-in groom, `NAME:strands:vertices`, on its body.
    ///
    /// # Panics
    /// If there is none of that name.
    pub fn builtin(name: &str, size: [u32; 2]) -> Self {
        let builtin = Builtin::parse(name).expect("a built-in groom");
        let strands = Strands::new(&builtin.asset(), &StrandOptions::default()).expect("strands");
        let scene = Self::new(name, strands, size);
        Self { capsules: builtin.capsules(), mesh: Some(builtin.mesh()), ..scene }
    }

    fn view(&self) -> View {
        let points: Vec<Vec3> = self.strands.rest_of_all().iter().map(|point| point.truncate()).collect();
        let around = Camera::around(&points, self.size);
        let reach = self.distance * around.eye.distance(around.target);
        let camera = Camera { eye: around.target + reach * self.from.normalize(), ..around };
        camera.view(self.size).expect("a view")
    }
}

/// A scene on a backend.
pub struct Show<B> {
    /// The GPU.
    pub backend: B,
    /// The simulation.
    pub sim: HairSim,
    scene: Scene,
    view: View,
    lights: Lights,
    targets: Targets,
    body: ScenePass,
    meshes: Vec<SceneMesh>,
    section: ShadedStrands,
    renderer: HairRenderer,
    frame: u32,
}

impl<B: Run> Show<B> {
    /// # Panics
    /// If the backend cannot make what the scene needs.
    pub fn new(mut backend: B, scene: &Scene) -> Self {
        let gpu: &mut dyn Run = &mut backend;
        let desc = SectionDesc::new(&scene.strands, scene.params.clone()).with_solver(scene.solver);
        let mut uploads = PassList::new();
        let sim = HairSim::new(gpu, &mut uploads, &[desc], scene.capsules.len()).expect("a simulation");
        let view = scene.view();
        let mut texture =
            |label, format| gpu.create_texture(&TextureDesc::new(label, scene.size, format)).expect("a texture");
        let targets = Targets::new(texture("show.color", TARGET), texture("show.depth", Format::Depth32F));
        let meshes = scene.mesh.iter().map(|mesh| SceneMesh::new(gpu, &mut uploads, mesh).expect("a mesh")).collect();
        let section = ShadedStrands::new(gpu, sim.buffers()[0], scene.info.clone());
        let section = section.expect("a section");
        let desc = RenderDesc::new(scene.size, TARGET).technique(scene.technique).shadows(coarse_shadows());
        let mut renderer = HairRenderer::new(gpu, &desc).expect("a renderer");
        let draw = SectionDraw::new(&section, &scene.material, sim.pose());
        renderer.grow_to_predicted(gpu, &view, &[draw]).expect("a pool");
        let body = ScenePass::new(gpu, TARGET, view.depth()).expect("a scene pass");
        gpu.run(&uploads).expect("the uploads run");
        let lights = lights();
        Self { backend, sim, scene: scene.clone(), view, lights, targets, body, meshes, section, renderer, frame: 0 }
    }

    /// Writes the next frame of 1/60 s, simulation and picture.
    ///
    /// # Panics
    /// If the motion is refused.
    pub fn record(&mut self, list: &mut PassList) {
        self.frame += 1;
        let seconds = f64::from(self.frame) / 60.0;
        let colliders = Collider::all_with_head(&self.scene.capsules);
        let input = self.scene.motion.input(seconds, 1.0 / 60.0).with_colliders(&colliders);
        self.sim.step(list, &input).expect("the input is fine");
        let Self { view, lights, targets, body, meshes, renderer, .. } = self;
        body.draw(list, view, input.head.matrix(), targets, meshes);
        let draw = SectionDraw::new(&self.section, &self.scene.material, self.sim.pose());
        renderer.draw(list, &[ViewDraw::new(view, lights, *targets)], &[draw]).expect("a view that can be drawn");
    }

    /// Runs so many frames.
    ///
    /// # Panics
    /// If the backend fails.
    pub fn play(&mut self, frames: u32) {
        let mut list = PassList::new();
        for _ in 0..frames {
            list.clear_commands();
            self.record(&mut list);
            self.backend.run(&list).expect("the frame runs");
        }
    }

    /// The picture of the last frame, four bytes a pixel, and what was drawn in it.
    pub fn picture(&mut self) -> (Vec<u8>, Counters) {
        let mut list = PassList::new();
        let counters = self.renderer.request_counters(&mut list, 0);
        let picture = list.read_texture(self.targets.color);
        let picture = run_and_read(&mut self.backend, &list, picture);
        (picture, Counters::from_bytes(&self.backend.read(counters).ready().expect("the list has run")))
    }

    /// What the renderer has room for.
    pub fn capacity(&self) -> u32 {
        self.renderer.capacity()
    }

    /// Positions of all strands, as the GPU has them.
    pub fn positions(&mut self) -> Vec<u8> {
        let mut list = PassList::new();
        let tickets: Vec<Ticket> = self.sim.read_positions(&mut list);
        run_and_read(&mut self.backend, &list, tickets[0])
    }
}
