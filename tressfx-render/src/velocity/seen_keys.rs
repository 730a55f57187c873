//! `hair.render.seen_keys`: the key of the fragment that each pixel is seen to have.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::shader::{Kernel, Module};

use crate::output::walk;
use crate::segments::walking;
use crate::shaders::{compute, with_shared};

const LIBRARY: &[Module] =
    &with_shared::<1, 19>([("sink", include_str!("../../shaders/velocity/seen_keys_sink.wgsl"))]);

pub(super) fn kernel(backend: &mut dyn Backend, copies: bool) -> Result<Kernel> {
    let root = ("seen_keys", include_str!("../../shaders/velocity/seen_keys.wgsl"));
    let specialization = walking(backend, &walk(copies));
    compute(backend, "hair.render.seen_keys", root, LIBRARY, &specialization)
}
