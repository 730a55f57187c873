//! The map of stability as a picture.

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::prelude::*;

use crate::case::SolverName;
use crate::map::{BENDING_LENGTHS, Cell, LOCAL_STIFFNESSES, RATES, VERTICES};

const SIZE: (u32, u32) = (1180, 330);
/// Where the names of the stiffnesses end, and where the squares begin.
const LEFT: i32 = 128;
const TOP: i32 = 64;
const SQUARE: i32 = 24;
const GAP: i32 = 24;

/// Speeds below these, m/s, and their colours: what is calm is pale (Viridis, turned).
const STEPS: [(f64, &str, RGBColor); 6] = [
    (1e-4, "below 0.1 mm/s", RGBColor(253, 231, 37)),
    (1e-3, "1 mm/s", RGBColor(122, 209, 81)),
    (1e-2, "1 cm/s", RGBColor(34, 168, 132)),
    (1e-1, "10 cm/s", RGBColor(42, 120, 142)),
    (1.0, "1 m/s", RGBColor(65, 68, 135)),
    (f64::INFINITY, "more", RGBColor(68, 1, 84)),
];
const NON_FINITE: RGBColor = RGBColor(213, 0, 0);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// The map of a solver, as SVG.
///
/// # Errors
/// It cannot be drawn.
pub fn map(solver: SolverName, cells: &[Cell]) -> Result<String> {
    let mut svg = String::new();
    draw(&mut svg, solver, cells).map_err(|error| anyhow!("the map: {error}"))?;
    Ok(svg)
}

fn color(speed: Option<f64>) -> RGBColor {
    let Some(speed) = speed else { return NON_FINITE };
    STEPS.iter().find(|(below, ..)| speed < *below).map_or(NON_FINITE, |(.., color)| *color)
}

fn draw(svg: &mut String, solver: SolverName, cells: &[Cell]) -> Drawn {
    let area: Area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let (what, names): (&str, Vec<String>) = match solver {
        SolverName::Direct => ("bending length, m", BENDING_LENGTHS.map(|length| length.to_string()).to_vec()),
        SolverName::Tressfx => ("local_stiffness", LOCAL_STIFFNESSES.map(|stiffness| stiffness.to_string()).to_vec()),
    };
    text(&area, (LEFT, 8), 18, &format!("{}: speed half a second after a hard shake", solver.name()))?;
    text(&area, (6, TOP - 22), 13, what)?;
    for (row, name) in names.iter().enumerate() {
        text(&area, (30, TOP + 5 + SQUARE * row as i32), 13, name)?;
    }
    let bottom = TOP + SQUARE * names.len() as i32;
    for (panel, vertices) in VERTICES.iter().enumerate() {
        let left = LEFT + panel as i32 * (SQUARE * RATES.len() as i32 + GAP);
        text(&area, (left, TOP - 22), 13, &format!("{vertices} vertices"))?;
        for (column, rate) in RATES.iter().enumerate() {
            let x = left + SQUARE * column as i32;
            text(&area, (x + 1, bottom + 4 + 11 * (column as i32 % 2)), 10, &format!("1/{rate}"))?;
            for cell in cells.iter().filter(|c| (c.solver, c.vertices, c.rate) == (solver, *vertices, *rate)) {
                let y = TOP + SQUARE * cell.stiffness as i32;
                let corners = [(x, y), (x + SQUARE - 1, y + SQUARE - 1)];
                area.draw(&Rectangle::new(corners, color(cell.speed).filled()))?;
            }
        }
    }
    text(&area, (LEFT, bottom + 30), 13, "sub-step, s")?;
    legend(&area, bottom + 56)?;
    area.present()
}

fn legend(area: &Area, y: i32) -> Drawn {
    let steps = STEPS.iter().map(|(_, name, color)| (*name, *color)).chain([("non-finite", NON_FINITE)]);
    for (place, (name, color)) in steps.enumerate() {
        let x = LEFT + 140 * place as i32;
        area.draw(&Rectangle::new([(x, y), (x + 16, y + 16)], color.filled()))?;
        text(area, (x + 22, y + 1), 13, name)?;
    }
    Ok(())
}

fn text(area: &Area, at: (i32, i32), size: i32, text: &str) -> Drawn {
    area.draw(&Text::new(text.to_owned(), at, ("sans-serif", size)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_has_a_square_for_each_cell_in_the_colour_of_its_speed() {
        let cell = Cell { solver: SolverName::Direct, vertices: 8, rate: 60, stiffness: 2, speed: Some(0.05) };
        let other = Cell { solver: SolverName::Tressfx, speed: None, ..cell };
        let svg = map(SolverName::Direct, &[cell, other]).unwrap();
        let squares = |color: &str| svg.matches(color).count();
        // One of the map and one of the legend; the other solver has a map of its own.
        assert_eq!((squares("#2A788E"), squares("#D50000"), squares("#414487")), (2, 1, 1));
        assert!(svg.contains("64 vertices") && svg.contains("1/1920") && svg.contains("bending length"));
    }

    #[test]
    fn faster_is_darker() {
        assert_eq!(color(Some(0.0)), STEPS[0].2);
        assert_eq!(color(Some(5.0)), STEPS[5].2);
        assert_eq!(color(None), NON_FINITE);
    }
}
