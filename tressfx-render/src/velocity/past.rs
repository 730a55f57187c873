//! Where strands were in the frame before, and what that is on the screen.

use glam::{DMat4, DVec4, Mat4};
use tressfx_core::backend::{Backend, BufferDesc, Owner};
use tressfx_core::error::{Error, Result};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::strand_buffers::StrandBuffers;
use tressfx_core::uniform_array::UniformArray;
use tressfx_core::view::{Pose, View};

use super::LABEL;
use crate::strands::SectionDraw;
use crate::views::{BoundView, MAX_VIEWS};

gpu_struct! {
    /// How a section has moved on the screen of a view since the frame before.
    pub struct MotionUniform {
        /// From its positions to pixels of the viewport times w, and w; columns.
        pub now: [[f32; 4]; 4],
        /// The same for its past positions, in the frame before.
        pub past: [[f32; 4]; 4],
        /// The jitter of this frame less that of the frame before, pixels.
        pub jitter: [f32; 2],
        /// The number of its first segment in the frame.
        pub first: u32,
        /// Nothing.
        pub unused: u32,
    }
}

impl MotionUniform {
    /// What the shaders are given for a section in a view. `past` is the pose of the past positions, where they are known.
    pub fn new(view: &View, pose: &Pose, past: Option<&Pose>, first: u32) -> Self {
        let [now, before] = view.jitter();
        let [past_view, past_projection] = view.previous_matrices();
        Self {
            now: to_pixels(view, [view.view_matrix(), view.projection_matrix()], pose).to_cols_array_2d(),
            past: to_pixels(view, [past_view, past_projection], past.unwrap_or(pose)).to_cols_array_2d(),
            jitter: (now - before).to_array(),
            first,
            unused: 0,
        }
    }
}

/// From the positions of a section to pixels times w, and w. It is multiplied in f64: far from the origin of the world each factor is large, and
/// their product is not.
fn to_pixels(view: &View, [to_view, projection]: [Mat4; 2], pose: &Pose) -> Mat4 {
    let half = view.size().map(|side| 0.5 * f64::from(side));
    let (rotation, translation) = (pose.rotation.as_dquat().normalize(), pose.translation.as_dvec3());
    let clip = projection.as_dmat4() * to_view.as_dmat4() * DMat4::from_rotation_translation(rotation, translation);
    let [x, y, w] = [clip.row(0), clip.row(1), clip.row(3)];
    // An orthographic view may have any w.
    let scale = if w.truncate() == glam::DVec3::ZERO { w.w } else { 1.0 };
    let rows = DMat4::from_cols(half[0] * (w + x), half[1] * (w - y), DVec4::ZERO, w);
    (rows.transpose() * (1.0 / scale)).as_mat4()
}

/// Where the strands of a section were, and what the passes of the motion are given about it.
#[derive(Debug)]
pub(crate) struct Past {
    /// `vec4<f32>` a vertex of every strand, as the positions: those of the frame before.
    pub(super) positions: BufferId,
    /// [`MotionUniform`] of each view.
    pub(super) uniforms: UniformArray<MotionUniform>,
    /// What takes the past positions to the world; `None` where they are not known.
    pose: Option<Pose>,
    owner: Owner,
}

impl Past {
    pub(crate) fn new(backend: &mut dyn Backend, strands: &StrandBuffers) -> Result<Self> {
        let bytes = (16 * u64::from(strands.shape.strand_vertices())).max(16);
        let ((positions, uniforms), owner) = Owner::build(backend, |backend| {
            let positions = backend.create_buffer(&BufferDesc::storage("hair.render.past_positions", bytes))?;
            Ok::<_, Error>((positions, UniformArray::new(backend, "hair.render.motions", MAX_VIEWS)?))
        })?;
        Ok(Self { positions, uniforms, pose: None, owner })
    }

    /// Writes a copy of the positions, which `pose` takes to the world.
    pub(crate) fn keep(&mut self, list: &mut PassList, strands: &StrandBuffers, pose: Pose) {
        let bytes = 16 * u64::from(strands.shape.strand_vertices());
        if bytes > 0 {
            list.copy(strands.positions, self.positions, bytes);
            self.pose = Some(pose);
        }
    }

    pub(crate) fn forget(&mut self) {
        self.pose = None;
    }

    pub(crate) fn is_known(&self) -> bool {
        self.pose.is_some()
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}

/// The past of a section that is drawn.
pub(super) fn of<'a>(draw: &SectionDraw<'a>) -> Result<&'a Past> {
    let missing = || Error::rule(LABEL, "a section keeps no past".to_owned());
    draw.strands.past.as_ref().ok_or_else(missing)
}

/// Uploads how the sections have moved in a view, and numbers their segments.
pub(super) fn upload(list: &mut PassList, view: &BoundView, draws: &[SectionDraw]) -> Result<()> {
    let mut first = 0u32;
    for draw in draws {
        let past = of(draw)?;
        let uniform = MotionUniform::new(view.view, &draw.pose, past.pose.as_ref(), first);
        past.uniforms.upload(list, view.index, &[uniform]);
        let next = first.checked_add(draw.segments()).filter(|&next| next < u32::MAX);
        first = next.ok_or_else(|| Error::rule(LABEL, "more segments than 32 bits count".to_owned()))?;
    }
    Ok(())
}
