//! An engine on raw Vulkan in bad weather: two queues, three frames in flight, frames that are thrown away, lists that are
//! recorded after what they name was destroyed, grooms that come and go, a window that changes its size and is minimised.
//! It fails where anybody waits, where memory is left over, or where the validation layer has something to say.
//!
//! `cargo run --release -p tressfx-examples --example stress_vulkan -- [--validate] [FRAMES]`

mod frames;
mod gpu;
mod stress;
mod targets;

use std::time::Instant;

use anyhow::{Result, ensure};

fn main() -> Result<()> {
    let (switches, words): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|word| word.starts_with("--"));
    ensure!(switches.iter().all(|switch| switch == "--validate"), "there is only --validate");
    let frames = words.first().map_or(Ok(2000), |word| word.parse())?;
    let started = Instant::now();
    let figures = stress::run(frames, !switches.is_empty())?;
    println!("{:.1} s for {frames} frames: {figures:#?}", started.elapsed().as_secs_f64());
    figures.check()
}
