//! Ranges of the guide, held to what the code refuses.

use super::table::{rows, words};

/// For each row of a table whose range is two numbers: both are accepted, and what is beyond them is refused. `accepts` reads a
/// table as the parameters that it is about, or not at all; `rest` is what it cannot do without.
pub(crate) fn hold(heading: &str, rest: &str, accepts: impl Fn(toml::Table) -> Option<bool>) {
    let mut held = 0;
    for row in rows(heading) {
        let name = &words(&row[0])[0];
        let Some((low, high)) = row[3].split_once(" to ") else { continue };
        let (Ok(low), Ok(high)) = (low.parse::<f64>(), high.parse::<f64>()) else { continue };
        let whole = row[2].trim_matches('`').parse::<i64>().is_ok();
        let step = if whole { 1.0 } else { 0.01 * high };
        let is_accepted = |value: f64| accepts(given(rest, name, value, whole)).unwrap_or(false);
        assert!(is_accepted(low) && is_accepted(high), "{heading}: {name} is said to be from {low} to {high}");
        assert!(
            !is_accepted(low - step.min(1.0)) && !is_accepted(high + step),
            "{heading}: {name} goes beyond {low} to {high}"
        );
        held += 1;
    }
    assert!(held > 0, "{heading}: no range was held to anything");
}

/// `name = value`, or in the table of a name with a point.
fn given(rest: &str, name: &str, value: f64, whole: bool) -> toml::Table {
    let mut table: toml::Table = rest.parse().unwrap();
    let color = name.ends_with("_color");
    let value = match whole {
        true => toml::Value::Integer(value as i64),
        false if color => toml::Value::Array(vec![toml::Value::Float(value); 3]),
        false => toml::Value::Float(value),
    };
    match name.split_once('.') {
        Some((outer, inner)) => drop(table[outer].as_table_mut().unwrap().insert(inner.to_owned(), value)),
        None => drop(table.insert(name.to_owned(), value)),
    }
    // Whatever the sub-step, a frame must hold one.
    if name == "sub_step" {
        table.insert(String::from("max_frame"), toml::Value::Float(10.0));
    }
    table
}
