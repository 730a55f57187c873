//! The plot of time against strands, both in octaves.

use anyhow::{Result, anyhow};
use plotters::prelude::*;

use crate::growth::{Growth, Point};
use crate::method::family_of;
use crate::plot::{COLORS, Drawn, milliseconds};

const AREA: (u32, u32) = (760, 480);
/// Of the line that time would follow if it grew as the strands do.
const PROPORTION: RGBColor = RGBColor(190, 190, 190);

/// # Errors
/// If there is no time to draw, or it cannot be drawn.
pub(crate) fn svg(growth: &Growth) -> Result<String> {
    let mut svg = String::new();
    draw(&mut svg, growth).map_err(|error| anyhow!("growth.svg: {error}"))?;
    Ok(svg)
}

/// Somewhat more than from the least to the largest.
fn range(values: impl Iterator<Item = f64> + Clone) -> std::ops::Range<f64> {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let largest = values.fold(0.0, f64::max);
    if least > 0.0 && least < f64::INFINITY { least / 1.3..largest * 1.3 } else { 0.1..10.0 }
}

fn draw(svg: &mut String, growth: &Growth) -> Drawn {
    let area = SVGBackend::with_string(svg, AREA).into_drawing_area();
    area.fill(&WHITE)?;
    let strands = range(growth.points.iter().map(|point| f64::from(point.strands)));
    let times = range(growth.points.iter().map(Point::ms));
    let mut chart = ChartBuilder::on(&area)
        .caption("builtin:long, 32 vertices a strand", ("sans-serif", 22))
        .margin(14)
        .x_label_area_size(48)
        .y_label_area_size(60)
        .build_cartesian_2d(strands.log_scale().base(2.0), times.log_scale().base(2.0))?;
    let [width, height] = growth.size;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .x_desc("strands")
        .y_desc(format!("milliseconds a frame, {width}x{height}, {}", growth.adapter))
        .x_label_formatter(&|strands| format!("{strands:.0}"))
        .y_label_formatter(&milliseconds)
        .draw()?;
    for method in growth.methods() {
        let points: Vec<_> = growth.of(method).map(|point| (f64::from(point.strands), point.ms())).collect();
        let color = family_of(method).map_or(BLACK, |(family, _)| COLORS[family]);
        if method == "tiles"
            && let (Some(first), Some(last)) = (points.first(), points.last())
        {
            let end = (last.0, first.1 * last.0 / first.0);
            let line = chart.draw_series(LineSeries::new([*first, end], PROPORTION.stroke_width(2)))?;
            line.label("as strands grow")
                .legend(|(x, y)| PathElement::new([(x, y), (x + 18, y)], PROPORTION.stroke_width(2)));
        }
        chart
            .draw_series(LineSeries::new(points.iter().copied(), color.stroke_width(2)))?
            .label(method)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], color.stroke_width(2)));
        chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, color.filled())))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE.mix(0.85))
        .border_style(TRANSPARENT)
        .label_font(("sans-serif", 14))
        .draw()?;
    area.present()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::growth::tests::growth;

    #[test]
    fn a_plot_names_its_methods_and_its_device() {
        let svg = svg(&growth()).unwrap();
        for word in ["ppll-k8", "tiles", "as strands grow", "a GPU", "strands", "1920x1080"] {
            assert!(svg.contains(word), "{word}");
        }
        let mut untimed = growth();
        untimed.points.iter_mut().for_each(|point| point.passes.clear());
        assert!(super::svg(&untimed).is_ok(), "nothing was timed");
    }
}
