//! Built-in grooms: sound, reproducible, outside of the head, fast.

use std::time::{Duration, Instant};

use glam::Vec3;
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
        let asset = builtin.asset();
        let report = Report::new(&asset).expect("sound");
        assert_eq!((report.strands, report.max_vertices), (500, builtin.vertices));
        assert_eq!(report.metres_per_unit, 1.0);
        assert!(report.oddities.is_empty(), "{style:?}: {:?}", report.oddities);
        // The others of a pony tail begin in its tie.
        let on_head = if style == Style::Ponytail { 275 } else { 500 };
        for range in asset.ranges().take(on_head) {
            let root = asset.points[range.start].into();
            let off = match builtin.head() {
                Some(head) => head.level(root) - 1.0,
                // Colliders are 2 mm below the skin.
                None => builtin.capsules().iter().map(|part| part.distance(root)).fold(f32::INFINITY, f32::min) - 2e-3,
            };
            assert!(off.abs() < 1e-5, "{style:?}: a root that is {off} off");
        }
        Strands::new(&asset, &StrandOptions::default()).expect("sound");
    }
}

#[test]
fn no_vertex_is_inside_of_head_or_bust() {
    for style in Style::ALL {
        for vertices in [2, 5, 32] {
            let builtin = Builtin { vertices, ..small(style) };
            let (asset, head, capsules) = (builtin.asset(), builtin.head(), builtin.capsules());
            for &point in &asset.points {
                let level = head.map_or(1.0, |head| head.level(point.into()));
                assert!(level > 1.0 - 1e-5, "{style:?}: {point:?} is inside of the head");
                assert!(capsules.iter().all(|c| c.distance(point.into()) > -1e-5), "{style:?}: {point:?}");
            }
        }
    }
}

#[test]
fn the_fur_of_the_animal_flows_from_nose_to_tail_and_is_short_on_face_and_feet() {
    let asset = Builtin { strands: 6000, ..Builtin::from(Style::Animal) }.asset();
    let points = |range: std::ops::Range<usize>| asset.points[range].iter().map(|&point| Vec3::from(point)).collect();
    let strands: Vec<Vec<Vec3>> = asset.ranges().map(points).collect();
    let length = |strand: &Vec<Vec3>| strand.windows(2).map(|edge| edge[0].distance(edge[1])).sum::<f32>();
    let mean = |chosen: &dyn Fn(Vec3) -> bool, of: &dyn Fn(&Vec<Vec3>) -> f32| {
        let chosen: Vec<f32> = strands.iter().filter(|strand| chosen(strand[0])).map(of).collect();
        assert!(chosen.len() > 50, "{} strands", chosen.len());
        chosen.iter().sum::<f32>() / chosen.len() as f32
    };
    let (trunk, feet) = (|p: Vec3| p.y > 0.25 && p.z.abs() < 0.15, |p: Vec3| p.y < 0.03);
    let (face, tail) = (|p: Vec3| p.z > 0.33, |p: Vec3| p.z < -0.36);
    let backwards = |strand: &Vec<Vec3>| (strand[0] - strand[strand.len() - 1]).z / length(strand);
    assert!(mean(&trunk, &backwards) > 0.5, "{}", mean(&trunk, &backwards));
    let [trunk, feet, face, tail] =
        [mean(&trunk, &length), mean(&feet, &length), mean(&face, &length), mean(&tail, &length)];
    assert!(
        trunk > 0.02 && tail > 1.3 * trunk && feet < 0.5 * trunk && face < 0.65 * trunk,
        "{trunk} {tail} {feet} {face}"
    );
    // As many on the left as on the right.
    let left = strands.iter().filter(|strand| strand[0].x < 0.0).count();
    assert!(left.abs_diff(3000) < 150, "{left} of 6000 on the left");
}

#[test]
fn a_beard_leaves_mouth_eyes_and_forehead_free() {
    let asset = Builtin::from(Style::Beard).asset();
    let free = |p: &Vec3| p.z > 0.05 && (p.y > 0.04 || (-0.03..0.015).contains(&p.y) && p.x.abs() < 0.05);
    let roots: Vec<Vec3> = asset.ranges().map(|range| asset.points[range.start].into()).collect();
    assert_eq!(roots.iter().filter(|root| free(root)).count(), 0);
    let brows = roots.iter().filter(|root| root.y > 0.0).count();
    assert!(brows > 100 && brows < roots.len() / 4, "{brows} hairs of brows");
}

#[test]
fn a_pony_tail_is_held_where_it_is_drawn_together() {
    let asset = Builtin { strands: 2000, ..Builtin::from(Style::Ponytail) }.asset();
    let masses = asset.inverse_mass.as_ref().expect("tips are held");
    let at = |vertex: usize| Vec3::from(asset.points[vertex]);
    let ranges: Vec<_> = asset.ranges().collect();
    let (skull, tail): (Vec<_>, Vec<_>) = ranges.into_iter().partition(|range| masses[range.end - 1] == 0.0);
    assert_eq!((skull.len(), tail.len()), (1100, 900));
    let tie = skull.iter().map(|range| at(range.end - 1)).sum::<Vec3>() / 1100.0;
    assert!(tie.z < -0.09 && tie.y > 0.03, "at the back of the head: {tie}");
    let in_tie = skull.iter().map(|range| range.end - 1).chain(tail.iter().map(|range| range.start));
    let farthest = in_tie.map(|vertex| at(vertex).distance(tie)).fold(0.0, f32::max);
    assert!(farthest < 0.015, "{farthest} m from the middle of the tie");
    let lowest = tail.iter().map(|range| at(range.end - 1).y).fold(f32::INFINITY, f32::min);
    assert!(lowest < tie.y - 0.2, "it hangs down: {lowest}");
    for range in skull.iter().chain(&tail) {
        assert_eq!(masses[range.start..range.start + 3], [0.0, 0.0, 1.0]);
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
