//! `tressfx info`.

use anyhow::Result;
use tressfx_asset::Report;

use crate::cli::Info;
use crate::groom;
use crate::info_body;
use crate::say::say;

/// Reports every file, as text or as a JSON array.
pub(crate) fn run(args: &Info) -> Result<()> {
    if let Some(files) = info_body::files(&args.grooms)? {
        return info_body::run(files, args.json);
    }
    let reports = args.grooms.iter().map(|name| Ok(Report::new(&groom::asset(name)?)?)).collect::<Result<Vec<_>>>()?;
    if args.json {
        say(serde_json::to_string_pretty(&reports)?)?;
        return Ok(());
    }
    for report in &reports {
        print(report)?;
    }
    Ok(())
}

fn print(report: &Report) -> std::io::Result<()> {
    let Report { length, bounds, oddities, .. } = report;
    let unit = report.metres_per_unit;
    say(&report.name)?;
    say(format_args!("  format     {:?}", report.format))?;
    say(format_args!("  strands    {}", report.strands))?;
    let counts = match (report.min_vertices, report.max_vertices) {
        (min, max) if min == max => format!("{min} a strand"),
        (min, max) => format!("{min} to {max} a strand"),
    };
    say(format_args!("  vertices   {} ({counts}, {} pinned)", report.vertices, report.pinned_vertices))?;
    say(format_args!(
        "  length     {:.4} mean, {:.4} to {:.4}, {:.4} median",
        length.mean, length.min, length.max, length.median
    ))?;
    say(format_args!("  bounds     {} to {}", bounds.min, bounds.max))?;
    say(format_args!("  unit       {unit} m (from the size of the groom)"))?;
    say(format_args!("  follow     {} a guide", report.follow_count))?;
    if let Some([r, g, b, opacity]) = report.mean_color {
        say(format_args!("  colour     {r:.3}, {g:.3}, {b:.3} (sRGB) in the mean, opacity {opacity:.3}"))?;
    }
    if let Some([low, high]) = report.thickness {
        say(format_args!("  thickness  {low} to {high}"))?;
    }
    if !report.arrays.is_empty() {
        say(format_args!("  also holds {}", report.arrays.join(", ")))?;
    }
    let odd = [
        (oddities.zero_length_segments, "zero-length segments"),
        (oddities.zero_length_strands, "zero-length strands"),
        (oddities.single_vertex_strands, "strands of one vertex"),
        (oddities.long_strands, "strands of more than 256 vertices"),
        (oddities.loose_roots, "strands whose root is not pinned"),
    ];
    for (count, what) in odd.into_iter().filter(|(count, _)| *count > 0) {
        say(format_args!("  odd        {count} {what}"))?;
    }
    Ok(())
}
