//! How much of a pixel a strand covers.

use glam::DVec2;

use crate::places::PLACES;

/// The half-widths of the base and of the flat top of a unit square, seen across a line with the unit normal `normal`.
fn reach(normal: DVec2) -> [f64; 2] {
    let n = normal.abs();
    [0.5 * (n.x + n.y), 0.5 * (n.x - n.y).abs()]
}

/// Area of a unit square within `half_width` of a line with the unit normal `normal` that passes at `distance` from its
/// centre.
pub fn coverage(distance: f64, half_width: f64, normal: DVec2) -> f64 {
    let [base, top] = reach(normal);
    // Area on one side of the line, less one half.
    let side = |distance: f64| {
        let x = distance.abs().min(base);
        let missing = if x > top { (x - top) * (x - top) / (2.0 * (base - top)) } else { 0.0 };
        (x - missing).copysign(distance) / (base + top)
    };
    (side(distance + half_width) - side(distance - half_width)).max(0.0)
}

/// How high a round fibre rises before its axis where a pixel at `distance` sees it: the root of the mean square.
pub(super) fn rise(distance: f64, half_width: f64) -> f64 {
    let [low, high] = [distance - 0.5, distance + 0.5].map(|edge| edge.clamp(-half_width, half_width));
    // The mean of the squares of all places from one edge to the other.
    let square = (low * low + low * high + high * high) / 3.0;
    (half_width * half_width - square).max(0.0).sqrt()
}

/// How long a pixel is taken along a line with the unit normal `normal`: as long as it is in the middle.
pub(super) fn pixel_length(normal: DVec2) -> f64 {
    reach(normal).iter().sum()
}

/// The share of a pixel between two ends that are so far before and behind its centre. The pixel is as long as `length` along them.
pub(super) fn between(before: f64, behind: f64, length: f64) -> f64 {
    let share = |end: f64| (end / length + 0.5).clamp(0.0, 1.0);
    (share(before) + share(behind) - 1.0).max(0.0)
}

/// What a strand covers of a pixel: the part within `half_width` of a line with the unit normal `normal` that passes at `distance` from the
/// centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stripe {
    /// In pixels, as all lengths here.
    pub distance: f64,
    /// Half of its width.
    pub half_width: f64,
    /// Of the line.
    pub normal: DVec2,
}

/// Places in a pixel, from its centre: 4, 16 or 64, one in each row and in each column, one in each of 4 x 4 or 8 x 8 cells, and so on.
/// The rows are those of the four halves of all rows, quarters and so on in turns, the lower half first.
fn places(count: u32) -> impl Iterator<Item = DVec2> {
    let row = move |column: u32| {
        // From halves of the columns come the smallest parts of the rows: every second time the later part comes first.
        let (mut row, mut rest, mut part, mut turned) = (0, column, count / 2, true);
        while part > 0 {
            row += if (rest % 2 == 1) != turned { part } else { 0 };
            (rest, part, turned) = (rest / 2, part / 2, !turned);
        }
        row
    };
    let at = move |number: u32| (f64::from(number) + 0.5) / f64::from(count) - 0.5;
    (0..count).map(move |column| DVec2::new(at(column), at(row(column))))
}

impl Stripe {
    /// The opacity at each of 1, 4, 16 or 64 places, with the mean `alpha`: all of them smaller by one factor than the covered share of their
    /// intervals across the line, or what they leave free.
    ///
    /// # Panics
    /// If there are to be others.
    pub fn parts(&self, count: u32, alpha: f64) -> Vec<f64> {
        assert!(PLACES.contains(&count), "{count} places");
        if count == 1 {
            return vec![alpha];
        }
        let Self { distance, half_width, normal } = *self;
        let reach = 0.5 / f64::from(count) * normal.abs().element_sum();
        let share = |place: DVec2| {
            let across = distance + place.dot(normal);
            let [low, high] = [(across - reach).max(-half_width), (across + reach).min(half_width)];
            (high - low).max(0.0) / (2.0 * reach)
        };
        let shares: Vec<f64> = places(count).map(share).collect();
        let mean = shares.iter().sum::<f64>() / f64::from(count);
        let adjusted = |share: f64| match alpha > mean {
            true => 1.0 - (1.0 - share) * ((1.0 - alpha) / (1.0 - mean).max(1e-12)),
            false => share * (alpha / mean.max(1e-12)),
        };
        shares.into_iter().map(adjusted).collect()
    }
}
