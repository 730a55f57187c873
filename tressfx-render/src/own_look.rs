//! Colours and widths that strands bring along: from their file, or from pictures.

mod buffers;
mod texture;

use glam::{DVec4, Vec3, Vec4};
use tressfx_core::strands::Strands;

pub(crate) use buffers::OwnBuffers;
pub use texture::{ColorTexture, ColorTextureError};

/// No part of a strand is so many times as wide as the mean.
const WIDEST: f64 = 16.0;

/// Colours and widths that strands have of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnLook {
    /// Linear RGB and opacity, a vertex of every guide: `vertex * guides + guide`.
    colors: Option<Vec<[f32; 4]>>,
    /// Whether there is more in the colours than opacity.
    has_color: bool,
    /// How many times as wide as the mean, and the share of the width that is left of the taper; in the same order.
    widths: Option<Vec<[f32; 2]>>,
}

/// A texture over the roots, and strands without texture coordinates.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}: its strands have no texture coordinates for a root texture")]
pub struct NoRootUvs(
    /// The groom.
    pub String,
);

impl OwnLook {
    /// What the file says. Its colours are taken for sRGB, its thickness as a multiple of the mean of all vertices: by itself it says neither of which material the
    /// hair is nor in which unit it is given. White everywhere is no colour, opacity of 0 everywhere no opacity, and the same thickness everywhere no width: that is
    /// what exporters leave where nobody has chosen.
    pub fn of(strands: &Strands) -> Self {
        let made = Self { widths: widths(strands), ..Self::default() };
        let Some(colors) = &strands.vertex_colors else { return made };
        let has_color = colors.iter().any(|color| color.truncate() != Vec3::ONE);
        let is_clear = colors.iter().all(|color| color.w == 0.0);
        let opacity = |color: &Vec4| if is_clear { 1.0 } else { color.w.clamp(0.0, 1.0) };
        if !has_color && colors.iter().all(|color| opacity(color) == 1.0) {
            return made;
        }
        let linear = |color: &Vec4| {
            let [r, g, b] = [color.x, color.y, color.z].map(|part| texture::linear(f64::from(part)) as f32);
            [r, g, b, opacity(color)]
        };
        let colors: Vec<[f32; 4]> = colors.iter().map(linear).collect();
        Self { colors: Some(strands.interleave(&colors)), has_color, ..made }
    }

    /// The same with these colours in the place of others: linear RGB and opacity, 0 to 1, a vertex of every guide, `vertex * guides + guide`.
    #[must_use]
    pub fn with_colors(self, colors: Vec<[f32; 4]>) -> Self {
        Self { colors: Some(colors), has_color: true, ..self }
    }

    /// The same, multiplied with a texture at the texture coordinates of the roots. The strands that follow a guide have its colours.
    ///
    /// # Errors
    /// Where the strands have no texture coordinates.
    pub fn with_root_texture(self, strands: &Strands, texture: &ColorTexture) -> Result<Self, NoRootUvs> {
        let uvs = strands.strand_uv.as_ref().ok_or_else(|| NoRootUvs(strands.name.clone()))?;
        let of_guides: Vec<DVec4> = uvs.iter().map(|uv| texture.at(uv.as_dvec2().to_array())).collect();
        Ok(self.multiplied(strands, |guide, _| of_guides[guide]))
    }

    /// The same, multiplied with a texture along the strands: from its left edge at the root to its right edge at the tip. Each guide takes a row of it, by chance.
    pub fn with_strand_texture(self, strands: &Strands, texture: &ColorTexture) -> Self {
        let (width, last) = (f64::from(texture.size()[0]), f64::from(strands.vertices - 1));
        let rows: Vec<f64> = strands.order.iter().map(|&strand| chance(strand)).collect();
        self.multiplied(strands, |guide, vertex| {
            // From the middle of the first texel to that of the last: the tip takes nothing of the root.
            let across = (0.5 + vertex as f64 / last * (width - 1.0)) / width;
            texture.at([across, rows[guide]])
        })
    }

    fn multiplied(mut self, strands: &Strands, color: impl Fn(usize, usize) -> DVec4) -> Self {
        let (guides, vertices) = (strands.guides as usize, strands.vertices as usize);
        // Opacity alone leaves the colours white.
        let colors = self.colors.get_or_insert_with(|| vec![[1.0; 4]; guides * vertices]);
        for (index, own) in colors.iter_mut().enumerate() {
            let times = color(index % guides, index / guides);
            *own = (Vec4::from_array(*own).as_dvec4() * times).as_vec4().to_array();
        }
        self.has_color = true;
        self
    }

    /// Whether there is anything: else strands need not bring it along.
    pub fn is_empty(&self) -> bool {
        self.colors.is_none() && self.widths.is_none()
    }

    /// Linear RGB and opacity, a vertex of every guide, `vertex * guides + guide`; none where the material's hold everywhere.
    pub fn colors(&self) -> Option<&[[f32; 4]]> {
        self.colors.as_deref()
    }

    /// Whether there is more in [`OwnLook::colors`] than opacity.
    pub fn has_color(&self) -> bool {
        self.has_color
    }

    /// Shares of the full width with the taper of a material, in the order of [`OwnLook::colors`]; none where strands bring no widths along.
    pub fn thickness(&self, tip_width: f32) -> Option<Vec<f32>> {
        let share = |[times, taper]: &[f32; 2]| times * (tip_width + (1.0 - tip_width) * taper);
        Some(self.widths.as_ref()?.iter().map(share).collect())
    }

    /// How many vertices it is for, by each of its arrays.
    pub(crate) fn lengths(&self) -> impl Iterator<Item = usize> {
        [self.colors.as_ref().map(Vec::len), self.widths.as_ref().map(Vec::len)].into_iter().flatten()
    }

    /// How many times as wide as the mean the widest part is.
    fn widest(&self) -> f32 {
        self.widths.iter().flatten().map(|[times, _]| *times).fold(1.0, f32::max)
    }
}

/// The widths of the file as multiples of their mean, which leaves the groom as dense as it would be without them.
fn widths(strands: &Strands) -> Option<Vec<[f32; 2]>> {
    let widths = strands.vertex_widths.as_ref()?;
    let mean = widths.iter().map(|&width| f64::from(width)).sum::<f64>() / widths.len() as f64;
    let is_alike = widths.iter().all(|&width| width == widths[0]);
    let times = |width: f32| (f64::from(width) / mean).min(WIDEST) as f32;
    let pairs = || widths.iter().zip(&strands.thickness).map(|(&width, &taper)| [times(width), taper]);
    (!is_alike && mean > 0.0).then(|| strands.interleave(&pairs().collect::<Vec<_>>()))
}

/// A number in [0, 1) that looks random, the same for the same strand of a file (the mixer of SplitMix64, with two rounds).
fn chance(strand: u32) -> f64 {
    let mixed = (u64::from(strand) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((mixed ^ (mixed >> 29)) >> 11) as f64 / (1u64 << 53) as f64
}
