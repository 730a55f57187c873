//! `tressfx info`.

use anyhow::Result;
use tressfx_asset::Report;

use crate::cli::Info;
use crate::groom;

/// Reports every file, as text or as a JSON array.
pub(crate) fn run(args: &Info) -> Result<()> {
    let reports = args.grooms.iter().map(|name| Ok(Report::new(&groom::asset(name)?)?)).collect::<Result<Vec<_>>>()?;
    if args.json {
        println!("{}", serde_json::to_string_pretty(&reports)?);
        return Ok(());
    }
    for report in &reports {
        print(report);
    }
    Ok(())
}

fn print(report: &Report) {
    let Report { length, bounds, oddities, .. } = report;
    let unit = report.metres_per_unit;
    println!("{}", report.name);
    println!("  format     {:?}", report.format);
    println!("  strands    {}", report.strands);
    let counts = match (report.min_vertices, report.max_vertices) {
        (min, max) if min == max => format!("{min} a strand"),
        (min, max) => format!("{min} to {max} a strand"),
    };
    println!("  vertices   {} ({counts}, {} pinned)", report.vertices, report.pinned_vertices);
    println!(
        "  length     {:.4} mean, {:.4} to {:.4}, {:.4} median",
        length.mean, length.min, length.max, length.median
    );
    println!("  bounds     {} to {}", bounds.min, bounds.max);
    println!("  unit       {unit} m (from the size of the groom)");
    println!("  follow     {} a guide", report.follow_count);
    if !report.arrays.is_empty() {
        println!("  also holds {}", report.arrays.join(", "));
    }
    let odd = [
        (oddities.zero_length_segments, "zero-length segments"),
        (oddities.zero_length_strands, "zero-length strands"),
        (oddities.single_vertex_strands, "strands of one vertex"),
        (oddities.long_strands, "strands of more than 256 vertices"),
        (oddities.loose_roots, "strands whose root is not pinned"),
    ];
    for (count, what) in odd.into_iter().filter(|(count, _)| *count > 0) {
        println!("  odd        {count} {what}");
    }
}
