//! `hair.render.composite_compute`.

use glam::DVec4;

/// The picture with hair over it; `hair` is premultiplied colour and alpha.
pub fn composite_compute(picture: DVec4, hair: DVec4) -> DVec4 {
    hair + (1.0 - hair.w) * picture
}
