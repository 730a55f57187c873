//! What strands bring along, on the GPU.

use std::sync::atomic::{AtomicU32, Ordering};

use half::f16;
use tressfx_core::backend::{Backend, BufferDesc, Owner};
use tressfx_core::error::{Error, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use super::OwnLook;
use crate::material::Material;

/// Buffers of an [`OwnLook`], those that it needs.
#[derive(Debug)]
pub(crate) struct OwnBuffers {
    /// The widths alone: colours are needed no more.
    widths: OwnLook,
    has_color: bool,
    /// `vec2<u32>` a vertex of every guide: linear RGB and opacity as four half floats.
    pub(crate) colors: Option<BufferId>,
    /// `f32` a vertex of every guide: in the place of the thickness that is simulated with, the taper of the material included.
    pub(crate) thickness: Option<BufferId>,
    /// The bits of the `tip_width` that the thickness was uploaded for.
    uploaded: AtomicU32,
    /// How many times as wide as the mean the widest part is.
    pub(crate) widest: f32,
    owner: Owner,
}

impl OwnBuffers {
    /// Makes the buffers and uploads colours, and widths with the usual taper.
    pub(crate) fn new(backend: &mut dyn Backend, list: &mut PassList, look: &OwnLook) -> Result<Self> {
        let ((colors, thickness), owner) = Owner::build(backend, |backend| {
            let mut storage =
                |label, bytes: usize| backend.create_buffer(&BufferDesc::storage(label, bytes.max(16) as u64));
            let colors = look.colors.as_ref().map(|colors| storage("hair.render.own_colors", 8 * colors.len()));
            let widths = look.widths.as_ref().map(|widths| storage("hair.render.own_thickness", 4 * widths.len()));
            Ok::<_, Error>((colors.transpose()?, widths.transpose()?))
        })?;
        if let (Some(buffer), Some(colors)) = (colors, &look.colors) {
            list.upload(buffer, 0, &colors.iter().map(packed).collect::<Vec<_>>());
        }
        let widths = OwnLook { widths: look.widths.clone(), ..OwnLook::default() };
        let (has_color, widest, usual) = (look.has_color, look.widest(), Material::default().tip_width);
        if let (Some(buffer), Some(shares)) = (thickness, widths.thickness(usual)) {
            list.upload(buffer, 0, &shares);
        }
        let uploaded = AtomicU32::new(usual.to_bits());
        Ok(Self { widths, has_color, colors, thickness, uploaded, widest, owner })
    }

    /// Whether the colours have more than opacity.
    pub(crate) fn has_color(&self) -> bool {
        self.has_color
    }

    /// Uploads the widths where the taper is not the one that they have.
    pub(crate) fn upload(&self, list: &mut PassList, material: &Material) {
        let Some(buffer) = self.thickness else { return };
        let tip_width = material.tip_width.to_bits();
        if self.uploaded.swap(tip_width, Ordering::Relaxed) != tip_width {
            list.upload(buffer, 0, &self.shares(material).unwrap_or_default());
        }
    }

    /// Shares of the full width, with the taper of a material.
    pub(crate) fn shares(&self, material: &Material) -> Option<Vec<f32>> {
        self.widths.thickness(material.tip_width)
    }

    pub(crate) fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}

fn packed(color: &[f32; 4]) -> [u32; 2] {
    let share = |part: f32| if part.is_nan() { 0.0 } else { part.clamp(0.0, 1.0) };
    let [r, g, b, a] = color.map(|part| u32::from(f16::from_f32(share(part)).to_bits()));
    [r | (g << 16), b | (a << 16)]
}
