//! What a channel of a picture is stored in.

use crate::color;

/// A channel of a picture: 8 or 16 bits, sRGB.
pub trait Channel: Copy + Eq + Into<u64> + sealed::Sealed {
    /// The brightest.
    const MOST: Self;

    /// A level, which is not above [`Channel::MOST`].
    fn of(level: u64) -> Self;

    /// The light of all levels.
    fn light() -> Vec<f32> {
        let most: u64 = Self::MOST.into();
        (0..=most).map(|level| color::linear(level as f32 / most as f32)).collect()
    }
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! channels {
    ($($bits:ty)+) => {$(
        impl sealed::Sealed for $bits {}

        impl Channel for $bits {
            const MOST: Self = Self::MAX;

            fn of(level: u64) -> Self {
                level as Self
            }
        }
    )+};
}

channels! { u8 u16 }
