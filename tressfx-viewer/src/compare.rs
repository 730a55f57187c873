//! `tressfx compare`.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use anyhow::{Context, Result, bail};
use comfy_table::{Table, presets};
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageFormat, Limits};
use tressfx_compare::{Comparison, Picture, compare};

use crate::cli::Compare;
use crate::say::say;

/// Comparing takes far more memory than a file does: this many pixels, a little more than 7680x4320, take some 3 GB.
const MOST_PIXELS: u64 = 1 << 25;

/// Compares two files, prints the figures and writes the heat map if there is to be one.
pub(crate) fn run(args: &Compare) -> Result<()> {
    let read = |path: &Path| read(path).with_context(|| path.display().to_string());
    let comparison = compared(read(&args.a)?, read(&args.b)?)
        .with_context(|| format!("{}, {}", args.a.display(), args.b.display()))?;
    if let Some(path) = &args.heat_map {
        write(path, &comparison.heat_map).with_context(|| path.display().to_string())?;
    }
    match args.json {
        true => say(serde_json::to_string_pretty(&comparison)?)?,
        false => say(table(&comparison))?,
    }
    Ok(())
}

/// With 16 bits where one of them has so many.
fn compared(a: DynamicImage, b: DynamicImage) -> Result<Comparison> {
    let is_deep = |image: &DynamicImage| image.color().bytes_per_pixel() > image.color().channel_count();
    let size = |image: &DynamicImage| [image.width(), image.height()];
    let (sizes, deep) = ([size(&a), size(&b)], is_deep(&a) || is_deep(&b));
    if deep {
        let [a, b] = [a, b].map(|image| image.into_rgba16().into_raw());
        return Ok(compare(&Picture::new(sizes[0], a)?, &Picture::new(sizes[1], b)?)?);
    }
    let [a, b] = [a, b].map(|image| image.into_rgba8().into_raw());
    Ok(compare(&Picture::new(sizes[0], a)?, &Picture::new(sizes[1], b)?)?)
}

/// Reads a PNG; what its header says is checked before any of its pixels is decoded.
fn read(path: &Path) -> Result<DynamicImage> {
    let decoder = PngDecoder::with_limits(BufReader::new(File::open(path)?), Limits::default())?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        bail!("{width}x{height} pixels are more than {MOST_PIXELS}");
    }
    Ok(DynamicImage::from_decoder(decoder)?)
}

fn write(path: &Path, picture: &Picture) -> Result<()> {
    let [width, height] = picture.size();
    let (color, format) = (ExtendedColorType::Rgba8, ImageFormat::Png);
    Ok(image::save_buffer_with_format(path, picture.rgba(), width, height, color, format)?)
}

fn table(comparison: &Comparison) -> Table {
    let psnr = comparison.psnr_db.map_or_else(|| "equal".to_owned(), |decibels| format!("{decibels:.2} dB"));
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(["figure", "value"]);
    table.add_row(["FLIP, mean", &format!("{:.6}", comparison.flip_mean)]);
    table.add_row(["PSNR", &psnr]);
    table.add_row(["largest difference", &format!("{} of 255", comparison.max_difference)]);
    table.add_row(["differing pixels", &format!("{:.4} %", 100.0 * comparison.differing_share)]);
    table
}
