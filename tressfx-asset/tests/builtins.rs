//! Built-in grooms: sound, reproducible, outside of the head, fast.

use std::time::{Duration, Instant};

use tressfx_asset::Report;
use tressfx_asset::builtin::{Builtin, BuiltinError, Style};
use tressfx_core::strands::{StrandOptions, Strands};

fn small(style: Style) -> Builtin {
    Builtin { strands: 500, ..Builtin::from(style) }
}

#[test]
fn every_style_is_sound_and_starts_on_the_head() {
    for style in Style::ALL {
        let builtin = small(style);
        let (asset, head) = (builtin.asset(), builtin.head().expect("every style has one"));
        let report = Report::new(&asset).expect("sound");
        assert_eq!((report.strands, report.max_vertices), (500, builtin.vertices));
        assert_eq!(report.metres_per_unit, 1.0);
        assert!(report.oddities.is_empty(), "{style:?}: {:?}", report.oddities);
        for range in asset.ranges() {
            let root = head.level(asset.points[range.start].into());
            assert!((root - 1.0).abs() < 1e-5, "{style:?}: a root at level {root}");
        }
        Strands::new(&asset, &StrandOptions::default()).expect("sound");
    }
}

#[test]
fn no_vertex_is_inside_of_head_or_bust() {
    for style in Style::ALL {
        for vertices in [2, 5, 32] {
            let builtin = Builtin { vertices, ..small(style) };
            let (asset, head, capsules) = (builtin.asset(), builtin.head().expect("a head"), builtin.capsules());
            for &point in &asset.points {
                assert!(head.level(point.into()) > 1.0 - 1e-5, "{style:?}: {point:?} is inside of the head");
                assert!(capsules.iter().all(|c| c.distance(point.into()) > -1e-5), "{style:?}: {point:?}");
            }
        }
    }
}

#[test]
fn the_face_is_free() {
    for style in [Style::Straight, Style::Wavy, Style::Long] {
        let before_the_face = |p: &&[f32; 3]| p[0].abs() < 0.03 && (-0.09..0.03).contains(&p[1]) && p[2] > 0.05;
        let asset = Builtin { strands: 4000, ..small(style) }.asset();
        assert_eq!(asset.points.iter().filter(before_the_face).count(), 0, "{style:?}");
    }
}

#[test]
fn the_seed_decides() {
    let builtin = small(Style::Wavy);
    assert_eq!(builtin.asset(), builtin.asset());
    assert_ne!(builtin.asset().points, Builtin { seed: 1, ..builtin }.asset().points);
}

#[test]
fn a_hundred_thousand_strands_take_seconds_at_most() {
    let start = Instant::now();
    let asset = Builtin::parse("long:100000:32").expect("known").asset();
    assert_eq!(asset.points.len(), 3_200_000);
    // Around a second when optimised; the bound allows for a slow, busy machine and an unoptimised build.
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
}

#[test]
fn names_and_counts_are_parsed() {
    let long = Builtin::parse("long:16384:32").expect("known");
    assert_eq!((long.style, long.strands, long.vertices), (Style::Long, 16384, 32));
    assert_eq!(long.to_string(), "long:16384:32");
    assert_eq!(Builtin::parse("fur").expect("known"), Builtin::from(Style::Fur));
    assert_eq!(Builtin::parse("curly:7").expect("known").strands, 7);
    assert!(matches!(Builtin::parse("short"), Err(BuiltinError::Name(_))));
    assert!(matches!(Builtin::parse("long:0"), Err(BuiltinError::Count { field: "strands", .. })));
    assert!(matches!(Builtin::parse("long:4:257"), Err(BuiltinError::Count { field: "vertices", .. })));
    assert!(matches!(Builtin::parse("long:4:x"), Err(BuiltinError::Count { field: "vertices", .. })));
    assert!(matches!(Builtin::parse("long:4:4:4"), Err(BuiltinError::Trailing(_))));
}
