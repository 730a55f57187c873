//! The plots of `docs/motion.md`: the f64 function of `direct` beside what thin rods are known to do.

use std::ops::Range;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use indicatif::{ProgressBar, ProgressStyle};
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;
use tressfx_conformance::rod::strand::LENGTH;
use tressfx_conformance::rod::{chain, experiment, threshold};

const SIZE: (u32, u32) = (760, 440);
const VERTICES: [usize; 4] = [8, 16, 32, 64];
const RATIOS: [f64; 12] = [0.1, 0.3, 1.0, 2.0, 3.0, 5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0];
/// Shares of a threshold at which a strand is tried.
const SHARES: [f64; 11] = [0.75, 0.8, 0.85, 0.9, 0.95, 0.99, 1.01, 1.05, 1.1, 1.15, 1.2];
/// The threshold and the 5 % beside it.
const LIMITS: [f64; 3] = [0.95, 1.0, 1.05];
const COLORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];
const GREY: RGBColor = RGBColor(150, 150, 150);

/// A line of a plot.
struct Line {
    name: String,
    points: Vec<(f64, f64)>,
}

impl Line {
    fn new(name: impl Into<String>, points: impl Iterator<Item = (f64, f64)>) -> Self {
        Self { name: name.into(), points: points.collect() }
    }
}

/// What a plot says.
struct Plot {
    file: &'static str,
    title: &'static str,
    x: &'static str,
    y: &'static str,
    /// Whether the axis of x is logarithmic.
    is_log: bool,
    /// Vertical lines at [`LIMITS`].
    has_limits: bool,
    /// Where no points are.
    legend: SeriesLabelPosition,
    lines: Vec<Line>,
}

/// A plot's name, and what makes it.
type Measured = (&'static str, fn() -> Plot);

/// Measures and writes all plots.
pub(crate) fn write(docs: &Path) -> Result<()> {
    std::fs::create_dir_all(docs).with_context(|| docs.display().to_string())?;
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len}: {msg}").expect("the template is fixed");
    let plots: [Measured; 6] = [
        ("elastica", elastica),
        ("modes", modes),
        ("helix", helix),
        ("Greenhill", greenhill),
        ("Michell", michell),
        ("bend-twist", bend_twist),
    ];
    let bar = ProgressBar::new(plots.len() as u64).with_style(style);
    for (name, measure) in plots {
        bar.set_message(name);
        let plot = measure();
        let mut svg = String::new();
        let path = docs.join(format!("motion-{}.svg", plot.file));
        let drawn = match plot.is_log {
            true => {
                let range = x_range(&plot);
                draw(&mut svg, &plot, range.log_scale())
            }
            false => draw(&mut svg, &plot, x_range(&plot)),
        };
        drawn.map_err(|error| anyhow!("{}: {error}", path.display()))?;
        std::fs::write(&path, svg).with_context(|| path.display().to_string())?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

fn elastica() -> Plot {
    let of = |vertices: usize| {
        let error = |ratio: &f64| (*ratio, 100.0 * experiment::elastica_error(vertices, *ratio));
        Line::new(format!("{vertices} vertices"), RATIOS.iter().map(error))
    };
    Plot {
        file: "elastica",
        title: "Heavy elastica: a strand held horizontally",
        x: "length over bending length",
        y: "distance of the tip, % of length",
        is_log: true,
        has_limits: false,
        legend: SeriesLabelPosition::UpperLeft,
        lines: VERTICES.into_iter().map(of).collect(),
    }
}

fn modes() -> Plot {
    let of = |number: usize| {
        let error = |&vertices: &usize| {
            let (frequency, _) = experiment::mode(vertices, number, 1.0 / 120.0);
            (vertices as f64, 100.0 * (frequency / chain::frequency(LENGTH, number) - 1.0))
        };
        Line::new(format!("mode {number}"), VERTICES.iter().map(error))
    };
    Plot {
        file: "modes",
        title: "Modes of a hanging strand, sub-steps of 1/120 s",
        x: "vertices",
        y: "error of the frequency, %",
        is_log: true,
        has_limits: false,
        legend: SeriesLabelPosition::LowerLeft,
        lines: (1..=3).map(of).collect(),
    }
}

fn helix() -> Plot {
    let known = experiment::known_helix();
    let error = |vertices: usize| {
        let found = experiment::helix(vertices);
        let off = found.tip.distance(known.tip) / experiment::HELIX_LENGTH;
        (vertices as f64, 100.0 * (1.0 - found.longer / known.longer), 100.0 * off)
    };
    let errors: Vec<_> = [24, 32, 48, 64, 96, 128, 192].into_iter().map(error).collect();
    let line =
        |name: &str, of: fn(&(f64, f64, f64)) -> f64| Line::new(name, errors.iter().map(|error| (error.0, of(error))));
    Plot {
        file: "helix",
        title: "A helix under gravity, against a Kirchhoff rod",
        x: "vertices",
        y: "error, %",
        is_log: false,
        has_limits: false,
        legend: SeriesLabelPosition::UpperRight,
        lines: vec![
            line("height, of that of the Kirchhoff rod", |error| error.1),
            line("distance of the tip, of the length", |error| error.2),
        ],
    }
}

/// A plot of what strands do on both sides of a threshold.
fn beside(file: &'static str, title: &'static str, y: &'static str, lines: Vec<Line>) -> Plot {
    let legend = SeriesLabelPosition::MiddleLeft;
    Plot { file, title, x: "share of the threshold", y, is_log: false, has_limits: true, legend, lines }
}

fn greenhill() -> Plot {
    let known = threshold::greenhill();
    let lean = SHARES.into_iter().map(|share| (share, experiment::lean(share * known)));
    let title = "Greenhill: an upright strand of 32 vertices, pushed a little";
    beside("greenhill", title, "lean after 8 s over that after the push", vec![Line::new("direct", lean)])
}

fn michell() -> Plot {
    let of = |vertices: usize| {
        let twist = SHARES.into_iter().map(move |share| (share, experiment::twist_of_a_ring(vertices, share)));
        Line::new(format!("{vertices} vertices"), twist)
    };
    let title = "Michell: a twisted ring, pushed a little";
    beside("michell", title, "share of the twist that is left after 4 s", vec![of(48), of(96)])
}

fn bend_twist() -> Plot {
    let of = |arc: f64| {
        let known = threshold::bend_twist(arc, 0.77);
        let aside = SHARES.into_iter().map(move |share| (share, 100.0 * experiment::arc_aside(arc, share * known)));
        Line::new(format!("{arc} radians"), aside)
    };
    let title = "Hanging arcs of 96 vertices: bending turns into twist";
    beside("bend-twist", title, "tip out of its plane, % of length", vec![of(8.0), of(12.0)])
}

fn bounds(plot: &Plot, of: impl Fn(&(f64, f64)) -> f64) -> Range<f64> {
    let values: Vec<f64> = plot.lines.iter().flat_map(|line| line.points.iter().map(&of)).collect();
    values.iter().copied().fold(f64::INFINITY, f64::min)..values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn x_range(plot: &Plot) -> Range<f64> {
    bounds(plot, |point| point.0)
}

/// From 0, or from below it where there is something, with room at both ends.
fn y_range(plot: &Plot) -> Range<f64> {
    let Range { start, end } = bounds(plot, |point| point.1);
    let room = 0.06 * (end - start.min(0.0));
    let start = if start < 0.0 { start - room } else { 0.0 };
    start..end + room
}

fn draw<X>(svg: &mut String, plot: &Plot, x: X) -> std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>
where
    X: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64>,
{
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let y = y_range(plot);
    let mut chart = ChartBuilder::on(&area)
        .caption(plot.title, ("sans-serif", 20))
        .margin(14)
        .margin_right(30)
        .x_label_area_size(46)
        .y_label_area_size(64)
        .build_cartesian_2d(x, y.clone())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc(plot.x)
        .y_desc(plot.y)
        .x_label_formatter(&|value| format!("{}", (value * 1000.0).round() / 1000.0))
        .draw()?;
    if plot.has_limits {
        for limit in LIMITS {
            let width = if limit == 1.0 { 3 } else { 1 };
            chart.draw_series([PathElement::new([(limit, y.start), (limit, y.end)], GREY.stroke_width(width))])?;
        }
    }
    for (line, color) in plot.lines.iter().zip(COLORS) {
        let points = line.points.iter().copied();
        chart
            .draw_series(LineSeries::new(points.clone(), color.stroke_width(2)))?
            .label(&line.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        chart.draw_series(points.map(|point| Circle::new(point, 4, color.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(plot.legend.clone())
        .background_style(WHITE.mix(0.8))
        .label_font(("sans-serif", 14))
        .draw()?;
    area.present()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plot_has_its_words_its_lines_and_its_limits() {
        let line = Line::new("direct", SHARES.into_iter().map(|share| (share, 10.0 * (share - 1.0))));
        let plot = beside("greenhill", "Greenhill", "lean", vec![line]);
        assert!(y_range(&plot).start < -2.5 && y_range(&plot).end > 2.0, "{:?}", y_range(&plot));
        let mut svg = String::new();
        draw(&mut svg, &plot, x_range(&plot)).unwrap();
        for word in ["Greenhill", "lean", "direct", "share of the threshold"] {
            assert!(svg.contains(word), "{word}");
        }
        assert_eq!(svg.matches("<circle").count(), SHARES.len());
    }
}
