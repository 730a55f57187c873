//! A plot of each scene: FLIP against time, and the methods that no other one beats in both.

use std::path::Path;

use anyhow::{Context, Result, anyhow};
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::figures::{Row, Run};
use crate::method::{FAMILIES, family_of};

const SIZE: (u32, u32) = (940, 480);
/// Where the legend begins: beside the plot, since points may lie anywhere in it.
const LEGEND: i32 = 690;

/// A colour a family; these are told apart by people who see few colours too (Okabe and Ito; the yellow is darker, and a grey, a brown, a violet and a dark red are added).
pub(crate) const COLORS: [RGBColor; FAMILIES.len()] = [
    RGBColor(0, 114, 178),
    RGBColor(86, 180, 233),
    RGBColor(184, 172, 20),
    RGBColor(120, 120, 120),
    RGBColor(90, 40, 140),
    RGBColor(213, 94, 0),
    RGBColor(230, 159, 0),
    RGBColor(150, 0, 40),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(0, 0, 0),
    RGBColor(140, 70, 20),
];

/// Of the line along the best ones.
const FRONT: RGBColor = RGBColor(200, 200, 200);

/// A row in the plot.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point<'a> {
    ms: f64,
    flip: f64,
    family: usize,
    setting: &'a str,
    /// Raw Vulkan; wgpu is filled.
    is_hollow: bool,
}

/// Whether there is anything to draw.
pub(crate) fn is_drawn(rows: &[&Row]) -> bool {
    !points(rows).is_empty()
}

/// Writes `SCENE.svg` for each scene.
pub(crate) fn write(run: &Run, docs: &Path) -> Result<()> {
    for scene in run.scenes() {
        let rows: Vec<&Row> = run.of_scene(scene).collect();
        let points = points(&rows);
        if points.is_empty() {
            continue;
        }
        let path = docs.join(format!("{scene}.svg"));
        let mut svg = String::new();
        let device =
            if rows.iter().any(|row| row.is_software()) { "on a CPU that plays a GPU" } else { &rows[0].adapter };
        draw(&mut svg, scene, device, &points).map_err(|error| anyhow!("{}: {error}", path.display()))?;
        std::fs::write(&path, svg).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

fn points<'a>(rows: &[&'a Row]) -> Vec<Point<'a>> {
    let point = |row: &&'a Row| {
        let (family, setting) = family_of(&row.method)?;
        let ms = row.ms().filter(|&ms| ms > 0.0)?;
        Some(Point { ms, flip: row.flip, family, setting, is_hollow: row.backend != "wgpu" })
    };
    rows.iter().filter_map(point).collect()
}

/// The points that no other one beats in both, from the fastest to the most exact.
fn front<'a>(points: &[Point<'a>]) -> Vec<Point<'a>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.ms.total_cmp(&b.ms).then(a.flip.total_cmp(&b.flip)));
    let mut least = f64::INFINITY;
    sorted.retain(|point| {
        let is_better = point.flip < least;
        least = least.min(point.flip);
        is_better
    });
    sorted
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<plotters::coord::combinators::LogCoord<f64>, RangedCoordf64>>;
pub(crate) type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

fn draw(svg: &mut String, scene: &str, device: &str, points: &[Point]) -> Drawn {
    let area: Area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let (plot, legend) = area.split_horizontally(LEGEND);
    let fold = |of: &dyn Fn(&Point) -> f64, least: bool| {
        let pick = if least { f64::min } else { f64::max };
        points.iter().map(of).reduce(pick).unwrap_or(1.0)
    };
    let times = fold(&|point| point.ms, true) * 0.8..fold(&|point| point.ms, false) * 1.25;
    let errors = 0.0..(fold(&|point| point.flip, false) * 1.12).max(1e-6);
    let mut chart = ChartBuilder::on(&plot)
        .caption(scene, ("sans-serif", 22))
        .margin(14)
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(times.log_scale(), errors)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc(format!("milliseconds a frame, {device}"))
        .y_desc("FLIP against the reference")
        .x_label_formatter(&time_label)
        .draw()?;
    draw_front(&mut chart, points)?;
    draw_legend(&legend, 0, "none is faster and more exact", FRONT)?;
    let mut row = 1;
    for (family, (of, color)) in FAMILIES.iter().zip(COLORS).enumerate() {
        let own: Vec<_> = points.iter().filter(|point| point.family == family).copied().collect();
        if !own.is_empty() {
            draw_family(&mut chart, color, &own)?;
            draw_legend(&legend, row, of.name, color)?;
            row += 1;
        }
    }
    if points.iter().any(|point| point.is_hollow) {
        draw_legend(&legend, row, "hollow: raw Vulkan", WHITE)?;
    }
    area.present()
}

/// The label of a time: 0.3 is found as three times 0.1.
pub(crate) fn milliseconds(ms: &f64) -> String {
    format!("{}", (ms * 1e6).round() / 1e6)
}

/// The same on a logarithmic axis, which has no room for the last ones before a power of ten.
fn time_label(ms: &f64) -> String {
    let label = milliseconds(ms);
    let is_last = label.trim_start_matches(['0', '.']).starts_with(['7', '8', '9']);
    if is_last { String::new() } else { label }
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
    let steps = front.windows(2).flat_map(|pair| [(pair[1].ms, pair[0].flip), (pair[1].ms, pair[1].flip)]);
    let line = front.first().map(|first| (first.ms, first.flip)).into_iter().chain(steps);
    chart.draw_series(LineSeries::new(line, FRONT.stroke_width(6)))?;
    Ok(())
}

fn draw_family(chart: &mut Chart, color: RGBColor, points: &[Point]) -> Drawn {
    let style = |is_hollow: bool| if is_hollow { color.stroke_width(2) } else { color.filled() };
    chart.draw_series(points.iter().map(|point| Circle::new((point.ms, point.flip), 5, style(point.is_hollow))))?;
    chart.draw_series(points.iter().map(|point| {
        let at = EmptyElement::at((point.ms, point.flip));
        at + Text::new(point.setting.to_owned(), (7, -14), ("sans-serif", 13).into_font().color(&color))
    }))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::tests::row;

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let rows =
            [row("ppll-k1", 0.5, 1.0), row("ppll-k8", 0.25, 2.0), row("tiles", 0.125, 4.0), row("ppll-k4", 0.3, 3.0)];
        let rows: Vec<&Row> = rows.iter().collect();
        let points = points(&rows);
        assert_eq!(front(&points).iter().map(|point| point.ms).collect::<Vec<_>>(), [1.0, 2.0, 4.0]);
    }

    #[test]
    fn a_plot_names_its_scene_its_device_and_its_methods() {
        let rows =
            [row("ppll-k8", 0.25, 2.0), row("tiles", 0.125, 4.0), Row { passes: Vec::new(), ..row("tiles", 0.1, 1.0) }];
        let rows: Vec<&Row> = rows.iter().collect();
        let mut svg = String::new();
        draw(&mut svg, "curly-near", "a GPU", &points(&rows)).unwrap();
        for word in ["curly-near", "a GPU", "ppll", "tiles", "FLIP"] {
            assert!(svg.contains(word), "{word}");
        }
        assert!(!svg.contains("shortcut") && !svg.contains("hollow"), "nothing was measured of it");
        assert!(!is_drawn(&rows[2..]), "what has no time has no place");
    }
}
