//! What pools have needed of late, so that they give back what they no longer need.

/// Frames after which it is looked at what was needed in them. What flickers faster than that is seen at its largest.
const FRAMES: u64 = 120;

/// The same where it is expected that less will be needed soon; then twice as many each time.
const FIRST_FRAMES: u64 = 30;

/// Of these frames one in so many must have been measured.
const FRAMES_OF_A_MEASUREMENT: u64 = 4;

/// The most that was needed of several things since some frames.
#[derive(Debug)]
pub(crate) struct Usage<const N: usize> {
    frames: u64,
    measurements: u64,
    /// Frames after which it is looked at them.
    enough: u64,
    most: [u64; N],
}

impl<const N: usize> Usage<N> {
    pub(crate) fn new() -> Self {
        Self { frames: 0, measurements: 0, enough: FRAMES, most: [0; N] }
    }

    /// The same for what will soon need less than in its first frames.
    pub(crate) fn settling() -> Self {
        Self { enough: FIRST_FRAMES, ..Self::new() }
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
        if self.frames < self.enough || self.measurements * FRAMES_OF_A_MEASUREMENT < self.enough {
            return None;
        }
        let most = self.most;
        *self = Self { enough: (2 * self.enough).min(FRAMES), ..Self::new() };
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

    /// What is told in so many frames, and after which of them.
    fn told(mut usage: Usage<2>, frames: u64) -> Vec<(u64, [u64; 2])> {
        let needed = |frame| [frame % 50, if frame == 3 { 9 } else { 1 }];
        let mut told = |frame: u64| {
            usage.begin_frame();
            usage.measured(needed(frame)).map(|most| (frame + 1, most))
        };
        (0..frames).filter_map(&mut told).collect()
    }

    #[test]
    fn the_most_of_many_frames_is_told_once() {
        assert_eq!(told(Usage::new(), 2 * FRAMES), [(120, [49, 9]), (240, [49, 1])]);
        assert_eq!(told(Usage::settling(), 210), [(30, [29, 9]), (90, [49, 1]), (210, [49, 1])]);
    }

    #[test]
    fn nothing_is_told_before_there_are_enough_measurements() {
        let mut usage = Usage::new();
        usage.expect([500, 0]);
        (0..FRAMES).for_each(|_| usage.begin_frame());
        let few = (1..FRAMES / FRAMES_OF_A_MEASUREMENT).filter_map(|_| usage.measured([1, 1])).count();
        assert_eq!((few, usage.measured([1, 1])), (0, Some([500, 1])));
    }
}
