//! Methods and their settings, as `tressfx render` takes them.

use anyhow::{Result, bail};

use crate::figures::Extent;

/// What belongs together in a plot: one technique in one variant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Family {
    pub(crate) name: &'static str,
    words: &'static [&'static str],
    ks: &'static [u32],
    quick_ks: &'static [u32],
}

/// All families, in the order of the tables.
pub(crate) const FAMILIES: [Family; 12] = [
    Family {
        name: "ppll",
        words: &["--oit", "ppll", "--skip-hidden", "false"],
        ks: &[0, 1, 2, 4, 8, 16, 32],
        quick_ks: &[1, 4, 8, 16],
    },
    Family {
        name: "ppll-raster",
        words: &["--oit", "ppll", "--skip-hidden", "false", "--fill", "raster"],
        ks: &[0, 1, 2, 4, 8, 16, 32],
        quick_ks: &[8],
    },
    Family {
        name: "ppll-weighted",
        words: &["--oit", "ppll", "--skip-hidden", "false", "--oit-tail", "weighted"],
        ks: &[4, 8, 16],
        quick_ks: &[8],
    },
    Family {
        name: "ppll-weighted-4-places",
        words: &["--oit", "ppll", "--oit-tail", "weighted", "--places", "4"],
        ks: &[8],
        quick_ks: &[8],
    },
    Family { name: "ppll-skip-hidden", words: &["--oit", "ppll", "--skip-hidden", "true"], ks: &[8], quick_ks: &[] },
    Family { name: "shortcut-mean", words: &["--oit", "shortcut"], ks: &[1, 2, 3, 4, 8], quick_ks: &[1, 3, 8] },
    Family {
        name: "shortcut-ordered",
        words: &["--oit", "shortcut", "--oit-ordered"],
        ks: &[1, 2, 3, 4, 8],
        quick_ks: &[3, 8],
    },
    Family {
        name: "shortcut-mean-skip-hidden",
        words: &["--oit", "shortcut", "--skip-hidden", "true"],
        ks: &[3],
        quick_ks: &[],
    },
    Family { name: "tiles", words: &["--oit", "tiles"], ks: &[], quick_ks: &[] },
    Family { name: "tiles-4-places", words: &["--oit", "tiles", "--places", "4"], ks: &[], quick_ks: &[] },
    Family { name: "tiles-16-places", words: &["--oit", "tiles", "--places", "16"], ks: &[], quick_ks: &[] },
    Family { name: "tiles-64-places", words: &["--oit", "tiles", "--places", "64"], ks: &[], quick_ks: &[] },
];

/// A family with a setting.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Method {
    /// Such as `ppll-k8`.
    pub(crate) name: String,
    pub(crate) words: Vec<String>,
}

/// What makes the light of a picture, all with the blending that is nearest to the truth. The method of the nearest fibre is drawn by the
/// reference renderer, with the spacing of TressFX 4.1, in radii, and with two that suit these grooms better.
const SHADOWS: [(&str, &[&str]); 7] = [
    ("no-shadows", &["--no-shadows"]),
    ("nearest-0.4", &["--reference", "--reference-light", "nearest", "--fibre-spacing", "0.4"]),
    ("nearest-40", &["--reference", "--reference-light", "nearest", "--fibre-spacing", "40"]),
    ("nearest-100", &["--reference", "--reference-light", "nearest", "--fibre-spacing", "100"]),
    ("shadows-128", &["--shadow-texels", "128", "--shadow-layers", "32"]),
    ("shadows-192", &[]),
    ("shadows-256", &["--shadow-texels", "256", "--shadow-layers", "64"]),
];

/// All methods.
pub(crate) fn methods(extent: Extent) -> Vec<Method> {
    if extent == Extent::Light {
        let words = |own: &[&str]| {
            ["--oit", "tiles", "--places", "4"].iter().chain(own).map(|word| (*word).to_owned()).collect()
        };
        return SHADOWS.map(|(name, own)| Method { name: name.to_owned(), words: words(own) }).into();
    }
    FAMILIES.iter().flat_map(|family| of_family(family, extent)).collect()
}

fn of_family(family: &Family, extent: Extent) -> Vec<Method> {
    let words =
        |more: &[String]| family.words.iter().map(|word| (*word).to_owned()).chain(more.iter().cloned()).collect();
    let ks = if extent == Extent::Quick { family.quick_ks } else { family.ks };
    if family.ks.is_empty() {
        return vec![Method { name: family.name.to_owned(), words: words(&[]) }];
    }
    let of = |k: &u32| Method {
        name: format!("{}-k{k}", family.name),
        words: words(&["--oit-k".to_owned(), k.to_string()]),
    };
    ks.iter().map(of).collect()
}

/// Those that are named, or all where none is.
///
/// # Errors
/// If there is no method of a name.
pub(crate) fn named(methods: Vec<Method>, names: &[String]) -> Result<Vec<Method>> {
    if let Some(unknown) = names.iter().find(|&name| methods.iter().all(|method| method.name != *name)) {
        let known: Vec<_> = methods.iter().map(|method| method.name.as_str()).collect();
        bail!("there is no method {unknown}; there are {}", known.join(", "));
    }
    Ok(methods.into_iter().filter(|method| names.is_empty() || names.contains(&method.name)).collect())
}

/// Which of [`FAMILIES`] a method belongs to, and its setting in words.
pub(crate) fn family_of(method: &str) -> Option<(usize, &str)> {
    let (name, setting) = method.rsplit_once("-k").unwrap_or((method, ""));
    Some((FAMILIES.iter().position(|family| family.name == name)?, setting))
}

/// Where a method comes in the tables.
pub(crate) fn place(method: &str) -> Option<(usize, u32)> {
    let (family, setting) = family_of(method)?;
    Some((family, setting.parse().unwrap_or(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_a_name_of_its_own_that_leads_to_its_family() {
        for extent in [Extent::Quick, Extent::Full] {
            let mut names: Vec<_> = methods(extent).into_iter().map(|method| method.name).collect();
            assert!(names.iter().all(|name| family_of(name).is_some()), "{names:?}");
            let count = names.len();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), count);
        }
        assert_eq!(methods(Extent::Full).len(), 34);
        let named = |name: &str| named(methods(Extent::Full), &[name.to_owned()]);
        assert_eq!(named("tiles-4-places").unwrap(), methods(Extent::Full)[31..32]);
        assert!(named("tiles-5-places").unwrap_err().to_string().contains("tiles-16-places"));
        assert_eq!(family_of("ppll-raster-k8"), Some((1, "8")));
        assert_eq!(family_of("tiles"), Some((8, "")));
    }
}
