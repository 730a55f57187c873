//! A plot of each case: distance against time, and the methods that no other one beats in both.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;

use crate::figures::{Row, Run};

const SIZE: (u32, u32) = (940, 520);
/// Where the legend begins: beside the plot, since points may lie anywhere in it.
const LEGEND: i32 = 690;
/// The smallest distance that is drawn, %.
const LEAST: f64 = 1e-4;

/// A line in the plot: what has the same solver, rounds and vertices, in colours that people who see few are told apart by too
/// (Okabe and Ito).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(230, 159, 0),
    RGBColor(204, 121, 167),
    RGBColor(90, 90, 90),
];

/// Of the line along the best ones.
const FRONT: RGBColor = RGBColor(200, 200, 200);

/// A row in the plot.
#[derive(Clone, Debug, PartialEq)]
struct Point {
    ms: f64,
    /// %.
    distance: f64,
    family: String,
    setting: String,
    joins: bool,
}

/// Whether there is anything to draw.
pub(crate) fn is_drawn(rows: &[&Row]) -> bool {
    rows.iter().any(|row| row.ms.is_some())
}

/// Writes `motion-CASE.svg` for each case.
pub(crate) fn write(run: &Run, docs: &Path) -> Result<()> {
    for case in run.cases() {
        let rows: Vec<&Row> = run.of_case(case).collect();
        if !is_drawn(&rows) {
            continue;
        }
        let path = docs.join(format!("motion-{case}.svg"));
        let mut svg = String::new();
        let is_software = rows.iter().any(|row| row.is_software());
        let device = if is_software { "on a CPU that plays a GPU" } else { &rows[0].adapter };
        draw(&mut svg, case, device, &points(&rows)).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        std::fs::write(&path, svg).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

fn points(rows: &[&Row]) -> Vec<Point> {
    // Most rows have the vertices of the case; the others are on their own.
    let usual = rows.first().map_or(0, |row| row.vertices);
    let mut vertices_of_lines = std::collections::BTreeSet::new();
    let point = |row: &&Row| {
        let ms = row.ms.filter(|&ms| ms > 0.0)?;
        // The same method with the vertices of the case comes twice, as a part of either line.
        let joins = row.vertices == usual && vertices_of_lines.insert((row.solver.clone(), row.rate, row.rounds));
        let (family, setting) = match joins {
            true => (format!("{}, {} rounds", row.solver, row.rounds), row.rate.to_string()),
            false => (format!("{}, other vertices", row.solver), format!("{} v", row.vertices)),
        };
        let distance = if row.distance.is_finite() { (100.0 * row.distance).max(LEAST) } else { return None };
        Some(Point { ms, distance, family, setting, joins })
    };
    rows.iter().filter_map(point).collect()
}

/// The points that no other one beats in both, from the fastest to the most exact.
fn front(points: &[Point]) -> Vec<Point> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.ms.total_cmp(&b.ms).then(a.distance.total_cmp(&b.distance)));
    let mut least = f64::INFINITY;
    sorted.retain(|point| {
        let is_better = point.distance < least;
        least = least.min(point.distance);
        is_better
    });
    sorted
}

/// The label of a place on a logarithmic axis: ones, twos and fives have one, the others would be too near.
fn tick(value: f64) -> String {
    let scale = 10f64.powf(value.log10().floor());
    match (value / scale).round() as u32 {
        first @ (1 | 2 | 5) => format!("{}", (f64::from(first) * scale * 1e9).round() / 1e9),
        _ => String::new(),
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;
type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn draw(svg: &mut String, case: &str, device: &str, points: &[Point]) -> Drawn {
    let area: Area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let (plot, legend) = area.split_horizontally(LEGEND);
    let range = |of: fn(&Point) -> f64, beyond: f64| {
        let least = points.iter().map(of).fold(f64::INFINITY, f64::min);
        let most = points.iter().map(of).fold(0.0, f64::max);
        least / beyond..most * beyond
    };
    let mut chart = ChartBuilder::on(&plot)
        .caption(case, ("sans-serif", 22))
        .margin(14)
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(range(|point| point.ms, 1.3).log_scale(), range(|point| point.distance, 1.6).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc(format!("milliseconds for 1/60 s of motion, {device}"))
        .y_desc("distance of tips to the reference, % of length")
        .x_label_formatter(&|ms| tick(*ms))
        .y_label_formatter(&|percent| tick(*percent))
        .draw()?;
    draw_front(&mut chart, points)?;
    let mut families: Vec<&str> = Vec::new();
    for point in points {
        if !families.contains(&point.family.as_str()) {
            families.push(&point.family);
        }
    }
    for (row, (family, color)) in families.iter().zip(COLORS.iter().cycle()).enumerate() {
        let own: Vec<&Point> = points.iter().filter(|point| point.family == *family).collect();
        draw_family(&mut chart, *color, &own)?;
        draw_legend(&legend, row as i32 + 1, family, *color)?;
    }
    draw_legend(&legend, 0, "none is faster and more exact", FRONT)?;
    legend.draw(&Text::new(
        "numbers: sub-steps a second",
        (4, 60 + 22 * (families.len() as i32 + 1)),
        ("sans-serif", 13),
    ))?;
    area.present()
}

/// One row of the legend: a dot for a family, a line for the best ones.
fn draw_legend(legend: &Area, row: i32, name: &str, color: RGBColor) -> Drawn {
    let y = 60 + 22 * row;
    match row {
        0 => legend.draw(&PathElement::new([(4, y), (24, y)], color.stroke_width(6)))?,
        _ => legend.draw(&Circle::new((14, y), 5, color.filled()))?,
    }
    legend.draw(&Text::new(name.to_owned(), (32, y - 7), ("sans-serif", 13)))
}

/// Steps along the points that no other one beats.
fn draw_front(chart: &mut Chart, points: &[Point]) -> Drawn {
    let front = front(points);
    let steps = front.windows(2).flat_map(|pair| [(pair[1].ms, pair[0].distance), (pair[1].ms, pair[1].distance)]);
    let line = front.first().map(|first| (first.ms, first.distance)).into_iter().chain(steps);
    chart.draw_series(LineSeries::new(line, FRONT.stroke_width(6)))?;
    Ok(())
}

fn draw_family(chart: &mut Chart, color: RGBColor, points: &[&Point]) -> Drawn {
    let line = points.iter().filter(|point| point.joins).map(|point| (point.ms, point.distance));
    chart.draw_series(LineSeries::new(line, color.stroke_width(1)))?;
    chart.draw_series(points.iter().map(|point| Circle::new((point.ms, point.distance), 5, color.filled())))?;
    chart.draw_series(points.iter().map(|point| {
        let at = EmptyElement::at((point.ms, point.distance));
        at + Text::new(point.setting.clone(), (7, -14), ("sans-serif", 13).into_font().color(&color))
    }))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::tests::row;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let rows = [row(60, 0.5, 1.0), row(120, 0.25, 2.0), row(480, 0.125, 4.0), row(240, 0.3, 3.0)];
        let rows: Vec<&Row> = rows.iter().collect();
        let points = points(&rows);
        assert_eq!(front(&points).iter().map(|point| point.ms).collect::<Vec<_>>(), [1.0, 2.0, 4.0]);
    }

    #[test]
    fn a_plot_names_its_case_its_device_and_its_methods() {
        let rows = [row(60, 0.25, 1.0), row(120, 0.125, 2.0), Row { vertices: 8, ..row(120, 0.5, 1.5) }];
        let rows: Vec<&Row> = rows.iter().collect();
        let mut svg = String::new();
        draw(&mut svg, "curly-shake", "a GPU", &points(&rows)).unwrap();
        for word in ["curly-shake", "a GPU", "direct, 2 rounds", "direct, other vertices", "8 v", "distance"] {
            assert!(svg.contains(word), "{word}");
        }
        let untimed = Row { ms: None, ..row(60, 0.25, 1.0) };
        assert!(!is_drawn(&[&untimed]), "what has no time has no place");
    }

    #[test]
    fn ones_twos_and_fives_of_an_axis_have_labels() {
        let labels = [0.1, 0.2, 0.1 + 0.2, 0.5, 1.0, 20.0, 90.0].map(tick);
        assert_eq!(labels, ["0.1", "0.2", "", "0.5", "1", "20", ""]);
    }
}
