//! How much two pictures differ: FLIP, PSNR, the largest difference of a channel, the share of pixels that differ, and a
//! heat map. It needs no GPU and nothing of hair.
//!
//! Pictures are sRGB with straight alpha, of 8 or 16 bits. With 8 bits, small errors are lost in their rounding: of pictures of hair it alone is a mean FLIP of 0.006. FLIP, PSNR and the heat map compare what one sees: both pictures are first
//! blended over mid-grey, so that the colour of a fully transparent pixel does not count. `max_difference` and
//! `differing_share` compare the bytes of all four channels.

#![forbid(unsafe_code)]

mod channel;
mod color;
mod filter;
mod flip;

use serde::Serialize;

pub use channel::Channel;

/// A picture of at least one pixel, four channels each: red, green, blue and straight alpha, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture<C = u8> {
    size: [u32; 2],
    rgba: Vec<C>,
}

/// Why there is nothing to compare.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// The channels are not those of a picture of this size.
    #[error("{channels} channels are not an RGBA picture of {}x{} pixels", size[0], size[1])]
    Channels {
        /// Width and height in pixels.
        size: [u32; 2],
        /// How many channels there were.
        channels: usize,
    },
    /// The two pictures have different sizes.
    #[error("the pictures have different sizes: {}x{} and {}x{}", .0[0], .0[1], .1[0], .1[1])]
    Sizes([u32; 2], [u32; 2]),
}

/// How much two pictures differ. The order of the two does not matter. Its JSON holds the four numbers, not the heat map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The mean of FLIP over all pixels, at 67 pixels a degree: 0 for equal pictures, 1 at most.
    pub flip_mean: f64,
    /// Peak signal-to-noise ratio of red, green and blue in decibels; none (in JSON, null) for equal pictures.
    pub psnr_db: Option<f64>,
    /// The largest difference of any channel, alpha too, in steps of 8 bits, rounded up.
    pub max_difference: u8,
    /// The share, from 0 to 1, of the pixels that differ in any channel.
    pub differing_share: f64,
    /// FLIP of every pixel: black where there is no difference, then purple, orange and nearly white (magma).
    #[serde(skip)]
    pub heat_map: Picture,
}

impl<C: Channel> Picture<C> {
    /// Takes `width * height * 4` channels.
    pub fn new(size: [u32; 2], rgba: Vec<C>) -> Result<Self, Error> {
        let needed = 4 * u128::from(size[0]) * u128::from(size[1]);
        if needed == 0 || needed != rgba.len() as u128 {
            return Err(Error::Channels { size, channels: rgba.len() });
        }
        Ok(Self { size, rgba })
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The channels, four a pixel.
    #[must_use]
    pub fn rgba(&self) -> &[C] {
        &self.rgba
    }

    fn pixels(&self) -> impl ExactSizeIterator<Item = &[C; 4]> {
        self.rgba.as_chunks().0.iter()
    }

    /// The picture blended over mid-grey, in sRGB-encoded values, as browsers and image viewers blend.
    fn over_gray(&self) -> Vec<[C; 3]> {
        let mix = |&[r, g, b, alpha]: &[C; 4]| {
            let (most, alpha): (u64, u64) = (C::MOST.into(), alpha.into());
            let gray = most / 255 * 128;
            [r, g, b].map(|channel| C::of((channel.into() * alpha + gray * (most - alpha) + most / 2) / most))
        };
        self.pixels().map(mix).collect()
    }
}

/// Compares two pictures of the same size. It needs about 90 bytes of memory for each pixel.
pub fn compare<C: Channel>(a: &Picture<C>, b: &Picture<C>) -> Result<Comparison, Error> {
    if a.size != b.size {
        return Err(Error::Sizes(a.size, b.size));
    }
    let seen = [a, b].map(Picture::over_gray);
    let largest = a.rgba.iter().zip(&b.rgba).map(|(a, b)| difference(*a, *b)).max().unwrap_or(0);
    let step: u64 = C::MOST.into() / 255;
    let flip = flip::differences(&seen[0], &seen[1], a.size[0] as usize);
    let pixels = flip.len() as f64;
    Ok(Comparison {
        flip_mean: flip.iter().copied().map(f64::from).sum::<f64>() / pixels,
        psnr_db: psnr(seen[0].as_flattened(), seen[1].as_flattened()),
        max_difference: largest.div_ceil(step) as u8,
        differing_share: a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count() as f64 / pixels,
        heat_map: Picture { size: a.size, rgba: flip.iter().flat_map(|difference| heat(*difference)).collect() },
    })
}

fn difference<C: Channel>(a: C, b: C) -> u64 {
    a.into().abs_diff(b.into())
}

fn psnr<C: Channel>(a: &[C], b: &[C]) -> Option<f64> {
    let squares: u64 = a.iter().zip(b).map(|(a, b)| difference(*a, *b).pow(2)).sum();
    let mean = squares as f64 / a.len() as f64;
    let most = C::MOST.into() as f64;
    (squares > 0).then(|| 10.0 * (most * most / mean).log10())
}

fn heat(difference: f32) -> [u8; 4] {
    let colorous::Color { r, g, b } = colorous::MAGMA.eval_continuous(f64::from(difference));
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(size: [u32; 2], rgba: [u8; 4]) -> Picture {
        Picture::new(size, rgba.repeat((size[0] * size[1]) as usize)).unwrap()
    }

    #[test]
    fn equal_pictures_have_no_difference() {
        let picture = even([7, 3], [10, 200, 30, 255]);
        let comparison = compare(&picture, &picture).unwrap();
        assert_eq!((comparison.flip_mean, comparison.psnr_db), (0.0, None));
        assert_eq!((comparison.max_difference, comparison.differing_share), (0, 0.0));
        assert_eq!(comparison.heat_map, even([7, 3], [0, 0, 4, 255]), "magma begins nearly black");
    }

    #[test]
    fn one_changed_channel_of_one_pixel_is_counted() {
        let before = even([8, 4], [100, 100, 100, 255]);
        let mut after = before.clone();
        after.rgba[4 * 13 + 1] = 80;
        let comparison = compare(&before, &after).unwrap();
        assert_eq!((comparison.max_difference, comparison.differing_share), (20, 1.0 / 32.0));
        let mean_square = 20.0 * 20.0 / (32.0 * 3.0);
        assert!((comparison.psnr_db.unwrap() - 10.0 * (65025.0_f64 / mean_square).log10()).abs() < 1e-9);
        assert!(comparison.flip_mean > 0.0);
    }

    #[test]
    fn what_cannot_be_seen_counts_as_bytes_only() {
        let comparison = compare(&even([4, 4], [0, 0, 0, 0]), &even([4, 4], [255, 0, 0, 0])).unwrap();
        assert_eq!((comparison.flip_mean, comparison.psnr_db), (0.0, None));
        assert_eq!((comparison.max_difference, comparison.differing_share), (255, 1.0));
        let half = even([1, 1], [0, 255, 128, 128]).over_gray();
        assert_eq!(half, [[64, 192, 128]]);
    }

    #[test]
    fn more_bits_of_the_same_channels_give_the_same_figures() {
        let eight = [1u8, 2].map(|seed| -> Vec<u8> {
            (0..4 * 32 * 32).map(|i: u32| (i * i / 7 + 91 * u32::from(seed)) as u8).collect()
        });
        let sixteen = eight.clone().map(|rgba| rgba.into_iter().map(|channel| u16::from(channel) * 257).collect());
        // (Opaque: what is blended over grey is rounded.)
        let eight = eight.map(|rgba| Picture::new([32, 32], opaque(rgba)).unwrap());
        let sixteen = sixteen.map(|rgba: Vec<u16>| Picture::new([32, 32], opaque(rgba)).unwrap());
        let [one, other] = [compare(&eight[0], &eight[1]).unwrap(), compare(&sixteen[0], &sixteen[1]).unwrap()];
        assert!(one.flip_mean > 0.05 && (one.flip_mean - other.flip_mean).abs() < 1e-6, "{one:?} {other:?}");
        assert!((one.psnr_db.unwrap() - other.psnr_db.unwrap()).abs() < 1e-9);
        assert_eq!((one.max_difference, one.differing_share), (other.max_difference, other.differing_share));
    }

    fn opaque<C: Channel>(mut rgba: Vec<C>) -> Vec<C> {
        rgba.iter_mut().skip(3).step_by(4).for_each(|alpha| *alpha = C::MOST);
        rgba
    }

    #[test]
    fn what_eight_bits_do_not_tell_is_seen_with_sixteen() {
        let even = |level: u16| Picture::new([8, 8], opaque([level; 4].repeat(64))).unwrap();
        let [none, little, step] = [1, 64, 257].map(|more| compare(&even(20_000), &even(20_000 + more)).unwrap());
        assert!(0.0 < none.flip_mean && none.flip_mean < little.flip_mean && little.flip_mean < step.flip_mean);
        assert_eq!([none, little, step].map(|found| found.max_difference), [1; 3]);
    }

    #[test]
    fn sizes_are_checked() {
        let error = compare(&even([2, 3], [0; 4]), &even([3, 2], [0; 4])).unwrap_err();
        assert_eq!(error.to_string(), "the pictures have different sizes: 2x3 and 3x2");
        assert!(Picture::new([u32::MAX; 2], vec![0u8; 4]).unwrap_err().to_string().contains("4294967295x4294967295"));
        assert!(Picture::<u8>::new([0, 4], Vec::new()).is_err());
    }

    #[test]
    fn as_json_it_is_the_four_figures() {
        let comparison = compare(&even([2, 2], [0, 0, 0, 255]), &even([2, 2], [255; 4])).unwrap();
        let json = serde_json::to_value(&comparison).unwrap();
        let keys: Vec<_> = json.as_object().unwrap().keys().collect();
        assert_eq!(keys, ["differing_share", "flip_mean", "max_difference", "psnr_db"]);
        assert_eq!(json["psnr_db"], 0.0);
    }
}
