//! What grown hair looks like: clumps, curls, wandering. Edges keep their lengths, and numbers out of range are refused by name.

use glam::Vec3;
use tressfx_asset::grow::{Amount, Direction, GrowError, Growth, grow};
use tressfx_asset::mesh::skinned_obj;
use tressfx_core::body::SkinnedMesh;

fn square() -> SkinnedMesh {
    skinned_obj("square", b"v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 3 2\nf 1 4 3\n").unwrap()
}

/// Straight hair of one length, 0.5, that stands.
fn straight() -> Growth {
    Growth {
        amount: Amount::Count(600),
        vertices: 64,
        length: 0.5,
        variation: 0.0,
        noise: 0.0,
        curl_length: 0.1,
        ..Growth::default()
    }
}

fn strands(growth: &Growth) -> Vec<Vec<Vec3>> {
    let asset = grow(&square(), growth).unwrap();
    asset.check().unwrap();
    asset.ranges().map(|range| asset.points[range].iter().map(|&point| point.into()).collect()).collect()
}

#[test]
fn edges_keep_their_lengths_whatever_the_style_is() {
    let combed = Growth { direction: Direction::Comb(Vec3::X), lie: 1.0, noise: 0.5, ..straight() };
    let styles = [
        combed.clone(),
        Growth { clumps: 20, clump: 1.0, ..combed.clone() },
        Growth { frizz: 1.0, ..combed.clone() },
        Growth { curl_radius: 0.05, ..combed.clone() },
        // The tightest that is not refused, and one that is wider than it is long.
        Growth { curl_radius: 0.02, curl_length: 4.0 * 0.5 / 63.0 + 1e-6, ..combed.clone() },
        Growth { curl_radius: 0.49, curl_length: 0.3, ..combed.clone() },
        Growth { curl_radius: 0.03, clumps: 9, clump: 0.8, frizz: 0.4, ..combed.clone() },
        Growth { curl_radius: 0.3, curl_length: 2.5, vertices: 2, length: 0.5, ..combed },
    ];
    for growth in &styles {
        let edge = 0.5 / (growth.vertices - 1) as f32;
        for strand in strands(growth) {
            let worst =
                strand.windows(2).map(|pair| (pair[0].distance(pair[1]) / edge - 1.0).abs()).fold(0.0, f32::max);
            // Positions are stored in f32, at most 1.5 from the origin.
            assert!(worst < 1e-4, "an edge differs by {worst}: {growth:?}");
        }
    }
}

#[test]
fn curls_are_helices_whose_radius_grows_from_the_root() {
    let growth = Growth { curl_radius: 0.03, ..straight() };
    let mut phases = Vec::new();
    for strand in strands(&growth) {
        let root = strand[0];
        let aside = |vertex: usize| Vec3::new(strand[vertex].x - root.x, 0.0, strand[vertex].z - root.z);
        let mut turned = 0.0;
        for vertex in 1..64 {
            let radius = 0.03 * vertex as f32 / 63.0;
            assert!(
                (aside(vertex).length() - radius).abs() < 1e-4,
                "{} at {vertex}, not {radius}",
                aside(vertex).length()
            );
            assert!(strand[vertex].y > strand[vertex - 1].y, "it never goes back");
            if vertex > 1 {
                turned += aside(vertex - 1).angle_between(aside(vertex));
            }
        }
        // A turn for each 0.1 that it is high.
        let turns = turned / std::f32::consts::TAU;
        assert!((turns - (strand[63].y - strand[1].y) / 0.1).abs() < 0.01, "{turns} turns in {}", strand[63].y);
        phases.push(aside(63).normalize());
    }
    // Without clumps they turn by themselves.
    let mean = phases.iter().sum::<Vec3>() / phases.len() as f32;
    assert!(mean.length() < 0.15, "{mean}");
}

#[test]
fn clumps_draw_tips_together_and_leave_roots() {
    let before = strands(&straight());
    for (clump, most) in [(1.0, 0.25), (0.5, 0.6)] {
        let clumped = strands(&Growth { clumps: 12, clump, ..straight() });
        // Standing hair is drawn to a strand that is as high as before: those that are, are the middles.
        let is_middle = |strand: &Vec<Vec3>| strand[63].distance(strand[0] + 0.5 * Vec3::Y) < 1e-5;
        let middles: Vec<&Vec<Vec3>> = clumped.iter().filter(|strand| is_middle(strand)).collect();
        assert_eq!(middles.len(), 12);
        for (strand, before) in clumped.iter().zip(&before) {
            assert_eq!(strand[0], before[0], "roots stay");
            let nearest =
                middles.iter().min_by(|one, other| one[0].distance(strand[0]).total_cmp(&other[0].distance(strand[0])));
            let away = |vertex: usize| {
                let middle = nearest.unwrap()[vertex];
                Vec3::new(middle.x - strand[vertex].x, 0.0, middle.z - strand[vertex].z).length()
            };
            let (root, half, tip) = (away(0), away(32), away(63));
            assert!(tip <= most * root + 1e-5, "{root} {tip}");
            // By the square of the way.
            assert!((half - root * (1.0 - 0.258 * clump)).abs() < 0.06 * root + 1e-5, "{root} {half}");
        }
    }
    // Those of a clump curl together.
    let curled = strands(&Growth { clumps: 1, clump: 0.0, curl_radius: 0.03, ..straight() });
    let first = curled[0][63] - curled[0][0];
    assert!(curled.iter().all(|strand| (strand[63] - strand[0]).distance(first) < 1e-4));
}

#[test]
fn strands_wander_by_themselves_more_to_the_tip() {
    let mean = |frizz: f32, vertex: usize| {
        let strands = strands(&Growth { frizz, ..straight() });
        let aside = strands.iter().map(|strand| (strand[vertex] - strand[0]).with_y(0.0));
        let count = strands.len() as f32;
        (aside.clone().map(Vec3::length).sum::<f32>() / count, aside.sum::<Vec3>().length() / count)
    };
    assert!(mean(0.0, 63).0 < 1e-6);
    let [(near, _), (tip, all)] = [mean(0.5, 16), mean(0.5, 63)];
    assert!(near > 1e-4 && tip > 4.0 * near && all < 0.2 * tip, "{near} {tip} {all}");
    assert!(mean(1.0, 63).0 > 1.3 * tip);
}

#[test]
fn what_is_out_of_range_is_refused_by_name() {
    let growth = straight();
    for (wrong, name) in [
        (Growth { amount: Amount::Count(0), ..growth.clone() }, "guides"),
        (Growth { amount: Amount::Count(3_000_000), ..growth.clone() }, "guides"),
        (Growth { clump: 1.1, ..growth.clone() }, "clump"),
        (Growth { clumps: 601, ..growth.clone() }, "clumps"),
        (Growth { frizz: -0.1, ..growth.clone() }, "frizz"),
        (Growth { noise: f32::NAN, ..growth.clone() }, "noise"),
        (Growth { curl_radius: -1.0, ..growth.clone() }, "curl radius"),
        (Growth { curl_radius: 0.5, ..growth.clone() }, "curl radius"),
        (Growth { curl_radius: f32::NAN, ..growth.clone() }, "curl radius"),
        (Growth { curl_radius: 0.1, curl_length: 0.01, ..growth.clone() }, "curl length"),
        (Growth { curl_radius: 0.1, curl_length: f32::INFINITY, ..growth.clone() }, "curl length"),
        (Growth { curl_radius: 0.1, curl_length: f32::NAN, ..growth.clone() }, "curl length"),
    ] {
        match grow(&square(), &wrong).unwrap_err() {
            GrowError::Number { name: found, .. } => assert_eq!(found, name),
            other => panic!("{other}"),
        }
    }
}
