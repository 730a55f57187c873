//! Hair for an engine's frame: the part that names no graphics API.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use anyhow::Result;
use glam::{Quat, Vec3};
use tressfx_asset::builtin::Builtin;
use tressfx_core::backend::{Backend, Format, ReadBack};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::{Pose, View};
use tressfx_render::{
    Counters, HairRenderer, Lights, Material, RenderDesc, SectionDraw, ShadedStrands, StrandInfo, Targets, ViewDraw,
};
use tressfx_sim::{Collider, HairSim, SectionDesc, SimParams, StepInput};

/// A groom that an engine simulates and draws.
pub struct Hair {
    sim: HairSim,
    /// What moves with the head.
    colliders: Vec<Collider<'static>>,
    section: ShadedStrands,
    material: Material,
    renderer: HairRenderer,
    targets: Targets,
    /// Uploads for the first frame, then empty.
    list: PassList,
    /// Counters of frames that the GPU may not have finished, oldest first.
    counters: VecDeque<Ticket>,
}

impl Hair {
    /// Makes everything that a groom needs on the GPU. `targets` are the engine's own textures, imported.
    ///
    /// # Errors
    /// What the groom or the backend says.
    pub fn new(
        backend: &mut dyn Backend,
        groom: &Builtin,
        view: &View,
        format: Format,
        targets: Targets,
    ) -> Result<Self> {
        let strands = Strands::new(&groom.asset(), &StrandOptions::default())?;
        let section = SectionDesc::new(&strands, SimParams::default());
        let colliders = Collider::all_with_head(&groom.capsules());
        let mut list = PassList::new();
        let sim = HairSim::new(backend, &mut list, &[section], colliders.len())?;
        let section = ShadedStrands::new(backend, sim.buffers()[0], StrandInfo::new(&strands))?;
        let mut renderer = HairRenderer::new(backend, &RenderDesc::new(view.size(), format))?;
        let material = Material::default();
        renderer.grow_to_predicted(backend, view, &[SectionDraw::new(&section, &material, sim.pose())])?;
        Ok(Self { sim, colliders, section, material, renderer, targets, list, counters: VecDeque::new() })
    }

    /// The passes of the next frame, which lasts `dt` seconds and at whose end the head is at `head`.
    ///
    /// # Errors
    /// What the simulation does not take.
    pub fn frame(&mut self, dt: f64, head: Pose, view: &View, lights: &Lights) -> Result<&PassList> {
        // The first frame keeps what `new` wanted to be uploaded.
        if self.sim.resets() > 0 {
            self.list.clear_commands();
        }
        self.sim.step(&mut self.list, &StepInput::new(dt, head).with_colliders(&self.colliders))?;
        let draws = [SectionDraw::new(&self.section, &self.material, self.sim.pose())];
        self.renderer.draw(&mut self.list, &[ViewDraw::new(view, lights, self.targets)], &draws)?;
        self.counters.push_back(self.renderer.request_counters(&mut self.list, 0));
        Ok(&self.list)
    }

    /// To be called after a frame was submitted: looks at what older ones counted, without waiting, and makes room where
    /// fragments were dropped.
    ///
    /// # Errors
    /// What the backend says.
    pub fn observe(&mut self, backend: &mut dyn Backend) -> Result<()> {
        while let Some(&ticket) = self.counters.front() {
            let read = backend.read(ticket);
            if read == ReadBack::Pending {
                break;
            }
            self.counters.pop_front();
            // A frame that was thrown away has counted nothing.
            if let ReadBack::Ready(bytes) = read {
                self.renderer.grow_to_measured(backend, &Counters::from_bytes(&bytes))?;
            }
        }
        Ok(())
    }

    /// Brings the positions of all strands back, as [`HairSim::read_positions`] does.
    pub fn read_positions(&self, list: &mut PassList) -> Ticket {
        self.sim.read_positions(list)[0]
    }

    /// The engine's textures have become others. Nobody has to wait for the GPU: what is freed here goes once it has finished.
    ///
    /// # Errors
    /// What the backend says.
    pub fn resize(&mut self, backend: &mut dyn Backend, view: &View, targets: Targets) -> Result<()> {
        let old = std::mem::replace(&mut self.targets, targets);
        [old.color, old.depth].into_iter().for_each(|texture| backend.destroy(texture.into()));
        self.renderer.resize(backend, view.size())?;
        let draw = SectionDraw::new(&self.section, &self.material, self.sim.pose());
        Ok(self.renderer.grow_to_predicted(backend, view, &[draw])?)
    }

    /// Frees everything. Of the engine's textures only the ids go.
    pub fn destroy(self, backend: &mut dyn Backend) {
        [self.targets.color, self.targets.depth].into_iter().for_each(|texture| backend.destroy(texture.into()));
        self.renderer.destroy(backend);
        self.section.destroy(backend);
        self.sim.destroy(backend);
    }
}

/// Where the head is after `seconds`: it turns to one side and to the other about the y axis.
pub fn head(seconds: f64) -> Pose {
    let begun = (2.0 * seconds).min(1.0);
    let angle = 0.5 * begun * (0.7 * TAU * seconds).sin();
    Pose { rotation: Quat::from_rotation_y(angle as f32), translation: Vec3::ZERO }
}
