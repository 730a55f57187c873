//! The buffers of a section.

use glam::{Vec3, Vec4};
use tressfx_core::Result;
use tressfx_core::backend::{Backend, BufferDesc};
use tressfx_core::error::Label;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::{StrandBuffers, StrandShape};
use tressfx_core::strands::{Strands, relative_to};
use tressfx_core::uniform_array::UniformArray;
use tressfx_core::view::Pose;

use crate::collider::GpuCollider;
use crate::kernel::GROUP;
use crate::section_desc::SectionDesc;
use crate::solver::Solver;
use crate::step::Step;

/// What the simulation of a section reads and writes. Everything but `strands` holds guides alone, vertex-major:
/// `vertex * guides + guide`.
#[derive(Debug)]
pub(crate) struct SectionBuffers {
    /// What the rendering reads too.
    pub(crate) strands: StrandBuffers,
    /// `vec4<f32>`: rest position relative to the centre of the groom, inverse mass.
    pub(crate) rest: BufferId,
    /// `f32`: rest length of the edge to the next vertex.
    pub(crate) rest_lengths: BufferId,
    /// `vec4<f32>`: position one sub-step ago, 0.
    pub(crate) previous: BufferId,
    /// `vec4<f32>`, `follow * guides + guide`; only where there are follow strands.
    pub(crate) follow_offsets: Option<BufferId>,
    /// Only where rods are solved for.
    pub(crate) rods: Option<RodBuffers>,
    /// Only where roots have transforms of their own.
    pub(crate) roots: Option<RootBuffers>,
    /// What changes from sub-step to sub-step.
    pub(crate) steps: UniformArray<Step>,
    /// Whether any vertex has another inverse mass than 1 that the root does not hold.
    pub(crate) inverse_masses: bool,
    /// Whether the tip of any guide is pinned.
    pub(crate) pinned_tips: bool,
}

/// What [`Solver::Direct`] keeps of its rods; vertex-major as all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RodBuffers {
    /// Two `vec4<f32>` a vertex ([`GpuRods`](crate::rods::GpuRods)).
    pub(crate) rest: BufferId,
    /// Fourteen `vec4<f32>` a vertex: the state, and what the sweeps of a sub-step leave for each other. The guides of a group of
    /// threads are beside each other: `((guide / GROUP * vertices + vertex) * 14 + slot) * GROUP + guide % GROUP`; where there are colliders two slots of each, so
    /// that all kernels which read them need the same feature `colliders` (`ADJACENT` in `rod.wgsl`). Where hair meets hair, a `vec4<f32>` a
    /// vertex follows, vertex-major: the acceleration by the hair around it.
    pub(crate) state: BufferId,
}

/// The transforms of roots; an element a guide.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RootBuffers {
    /// [`RootTransform`] at the end of the frame: what the caller gives.
    pub(crate) targets: BufferId,
    /// [`RootTransform`] at the ends of the last three frames, in turns.
    pub(crate) places: [BufferId; 3],
    /// With the head, now and one sub-step ago; four `vec4<f32>`.
    pub(crate) now: BufferId,
}

/// The colliders of a frame, shared by all sections.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ColliderBuffer {
    /// [`GpuCollider`].
    pub(crate) colliders: BufferId,
    /// How many colliders a frame may have.
    pub(crate) most: usize,
}

gpu_struct! {
    /// Where the root of a guide is, within the space of the rest pose: points relative to the centre of the groom
    /// ([`HairSim::center`](crate::HairSim::center)) are turned, then moved.
    pub struct RootTransform {
        /// A unit quaternion.
        pub rotation: Vec4,
        /// Where the centre goes, relative to the centre; `w` is not read.
        pub place: Vec4,
    }
}

impl RootTransform {
    /// A root that rides on the head.
    pub const WITH_HEAD: Self = Self { rotation: Vec4::W, place: Vec4::ZERO };

    /// A pose within the space of the rest pose.
    pub fn new(center: Vec3, pose: &Pose) -> Self {
        let (rotation, center) = (pose.rotation.as_dquat().normalize(), center.as_dvec3());
        let place = rotation * center + pose.translation.as_dvec3() - center;
        Self { rotation: rotation.as_quat().into(), place: place.as_vec3().extend(0.0) }
    }
}

impl SectionBuffers {
    /// `has_volume` where hair meets hair.
    pub(crate) fn new(backend: &mut dyn Backend, desc: &SectionDesc, center: Vec3, has_volume: bool) -> Result<Self> {
        let (strands, own_roots) = (desc.strands, desc.own_roots);
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
            rods: match desc.solver {
                Solver::TressFx => None,
                Solver::Direct => Some(RodBuffers::new(backend, shape, has_volume)?),
            },
            roots: if own_roots { Some(RootBuffers::new(backend, shape.guides)?) } else { None },
            steps: UniformArray::new(backend, "hair.steps", STEPS)?,
            inverse_masses: strands.rest.chunks(vertices).any(has_inverse_masses),
            pinned_tips: strands.rest.chunks(vertices).any(|strand| strand[vertices - 1].w == 0.0),
        })
    }

    /// Uploads the rest pose.
    pub(crate) fn upload(&self, list: &mut PassList, strands: &Strands) {
        list.upload(self.rest, 0, &strands.interleave(&relative_to(self.strands.center, &strands.rest)));
        list.upload(self.rest_lengths, 0, &strands.interleave(&strands.rest_lengths));
        list.upload(self.strands.thickness, 0, &strands.interleave(&strands.thickness));
        if let Some(buffer) = self.follow_offsets {
            list.upload(buffer, 0, &strands.follow_offsets);
        }
        if let Some(roots) = &self.roots {
            list.upload(roots.targets, 0, &vec![RootTransform::WITH_HEAD; strands.guides as usize]);
        }
    }
}

/// The [`Step`] that stands alone, such as that of a reset, in [`SectionBuffers::steps`].
pub(crate) const ALONE: usize = 0;
/// The step of the first sub-step of a frame.
pub(crate) const FIRST: usize = 1;
/// All of them.
pub(crate) const STEPS: usize = FIRST + ColliderBuffer::SUB_STEPS;

/// Whether a strand has another inverse mass than 1 behind the vertices that its root holds.
fn has_inverse_masses(strand: &[Vec4]) -> bool {
    strand.iter().skip_while(|vertex| vertex.w == 0.0).any(|vertex| vertex.w != 1.0)
}

impl RodBuffers {
    /// Of a vertex, in the buffer of the state.
    const SLOTS: u64 = 14;

    fn new(backend: &mut dyn Backend, shape: StrandShape, has_volume: bool) -> Result<Self> {
        let pushes = if has_volume { 16 * u64::from(shape.guide_vertices()) } else { 0 };
        let state = BufferDesc::storage("hair.rods", Self::state_bytes(shape.guides, shape.vertices) + pushes);
        Ok(Self {
            rest: storage(backend, "hair.rod_rest", 16 * 2, shape.guide_vertices())?,
            state: backend.create_buffer(&state)?,
        })
    }

    /// Of the state without pushes: groups of threads are whole.
    pub(crate) fn state_bytes(guides: u32, vertices: u32) -> u64 {
        16 * Self::SLOTS * u64::from(guides.next_multiple_of(GROUP)) * u64::from(vertices)
    }
}

impl RootBuffers {
    /// Bytes of a [`RootTransform`].
    const BYTES: u64 = 32;

    fn new(backend: &mut dyn Backend, guides: u32) -> Result<Self> {
        let transforms = |backend: &mut dyn Backend, label| storage(backend, label, Self::BYTES, guides);
        let place = |backend: &mut dyn Backend| transforms(backend, "hair.root_places");
        Ok(Self {
            targets: transforms(backend, "hair.root_targets")?,
            places: [place(backend)?, place(backend)?, place(backend)?],
            now: storage(backend, "hair.roots", 64, guides)?,
        })
    }

    /// The frame ends: its end is the start of the next one, and has the place with this number.
    pub(crate) fn end_frame(&self, list: &mut PassList, place: u32, guides: u32) {
        list.copy(self.targets, self.places[place as usize], Self::BYTES * u64::from(guides));
    }
}

impl ColliderBuffer {
    /// For so many colliders in a frame of a groom of so many sections.
    pub(crate) fn new(backend: &mut dyn Backend, most: usize, sections: usize) -> Result<Self> {
        let count = (most * sections.max(1) * Self::SUB_STEPS) as u32;
        Ok(Self { colliders: storage(backend, "hair.colliders", size_of::<GpuCollider>() as u64, count)?, most })
    }

    /// Of so many sub-steps the colliders are uploaded at once.
    pub(crate) const SUB_STEPS: usize = 16;
}

/// A storage buffer for `count` elements, filled with zeros.
pub(crate) fn storage(backend: &mut dyn Backend, label: Label, bytes_each: u64, count: u32) -> Result<BufferId> {
    let bytes = (bytes_each * u64::from(count)).max(16);
    backend.create_buffer(&BufferDesc::storage(label, bytes))
}
