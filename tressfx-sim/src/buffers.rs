//! The buffers of a section.

use bytemuck::NoUninit;
use glam::Vec3;
use tressfx_core::Result;
use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Label;
use tressfx_core::id::BufferId;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{Strands, about};

use crate::step::Step;

/// What the simulation of a section reads and writes. Everything but `strands` holds guides alone, vertex-major:
/// `vertex * guides + guide`.
#[derive(Debug)]
pub(crate) struct SectionBuffers {
    /// What the rendering reads too.
    pub(crate) strands: StrandBuffers,
    /// `vec4<f32>`: rest position about the centre of the groom, inverse mass.
    pub(crate) rest: BufferId,
    /// `f32`: rest length of the edge to the next vertex.
    pub(crate) rest_lengths: BufferId,
    /// `vec4<f32>`: position one sub-step ago, 0.
    pub(crate) previous: BufferId,
    /// `vec4<f32>`, `follow * guides + guide`; only where there are follow strands.
    pub(crate) follow_offsets: Option<BufferId>,
    /// [`Step`].
    pub(crate) step: BufferId,
    /// Whether the tip of any guide is pinned.
    pub(crate) pinned_tips: bool,
}

impl SectionBuffers {
    pub(crate) fn new(backend: &mut dyn Backend, strands: &Strands, center: Vec3) -> Result<Self> {
        let shape = StrandShape::of(strands);
        let vertices = strands.vertices as usize;
        let follows = shape.guides * shape.follows;
        Ok(Self {
            strands: StrandBuffers::new(backend, shape, center)?,
            rest: storage(backend, "hair.rest", 16, shape.guide_vertices())?,
            rest_lengths: storage(backend, "hair.rest_lengths", 4, shape.guide_vertices())?,
            previous: storage(backend, "hair.previous", 16, shape.guide_vertices())?,
            follow_offsets: match follows {
                0 => None,
                _ => Some(storage(backend, "hair.follow_offsets", 16, follows)?),
            },
            step: backend.create_buffer(&BufferDesc::uniform("hair.step", size_of::<Step>() as u64))?,
            pinned_tips: strands.rest.chunks(vertices).any(|strand| strand[vertices - 1].w == 0.0),
        })
    }

    /// What has to be uploaded once.
    pub(crate) fn uploads(&self, strands: &Strands) -> impl Iterator<Item = Upload> {
        let always = [
            Upload::new(self.rest, &strands.interleave(&about(self.strands.center, &strands.rest))),
            Upload::new(self.rest_lengths, &strands.interleave(&strands.rest_lengths)),
            Upload::new(self.strands.thickness, &strands.interleave(&strands.thickness)),
        ];
        let offsets = self.follow_offsets.map(|buffer| Upload::new(buffer, &strands.follow_offsets));
        always.into_iter().chain(offsets)
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        let StrandBuffers { positions, tangents, thickness, .. } = self.strands;
        let all = [positions, tangents, thickness, self.rest, self.rest_lengths, self.previous, self.step];
        for buffer in all.into_iter().chain(self.follow_offsets) {
            backend.destroy(buffer.into());
        }
    }
}

/// Bytes on their way to the start of a buffer.
#[derive(Debug)]
pub(crate) struct Upload {
    pub(crate) buffer: BufferId,
    pub(crate) bytes: Vec<u8>,
}

impl Upload {
    pub(crate) fn new<T: NoUninit>(buffer: BufferId, data: &[T]) -> Self {
        Self { buffer, bytes: bytemuck::cast_slice(data).to_vec() }
    }
}

/// A storage buffer for `count` elements, filled with zeros.
pub(crate) fn storage(backend: &mut dyn Backend, label: Label, bytes_each: u64, count: u32) -> Result<BufferId> {
    let bytes = (bytes_each * u64::from(count)).max(16);
    backend.create_buffer(&BufferDesc::storage(label, bytes))
}
