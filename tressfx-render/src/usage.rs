//! What pools have needed of late, so that they give back what they no longer need.

/// Frames after which it is looked at what was needed in them. What flickers faster than that is seen at its largest.
const FRAMES: u64 = 120;

/// Measurements that these frames must have brought at least.
const MEASUREMENTS: u64 = 30;

/// The most that was needed of several things since some frames.
#[derive(Debug)]
pub(crate) struct Usage<const N: usize> {
    frames: u64,
    measurements: u64,
    most: [u64; N],
}

impl<const N: usize> Usage<N> {
    pub(crate) fn new() -> Self {
        Self { frames: 0, measurements: 0, most: [0; N] }
    }

    pub(crate) fn begin_frame(&mut self) {
        self.frames += 1;
    }

    /// So much is expected to be needed.
    pub(crate) fn expect(&mut self, needed: [u64; N]) {
        self.most.iter_mut().zip(needed).for_each(|(most, needed)| *most = needed.max(*most));
    }

    /// So much was needed in a frame. Now and then it returns the most that was needed in a long time, and begins anew.
    pub(crate) fn measured(&mut self, needed: [u64; N]) -> Option<[u64; N]> {
        self.expect(needed);
        self.measurements += 1;
        if self.frames < FRAMES || self.measurements < MEASUREMENTS {
            return None;
        }
        let most = self.most;
        *self = Self::new();
        Some(most)
    }
}

/// Whether a pool of this size is more than so many times as large as what it needs.
pub(crate) fn is_surplus(capacity: u64, needed: u64, surplus: f64) -> bool {
    capacity as f64 > needed as f64 * surplus
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_of_many_frames_is_told_once() {
        let mut usage = Usage::new();
        let mut told = Vec::new();
        for frame in 0..2 * FRAMES {
            usage.begin_frame();
            told.extend(usage.measured([frame % 50, if frame == 3 { 9 } else { 1 }]));
        }
        assert_eq!(told, [[49, 9], [49, 1]]);
        usage.expect([500, 0]);
        (0..FRAMES).for_each(|_| usage.begin_frame());
        let few = (1..MEASUREMENTS).filter_map(|_| usage.measured([1, 1])).count();
        assert_eq!((few, usage.measured([1, 1])), (0, Some([500, 1])), "not before there are enough measurements");
    }
}
