//! criterion's measurement: nanoseconds that passes have taken, by the timestamps of the GPU.

use std::cell::Cell;
use std::rc::Rc;

use criterion::measurement::{Measurement, ValueFormatter, WallTime};
use tressfx_core::backend::Timing;

/// A clock that goes on where it is told how long passes took. Its copies show the same time.
///
/// What a benchmark does between its passes is not counted: writing the list, submitting, waiting.
#[derive(Clone, Debug, Default)]
pub struct GpuClock(Rc<Cell<f64>>);

impl GpuClock {
    /// Adds the passes of a label, as often as they ran; all of them where there is none.
    pub fn advance(&self, timings: &[Timing], label: Option<&str>) {
        let counts = |timing: &&Timing| label.is_none_or(|label| timing.label == label);
        let nanoseconds: f64 = timings.iter().filter(counts).map(|timing| timing.nanoseconds).sum();
        self.0.set(self.0.get() + nanoseconds);
    }
}

impl Measurement for GpuClock {
    type Intermediate = f64;
    type Value = f64;

    fn start(&self) -> f64 {
        self.0.get()
    }

    fn end(&self, start: f64) -> f64 {
        self.0.get() - start
    }

    fn add(&self, one: &f64, other: &f64) -> f64 {
        one + other
    }

    fn zero(&self) -> f64 {
        0.0
    }

    fn to_f64(&self, nanoseconds: &f64) -> f64 {
        *nanoseconds
    }

    fn formatter(&self) -> &dyn ValueFormatter {
        WallTime.formatter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_on_by_what_passes_took_and_nothing_else() {
        let timing = |label, nanoseconds| Timing { nanoseconds, ..Timing::new(label, None, 0) };
        let timings = [timing("bin", 20.0), timing("blend", 700.0), timing("bin", 5.0)];
        let clock = GpuClock::default();
        let copy = clock.clone();
        let start = clock.start();
        assert_eq!(clock.end(start), 0.0);
        copy.advance(&timings, Some("bin"));
        assert_eq!(clock.end(start), 25.0, "rounds of a frame are one time");
        copy.advance(&timings, None);
        assert_eq!(clock.end(start), 750.0);
        copy.advance(&timings, Some("another"));
        assert_eq!(clock.end(start), 750.0);
        assert_eq!(clock.formatter().format_value(2.5e6).trim(), "2.5000 ms");
    }
}
