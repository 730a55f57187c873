//! What many times of one thing come to.

use std::fmt;

/// Nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The one in the middle.
    pub median: f64,
    /// The least.
    pub least: f64,
}

/// Of nanoseconds, which are sorted; 0 where there are none.
pub fn median_and_least(times: &mut [f64]) -> Spread {
    times.sort_by(f64::total_cmp);
    let [median, least] = [times.len() / 2, 0].map(|index| times.get(index).copied().unwrap_or(0.0));
    Spread { median, least }
}

impl fmt::Display for Spread {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{:.4} ms, least {:.4} ms", self.median * 1e-6, self.least * 1e-6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle() {
        let spread = median_and_least(&mut [5e6, 1e6, 3e6]);
        assert_eq!(spread.to_string(), "3.0000 ms, least 1.0000 ms");
        assert_eq!(median_and_least(&mut []), Spread { median: 0.0, least: 0.0 });
    }
}
