//! What is drawn: grooms, and how near the camera is.

use std::path::PathBuf;

use anyhow::{Result, bail};

use crate::figures::Extent;

/// How near the camera is: a share of the distance at which the sphere around the box of the groom fills the picture from top to
/// bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    name: &'static str,
    share: f64,
}

const NEAR: Place = Place { name: "near", share: 0.38 };
const MIDDLE: Place = Place { name: "middle", share: 0.7 };
const FAR: Place = Place { name: "far", share: 2.0 };

/// In which pose a groom is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Moment {
    /// After the frames of the setting, at rest in its place.
    Still,
    /// As it is in its file.
    Rest,
    /// In the middle of a motion of the head.
    Shaken,
}

/// Vertical field of view in degrees.
const FOV: f64 = 30.0;

/// A groom from a distance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scene {
    /// Such as `curly-near`.
    pub(crate) name: String,
    /// As `tressfx` takes it; none where its folder is not known.
    pub(crate) groom: Option<String>,
    place: Place,
    moment: Moment,
}

/// The box around a groom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) min: [f64; 3],
    pub(crate) max: [f64; 3],
}

/// What is looked at: a line each.
#[derive(Clone, Copy, Debug)]
struct Groom {
    name: &'static str,
    /// As `tressfx` takes it, or a file in the folder of real grooms.
    file: &'static str,
    is_real: bool,
    /// Whether its light is judged.
    is_lit: bool,
}

const GROOMS: &[Groom] = &[
    Groom { name: "curly", file: "builtin:curly", is_real: false, is_lit: true },
    Groom { name: "fur", file: "builtin:fur", is_real: false, is_lit: true },
    Groom { name: "animal", file: "builtin:animal", is_real: false, is_lit: true },
    Groom { name: "long", file: "builtin:long", is_real: false, is_lit: true },
    Groom { name: "dense", file: "builtin:long:131072:32", is_real: false, is_lit: false },
    Groom { name: "mohawk", file: "tressfx41_ratboy/Ratboy_mohawk.tfx", is_real: true, is_lit: true },
    Groom { name: "sintel", file: "sintel_lite/GEO-sintel_hair_emit.002-sintel_hair.tfx", is_real: true, is_lit: true },
];

/// In a quick run each groom is seen from one distance, and the dense one has fewer strands.
const QUICK: [(&str, Place); 6] =
    [("curly", NEAR), ("fur", FAR), ("long", MIDDLE), ("dense", NEAR), ("mohawk", FAR), ("sintel", MIDDLE)];
const QUICK_DENSE: &str = "builtin:long:32768:16";

/// All scenes; those of real grooms have no groom unless TRESSFX_ASSETS names a folder.
pub(crate) fn scenes(extent: Extent) -> Vec<Scene> {
    let assets = std::env::var_os("TRESSFX_ASSETS").map(PathBuf::from);
    let scene = |name: &str, place: Place, moment: Moment| {
        let groom = GROOMS.iter().find(|groom| groom.name == name).expect("a groom of the table");
        let file = if (name, extent) == ("dense", Extent::Quick) { QUICK_DENSE } else { groom.file };
        let groom = match groom.is_real {
            true => assets.as_ref().map(|assets| assets.join(file).to_string_lossy().into_owned()),
            false => Some(file.to_owned()),
        };
        let seen = match moment {
            Moment::Still => place.name,
            Moment::Rest => "rest",
            Moment::Shaken => "shaken",
        };
        Scene { name: format!("{name}-{seen}"), groom, place, moment }
    };
    match extent {
        Extent::Quick => QUICK.iter().map(|&(name, place)| scene(name, place, Moment::Still)).collect(),
        Extent::Full => {
            let places = [NEAR, MIDDLE, FAR];
            GROOMS.iter().flat_map(|groom| places.map(|place| scene(groom.name, place, Moment::Still))).collect()
        }
        Extent::Light => {
            let moments = [Moment::Rest, Moment::Shaken];
            let lit = GROOMS.iter().filter(|groom| groom.is_lit);
            lit.flat_map(|groom| moments.map(|moment| scene(groom.name, MIDDLE, moment))).collect()
        }
    }
}

/// Those of some scenes that have one of these names; all where there is no name.
pub(crate) fn named(scenes: Vec<Scene>, names: &[String]) -> Result<Vec<Scene>> {
    if let Some(unknown) = names.iter().find(|&name| scenes.iter().all(|scene| scene.name != *name)) {
        let known: Vec<_> = scenes.iter().map(|scene| scene.name.as_str()).collect();
        bail!("there is no scene {unknown}; there are {}", known.join(", "));
    }
    Ok(scenes.into_iter().filter(|scene| names.is_empty() || names.contains(&scene.name)).collect())
}

impl Scene {
    /// How `tressfx render` gets to the pose.
    pub(crate) fn motion(&self, frames: u32) -> Vec<String> {
        let frames = frames.to_string();
        let words: &[&str] = match self.moment {
            Moment::Still => &["--frames", &frames],
            Moment::Rest => &["--frames", "0"],
            Moment::Shaken => &["--frames", &frames, "--motion", "shake"],
        };
        words.iter().map(|word| (*word).to_owned()).collect()
    }

    /// What `tressfx render --camera` takes: slightly from above, from in front or, where the groom is much deeper than wide,
    /// from the side.
    pub(crate) fn camera(&self, bounds: &Bounds) -> String {
        let extent = [0, 1, 2].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let center = [0, 1, 2].map(|axis| 0.5 * (bounds.max[axis] + bounds.min[axis]));
        let direction = if extent[2] > 1.5 * extent[0] { [1.0, 0.12, 0.35] } else { [0.35, 0.12, 1.0] };
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let distance = self.place.share * 0.5 * length(extent) / (0.5 * FOV).to_radians().sin();
        let eye = [0, 1, 2].map(|axis| center[axis] + direction[axis] / length(direction) * distance);
        let numbers = eye.iter().chain(&center).chain(&[FOV]).map(|number| format!("{number:.5}"));
        numbers.collect::<Vec<_>>().join(",")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_enough_scenes_and_none_twice() {
        let lit = GROOMS.iter().filter(|groom| groom.is_lit).count();
        for (extent, count) in
            [(Extent::Quick, QUICK.len()), (Extent::Full, 3 * GROOMS.len()), (Extent::Light, 2 * lit)]
        {
            let mut names: Vec<_> = scenes(extent).into_iter().map(|scene| scene.name).collect();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), count);
        }
    }

    #[test]
    fn scenes_are_found_by_name() {
        let named = |names: &[&str]| {
            named(scenes(Extent::Full), &names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>())
        };
        let names: Vec<_> = named(&["sintel-far", "curly-near"]).unwrap().into_iter().map(|scene| scene.name).collect();
        assert_eq!(names, ["curly-near", "sintel-far"]);
        assert_eq!(named(&[]).unwrap().len(), 3 * GROOMS.len());
        assert!(named(&["curly"]).unwrap_err().to_string().contains("no scene curly; there are curly-near"));
    }

    #[test]
    fn the_camera_sees_the_middle_from_its_distance() {
        let scene = Scene { name: String::new(), groom: None, place: NEAR, moment: Moment::Rest };
        let camera = scene.camera(&Bounds { min: [-1.0, 0.0, -2.0], max: [1.0, 4.0, 2.0] });
        let numbers: Vec<f64> = camera.split(',').map(|number| number.parse().unwrap()).collect();
        assert_eq!(numbers[3..], [0.0, 2.0, 0.0, 30.0]);
        let distance = (numbers[0].powi(2) + (numbers[1] - 2.0).powi(2) + numbers[2].powi(2)).sqrt();
        assert!((distance - NEAR.share * 3.0 / 15f64.to_radians().sin()).abs() < 1e-3, "{distance}");
        assert!(numbers[0] > numbers[2], "it is deep: from the side");
    }
}
