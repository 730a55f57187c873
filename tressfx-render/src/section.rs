//! A section of a groom on the GPU.

use glam::Vec3;
use tressfx_core::backend::{Backend, BufferDesc, BufferUse};
use tressfx_core::error::Result;
use tressfx_core::id::BufferId;
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;

use crate::gpu;
use crate::material::Material;

/// Segments that a prediction looks at.
const SAMPLES: usize = 4096;

/// What rendering needs to know of a section beside its buffers.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandInfo {
    /// Metres that a unit of the positions stands for.
    pub metres_per_unit: f32,
    /// Middle of the roots: the side of a strand that faces away from it is taken for the outside of the hair.
    pub root_center: Vec3,
    /// An even sample of the segments of the rest pose: both ends, and the shares of the full width there. From it the
    /// number of fragments is predicted.
    pub sample: Vec<([Vec3; 2], [f32; 2])>,
}

impl StrandInfo {
    /// What there is to know of a groom.
    pub fn new(strands: &Strands) -> Self {
        let vertices = strands.vertices as usize;
        let roots = strands.rest.iter().step_by(vertices).map(|root| root.truncate());
        let root_center = roots.sum::<Vec3>() / strands.guides.max(1) as f32;
        let segments = strands.guides as usize * (vertices - 1);
        let segment = |i: usize| {
            let start = i / (vertices - 1) * vertices + i % (vertices - 1);
            let ends = [start, start + 1];
            (ends.map(|end| strands.rest[end].truncate()), ends.map(|end| strands.thickness[end]))
        };
        let count = segments.min(SAMPLES);
        let sample = (0..count).map(|i| segment(i * segments / count)).collect();
        Self { metres_per_unit: strands.metres_per_unit, root_center, sample }
    }
}

/// A section that can be drawn.
#[derive(Clone, Debug)]
pub struct Section {
    pub(crate) buffers: StrandBuffers,
    pub(crate) info: StrandInfo,
    /// [`gpu::Section`].
    pub(crate) uniform: BufferId,
    /// `vec2<u32>` a vertex of every strand: four half floats, colour and opacity.
    pub(crate) colors: BufferId,
}

impl Section {
    /// Makes what rendering needs beside `buffers`, which stay the caller's.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size.
    pub fn new(backend: &mut dyn Backend, buffers: StrandBuffers, info: StrandInfo) -> Result<Self> {
        let uniform = backend.create_buffer(&BufferDesc {
            label: "hair.render.section",
            bytes: size_of::<gpu::Section>() as u64,
            usage: BufferUse::Uniform,
        })?;
        let colors = backend.create_buffer(&BufferDesc {
            label: "hair.render.colors",
            bytes: (8 * u64::from(buffers.shape.strand_vertices())).max(16),
            usage: BufferUse::Storage,
        });
        let colors = colors.inspect_err(|_| backend.destroy(uniform.into()))?;
        Ok(Self { buffers, info, uniform, colors })
    }

    /// Colours as `hair.render.shade` leaves them: for tests and tools.
    pub fn colors(&self) -> BufferId {
        self.colors
    }

    /// Frees what [`Section::new`] made.
    pub fn destroy(self, backend: &mut dyn Backend) {
        backend.destroy(self.uniform.into());
        backend.destroy(self.colors.into());
    }
}

/// A section in a frame.
#[derive(Clone, Copy, Debug)]
pub struct SectionDraw<'a> {
    /// The section.
    pub section: &'a Section,
    /// Its look.
    pub material: &'a Material,
    /// Where its positions are moved to: what the simulation reports, else [`Pose::IDENTITY`].
    pub pose: Pose,
}

impl SectionDraw<'_> {
    /// What the shaders are given.
    pub fn uniform(&self) -> gpu::Section {
        gpu::Section::new(self.section.buffers.shape, &self.section.info, self.material, &self.pose)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.section.buffers.shape.segments() == 0
    }
}
