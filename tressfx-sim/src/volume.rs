//! Hair against hair: a grid that is fixed to the head, over which the mass and the momentum of all guides are spread.
//!
//! Where hair is denser than at rest it is pushed down the slope of the density, and its velocity goes towards the mean of the hair around it (Hadap,
//! Magnenat-Thalmann 2001; Petrovic, Henne, Anderson 2005). The grid turns with the head, so what a node has at rest it has at rest again.
//! Three kernels at the end of each sub-step: it has the same length at any frame rate, and so has the push.

mod grid;
mod params;

use glam::Vec3;
use tressfx_core::Result;
use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::strands::Strands;

use crate::buffers::{RodBuffers, storage};
use crate::error::SimError;
use crate::field::Fields;
use crate::kernel::volume_nodes::volume_nodes;
use crate::kernel::{Kernels, Pass};
use crate::params::ParamError;
use crate::reference::{VolumeSums, rest_masses};
use crate::section_desc::SectionDesc;
use crate::sim::HairSim;
use crate::stage::Stage;

pub use grid::VolumeGrid;
pub use params::VolumeParams;

/// All hair together counts as this: so no sum at a node leaves 32 bits, whatever falls into one cell.
const WHOLE: f64 = (1u32 << 30) as f64;
/// The stages of a sub-step, behind those of the solvers.
const STAGES: [Stage; 3] = [Stage::VolumeSplat, Stage::VolumeNodes, Stage::VolumePush];

gpu_struct! {
    /// The grid and the parameters, in the unit of the file.
    pub(crate) struct GpuVolume {
        /// The first node, in the space of the head, relative to the centre of the groom.
        pub origin: Vec3,
        /// From node to node.
        pub cell: f32,
        /// Nodes along x, y and z.
        pub nodes: [u32; 3],
        /// Whole numbers that a unit of length of one strand counts as.
        pub unit_mass: f32,
        /// The speed that momentum is a share of, units/s.
        pub fastest: f32,
        /// The rate at which velocities become those around them, 1/s.
        pub friction: f32,
        /// How fast compression spreads, units/s.
        pub sound_speed: f32,
        /// Nothing.
        pub padding: f32,
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct VolumeBuffers {
    /// [`GpuVolume`].
    pub(crate) volume: BufferId,
    /// `vec4<i32>` a node: mass and momentum.
    pub(crate) sums: BufferId,
    /// `f32` a node: the mass that it may have without pressure.
    pub(crate) rest_masses: BufferId,
    /// Two `vec4<f32>` a node: the slope of the pressure, and the mean velocity.
    pub(crate) node_values: BufferId,
}

/// What all sections share of it.
#[derive(Debug)]
pub(crate) struct Volume {
    params: VolumeParams,
    grid: VolumeGrid,
    /// The parameters as kernels have them.
    uniform: GpuVolume,
    metres_per_unit: f64,
    pub(crate) buffers: VolumeBuffers,
    nodes: Pass,
}

impl Volume {
    pub(crate) fn new(
        backend: &mut dyn Backend,
        kernels: &mut Kernels,
        sections: &[SectionDesc],
        center: Vec3,
        params: &VolumeParams,
    ) -> Result<Self> {
        let strands: Vec<&Strands> = sections.iter().map(|section| section.strands).collect();
        let grid = VolumeGrid::around(&strands, center, params.cells);
        let nodes = grid.node_count();
        let buffers = VolumeBuffers {
            volume: backend.create_buffer(&BufferDesc::uniform("hair.volume", size_of::<GpuVolume>() as u64))?,
            sums: storage(backend, "hair.volume_sums", 16, nodes)?,
            rest_masses: storage(backend, "hair.volume_rest_masses", 4, nodes)?,
            node_values: storage(backend, "hair.volume_nodes", 32, nodes)?,
        };
        let metres_per_unit = strands.first().map_or(1.0, |strands| f64::from(strands.metres_per_unit));
        let whole: f64 = strands.iter().map(|strands| VolumeSums::whole_mass(strands)).sum();
        let uniform = GpuVolume {
            origin: grid.origin,
            cell: grid.cell,
            nodes: grid.nodes,
            unit_mass: if whole > 0.0 { (WHOLE / whole) as f32 } else { 0.0 },
            fastest: (f64::from(VolumeParams::FASTEST) / metres_per_unit) as f32,
            friction: params.friction,
            sound_speed: (f64::from(params.sound_speed) / metres_per_unit) as f32,
            padding: 0.0,
        };
        let pass = volume_nodes(backend, kernels, &buffers, nodes)?;
        Ok(Self { params: params.clone(), grid, uniform, metres_per_unit, buffers, nodes: pass })
    }

    /// Uploads the rest pose as the grid sees it.
    pub(crate) fn upload(&self, list: &mut PassList, sections: &[SectionDesc], center: Vec3) {
        let strands: Vec<&Strands> = sections.iter().map(|section| section.strands).collect();
        let unit_mass = f64::from(self.uniform.unit_mass);
        let masses = rest_masses(&self.grid, &strands, center, self.params.rest_density);
        // Less than one whole number is not there.
        let masses: Vec<f32> = masses.iter().map(|mass| (mass * unit_mass).max(1.0) as f32).collect();
        list.upload(self.buffers.rest_masses, 0, &masses);
        list.upload(self.buffers.volume, 0, &[self.uniform]);
    }

    /// Changes what is no size of the grid.
    fn set(&mut self, list: &mut PassList, params: &VolumeParams) -> std::result::Result<(), ParamError> {
        params.validate()?;
        params.same_grid(&self.params)?;
        self.uniform.friction = params.friction;
        self.uniform.sound_speed = (f64::from(params.sound_speed) / self.metres_per_unit) as f32;
        self.params = params.clone();
        list.upload(self.buffers.volume, 0, &[self.uniform]);
        Ok(())
    }
}

impl HairSim {
    /// The same as [`HairSim::new`], or as [`HairSim::with_fields`] where there are some, with hair against hair: all sections keep their volume together and rub against
    /// each other. It takes three more passes in a sub-step, 52 bytes a node of its grid, and 16 bytes a guide vertex of
    /// [`Solver::Direct`](crate::Solver::Direct). A simulation made without it has none of that.
    ///
    /// # Errors
    /// As [`HairSim::new`], and a parameter of the volume outside its range.
    pub fn with_volume(
        backend: &mut dyn Backend,
        list: &mut PassList,
        sections: &[SectionDesc],
        max_colliders: usize,
        fields: Option<&Fields>,
        volume: &VolumeParams,
    ) -> std::result::Result<Self, SimError> {
        volume.validate()?;
        Self::made(backend, list, sections, max_colliders, fields, Some(volume))
    }

    /// The parameters of hair against hair; `None` where the simulation was made without it.
    pub fn volume(&self) -> Option<&VolumeParams> {
        self.shared.volume.as_ref().map(|volume| &volume.params)
    }

    /// Changes them, from the next frame on. What the grid was made of has to stay: its cells and the density at rest.
    ///
    /// # Errors
    /// A simulation that was made without, a parameter outside its range, or another grid; nothing changes then.
    pub fn set_volume(&mut self, list: &mut PassList, params: &VolumeParams) -> std::result::Result<(), SimError> {
        self.shared.volume.as_mut().ok_or(SimError::NoVolume)?.set(list, params)?;
        self.wake();
        Ok(())
    }

    /// The grid of hair against hair.
    pub fn volume_grid(&self) -> Option<VolumeGrid> {
        self.shared.volume.as_ref().map(|volume| volume.grid)
    }

    /// Brings back what the last sub-step has left at the nodes of the grid, x first, then y, then z: `vec4<i32>`, mass and momentum, all mass being 2^30 and momentum the
    /// mass times the velocity as a share of [`VolumeParams::FASTEST`]; and two `vec4<f32>`, the slope of the pressure and the mean velocity, in the unit of the file, each
    /// with nothing in its last number.
    pub fn read_volume(&self, list: &mut PassList) -> Option<[Ticket; 2]> {
        let volume = self.shared.volume.as_ref()?;
        let nodes = u64::from(volume.grid.node_count());
        let VolumeBuffers { sums, node_values, .. } = volume.buffers;
        Some([list.read_buffer(sums, 0, 16 * nodes), list.read_buffer(node_values, 0, 32 * nodes)])
    }

    /// Brings back by what the hair around them accelerates the guides of a section that [`Solver::Direct`](crate::Solver::Direct) moves, units/s^2 on the axes of the
    /// world: `vec4<f32>`, vertex-major. `None` for other solvers, without hair against hair, and where there is no such section.
    pub fn read_push(&self, list: &mut PassList, section: usize) -> Option<Ticket> {
        self.shared.volume.as_ref()?;
        let section = self.sections.get(section)?;
        let (rods, shape) = (section.buffers.rods?, section.buffers.strands.shape);
        let first = RodBuffers::state_bytes(shape.guides, shape.vertices);
        Some(list.read_buffer(rods.state, first, 16 * u64::from(shape.guide_vertices())))
    }

    /// The end of a sub-step, where hair meets hair.
    pub(crate) fn record_volume(&self, list: &mut PassList, place: usize) {
        if self.shared.volume.is_some() {
            STAGES.iter().for_each(|&stage| self.record_stage_at(list, stage, place));
        }
    }

    /// A stage of all sections. `place` is where the steps are.
    pub(crate) fn record_stage_at(&self, list: &mut PassList, stage: Stage, place: usize) {
        if let Some(volume) = &self.shared.volume {
            match stage {
                Stage::VolumeSplat => list.clear(volume.buffers.sums, 0, 16 * u64::from(volume.grid.node_count())),
                Stage::VolumeNodes => volume.nodes.record(list, 0),
                _ => {}
            }
        }
        self.sections.iter().for_each(|section| section.record(list, stage, place));
    }
}
