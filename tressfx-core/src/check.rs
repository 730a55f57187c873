//! The rules of a list, checked in one place so that no backend has to.

use crate::hazards::{Access, accesses};
use crate::id::Resource;
use crate::pass::{Command, ComputePass, Grid, Groups, PassList};
use crate::shader::{Shader, SlotKind};

/// Checks a list in debug builds.
///
/// # Panics
/// If a rule is broken, with the label or the place of the command: always a mistake of the program.
pub fn check(list: &PassList) {
    if cfg!(debug_assertions)
        && let Some(problem) = problem(list)
    {
        panic!("{problem}");
    }
}

/// The first broken rule of a list, in words.
///
/// The rules: sizes and offsets are multiples of 4, uploads lie within the list's bytes, a copy has two ends, a grid fits
/// the dimensions of every device, a buffer with the number of groups is not bound beside, each binding is of the kind that the shader declares, and within one pass nothing
/// that is written or drawn to is also bound another way.
///
/// It sees no descriptions of resources. That they are alive is the backend's to check; that ranges lie within their
/// buffers, and that pipelines fit the targets, the caller answers for.
pub fn problem(list: &PassList) -> Option<String> {
    list.commands.iter().enumerate().find_map(|(index, command)| {
        let problem = misaligned(command).or_else(|| misused(command, list.bytes.len()))?;
        Some(format!("command {index}, {}: {problem}", name(command)))
    })
}

fn name(command: &Command) -> &'static str {
    match command {
        Command::Upload { .. } => "upload",
        Command::Clear { .. } => "clear",
        Command::Copy { .. } => "copy",
        Command::Compute(pass) => pass.kernel.label(),
        Command::Raster(pass) => pass.label,
        Command::ReadBuffer { .. } => "read buffer",
        Command::ReadTexture { .. } => "read texture",
    }
}

fn misaligned(command: &Command) -> Option<String> {
    let sizes: Vec<u64> = match command {
        Command::Upload { offset, data, .. } => vec![*offset, data.len() as u64],
        Command::Clear { offset, bytes, .. } | Command::ReadBuffer { offset, bytes, .. } => vec![*offset, *bytes],
        Command::Copy { src_offset, dst_offset, bytes, .. } => vec![*src_offset, *dst_offset, *bytes],
        Command::Compute(ComputePass { groups: Groups::Indirect { offset, .. }, .. }) => vec![*offset],
        _ => Vec::new(),
    };
    let odd = sizes.into_iter().find(|size| size % 4 != 0)?;
    Some(format!("{odd} is not a multiple of 4"))
}

fn misused(command: &Command, bytes: usize) -> Option<String> {
    match command {
        Command::Upload { data, .. } if data.end > bytes => {
            Some(format!("bytes {data:?} of a list that holds {bytes}"))
        }
        Command::Copy { src, dst, .. } if src == dst => Some(String::from("from a buffer to itself")),
        Command::Compute(pass) => crowded(pass.groups)
            .or_else(|| mismatch(&pass.kernel.shader, pass.bindings.resources()))
            .or_else(|| argued(pass)),
        Command::Raster(pass) => pass
            .draws
            .iter()
            .find_map(|draw| mismatch(&draw.kernel.shader, draw.bindings.resources()))
            .or_else(|| drawn_and_bound(command)),
        _ => None,
    }
}

fn crowded(groups: Groups) -> Option<String> {
    let Groups::Grid(grid) = groups else { return None };
    let too_many = grid.0.iter().any(|&groups| groups > Grid::MAX_GROUPS);
    too_many.then(|| format!("{grid:?} exceeds {} groups in a dimension", Grid::MAX_GROUPS))
}

fn argued(pass: &ComputePass) -> Option<String> {
    let Groups::Indirect { buffer, .. } = pass.groups else { return None };
    let bound = pass.bindings.resources().contains(&buffer.into());
    bound.then(|| format!("{buffer:?} holds the number of groups and is bound in the same pass"))
}

fn mismatch(shader: &Shader, resources: &[Resource]) -> Option<String> {
    if shader.slots.len() != resources.len() {
        return Some(format!("{} of {} bindings", resources.len(), shader.slots.len()));
    }
    for (index, (slot, resource)) in shader.slots.iter().zip(resources).enumerate() {
        let texture = matches!(slot.kind, SlotKind::Texture | SlotKind::DepthTexture);
        if texture != matches!(resource, Resource::Texture(_)) {
            return Some(format!("`{}` is a {:?}, bound is {resource:?}", slot.name, slot.kind));
        }
        let again = |other: usize| {
            let written = slot.kind == SlotKind::ReadWrite || shader.slots[other].kind == SlotKind::ReadWrite;
            resources[other] == *resource && written
        };
        if let Some(other) = (0..index).find(|&other| again(other)) {
            return Some(format!(
                "`{}` and `{}` are the same buffer, and it is written",
                shader.slots[other].name, slot.name
            ));
        }
    }
    None
}

fn drawn_and_bound(command: &Command) -> Option<String> {
    let both = accesses(command)
        .into_iter()
        .find(|(_, access)| access.contains(Access::TARGET) && *access != Access::TARGET)?;
    Some(format!("{:?} is drawn to and bound in the same pass", both.0))
}
