//! The rules of a list, held against the descriptions of what it names: before a command reaches a graphics API, in release
//! builds too.

mod bindings;
mod desc;
mod raster;

use crate::backend::{BufferDesc, BufferUses, Caps, ComputeDesc, RasterDesc, TextureDesc, TextureUses};
use crate::error::{Error, Need, Result};
use crate::id::{BufferId, PipelineId, TextureId};
use crate::pass::{Command, ComputePass, Grid, Groups, PassList, ROW_ALIGNMENT};

/// What knows the descriptions of resources: those that lists of an epoch may name.
pub(crate) trait Described {
    fn caps(&self) -> &Caps;
    fn buffer(&self, id: BufferId, epoch: u64) -> Option<&BufferDesc>;
    fn texture(&self, id: TextureId, epoch: u64) -> Option<&TextureDesc>;
    fn compute(&self, id: PipelineId, epoch: u64) -> Option<&ComputeDesc>;
    fn raster(&self, id: PipelineId, epoch: u64) -> Option<&RasterDesc>;
}

/// What is wrong, in words.
type Rule<T = ()> = Result<T, String>;

/// Descriptions, as one list sees them.
struct Known<'a> {
    all: &'a dyn Described,
    epoch: u64,
}

/// Checks a list.
///
/// # Errors
/// [`Error::Rule`] with the first command that breaks a rule.
pub(crate) fn check(list: &PassList, all: &dyn Described) -> Result<()> {
    let known = Known { all, epoch: list.epoch() };
    for (index, command) in list.commands().iter().enumerate() {
        known.command(command, list.bytes().len()).map_err(|message| {
            let scope = command.scope().map(|scope| format!(" of {scope}")).unwrap_or_default();
            Error::rule(format!("command {index}, {}{scope}", command.name()), message)
        })?;
    }
    Ok(())
}

impl Known<'_> {
    fn command(&self, command: &Command, uploaded: usize) -> Rule {
        match command {
            Command::Upload { dst, offset, data } => {
                if data.start > data.end || data.end > uploaded {
                    return Err(format!("bytes {data:?} of a list that holds {uploaded}"));
                }
                if !data.start.is_multiple_of(4) {
                    return Err(format!("bytes {data:?} do not begin at a multiple of 4"));
                }
                self.range(*dst, *offset, data.len() as u64, BufferUses::COPY_DESTINATION)
            }
            Command::Clear { dst, offset, bytes } => self.range(*dst, *offset, *bytes, BufferUses::COPY_DESTINATION),
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                if src == dst {
                    return Err(format!("from {src:?} to itself"));
                }
                self.range(*src, *src_offset, *bytes, BufferUses::COPY_SOURCE)?;
                self.range(*dst, *dst_offset, *bytes, BufferUses::COPY_DESTINATION)
            }
            Command::CopyToTexture { src, offset, row_bytes, dst } => self.rows(*src, *offset, *row_bytes, *dst),
            Command::Compute(pass) => self.compute(pass),
            Command::Raster(pass) => self.raster(pass),
            Command::ReadBuffer { src, offset, bytes, .. } => {
                self.need(Need::ReadBack)?;
                self.range(*src, *offset, *bytes, BufferUses::COPY_SOURCE)
            }
            Command::ReadTexture { src, .. } => {
                self.need(Need::ReadBack)?;
                self.texture(*src, TextureUses::COPY_SOURCE).map(drop)
            }
        }
    }

    fn need(&self, need: Need) -> Rule {
        self.all.caps().check("", &[need]).map_err(|_| format!("the device has no {need}"))
    }

    /// A buffer that can be used so.
    fn buffer(&self, id: BufferId, uses: BufferUses) -> Rule<&BufferDesc> {
        let desc = self.all.buffer(id, self.epoch).ok_or_else(|| {
            format!("{id:?} is no buffer of this backend, or it was destroyed before the list was begun")
        })?;
        match desc.uses.contains(uses) {
            true => Ok(desc),
            false => Err(format!("`{}` was not made for {uses:?}: it is for {:?}", desc.label, desc.uses)),
        }
    }

    /// A texture that can be used so.
    fn texture(&self, id: TextureId, uses: TextureUses) -> Rule<&TextureDesc> {
        let desc = self.all.texture(id, self.epoch).ok_or_else(|| {
            format!("{id:?} is no texture of this backend, or it was destroyed before the list was begun")
        })?;
        match desc.uses.contains(uses) {
            true => Ok(desc),
            false => Err(format!("`{}` was not made for {uses:?}: it is for {:?}", desc.label, desc.uses)),
        }
    }

    /// A part of a buffer, in multiples of 4.
    fn range(&self, id: BufferId, offset: u64, bytes: u64, uses: BufferUses) -> Rule {
        let desc = self.buffer(id, uses)?;
        if let Some(odd) = [offset, bytes].into_iter().find(|size| !size.is_multiple_of(4)) {
            return Err(format!("`{}`: {odd} is not a multiple of 4", desc.label));
        }
        within(desc, offset, bytes)
    }

    /// Rows of a buffer that become a texture.
    fn rows(&self, src: BufferId, offset: u64, row_bytes: u32, dst: TextureId) -> Rule {
        let buffer = self.buffer(src, BufferUses::COPY_SOURCE)?;
        let texture = self.texture(dst, TextureUses::COPY_DESTINATION)?;
        let [width, height] = texture.size.map(u64::from);
        let row = width * u64::from(texture.format.bytes());
        if texture.format.is_depth() {
            return Err(format!("`{}` holds depth", texture.label));
        }
        if !offset.is_multiple_of(8) || !row_bytes.is_multiple_of(ROW_ALIGNMENT) {
            return Err(format!(
                "offset {offset} or rows of {row_bytes} bytes: multiples of 8 and {ROW_ALIGNMENT} are"
            ));
        }
        if row > u64::from(row_bytes) {
            return Err(format!("rows of {row_bytes} bytes, `{}` has {row}", texture.label));
        }
        within(buffer, offset, u64::from(row_bytes) * (height - 1) + row)
    }

    fn compute(&self, pass: &ComputePass) -> Rule {
        let kernel = &pass.kernel;
        let made = self.all.compute(kernel.pipeline, self.epoch).ok_or_else(|| {
            format!("{:?} is no compute pipeline of this backend, or it was destroyed", kernel.pipeline)
        })?;
        self.same_shader(&made.shader, &kernel.shader)?;
        self.bindings(&kernel.shader, &pass.bindings)?;
        match pass.groups {
            Groups::Grid(grid) if grid.0.iter().any(|&groups| groups > Grid::MAX_GROUPS) => {
                Err(format!("{grid:?} exceeds {} groups in a dimension", Grid::MAX_GROUPS))
            }
            Groups::Grid(_) => Ok(()),
            Groups::Indirect { buffer, .. } if pass.bindings.names(buffer.into()) => {
                Err(format!("{buffer:?} holds the number of groups and is bound in the same pass"))
            }
            Groups::Indirect { buffer, offset } => self.range(buffer, offset, 12, BufferUses::INDIRECT),
        }
    }
}

/// Whether a part lies within a buffer.
fn within(desc: &BufferDesc, offset: u64, bytes: u64) -> Rule {
    match offset.checked_add(bytes) {
        Some(end) if end <= desc.bytes => Ok(()),
        _ => Err(format!("`{}`: {bytes} bytes from byte {offset} on, it has {}", desc.label, desc.bytes)),
    }
}
