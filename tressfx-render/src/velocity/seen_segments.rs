//! `hair.render.seen_segments`: the segment of the fragment that each pixel is seen to have.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::shader::{Kernel, Module};

use super::MOTION;
use crate::output::walk;
use crate::segments::walking;
use crate::shaders::{compute, with_shared};

const LIBRARY: &[Module] =
    &with_shared::<2, 20>([MOTION, ("sink", include_str!("../../shaders/velocity/seen_segments_sink.wgsl"))]);

pub(super) fn kernel(backend: &mut dyn Backend, copies: bool) -> Result<Kernel> {
    let root = ("seen_segments", include_str!("../../shaders/velocity/seen_segments.wgsl"));
    let specialization = walking(backend, &walk(copies));
    compute(backend, "hair.render.seen_segments", root, LIBRARY, &specialization)
}
