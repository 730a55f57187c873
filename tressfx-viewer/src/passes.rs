//! The passes of a frame as a table: `--print-passes`.

use comfy_table::{Table, presets};
use tressfx_core::pass::{Command, Count, Grid, Groups, PassList};
use tressfx_core::shader::{Shader, SlotKind};

/// One row a compute pass or draw, in the order in which they run.
pub(crate) fn table(list: &PassList) -> String {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN);
    table.set_header(["pass", "features", "bindings", "size"]);
    for command in list.commands() {
        match command {
            Command::Compute(pass) => {
                let size = match pass.groups {
                    Groups::Grid(Grid([x, y, z])) => format!("{x} x {y} x {z} groups"),
                    Groups::Indirect { .. } => String::from("as a buffer says"),
                };
                table.add_row(row(pass.kernel.label(), &pass.kernel.shader, size));
            }
            Command::Raster(pass) => {
                for draw in &pass.draws {
                    let size = match draw.count {
                        Count::Direct { vertices, instances } => format!("{vertices} vertices x {instances}"),
                        Count::Indirect { .. } => String::from("as a buffer says"),
                    };
                    table.add_row(row(pass.label, &draw.pipeline.shader, size));
                }
            }
            _ => {}
        }
    }
    table.to_string()
}

fn row(label: &str, shader: &Shader, size: String) -> [String; 4] {
    let bindings: Vec<String> =
        shader.slots.iter().map(|slot| format!("{} ({})", slot.name, access(slot.kind))).collect();
    [label.to_owned(), shader.features.clone(), bindings.join(", "), size]
}

fn access(kind: SlotKind) -> &'static str {
    match kind {
        SlotKind::Uniform => "uniform",
        SlotKind::Read => "read",
        SlotKind::ReadWrite => "read-write",
        SlotKind::StorageTexture(_) => "written texture",
        SlotKind::ReadWriteTexture(_) => "read and written texture",
        SlotKind::Sampler => "sampler",
        _ => "texture",
    }
}
