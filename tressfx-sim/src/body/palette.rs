//! The matrices of joints on the GPU.

use glam::{Affine3A, Vec4};
use tressfx_core::Result;
use tressfx_core::backend::Backend;
use tressfx_core::body::Influences;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use crate::buffers::storage;
use crate::error::SimError;

/// Joints are counted by 16 bits.
const MOST: usize = 1 << 16;

/// The matrices of the joints of a body, which one kernel or several read.
#[derive(Clone, Copy, Debug)]
pub struct JointPalette {
    /// Three `vec4<f32>` a joint: the rows of the matrix from the bind pose to where it is. An engine may give a buffer of its own.
    pub buffer: BufferId,
    /// How many joints there are.
    pub joints: usize,
}

impl JointPalette {
    /// A palette with every joint in the bind pose once `list` has run.
    ///
    /// # Errors
    /// More than 65,536 joints, or what the backend says.
    pub fn new(backend: &mut dyn Backend, list: &mut PassList, joints: usize) -> Result<Self, SimError> {
        if joints > MOST {
            return Err(SimError::TooManyJoints { given: joints, most: MOST });
        }
        let made = Self { buffer: storage(backend, "hair.joints", 48, joints as u32)?, joints };
        made.set(list, &vec![Affine3A::IDENTITY; joints])?;
        Ok(made)
    }

    /// Says where the joints are from now on.
    ///
    /// # Errors
    /// Another number of joints, and matrices that are not finite.
    pub fn set(&self, list: &mut PassList, joints: &[Affine3A]) -> Result<(), SimError> {
        if joints.len() != self.joints {
            return Err(SimError::JointCount { given: joints.len(), expected: self.joints });
        }
        if joints.iter().any(|joint| !joint.is_finite()) {
            return Err(SimError::NonFinite { name: "joint" });
        }
        let rows = |joint: &Affine3A| -> [Vec4; 3] {
            let linear = glam::Mat3::from(joint.matrix3).transpose();
            let translation = joint.translation;
            [
                linear.x_axis.extend(translation.x),
                linear.y_axis.extend(translation.y),
                linear.z_axis.extend(translation.z),
            ]
        };
        list.upload(self.buffer, 0, &joints.iter().flat_map(rows).collect::<Vec<_>>());
        Ok(())
    }

    /// Whether the joints of these influences are in it.
    ///
    /// # Errors
    /// The first that is not.
    pub(super) fn check(&self, influences: &[Influences]) -> Result<(), SimError> {
        let joints = influences.iter().flat_map(|of| of.joints);
        match joints.max().filter(|&joint| joint as usize >= self.joints) {
            Some(joint) => Err(SimError::NoJoint { joint, count: self.joints }),
            None => Ok(()),
        }
    }
}

/// Two joints in a word.
pub(super) fn packed(joints: [u32; 4]) -> [u32; 2] {
    [joints[0] | joints[1] << 16, joints[2] | joints[3] << 16]
}
