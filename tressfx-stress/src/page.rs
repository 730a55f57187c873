//! The page that people read.

use std::fmt::Write as _;

use crate::case::SolverName;
use crate::run::State;
use crate::tally::{Spread, Tally, Worst};

/// `stress.md`.
pub fn page(state: &State) -> String {
    let mut page = String::from(
        "# Stress\n\n\
         Made by `cargo xtask stress`, which also makes [stress.json](stress.json), the same figures. Each case is made from a seed: \
         strands (curved, straight, curls, hairpins, folded, points, loops, edges of no length and of lengths a million times apart, 2 to \
         256 vertices, one strand to a million), every parameter over its whole legal range, any unit, heads that stand, walk, are shaken, \
         jump by 100 m and spin with 100 turns a second, roots that move by themselves, wind, capsules that swallow the groom, sub-steps \
         from 0.01 ms to 0.1 s, frames of 0 s, of a day, and backwards. Half a second of calm follows.\n\n",
    );
    let _ = writeln!(
        page,
        "Seed {}, {:.2} hours on {}.\n",
        state.settings.seed,
        state.seconds / 3600.0,
        state.devices.join(" and ")
    );
    page.push_str(&counts(state));
    page.push_str(&spreads(state));
    page.push_str(WHAT_IT_MEANS);
    page.push_str(&failures(state));
    page.push_str(&maps(state));
    page
}

/// What is said of a tally in a row of a table.
type Said<'a> = &'a dyn Fn(&Tally) -> String;
/// What is measured, and the powers of ten that it is told by.
type Measured<'a> = (&'a str, &'a dyn Fn(&Tally) -> &Spread, [i32; 3]);

fn columns<'a>(state: &'a State, of: &dyn Fn(&'a Tally) -> String) -> String {
    state.tallies.values().map(|tally| format!(" {} |", of(tally))).collect()
}

fn heading(state: &State, first: &str) -> String {
    let names: String = state.tallies.keys().map(|solver| format!(" `{}` |", solver.name())).collect();
    format!("| {first} |{names}\n|---|{}\n", "---|".repeat(state.tallies.len()))
}

fn counts(state: &State) -> String {
    let mut table = heading(state, "counted");
    let rows: [(&str, Said); 10] = [
        ("cases", &|tally| tally.cases.to_string()),
        ("of them on both backends, equal to the bit unless they failed", &|tally| tally.compared.to_string()),
        ("sub-steps", &|tally| tally.sub_steps.to_string()),
        ("strands", &|tally| tally.strands.to_string()),
        ("strands times sub-steps", &|tally| format!("{:.3e}", tally.strand_steps as f64)),
        ("most strands of a case", &|tally| tally.most_strands.to_string()),
        ("teleports", &|tally| tally.teleports.to_string()),
        ("positions not finite", &|tally| tally.non_finite.to_string()),
        ("strands reset as not finite", &|tally| tally.resets.to_string()),
        ("cases that failed", &|tally| tally.failed.to_string()),
    ];
    for (name, of) in rows {
        let _ = writeln!(table, "| {name} |{}", columns(state, of));
    }
    table + "\n"
}

fn spreads(state: &State) -> String {
    let mut table = heading(state, "measured");
    let rows: [Measured; 3] = [
        ("worst edge error of a case, of its length, beyond rounding", &|tally| &tally.edge, [-6, -4, -2]),
        ("energy gained, of a fall by the strand's length", &|tally| &tally.energy, [-6, -3, 0]),
        ("highest speed after half a second of calm, m/s", &|tally| &tally.rest_speed, [-3, -1, 1]),
    ];
    for (name, of, decades) in rows {
        let _ = writeln!(table, "| {name}: cases |{}", columns(state, &|tally| of(tally).cases.to_string()));
        for decade in decades {
            let below = |tally: &Tally| format!("{:.1} %", 100.0 * of(tally).below(decade));
            let _ = writeln!(table, "| below 1e{decade} |{}", columns(state, &below));
        }
        let worst = |tally: &Tally| match of(tally).worst {
            Worst { value: 0.0, .. } => String::from("0"),
            Worst { value, seed } => format!("{value:.1e} (seed {seed})"),
        };
        let _ = writeln!(table, "| the largest |{}", columns(state, &worst));
    }
    table + "\n"
}

const WHAT_IT_MEANS: &str = "Every case must stay finite, without a strand that is reset, with its roots where the head has them, and with the \
same bits on both backends. `direct` must also keep its edges within 2e-5 of their length, beyond what rounding makes of coordinates; gain \
no more than 0.2 % of the energy of a fall, where nothing happens and the joints want the pose of the file; and be no faster after the \
calm than three times what is left of its speed, what falls and what creeps back may be. Of the published method these three are only \
counted. Strands with little drag swing on for long, so high speeds are no failure by themselves.\n\n\
`cargo xtask stress --case SEED --solver SOLVER` plays a case alone and says what is wrong with it.\n\n";

fn failures(state: &State) -> String {
    if state.failures.is_empty() {
        return String::from("No case failed.\n\n");
    }
    let mut list = String::from(
        "## Cases that failed\n\nThe first of each kind with the smallest part of it that still fails in the same way.\n\n",
    );
    for failure in &state.failures {
        let _ = writeln!(list, "* {failure}");
    }
    list + "\n"
}

fn maps(state: &State) -> String {
    if state.map.is_empty() {
        return String::new();
    }
    let mut maps = String::from(
        "## Maps of stability\n\n\
         Sixteen strands of 20 cm, from straight to curls of 12 mm, at the defaults but for `sag_free` 0, are shaken with 2 g at 4 Hz and turned, for \
         half a second. Then the head stands still. The colour is the highest speed after half a second of that. Strands that fall to where they \
         hang are still under way then, so soft ones are darker.\n\n",
    );
    for solver in [SolverName::Direct, SolverName::Tressfx] {
        if state.map.iter().any(|cell| cell.solver == solver) {
            let _ = writeln!(maps, "![Map of {0}](stress-{0}.svg)\n", solver.name());
        }
    }
    maps.trim_end().to_owned() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Settings;
    use crate::verdict::Verdict;

    #[test]
    fn a_page_states_what_was_counted() {
        let mut state = State::new(Settings { seed: 5, solvers: vec![SolverName::Direct], backends: Vec::new() });
        let verdict = Verdict { strands: 12, sub_steps: 30, edge: 3e-7, ..Verdict::default() };
        state.tallies.entry(SolverName::Direct).or_default().add(77, &verdict, true);
        state.seconds = 1800.0;
        let page = page(&state);
        for text in
            ["Seed 5, 0.50 hours", "| cases | 1 |", "3.0e-7 (seed 77)", "| below 1e-6 | 100.0 % |", "No case failed"]
        {
            assert!(page.contains(text), "{text}:\n{page}");
        }
        assert!(!page.contains(".svg"));
    }
}
