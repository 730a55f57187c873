//! What was counted over many cases.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::verdict::Verdict;

/// The largest value of something, and the seed of its case.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Worst {
    /// The value.
    pub value: f64,
    /// The seed.
    pub seed: u64,
}

/// The values of something over cases.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Spread {
    /// Cases that have a value.
    pub cases: u64,
    /// The largest.
    pub worst: Worst,
    /// Cases by the power of ten that their value is below; `None` is no value above 0.
    decades: BTreeMap<i32, u64>,
}

/// What is not told apart below this power of ten.
const LEAST: i32 = -12;

impl Spread {
    fn add(&mut self, value: f64, seed: u64) {
        // A file of JSON has no infinity.
        let value = if value.is_finite() { value } else { f64::MAX };
        self.cases += 1;
        if value > self.worst.value {
            self.worst = Worst { value, seed };
        }
        let decade = if value > 0.0 { (value.log10().floor() as i32 + 1).max(LEAST) } else { LEAST };
        *self.decades.entry(decade).or_default() += 1;
    }

    /// The share of the cases whose value is below a power of ten.
    pub fn below(&self, decade: i32) -> f64 {
        let below: u64 = self.decades.range(..=decade).map(|(_, cases)| cases).sum();
        below as f64 / self.cases.max(1) as f64
    }
}

/// What was counted over the cases of a solver.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Tally {
    /// Cases.
    pub cases: u64,
    /// Strands of all cases.
    pub strands: u64,
    /// Sub-steps of all cases.
    pub sub_steps: u64,
    /// Strands times sub-steps.
    pub strand_steps: u64,
    /// The most strands of a case.
    pub most_strands: u64,
    /// Resets because of teleports.
    pub teleports: u64,
    /// Positions that were not finite.
    pub non_finite: u64,
    /// Strands that were reset because they had become non-finite.
    pub resets: u64,
    /// Cases that were played on both backends.
    pub compared: u64,
    /// Cases in which something was wrong.
    pub failed: u64,
    /// Cases by what was wrong.
    pub troubles: BTreeMap<String, u64>,
    /// Errors of edges beyond rounding, of their lengths.
    pub edge: Spread,
    /// Energy gained, of that of a fall by the strand's length.
    pub energy: Spread,
    /// Speeds half a second after the last disturbance, m/s.
    pub rest_speed: Spread,
}

impl Tally {
    /// Adds a case.
    pub fn add(&mut self, seed: u64, verdict: &Verdict, is_compared: bool) {
        self.cases += 1;
        self.strands += verdict.strands;
        self.sub_steps += verdict.sub_steps;
        self.strand_steps += verdict.strands * verdict.sub_steps;
        self.most_strands = self.most_strands.max(verdict.strands);
        self.teleports += verdict.teleports;
        self.non_finite += verdict.non_finite;
        self.resets += verdict.resets;
        self.compared += u64::from(is_compared);
        self.failed += u64::from(!verdict.troubles.is_empty());
        for trouble in &verdict.troubles {
            *self.troubles.entry(trouble.kind().to_owned()).or_default() += 1;
        }
        self.edge.add(verdict.edge, seed);
        verdict.energy.into_iter().for_each(|energy| self.energy.add(energy, seed));
        verdict.rest_speed.into_iter().for_each(|speed| self.rest_speed.add(speed, seed));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::Trouble;

    #[test]
    fn cases_add_up() {
        let mut tally = Tally::default();
        let troubles = vec![Trouble::Edge(0.5), Trouble::Resets(2)];
        let bad = Verdict { strands: 3, sub_steps: 10, edge: 0.5, resets: 2, troubles, ..Verdict::default() };
        let good = Verdict { strands: 1, sub_steps: 5, edge: 3e-7, energy: Some(0.0), ..Verdict::default() };
        tally.add(7, &bad, false);
        tally.add(8, &good, true);
        assert_eq!((tally.cases, tally.strands, tally.strand_steps, tally.compared), (2, 4, 35, 1));
        assert_eq!((tally.failed, tally.resets, tally.troubles["edge"]), (1, 2, 1));
        assert_eq!((tally.edge.worst.seed, tally.edge.below(-6), tally.edge.below(0)), (7, 0.5, 1.0));
        assert_eq!((tally.energy.cases, tally.energy.below(LEAST)), (1, 1.0));
    }

    #[test]
    fn what_is_not_finite_survives_a_file() {
        let mut tally = Tally::default();
        tally.add(1, &Verdict { edge: f64::INFINITY, ..Verdict::default() }, false);
        let text = serde_json::to_string(&tally).unwrap();
        assert_eq!(serde_json::from_str::<Tally>(&text).unwrap(), tally);
    }
}
