//! Strands against what is known about simple grooms.

use glam::{Vec3, Vec4};
use tressfx_core::asset::{AssetFormat, HairAsset, Placement};
use tressfx_core::strands::{MAX_FOLLOWS, StrandOptions, Strands, StrandsError, metres_per_unit};

fn asset(strands: &[&[[f32; 3]]]) -> HairAsset {
    let counts = strands.iter().map(|strand| strand.len() as u32).collect();
    HairAsset::new("test", AssetFormat::Text, strands.concat(), counts)
}

/// Bent strands beside each other, each with texture coordinates of its own.
fn row(strands: u32, vertices: u32) -> HairAsset {
    let point = |i: u32| [(i / vertices) as f32 * 0.01, (i % vertices) as f32, ((i % vertices) as f32).sin()];
    let points = (0..strands * vertices).map(point).collect();
    HairAsset {
        strand_uvs: Some((0..strands).map(|strand| [strand as f32, 0.5]).collect()),
        ..HairAsset::new("row", AssetFormat::Builtin, points, vec![vertices; strands as usize])
    }
}

fn in_file_order() -> StrandOptions {
    StrandOptions { shuffle: false, ..StrandOptions::default() }
}

fn make(asset: &HairAsset, options: &StrandOptions) -> Strands {
    Strands::new(asset, options).unwrap_or_else(|error| panic!("{error}"))
}

const BENT: [[f32; 3]; 4] = [[0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 1.0, 3.0]];

#[test]
fn ragged_strands_are_resampled_by_arc_length_and_others_kept() {
    let strands = make(&asset(&[&BENT, &[[5.0, 0.0, 0.0], [5.0, 3.0, 0.0]]]), &in_file_order());
    assert_eq!((strands.guides, strands.vertices), (2, 4));
    let at = |index: usize| strands.rest[index].truncate().to_array();
    assert_eq!([at(0), at(1), at(2), at(3)], BENT);
    assert_eq!([at(4), at(5), at(6), at(7)], [[5.0, 0.0, 0.0], [5.0, 1.0, 0.0], [5.0, 2.0, 0.0], [5.0, 3.0, 0.0]]);
    assert_eq!(strands.rest_lengths, [1.0, 1.0, 2.0, 0.0, 1.0, 1.0, 1.0, 0.0]);

    let coarse = make(&asset(&[&BENT]), &StrandOptions { vertices: Some(3), ..in_file_order() });
    assert_eq!(coarse.rest[1].truncate().to_array(), [0.0, 1.0, 1.0]);
    assert_eq!(coarse.rest.iter().map(|vertex| vertex.w).collect::<Vec<_>>(), [0.0, 0.0, 1.0]);
}

#[test]
fn inverse_masses_follow_the_convention_where_the_file_has_none() {
    let masses = |asset: &HairAsset| make(asset, &in_file_order()).rest.iter().map(|v| v.w).collect::<Vec<_>>();
    let mut bent = asset(&[&BENT]);
    assert_eq!(masses(&bent), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(masses(&asset(&[&BENT[..2]])), [0.0, 1.0]);
    bent.both_ends_immovable = true;
    assert_eq!(masses(&bent), [0.0; 4]);
    bent.inverse_mass = Some(vec![0.0, 0.5, 1.0, 2.0]);
    assert_eq!(masses(&bent), [0.0, 0.5, 1.0, 2.0]);
}

#[test]
fn frames_turn_with_the_strand_and_do_not_twist() {
    let strands = make(&asset(&[&BENT]), &in_file_order());
    let axis = |vertex: usize, axis: Vec3| strands.rest_frames[vertex] * axis;
    for (vertex, edge) in [Vec3::Y, Vec3::Z, Vec3::Z, Vec3::Z].into_iter().enumerate() {
        assert!(axis(vertex, Vec3::X).distance(edge) < 1e-6, "{vertex}");
    }
    // The bend is about x: whatever points along x stays, and nothing else may turn into it.
    let along_x = |vertex: usize| (axis(vertex, Vec3::Y).x, axis(vertex, Vec3::Z).x);
    assert!((along_x(0).0 - along_x(3).0).abs() < 1e-6 && (along_x(0).1 - along_x(3).1).abs() < 1e-6);
    assert!(strands.tangents[1].truncate().distance(Vec3::new(0.0, 1.0, 1.0).normalize()) < 1e-6);
    assert_eq!(strands.tangents[3], Vec4::Z);
    assert_eq!(strands.root_directions, [Vec3::Y]);
}

#[test]
fn thickness_tapers_as_a_quarter_ellipse() {
    let strands = make(&asset(&[&BENT]), &in_file_order());
    let expected = [1.0, (1.0f32 - 1.0 / 16.0).sqrt(), 0.75f32.sqrt(), 0.0];
    assert!(strands.thickness.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{:?}", strands.thickness);
}

#[test]
fn degenerate_strands_are_harmless() {
    let back_and_forth: [[f32; 3]; 4] = [[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]];
    let late: [[f32; 3]; 3] = [[1.0; 3], [1.0; 3], [1.0, 1.0, 2.0]];
    let strands = make(
        &asset(&[&back_and_forth, &late, &[[2.0; 3]; 4], &[[3.0; 3]]]),
        &StrandOptions { follows: Some(2), ..in_file_order() },
    );
    assert!(strands.rest_frames.iter().all(|frame| frame.is_normalized()));
    assert!(strands.tangents.iter().all(|tangent| (tangent.length() - 1.0).abs() < 1e-6));
    assert_eq!(strands.root_directions, [Vec3::Y, Vec3::Z, Vec3::Y, Vec3::Y]);
    assert_eq!(strands.thickness[8], 1.0);
    assert!(strands.thickness[9] > strands.thickness[10] && strands.thickness[11] == 0.0);
    assert!(strands.rest_of_all().iter().all(|vertex| vertex.is_finite()));
}

#[test]
fn follow_strands_fill_a_disc_across_the_root() {
    let options =
        StrandOptions { follows: Some(MAX_FOLLOWS), follow_radius: Some(0.5), tip_separation: 1.0, ..in_file_order() };
    let strands = make(&asset(&[&BENT, &BENT, &BENT, &BENT]), &options);
    assert_eq!(strands.strand_count(), 4 * 257);
    assert_eq!(strands.follow_offsets.len(), 4 * 256);
    let lengths: Vec<f32> = strands.follow_offsets.iter().map(|offset| offset.truncate().length()).collect();
    assert!(lengths.iter().all(|&length| length <= 0.5 + 1e-6));
    assert!(strands.follow_offsets.iter().all(|offset| offset.truncate().dot(Vec3::Y).abs() < 1e-6));
    // Uniform by area: a quarter of them within half of the radius.
    let inner = lengths.iter().filter(|&&length| length < 0.25).count() as f32 / lengths.len() as f32;
    assert!((inner - 0.25).abs() < 0.05, "{inner}");
    let all = strands.rest_of_all();
    let follow = 4 + 2;
    let offset = |vertex: usize| all[follow * 4 + vertex] - strands.rest[2 * 4 + vertex];
    assert!(offset(0).distance(strands.follow_offsets[2]) < 1e-6);
    assert!(offset(3).distance(strands.follow_offsets[2] * 2.0) < 1e-6);
    assert!(
        all.iter()
            .all(|p| p.truncate().cmpge(strands.bounds.min).all() && p.truncate().cmple(strands.bounds.max).all())
    );
}

#[test]
fn the_order_is_a_permutation_and_a_prefix_samples_evenly() {
    let groom = row(1000, 4);
    let strands = make(&groom, &StrandOptions::default());
    let mut sorted = strands.order.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..1000));
    let first_half = strands.order[..200].iter().filter(|&&strand| strand < 500).count();
    assert!((70..130).contains(&first_half), "{first_half}");
    let uvs = groom.strand_uvs.as_ref().expect("set above");
    assert_eq!(strands.strand_uv.as_ref().expect("from the file")[7].to_array(), uvs[strands.order[7] as usize]);
    assert_eq!(strands, make(&groom, &StrandOptions::default()));
}

#[test]
fn layouts_are_inverse_to_each_other_and_poses_go_back_in_file_order() {
    let groom = row(50, 6);
    let strands = make(&groom, &StrandOptions { follows: Some(2), ..StrandOptions::default() });
    let gpu = strands.interleave(&strands.rest);
    assert_eq!(gpu[3 * 50 + 7], strands.rest[7 * 6 + 3]);
    assert_eq!(strands.deinterleave(&gpu), strands.rest);

    let all = strands.rest_of_all();
    assert_eq!(strands.pose_asset(&all, false).expect("enough").points, groom.points);
    let pose = strands.pose_asset(&all, true).expect("all");
    assert_eq!(pose.strand_count(), 150);
    assert_eq!(pose.points[3 * 6 * 4..][..6], groom.points[6 * 4..][..6]);
    let guide = strands.order.iter().position(|&strand| strand == 4).expect("a permutation");
    let second_follow = &all[(50 * 2 + guide) * 6..][..6];
    assert!(pose.points[(3 * 4 + 2) * 6..][..6].iter().zip(second_follow).all(|(a, b)| *a == b.truncate().to_array()));
    assert!(matches!(
        strands.pose_asset(&strands.rest, true),
        Err(StrandsError::PoseLength { found: 300, needed: 900 })
    ));
}

#[test]
fn placement_and_units_are_applied() {
    let mut groom = asset(&[&BENT]);
    groom.placement = Some(Placement { scale: 2.0, rotation: [0.0, 0.0, 90.0], translation: [1.0, 0.0, 0.0] });
    let strands = make(&groom, &in_file_order());
    assert!(strands.rest[1].truncate().distance(Vec3::new(-1.0, 0.0, 0.0)) < 1e-6, "{}", strands.rest[1]);
    assert_eq!(strands.metres_per_unit, metres_per_unit(&strands.bounds));
    let given = make(&groom, &StrandOptions { metres_per_unit: Some(0.3), ..in_file_order() });
    assert_eq!(given.metres_per_unit, 0.3);
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let groom = asset(&[&BENT]);
    let bad = |options: StrandOptions| Strands::new(&groom, &options).expect_err("out of range").to_string();
    assert!(bad(StrandOptions { vertices: Some(257), ..in_file_order() }).contains("vertices is 257"));
    assert!(bad(StrandOptions { vertices: Some(1), ..in_file_order() }).contains("vertices is 1"));
    assert!(bad(StrandOptions { follows: Some(257), ..in_file_order() }).contains("follows is 257"));
    assert!(bad(StrandOptions { follow_radius: Some(f32::NAN), ..in_file_order() }).contains("follow_radius"));
    assert!(bad(StrandOptions { tip_separation: f32::INFINITY, ..in_file_order() }).contains("tip_separation"));
    assert!(bad(StrandOptions { metres_per_unit: Some(0.0), ..in_file_order() }).contains("metres_per_unit"));

    let mut broken = groom.clone();
    broken.counts = vec![3];
    assert!(matches!(Strands::new(&broken, &in_file_order()), Err(StrandsError::Asset(_))));
    let huge = asset(&[&[[-3e38, 0.0, 0.0], [3e38, 0.0, 0.0]]]);
    assert!(matches!(Strands::new(&huge, &in_file_order()), Err(StrandsError::Overflow { strand: 0, .. })));
}
