//! Pictures that say from place to place how hair grows.

use thiserror::Error;
use tressfx_core::texels::texels_beside;

/// A picture over a mesh: numbers from 0 to 1, row by row from the top, as many for each texel as there are channels.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMap {
    size: [u32; 2],
    channels: u32,
    texels: Vec<f32>,
}

/// Numbers that make no map.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MapError {
    /// There are none, or not as many as the size says.
    #[error(
        "a map of {} x {} texels of {channels} numbers with {numbers} of them: it takes at least one, and as many as it says",
        size[0], size[1]
    )]
    Count {
        /// Width and height.
        size: [u32; 2],
        /// Numbers of a texel.
        channels: u32,
        /// How many numbers there are.
        numbers: usize,
    },
    /// One is outside of its range.
    #[error("texel ({}, {}) of a map is {value}, but must be from 0 to 1", texel[0], texel[1])]
    Value {
        /// Its column and row.
        texel: [u32; 2],
        /// The number.
        value: f32,
    },
}

impl SurfaceMap {
    /// A map of so many texels across and down.
    ///
    /// # Errors
    /// [`MapError`] where there are none or not as many as that, and for a number outside of 0 to 1.
    pub fn new(size: [u32; 2], channels: u32, texels: Vec<f32>) -> Result<Self, MapError> {
        let count = (u64::from(size[0]) * u64::from(size[1])).checked_mul(channels.into());
        if count.is_none_or(|count| count == 0 || count != texels.len() as u64) {
            return Err(MapError::Count { size, channels, numbers: texels.len() });
        }
        match texels.iter().position(|value| !(0.0..=1.0).contains(value)) {
            Some(place) => {
                let texel = place as u64 / u64::from(channels);
                let texel = [texel % u64::from(size[0]), texel / u64::from(size[0])].map(|at| at as u32);
                Err(MapError::Value { texel, value: texels[place] })
            }
            None => Ok(Self { size, channels, texels }),
        }
    }

    /// Texels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Numbers of a texel.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// The largest number in it.
    pub fn largest(&self) -> f64 {
        self.texels.iter().copied().fold(0.0, f32::max).into()
    }

    /// The numbers at texture coordinates that are finite, between texels bilinear: (0, 0) is the upper left corner, (1, 1) the lower right one, beyond them the
    /// map repeats. Channels beyond its own are 0.
    pub fn at<const N: usize>(&self, uv: [f64; 2]) -> [f64; N] {
        let ([left, right], across) = texels_beside(uv[0], self.size[0]);
        let ([above, below], down) = texels_beside(uv[1], self.size[1]);
        let channels = self.channels as usize;
        let texel = |x: usize, y: usize, channel: usize| match self
            .texels
            .get((y * self.size[0] as usize + x) * channels + channel)
        {
            Some(&value) if channel < channels => f64::from(value),
            _ => 0.0,
        };
        std::array::from_fn(|channel| {
            let row = |y| texel(left, y, channel) * (1.0 - across) + texel(right, y, channel) * across;
            row(above) * (1.0 - down) + row(below) * down
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_where_the_middles_of_texels_are_and_mixed_between() {
        let map = SurfaceMap::new([2, 2], 1, vec![0.0, 1.0, 0.5, 0.25]).unwrap();
        for (uv, expected) in [
            ([0.25, 0.25], 0.0),
            ([0.75, 0.25], 1.0),
            ([0.25, 0.75], 0.5),
            ([0.75, 0.75], 0.25),
            ([0.5, 0.25], 0.5),
            ([0.5, 0.5], 0.4375),
            ([1.0, 0.25], 0.5),
            ([-2.75, 3.25], 0.0),
        ] {
            assert_eq!(map.at(uv), [expected], "{uv:?}");
        }
        let colors = SurfaceMap::new([1, 1], 3, vec![0.25, 0.5, 0.75]).unwrap();
        assert_eq!(colors.at([0.1, 9.0]), [0.25, 0.5, 0.75]);
        assert_eq!((colors.size(), colors.channels(), colors.largest()), ([1, 1], 3, 0.75));
    }

    #[test]
    fn what_is_no_map_is_refused() {
        for (size, channels, numbers) in
            [([0, 4], 1, 0), ([2, 2], 1, 3), ([2, 2], 3, 4), ([1, 1], 0, 0), ([u32::MAX; 2], 4, 1)]
        {
            let error = SurfaceMap::new(size, channels, vec![0.0; numbers]).unwrap_err();
            assert!(matches!(error, MapError::Count { .. }), "{error}");
        }
        for wrong in [-0.1, 1.5, f32::NAN, f32::INFINITY] {
            let error = SurfaceMap::new([2, 2], 1, vec![0.0, 0.0, 0.0, wrong]).unwrap_err();
            assert!(error.to_string().starts_with("texel (1, 1) of a map is"), "{error}");
        }
    }
}
