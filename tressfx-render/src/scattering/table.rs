//! What shaders look up of a fibre: it depends on how rough the fibre is and how its scales tilt, not on its colour.

use std::f64::consts::{FRAC_PI_2, PI};

use half::f16;

use super::azimuthal::{Across, detector_width};
use super::longitudinal::{lobe, variances};
use crate::material::Material;

/// R, TT, TRT, and all that is mirrored more often.
pub(crate) const LOBES: usize = 4;

/// Entries over the angle around the fibre, from light and eye on one side to opposite sides.
const COLUMNS: usize = 64;
/// Entries over the cosine of `theta_d`, from 0 to 1.
const ROWS: usize = 16;
/// Entries over the angle between a direction and the tangent.
const POLES: usize = 64;
/// Entries of the buffer, 16 bytes each.
pub(crate) const ENTRIES: usize = COLUMNS * ROWS + POLES + 2 * ROWS;

/// Angles that integrals along the fibre are made of.
const ANGLES: usize = 192;
/// Rounds in which `g` is found; each halves what is wrong.
const ROUNDS: usize = 24;
/// The absorption at which a lobe has exactly the colour of its path.
const MEASURED: f64 = 0.5;

/// By how many tilts light and eye are turned each, for each lobe (Marschner et al. 2003). R goes towards the root.
pub(crate) const TURNS: [f64; LOBES] = [1.0, -0.5, -1.5, 0.0];

/// Eight numbers. Around the fibre: the lobes of a white fibre, the radii that light of the last three goes within it, and 0. Along it: `e`,
/// the last three lobes of a white fibre under a white sky, their radii, and the square of `g`.
pub(crate) type Entry = [f64; 8];

/// What a table depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Roughness along the fibre, 0 to 1.
    pub(crate) roughness: f32,
    /// Roughness around it, 0 to 1.
    pub(crate) azimuthal_roughness: f32,
    /// Tilt of the scales in radians.
    pub(crate) tilt: f32,
}

/// What fibres that scatter as glass look up, in f64.
#[derive(Clone, Debug)]
pub struct FibreTable {
    /// Row by row.
    around: Vec<Entry>,
    along: Vec<Entry>,
    /// By cosine of `theta_d`, in pairs: how much light of each lobe of a white fibre goes on and how much comes back; and the radii that
    /// light of the last three goes within it, from the fourth number on.
    passed: Vec<Entry>,
}

/// A place in the table for an angle from 0 to PI, 0 to 1: `s / (s + c)` with sine and cosine of its half. It needs no inverse function and is
/// finest at both ends.
pub(crate) fn place(cosine: f64) -> f64 {
    let [s, c] = [1.0 - cosine, 1.0 + cosine].map(|x| (0.5 * x).max(0.0).sqrt());
    s / (s + c)
}

/// The angle of a place.
fn angle(place: f64) -> f64 {
    2.0 * place.atan2(1.0 - place)
}

/// Two entries and the share of the second.
fn between(place: f64, count: usize) -> (usize, f64) {
    let at = place.clamp(0.0, 1.0) * (count - 1) as f64;
    let first = (at as usize).min(count - 2);
    (first, at - first as f64)
}

fn mix(a: &Entry, b: &Entry, share: f64) -> Entry {
    std::array::from_fn(|i| a[i] + share * (b[i] - a[i]))
}

/// The radii after which so much is left of so much.
fn path(white: f64, left: f64) -> f64 {
    if white > 1e-12 && left > 0.0 { -(left / white).ln() / MEASURED } else { 0.0 }
}

fn entry(white: [f64; LOBES], left: [f64; LOBES], g_square: f64) -> Entry {
    let [_, through, back, rest] = std::array::from_fn(|p| path(white[p], left[p]));
    [white[0], white[1], white[2], white[3], through, back, rest, g_square]
}

/// The integral over the angle of what is 1 at an entry and falls to 0 at its neighbours, for each column.
fn weights() -> [f64; COLUMNS] {
    const STEPS: usize = 64;
    let mut weights = [0.0; COLUMNS];
    for step in 0..STEPS * (COLUMNS - 1) {
        let t = (step as f64 + 0.5) / (STEPS * (COLUMNS - 1)) as f64;
        let (first, share) = between(t, COLUMNS);
        let width = 2.0 / (t * t + (1.0 - t) * (1.0 - t)) / (STEPS * (COLUMNS - 1)) as f64;
        weights[first] += (1.0 - share) * width;
        weights[first + 1] += share * width;
    }
    weights
}

impl FibreTable {
    /// What fibres of a material look up; none where they do not scatter as glass.
    pub fn of(material: &Material) -> Option<Self> {
        material.fibre_shape().map(|shape| Self::new(&shape))
    }

    pub(crate) fn new(shape: &Shape) -> Self {
        let width = detector_width(f64::from(shape.azimuthal_roughness));
        let weights = weights();
        let (mut around, mut shares) = (Vec::with_capacity(COLUMNS * ROWS), Vec::with_capacity(ROWS));
        let mut passed = Vec::with_capacity(2 * ROWS);
        for row in 0..ROWS {
            let across = Across::new(row as f64 / (ROWS - 1) as f64);
            let all = [0.0, MEASURED].map(|absorption| across.shares(absorption));
            let column = |k: usize| across.lobes(angle(k as f64 / (COLUMNS - 1) as f64), width, [0.0, MEASURED]);
            let lobes: Vec<[[f64; LOBES]; 2]> = (0..COLUMNS).map(column).collect();
            // Between entries the lobes are straight; their integral is what leaves by them.
            let scale: [f64; LOBES] = std::array::from_fn(|p| {
                let sum: f64 = lobes.iter().zip(weights).map(|(lobes, weight)| lobes[0][p] * weight).sum();
                if sum > 0.0 { 0.5 * all[0][p] / sum } else { 0.0 }
            });
            let scaled = |lobes: &[f64; LOBES]| std::array::from_fn(|p| lobes[p] * scale[p]);
            around.extend(lobes.iter().map(|[white, left]| entry(scaled(white), scaled(left), 0.0)));
            let on: [f64; LOBES] = std::array::from_fn(|p| {
                let behind = lobes.iter().zip(weights).skip(COLUMNS / 2);
                2.0 * scale[p] * behind.map(|(lobes, weight)| lobes[0][p] * weight).sum::<f64>()
            });
            passed.push(std::array::from_fn(|i| if i < LOBES { on[i] } else { all[0][i - LOBES] - on[i - LOBES] }));
            passed.push(entry(all[0], all[1], 0.0));
            shares.push(all);
        }
        Self { around, along: along(shape, &shares), passed }
    }

    /// What is seen around the fibre at an angle between light and eye.
    pub(crate) fn around(&self, cos_phi: f64, cos_theta_d: f64) -> Entry {
        let (column, x) = between(place(cos_phi), COLUMNS);
        let (row, y) = between(cos_theta_d, ROWS);
        let at = |row: usize| {
            let first = row * COLUMNS + column;
            mix(&self.around[first], &self.around[first + 1], x)
        };
        mix(&at(row), &at(row + 1), y)
    }

    /// What is seen in white light from everywhere, and what light is divided by.
    pub(crate) fn along(&self, sin_theta: f64) -> Entry {
        let (first, share) = between(place(sin_theta), POLES);
        mix(&self.along[first], &self.along[first + 1], share)
    }

    /// How much of each lobe goes on and comes back, and the radii of the last three.
    pub(crate) fn passed(&self, cos_theta_d: f64) -> [Entry; 2] {
        let (row, share) = between(cos_theta_d, ROWS);
        [0, 1].map(|i| mix(&self.passed[2 * row + i], &self.passed[2 * row + 2 + i], share))
    }

    /// As the shader reads it.
    pub(crate) fn packed(&self) -> Vec<[u32; 4]> {
        let pair = |entry: &Entry, i: usize| {
            let [low, high] = [entry[2 * i], entry[2 * i + 1]].map(|x| u32::from(f16::from_f64(x).to_bits()));
            low | (high << 16)
        };
        let entries = self.around.iter().chain(&self.along).chain(&self.passed);
        entries.map(|entry| std::array::from_fn(|i| pair(entry, i))).collect()
    }
}

/// Sine and cosine.
fn turned(theta: f64) -> [f64; 2] {
    [theta.sin(), theta.cos()]
}

/// The lobes along a fibre, for all pairs of angles.
struct Along<'a> {
    variances: [f64; LOBES],
    tilt: f64,
    shares: &'a [[[f64; LOBES]; 2]],
}

impl Along<'_> {
    /// Shares of the lobes between two angles, white and where something is taken.
    fn shares(&self, from: f64, to: f64) -> [[f64; LOBES]; 2] {
        let (row, share) = between((0.5 * (to - from)).cos(), ROWS);
        [0, 1].map(|k| {
            let [low, high] = [row, row + 1].map(|row| self.shares[row][k]);
            std::array::from_fn(|p| low[p] + share * (high[p] - low[p]))
        })
    }

    /// What goes from the angle `from` to the angle `to` by each lobe, and back.
    fn lobes(&self, from: f64, to: f64) -> [[f64; LOBES]; 2] {
        let turned = |theta: f64, p: usize| turned(theta + TURNS[p] * self.tilt);
        let lobes: [f64; LOBES] = std::array::from_fn(|p| lobe(self.variances[p], turned(from, p), turned(to, p)));
        self.shares(from, to).map(|shares| std::array::from_fn(|p| lobes[p] * shares[p]))
    }

    /// All lobes of a white fibre.
    fn white(&self, from: f64, to: f64) -> f64 {
        self.lobes(from, to)[0].iter().sum()
    }
}

/// The light of a white fibre that leaves by its lobes, at angles that integrals are made of.
struct Balance {
    thetas: Vec<f64>,
    measure: Vec<f64>,
    /// What a direction's light is multiplied by, 1 / `g`.
    scales: Vec<f64>,
    /// The share of the light of each direction that its lobes lack.
    lacking: Vec<f64>,
    /// All that they lack.
    all_lacking: f64,
}

impl Balance {
    /// Without tilt a symmetric matrix is scaled from both sides so that all of its sums are 1 (Sinkhorn and Knopp 1967). Scales that tilt
    /// move light between directions of which one has more others around it, and to scale that away would take the tilt away. So what
    /// is too much is scaled down, from both sides again, and what is too little is lacking.
    fn new(lobes: &Along) -> Self {
        let thetas: Vec<f64> = (0..ANGLES).map(|k| PI * ((k as f64 + 0.5) / ANGLES as f64 - 0.5)).collect();
        let measure: Vec<f64> = thetas.iter().map(|theta| theta.cos().powi(2) * PI / ANGLES as f64).collect();
        let straight = matrix(&Along { tilt: 0.0, ..*lobes }, &thetas);
        let tilted = matrix(lobes, &thetas);
        let scales = scaled(vec![1.0; ANGLES], &straight, &measure, 0.0);
        let scales = scaled(scales, &tilted, &measure, 1.0);
        let lacking: Vec<f64> = sums(&tilted, &scales, &measure).iter().map(|sum| (1.0 - sum).max(0.0)).collect();
        let all_lacking = lacking.iter().zip(&measure).map(|(lacking, measure)| lacking * measure).sum();
        Self { thetas, measure, scales, lacking, all_lacking }
    }
}

/// All lobes of a white fibre between all pairs of angles: the same both ways.
fn matrix(lobes: &Along, thetas: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; ANGLES * ANGLES];
    for (i, j) in (0..ANGLES).flat_map(|i| (i..ANGLES).map(move |j| (i, j))) {
        let white = lobes.white(thetas[i], thetas[j]);
        (all[i * ANGLES + j], all[j * ANGLES + i]) = (white, white);
    }
    all
}

/// What leaves towards each angle under a white sky.
fn sums(matrix: &[f64], scales: &[f64], measure: &[f64]) -> Vec<f64> {
    let weights: Vec<f64> = scales.iter().zip(measure).map(|(scale, measure)| scale * measure).collect();
    let row = |row: &[f64]| row.iter().zip(&weights).map(|(lobes, weight)| lobes * weight).sum::<f64>();
    matrix.chunks_exact(ANGLES).zip(scales).map(|(lobes, scale)| scale * row(lobes)).collect()
}

/// Scales a symmetric matrix from both sides until its sums are 1, or at most 1 where `least` is 1: smaller ones are taken for it.
fn scaled(mut scales: Vec<f64>, matrix: &[f64], measure: &[f64], least: f64) -> Vec<f64> {
    for _ in 0..ROUNDS {
        let sums = sums(matrix, &scales, measure);
        scales.iter_mut().zip(sums).for_each(|(scale, sum)| *scale /= sum.max(least).sqrt());
    }
    scales
}

fn along(shape: &Shape, shares: &[[[f64; LOBES]; 2]]) -> Vec<Entry> {
    let tilt = f64::from(if shape.tilt.is_finite() { shape.tilt } else { 0.0 });
    let lobes = Along { variances: variances(f64::from(shape.roughness)), tilt, shares };
    let balance = Balance::new(&lobes);
    (0..POLES).map(|k| pole(&lobes, &balance, FRAC_PI_2 - angle(k as f64 / (POLES - 1) as f64))).collect()
}

/// The entry along the fibre of an angle.
fn pole(lobes: &Along, balance: &Balance, theta: f64) -> Entry {
    let (first, share) =
        between((theta / PI + 0.5 - 0.5 / ANGLES as f64) * ANGLES as f64 / (ANGLES - 1) as f64, ANGLES);
    let lacking = balance.lacking[first] + share * (balance.lacking[first + 1] - balance.lacking[first]);
    let (mut white, mut left, mut even) = ([0.0; LOBES], [0.0; LOBES], 0.0);
    for (k, &from) in balance.thetas.iter().enumerate() {
        let weight = balance.scales[k] * balance.measure[k];
        let seen = lobes.lobes(from, theta);
        (0..LOBES).for_each(|p| white[p] += weight * seen[0][p]);
        (0..LOBES).for_each(|p| left[p] += weight * seen[1][p]);
        let through = lobes.shares(from, theta).map(|shares| shares[1]);
        even += balance.lacking[k] * balance.measure[k] * through[1] / through[0].max(1e-12);
    }
    let g = white.iter().sum::<f64>() / (1.0 - lacking).max(1e-6);
    let (mut white, mut left) = (white.map(|x| x / g), left.map(|x| x / g));
    // Where nothing is lacking this adds 0.
    let all_lacking = balance.all_lacking.max(1e-30);
    white[1] += lacking;
    left[1] += lacking * even / all_lacking;
    let mut entry = entry(white, left, g * g);
    entry[0] = g * lacking / all_lacking.sqrt();
    entry
}
