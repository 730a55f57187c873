//! Grooms by name.

use glam::Vec3;
use tressfx_asset::builtin::Builtin;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::{StrandOptions, Strands};

/// What stops a benchmark.
pub type Failure = Box<dyn std::error::Error>;

/// A file, `builtin:NAME...` or `sphere:STRANDS`.
///
/// # Errors
/// A name that is none, or a file that cannot be read.
pub fn asset(name: &str) -> Result<HairAsset, Failure> {
    if let Some(builtin) = name.strip_prefix("builtin:") {
        return Ok(builtin.parse::<Builtin>()?.asset());
    }
    match name.strip_prefix("sphere:") {
        Some(strands) => Ok(sphere(strands.parse()?)),
        None => Ok(tressfx_asset::read(name)?),
    }
}

/// The strands of `GROOM[,FOLLOWS]`: so many strands follow each of the groom, none where nothing is said.
///
/// # Errors
/// As [`asset`], and strands that cannot be made of it.
pub fn strands(groom: &str) -> Result<Strands, Failure> {
    let (name, follows) = groom.rsplit_once(',').unwrap_or((groom, "0"));
    let options = StrandOptions { follows: Some(follows.parse()?), ..StrandOptions::default() };
    Ok(Strands::new(&asset(name)?, &options)?)
}

/// Strands 0.4 units long on a sphere, which hang a little: like the groom on which AMD's shaders were measured.
fn sphere(strands: u32) -> HairAsset {
    let golden = std::f32::consts::PI * (3.0 - 5f32.sqrt());
    let strand = |i: u32| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / strands as f32;
        let (sin, cos) = (golden * i as f32).sin_cos();
        let out = Vec3::new(cos, 0.0, sin) * (1.0 - y * y).sqrt() + Vec3::Y * y;
        let point = move |s: f32| out * (0.5 + 0.4 * s - 0.05 * s * s) - Vec3::Y * 0.12 * s * s;
        (0..32).map(move |vertex| point(vertex as f32 / 31.0).to_array())
    };
    HairAsset::new("sphere", AssetFormat::Builtin, (0..strands).flat_map(strand).collect(), vec![32; strands as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_make_grooms_and_others_are_errors() {
        let sphere = strands("sphere:20,2").unwrap();
        assert_eq!((sphere.strand_count(), sphere.vertices), (60, 32));
        assert_eq!(strands("builtin:wavy:30:8").unwrap().strand_count(), 30);
        for wrong in ["builtin:none", "sphere:many", "sphere:20,x", "no such file.tfx"] {
            assert!(strands(wrong).is_err(), "{wrong}");
        }
    }
}
