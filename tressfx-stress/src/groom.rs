//! Random and hostile strands.

use glam::{Quat, Vec3};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::StrandOptions;

use crate::dice::{Dice, Rolls};

/// The most vertices of all guides of a usual groom.
const USUAL_VERTICES: u32 = 4096;
/// How often a groom has very many strands.
const CROWDED: f64 = 1.0 / 256.0;

/// What a strand looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    /// Random turns from edge to edge.
    Curved,
    /// On a line.
    Straight,
    /// A helix.
    Curly,
    /// Sharp turns from edge to edge.
    Hairpins,
    /// To and fro on a line.
    Folded,
    /// All vertices in one place.
    Point,
    /// Two vertices in each place.
    Pairs,
    /// Edges of lengths that differ by up to a million times.
    Uneven,
    /// Its tip is its root.
    Loop,
    /// Any place in a box.
    Noise,
    /// One long edge among tiny ones.
    Jump,
}

const FORMS: [Form; 11] = [
    Form::Curved,
    Form::Straight,
    Form::Curly,
    Form::Hairpins,
    Form::Folded,
    Form::Point,
    Form::Pairs,
    Form::Uneven,
    Form::Loop,
    Form::Noise,
    Form::Jump,
];

impl Form {
    /// The place of vertex `i` of a strand that is about 1 long and begins at 0.
    fn points(self, vertices: u32, rolls: &mut Rolls) -> Vec<Vec3> {
        let edges = (vertices.max(2) - 1) as f32;
        let (along, across) = frame(rolls);
        let mut points = vec![Vec3::ZERO];
        let turns = rolls.decades(0.5..=f64::from(edges).max(1.0)) as f32;
        let radius = rolls.decades(1e-3..=0.5) as f32;
        let mut direction = along;
        for i in 1..vertices {
            let (last, share) = (points[points.len() - 1], i as f32 / edges);
            let angle = std::f32::consts::TAU * turns * share;
            points.push(match self {
                Self::Curved => {
                    direction = (direction + 0.4 * rolls.direction()).normalize_or(along);
                    last + direction / edges
                }
                Self::Straight => along * share,
                Self::Curly => along * share + radius * (Quat::from_axis_angle(along, angle) * across - across),
                Self::Hairpins => along * (i % 2) as f32 * radius + across * share,
                Self::Folded => along * (i % 2) as f32,
                Self::Point => Vec3::ZERO,
                Self::Pairs => along * ((i / 2) as f32 / edges),
                Self::Uneven => last + rolls.direction() * rolls.decades(1e-6..=1.0) as f32,
                Self::Loop => {
                    let around = Quat::from_axis_angle(across, std::f32::consts::TAU * share);
                    0.2 * (around * along - along)
                }
                Self::Noise => rolls.direction() * rolls.share() as f32,
                Self::Jump => last + along * if i == vertices / 2 { 1.0 } else { 1e-6 },
            });
        }
        points
    }
}

/// Two directions, one across the other.
fn frame(rolls: &mut Rolls) -> (Vec3, Vec3) {
    let along = rolls.direction();
    (along, along.any_orthonormal_vector())
}

/// How many vertices of a strand are pinned.
#[derive(Clone, Copy, Debug)]
enum Pins {
    /// As [`HairAsset::inverse_masses`] has it: the first two.
    Usual,
    Root,
    BothEnds,
    Nothing,
    Everything,
    /// The root, and masses that differ.
    Masses,
}

/// A groom before it is prepared.
#[derive(Clone, Debug)]
pub struct Groom {
    /// Its strands.
    pub asset: HairAsset,
    /// How they are prepared.
    pub options: StrandOptions,
}

/// Random strands: of one form or of many, of any size, unit and number.
pub fn groom(dice: Dice) -> Groom {
    let mut rolls = dice.of("groom");
    let is_crowded = rolls.chance(CROWDED);
    let vertices = if is_crowded { rolls.one_of(&[2, 3, 4]) } else { vertices(&mut rolls) };
    let strands = match is_crowded {
        true => rolls.one_of(&[100_000, 300_000, 1_000_000]),
        false => rolls.one_of(&[1, 2, 3, 8, 64, 65, 200, 1000]).min(USUAL_VERTICES / vertices),
    };
    let length = match rolls.whole(0..=9) {
        0 => rolls.decades(1e-6..=1e-3),
        1 => rolls.decades(1.0..=1e3),
        _ => rolls.decades(0.01..=0.5),
    } as f32;
    let metres_per_unit = rolls.one_of(&[1.0, 1.0, 0.01, 0.01, 0.001, 1e-4, 37.0]);
    let (scale, head) = (length / metres_per_unit, 0.1 / metres_per_unit);
    let one_form = rolls.one_of(&FORMS);
    let is_mixed = rolls.chance(0.4);
    let differ = !is_crowded && rolls.chance(0.1);
    let shift = if rolls.chance(0.1) { rolls.direction() * 100.0 * head } else { Vec3::ZERO };
    let (mut points, mut counts) = (Vec::new(), Vec::new());
    for _ in 0..strands {
        let form = if is_mixed { rolls.one_of(&FORMS) } else { one_form };
        let count = if differ { rolls.whole(1..=vertices) } else { vertices };
        let root = shift + rolls.direction() * head;
        points.extend(form.points(count, &mut rolls).iter().map(|point| (root + *point * scale).to_array()));
        counts.push(count);
    }
    let inverse_mass = inverse_masses(&mut rolls, &counts);
    let both_ends_immovable = matches!(inverse_mass, Masses::BothEnds);
    let inverse_mass = if let Masses::Given(masses) = inverse_mass { Some(masses) } else { None };
    let asset = HairAsset::new("random", AssetFormat::Builtin, points, counts);
    let follows = if is_crowded { 0 } else { rolls.one_of(&[0, 0, 1, 3]) };
    let options = StrandOptions {
        follows: Some(follows),
        tip_separation: rolls.even(-1.0..=3.0) as f32,
        metres_per_unit: Some(metres_per_unit),
        seed: 1,
        ..StrandOptions::default()
    };
    Groom { asset: HairAsset { inverse_mass, both_ends_immovable, ..asset }, options }
}

fn vertices(rolls: &mut Rolls) -> u32 {
    match rolls.whole(0..=9) {
        0 => 2,
        1 => 3,
        2 => 256,
        3 => 128,
        _ => rolls.one_of(&[4, 6, 8, 12, 16, 16, 24, 32, 32, 48, 64]),
    }
}

enum Masses {
    Usual,
    BothEnds,
    Given(Vec<f32>),
}

fn inverse_masses(rolls: &mut Rolls, counts: &[u32]) -> Masses {
    let pins = match rolls.whole(0..=19) {
        0..=9 => Pins::Usual,
        10..=14 => Pins::Root,
        15..=16 => Pins::BothEnds,
        17 => Pins::Nothing,
        18 => Pins::Everything,
        _ => Pins::Masses,
    };
    let each = |of: &mut dyn FnMut(u32) -> f32| {
        Masses::Given(counts.iter().flat_map(|&count| (0..count).map(&mut *of).collect::<Vec<_>>()).collect())
    };
    match pins {
        Pins::Usual => Masses::Usual,
        Pins::BothEnds => Masses::BothEnds,
        Pins::Root => each(&mut |vertex| if vertex == 0 { 0.0 } else { 1.0 }),
        Pins::Nothing => each(&mut |_| 1.0),
        Pins::Everything => each(&mut |_| 0.0),
        Pins::Masses => each(&mut |vertex| if vertex == 0 { 0.0 } else { rolls.decades(1e-3..=1e3) as f32 }),
    }
}

impl Groom {
    /// The strands of the file from `first` on, at most `most` of them.
    #[must_use]
    pub fn only(mut self, first: u32, most: u32) -> Self {
        let strands = self.asset.strand_count();
        let first = (first as usize).min(strands - 1);
        let end = first.saturating_add(most.max(1) as usize).min(strands);
        let ranges: Vec<_> = self.asset.ranges().collect();
        let vertices = ranges[first].start..ranges[end - 1].end;
        self.asset.points = self.asset.points[vertices.clone()].to_vec();
        self.asset.counts = self.asset.counts[first..end].to_vec();
        self.asset.inverse_mass = self.asset.inverse_mass.map(|masses| masses[vertices].to_vec());
        self
    }
}

#[cfg(test)]
mod tests {
    use tressfx_core::strands::Strands;

    use super::*;

    #[test]
    fn grooms_are_sound_and_of_many_kinds() {
        let grooms: Vec<_> =
            (0..300).map(|seed| groom(Dice::new(seed))).filter(|groom| groom.asset.counts.len() < 10_000).collect();
        let strands: Vec<_> =
            grooms.iter().map(|groom| Strands::new(&groom.asset, &groom.options).expect("sound")).collect();
        for vertices in [2, 256] {
            assert!(strands.iter().any(|strands| strands.vertices == vertices), "{vertices}");
        }
        let some_edge =
            |of: &dyn Fn(f32) -> bool| strands.iter().any(|strands| strands.rest_lengths.iter().any(|&l| of(l)));
        assert!(some_edge(&|length| length == 0.0) && some_edge(&|length| length > 10.0));
        assert!(some_edge(&|length| length > 0.0 && length < 1e-7));
        assert!(
            strands.iter().any(|strands| strands.guides == 1) && strands.iter().any(|strands| strands.guides > 500)
        );
    }

    #[test]
    fn a_part_of_a_groom_is_sound_too() {
        let groom = (0..).map(|seed| groom(Dice::new(seed))).find(|groom| groom.asset.counts.len() == 64).unwrap();
        let points = groom.asset.ranges().nth(5).unwrap();
        let part = groom.clone().only(5, 2);
        part.asset.check().unwrap();
        assert_eq!(part.asset.counts.len(), 2);
        assert_eq!(part.asset.points[0], groom.asset.points[points.start]);
    }
}
