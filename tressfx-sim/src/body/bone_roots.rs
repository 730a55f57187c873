//! Roots that ride on bones, without a mesh.

use glam::{DMat3, DQuat, DVec3, Vec3, Vec4};
use tressfx_core::backend::Backend;
use tressfx_core::body::Influences;
use tressfx_core::gpu_struct;
use tressfx_core::pass::PassList;
use tressfx_core::strands::Strands;

use super::palette::{JointPalette, packed};
use super::roots_pass::{RootSource, RootsPass, targets};
use crate::HairSim;
use crate::error::SimError;
use crate::kernel::bone_roots;

gpu_struct! {
    /// A root that bones move, as the kernel reads it.
    pub struct BoneRoot {
        /// Where it is in the bind pose, relative to the centre.
        pub rest: Vec3,
        /// Its first two bones, the first in the lower half.
        pub joints_01: u32,
        /// The frame in the bind pose: a unit quaternion that takes z to the direction in which the strand grows.
        pub frame: Vec4,
        /// The share of each bone.
        pub weights: Vec4,
        /// Its other bones.
        pub joints_23: u32,
        /// Nothing.
        pub padding: u32,
        /// Nothing.
        pub more_padding: [u32; 2],
    }
}

impl BoneRoot {
    /// A root at `root` whose strand grows towards `next`.
    pub fn new(center: Vec3, root: Vec3, next: Vec3, of: &Influences) -> Self {
        let up = (next.as_dvec3() - root.as_dvec3()).normalize_or(DVec3::Z);
        let (x, y) = up.any_orthonormal_pair();
        let frame = DQuat::from_mat3(&DMat3::from_cols(x, y, up)).normalize();
        let [joints_01, joints_23] = packed(of.joints);
        Self {
            rest: (root.as_dvec3() - center.as_dvec3()).as_vec3(),
            joints_01,
            frame: frame.as_quat().into(),
            weights: of.weights.into(),
            joints_23,
            padding: 0,
            more_padding: [0; 2],
        }
    }

    /// Those of the guides of a section; `influences` has an entry a strand of the file.
    ///
    /// # Errors
    /// Fewer influences than strands.
    pub fn all(center: Vec3, strands: &Strands, influences: &[Influences]) -> Result<Vec<Self>, SimError> {
        let guides = strands.rest.chunks(strands.vertices as usize).zip(&strands.order);
        let root = |(guide, &strand): (&[Vec4], &u32)| {
            let of = influences.get(strand as usize);
            let of = of.ok_or(SimError::RootCount { given: influences.len(), expected: strand as usize + 1 })?;
            Ok(Self::new(center, guide[0].truncate(), guide[1].truncate(), of))
        };
        guides.map(root).collect()
    }
}

/// The roots of a section on bones: one pass a frame.
#[derive(Debug)]
pub struct BoneRoots(RootsPass);

impl BoneRoots {
    /// Makes what it needs, and uploads the roots with `list`. `influences` has an entry a strand of the file, with joints of the palette.
    ///
    /// # Errors
    /// A section without roots of its own or that does not exist, fewer influences than strands, a joint that the palette does not have, or what the
    /// backend says.
    pub fn new(
        backend: &mut dyn Backend,
        list: &mut PassList,
        (sim, section): (&HairSim, usize),
        strands: &Strands,
        influences: &[Influences],
        palette: JointPalette,
    ) -> Result<Self, SimError> {
        let center = sim.center();
        palette.check(influences)?;
        let roots = BoneRoot::all(center, strands, influences)?;
        let targets = targets(sim, section, roots.len())?;
        let source = RootSource { center, guides: roots.len() as u32, stride: 0, first: 0, padding: [0; 2] };
        let read = ("joints", palette.buffer.into());
        RootsPass::new(backend, list, &bone_roots::SOURCE, source, (&roots, targets), read).map(Self)
    }

    /// Says where the roots are at the end of the next frame, from where the joints are now. It comes behind what sets the palette and before
    /// [`HairSim::step`].
    pub fn record(&self, list: &mut PassList, sim: &mut HairSim) {
        self.0.record(list, sim);
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.0.destroy(backend);
    }
}
