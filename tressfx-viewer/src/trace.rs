//! When what ran, for chrome://tracing and Perfetto: `--trace`.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result};
use serde::Serialize;
use tressfx_core::backend::Timing;

/// A run as events of the Trace Event Format.
#[derive(Debug)]
pub(crate) struct Trace {
    begun: Instant,
    events: Vec<Event>,
}

#[derive(Debug, Serialize)]
struct File<'a> {
    #[serde(rename = "traceEvents")]
    events: &'a [Event],
    #[serde(rename = "displayTimeUnit")]
    unit: &'static str,
}

/// Something that took a while; times in microseconds.
#[derive(Debug, Serialize)]
struct Event {
    name: &'static str,
    cat: &'static str,
    ph: &'static str,
    ts: f64,
    dur: f64,
    pid: u32,
    /// A row of the picture.
    tid: &'static str,
    args: Args,
}

#[derive(Debug, Serialize)]
struct Args {
    frame: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    invocations: Option<u64>,
}

impl Trace {
    pub(crate) fn new() -> Self {
        Self { begun: Instant::now(), events: Vec::new() }
    }

    /// Something that the CPU did from `start` until now.
    pub(crate) fn cpu(&mut self, name: &'static str, frame: u32, start: Instant) {
        let ts = start.duration_since(self.begun).as_secs_f64() * 1e6;
        let args = Args { frame, bytes: None, invocations: None };
        let dur = start.elapsed().as_secs_f64() * 1e6;
        self.events.push(Event { name, cat: "cpu", ph: "X", ts, dur, pid: 1, tid: "cpu", args });
    }

    /// The passes of a list that was submitted at `start`. The clocks of the two sides have no common zero, so the first pass
    /// stands where the list was submitted.
    pub(crate) fn gpu(&mut self, timings: &[Timing], frame: u32, start: Instant) {
        let submitted = start.duration_since(self.begun).as_secs_f64() * 1e6;
        self.events.extend(timings.iter().map(|timing| Event {
            name: timing.label,
            cat: "gpu",
            ph: "X",
            ts: submitted + timing.begin * 1e-3,
            dur: timing.nanoseconds * 1e-3,
            pid: 1,
            tid: "gpu",
            args: Args { frame, bytes: Some(timing.bytes), invocations: timing.invocations },
        }));
    }

    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string(&File { events: &self.events, unit: "ms" })?;
        std::fs::write(path, text).with_context(|| path.display().to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_follow_the_moment_of_their_submission() {
        let mut trace = Trace::new();
        let start = Instant::now();
        let timing = Timing { begin: 2000.0, nanoseconds: 500.0, ..Timing::new("a", None, 8) };
        trace.gpu(&[timing], 3, start);
        trace.cpu("run", 3, start);
        let submitted = start.duration_since(trace.begun).as_secs_f64() * 1e6;
        assert!((trace.events[0].ts - submitted - 2.0).abs() < 1e-6);
        assert_eq!((trace.events[0].dur, trace.events[0].tid), (0.5, "gpu"));
        assert_eq!((trace.events[1].ts, trace.events[1].tid), (submitted, "cpu"));
        let text = serde_json::to_string(&trace.events).unwrap();
        assert!(text.contains(r#""args":{"frame":3,"bytes":8}"#), "{text}");
    }
}
