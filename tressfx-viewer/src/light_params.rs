//! Lights of a parameter file: `[sky]` and `[[light]]`.

use anyhow::{Context, Result, bail, ensure};
use glam::Vec3;
use serde::Deserialize;
use tressfx_render::{Cone, Light, LightPlace, Lights, MAX_LIGHTS};

/// Light from everywhere, linear RGB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct SkyParams {
    above: Vec3,
    below: Vec3,
}

/// A light, as [`Light`] has it: at `position`, or infinitely far in the direction `towards`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LightParams {
    towards: Option<Vec3>,
    position: Option<Vec3>,
    reach: Option<f32>,
    cone: Option<ConeParams>,
    color: Vec3,
    #[serde(default = "yes")]
    casts: bool,
}

/// Angles are degrees.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct ConeParams {
    along: Vec3,
    inner: f32,
    outer: f32,
}

fn yes() -> bool {
    true
}

/// The light that a file describes; none where it says nothing of light.
///
/// # Errors
/// More than [`MAX_LIGHTS`]; what names neither or both places; what is not finite, or dark by less than nothing.
pub(crate) fn lights(sky: Option<&SkyParams>, lights: &[LightParams]) -> Result<Option<Lights>> {
    if sky.is_none() && lights.is_empty() {
        return Ok(None);
    }
    let SkyParams { above, below } = sky.copied().unwrap_or_default();
    ensure!(
        is_color(above) && is_color(below),
        "sky: {above} above and {below} below must be finite, and not negative"
    );
    ensure!(lights.len() <= MAX_LIGHTS, "{} tables `light`: there can be {MAX_LIGHTS}", lights.len());
    let light = |(index, light): (usize, &LightParams)| light.light().with_context(|| format!("light {index}"));
    let lights = lights.iter().enumerate().map(light).collect::<Result<_>>()?;
    Ok(Some(Lights { sky: above, ground: below, lights }))
}

impl LightParams {
    fn light(&self) -> Result<Light> {
        let Self { towards, position, reach, cone, color, casts } = *self;
        ensure!(is_color(color), "color {color} must be finite, and not negative");
        let light = match (towards, position) {
            (Some(towards), None) => {
                ensure!(is_direction(towards), "towards {towards} is no direction");
                ensure!(reach.is_none() && cone.is_none(), "`reach` and `cone` are of a light with a `position`");
                Light::directional(towards, color)
            }
            (None, Some(position)) => {
                let reach = reach.context("`reach` is missing: the distance up to which it has its full colour")?;
                ensure!(position.is_finite(), "position {position} must be finite");
                ensure!(reach.is_finite() && reach > 0.0, "reach {reach} must be more than 0");
                let cone = cone.map(|cone| cone.cone()).transpose()?;
                Light { place: LightPlace::Point { position, reach, cone }, ..Light::point(position, reach, color) }
            }
            _ => bail!("it must have either `towards` or `position`"),
        };
        Ok(light.casts(casts))
    }
}

impl ConeParams {
    fn cone(self) -> Result<Cone> {
        let Self { along, inner, outer } = self;
        ensure!(is_direction(along), "cone: along {along} is no direction");
        ensure!(
            inner >= 0.0 && inner < outer && outer <= 180.0,
            "cone: inner {inner} and outer {outer} must be from 0 to 180 degrees, the outer one larger"
        );
        Ok(Cone { along, inner: inner.to_radians(), outer: outer.to_radians() })
    }
}

fn is_color(color: Vec3) -> bool {
    color.is_finite() && color.min_element() >= 0.0
}

fn is_direction(direction: Vec3) -> bool {
    direction.try_normalize().is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Deserialize)]
    struct File {
        sky: Option<SkyParams>,
        #[serde(default)]
        light: Vec<LightParams>,
    }

    fn read(text: &str) -> Result<Option<Lights>> {
        let file: File = toml::from_str(text)?;
        lights(file.sky.as_ref(), &file.light)
    }

    #[test]
    fn lights_are_where_the_file_says() {
        assert_eq!(read("").unwrap(), None);
        let text = "[sky]\nabove = [1, 2, 3]\n[[light]]\ntowards = [0, 1, 0]\ncolor = [1, 1, 1]\n[[light]]\nposition = [0, 2, 0]\n\
                    reach = 1\ncolor = [2, 2, 2]\ncasts = false\ncone = { along = [0, -1, 0], inner = 10, outer = 90 }\n";
        let Lights { sky, ground, lights } = read(text).unwrap().unwrap();
        assert_eq!((sky, ground), (Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO));
        let cone = Cone { along: Vec3::NEG_Y, inner: 10f32.to_radians(), outer: 90f32.to_radians() };
        let spot = Light::spot(Vec3::Y * 2.0, 1.0, cone, Vec3::splat(2.0)).casts(false);
        assert_eq!(lights, [Light::directional(Vec3::Y, Vec3::ONE), spot]);
    }

    #[test]
    fn what_is_no_light_is_refused_by_its_number() {
        let good = "[[light]]\ntowards = [0, 1, 0]\ncolor = [1, 1, 1]\n";
        let message = |text: &str| format!("{:#}", read(&format!("{good}[[light]]\n{text}")).unwrap_err());
        assert!(message("color = [1, 1, 1]").contains("light 1: it must have either"));
        assert!(message("towards = [0, 0, 0]\ncolor = [1, 1, 1]").contains("light 1: towards"));
        assert!(message("towards = [0, 1, 0]\ncolor = [1, -1, 1]").contains("light 1: color"));
        assert!(message("towards = [0, 1, 0]\nreach = 1\ncolor = [1, 1, 1]").contains("`reach` and `cone`"));
        assert!(message("position = [0, 1, 0]\ncolor = [1, 1, 1]").contains("`reach` is missing"));
        assert!(message("position = [0, 1, 0]\nreach = 0\ncolor = [1, 1, 1]").contains("reach 0"));
        let cone =
            "position = [0, 1, 0]\nreach = 1\ncolor = [1, 1, 1]\ncone = { along = [0, 1, 0], inner = 20, outer = 10 }";
        assert!(message(cone).contains("inner 20 and outer 10"));
        assert!(read(&good.repeat(17)).unwrap_err().to_string().contains("17 tables `light`: there can be 16"));
        assert!(read("[sky]\nabove = [-1, 0, 0]").unwrap_err().to_string().contains("sky"));
    }
}
