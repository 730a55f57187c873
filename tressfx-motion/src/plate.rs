//! The plate of `docs/materials.md`: strands of the published method at several stiffnesses, beside rods with the bending lengths that those
//! are translated to.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use glam::{DVec3, Vec3};
use plotters::prelude::*;
use tressfx_conformance::sim::Motion;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_sim::bending_length::of_local_stiffness;
use tressfx_sim::reference::Simulation;
use tressfx_sim::{ClockParams, SectionDesc, SimParams, Solver};

const FILE: &str = "motion-stiffness.svg";
const SIZE: (u32, u32) = (940, 460);
const VERTICES: u16 = 16;
/// Metres.
const LENGTH: f32 = 0.2;
const STIFFNESSES: [f32; 4] = [0.3, 0.7, 0.9, 0.95];
const COLORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];
/// m/s^2: a hundredth of the Earth's, as in TressFX's samples, and that of the Earth.
const GRAVITIES: [f32; 2] = [0.0981, 9.81];
/// How long strands have to come to rest, s.
const SECONDS: u32 = 20;

/// Simulates the strands and draws them.
pub(crate) fn write(docs: &Path) -> Result<()> {
    let path = docs.join(FILE);
    let mut svg = String::new();
    draw(&mut svg).map_err(|error| anyhow!("{}: {error}", path.display()))?;
    std::fs::write(&path, svg).with_context(|| path.display().to_string())
}

/// A strand held horizontally, in metres.
fn strand() -> Result<Strands> {
    let point = |i: u16| [LENGTH * f32::from(i) / f32::from(VERTICES - 1), 0.0, 0.0];
    let points = (0..VERTICES).map(point).collect();
    let asset = HairAsset::new("line", AssetFormat::Builtin, points, vec![VERTICES.into()]);
    let options = StrandOptions { follows: Some(0), metres_per_unit: Some(1.0), ..StrandOptions::default() };
    Ok(Strands::new(&asset, &options)?)
}

/// Where its vertices come to rest, from the root, in shares of its length: along, up.
fn rested(solver: Solver, local_stiffness: f32, gravity: f32) -> Result<Vec<(f64, f64)>> {
    let strands = strand()?;
    let params = SimParams {
        gravity: Vec3::NEG_Y * gravity,
        bending_length: of_local_stiffness(local_stiffness, VERTICES.into(), LENGTH),
        sag_free: 0.0,
        air_drag: 5.0,
        local_stiffness,
        global_stiffness: 0.0,
        damping: 0.02,
        ..SimParams::default()
    };
    let mut simulation = Simulation::new(&[SectionDesc::new(&strands, params).with_solver(solver)])?;
    simulation.set_clock_params(ClockParams { sub_step: 1.0 / 60.0, ..ClockParams::default() })?;
    let motion = Motion::still(&strands);
    simulation.step(&motion.input(0.0, 0.0))?;
    for frame in 1..=60 * SECONDS {
        simulation.step(&motion.input(f64::from(frame) / 60.0, 1.0 / 60.0))?;
    }
    let places = simulation.positions(0);
    let share = |place: &DVec3| (*place - places[0]) / f64::from(LENGTH);
    Ok(places.iter().map(share).map(|place| (place.x, place.y)).collect())
}

fn draw(svg: &mut String) -> Result<()> {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let (left, right) = area.split_horizontally(SIZE.0 / 2);
    for (panel, gravity) in [left, right].into_iter().zip(GRAVITIES) {
        let title = format!("gravity {gravity} m/s^2, {VERTICES} vertices, 20 cm");
        let mut chart = ChartBuilder::on(&panel)
            .caption(title, ("sans-serif", 16))
            .margin(12)
            .x_label_area_size(40)
            .y_label_area_size(46)
            .build_cartesian_2d(-0.05..1.05, -1.7..0.1)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .x_desc("along, lengths")
            .y_desc("up, lengths")
            .x_label_formatter(&|value| format!("{value:.1}"))
            .y_label_formatter(&|value: &f64| format!("{:.1}", (10.0 * value).round() / 10.0 + 0.0))
            .draw()?;
        for (local_stiffness, color) in STIFFNESSES.into_iter().zip(COLORS) {
            let bending_length = of_local_stiffness(local_stiffness, VERTICES.into(), LENGTH);
            chart
                .draw_series(LineSeries::new(rested(Solver::Direct, local_stiffness, gravity)?, color.stroke_width(2)))?
                .label(format!("direct, bending length {:.1} cm", 100.0 * bending_length))
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
            let published = rested(Solver::TressFx, local_stiffness, gravity)?;
            chart
                .draw_series(published.into_iter().map(|place| Circle::new(place, 3, color.filled())))?
                .label(format!("tressfx, local stiffness {local_stiffness}"))
                .legend(move |(x, y)| Circle::new((x + 9, y), 3, color.filled()));
        }
        if gravity == GRAVITIES[0] {
            chart
                .configure_series_labels()
                .position(SeriesLabelPosition::LowerLeft)
                .background_style(WHITE.mix(0.8))
                .label_font(("sans-serif", 13))
                .draw()?;
        }
    }
    area.present()?;
    drop(area);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn with_little_gravity_rods_hang_as_the_published_method_has_it() {
        for local_stiffness in [0.9, 0.95] {
            let [rods, published] = [Solver::Direct, Solver::TressFx]
                .map(|solver| rested(solver, local_stiffness, GRAVITIES[0]).unwrap().last().copied().unwrap());
            let apart = (rods.0 - published.0).hypot(rods.1 - published.1);
            assert!(apart < 0.03, "{local_stiffness}: {rods:?} {published:?}");
        }
    }
}
