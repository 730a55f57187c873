//! The list of a frame's commands.

use std::fmt;
use std::sync::Arc;

use bytemuck::NoUninit;

use super::{Command, ComputePass, Grid, Groups, RasterPass, Ticket};
use crate::epoch::Epoch;
use crate::error::Label;
use crate::id::{BufferId, TextureId};
use crate::shader::{Bindings, Kernel};

/// The commands of a frame, in the order in which they take effect.
///
/// It can be printed, compared, stored and run again. Nothing happens until a backend runs it. As long as it holds commands,
/// whatever is destroyed stays alive for it: clear or drop a list that is not needed any more.
#[derive(Clone, Default)]
pub struct PassList {
    commands: Vec<Command>,
    bytes: Vec<u8>,
    scope: Option<Arc<str>>,
    /// Since the first command.
    epoch: Option<Epoch>,
}

impl PartialEq for PassList {
    fn eq(&self, other: &Self) -> bool {
        (&self.commands, &self.bytes) == (&other.commands, &other.bytes)
    }
}

impl PassList {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// The commands.
    pub fn commands(&self) -> &[Command] {
        &self.commands
    }

    /// The bytes that the uploads name.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The epoch of its first command; 0 where there is none.
    pub(crate) fn epoch(&self) -> u64 {
        self.epoch.as_ref().map_or(0, Epoch::number)
    }

    /// Forgets all commands and keeps the memory for the next frame.
    pub fn clear_commands(&mut self) {
        self.commands.clear();
        self.bytes.clear();
        self.scope = None;
        self.epoch = None;
    }

    /// Names whose passes are written from now on, such as a groom, in prints, profilers and [`Timing`]s.
    ///
    /// [`Timing`]: crate::backend::Timing
    pub fn scope(&mut self, name: Option<Arc<str>>) {
        self.scope = name;
    }

    /// Adds a command.
    pub fn push(&mut self, mut command: Command) {
        self.epoch.get_or_insert_with(Epoch::now);
        let scope = match &mut command {
            Command::Compute(pass) => Some(&mut pass.scope),
            Command::Raster(pass) => Some(&mut pass.scope),
            _ => None,
        };
        if let Some(scope @ None) = scope {
            scope.clone_from(&self.scope);
        }
        self.commands.push(command);
    }

    /// Adds the commands of another list after its own.
    pub fn append(&mut self, other: &Self) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(&other.bytes);
        for command in &other.commands {
            let mut command = command.clone();
            if let Command::Upload { data, .. } = &mut command {
                *data = data.start.saturating_add(start)..data.end.saturating_add(start);
            }
            self.push(command);
        }
        // What either may name, both together may.
        let older = other.epoch.as_ref().filter(|other| other.number() < self.epoch());
        if let Some(older) = older {
            self.epoch = Some(older.clone());
        }
    }

    /// The same list with other commands, for tools that leave some out or add to them. They name the bytes of this list.
    #[must_use]
    pub fn with_commands(&self, commands: Vec<Command>) -> Self {
        let epoch = self.epoch.clone().or_else(|| (!commands.is_empty()).then(Epoch::now));
        Self { commands, epoch, ..self.clone() }
    }

    /// Writes `data` to `dst` from byte `offset` on. Its size must be a multiple of 4.
    pub fn upload<T: NoUninit>(&mut self, dst: BufferId, offset: u64, data: &[T]) {
        let start = self.bytes.len();
        self.bytes.extend_from_slice(bytemuck::cast_slice(data));
        self.push(Command::Upload { dst, offset, data: start..self.bytes.len() });
    }

    /// Makes `bytes` bytes of `dst` zero.
    pub fn clear(&mut self, dst: BufferId, offset: u64, bytes: u64) {
        self.push(Command::Clear { dst, offset, bytes });
    }

    /// Copies the first `bytes` bytes of `src` to the start of `dst`.
    pub fn copy(&mut self, src: BufferId, dst: BufferId, bytes: u64) {
        self.push(Command::Copy { src, src_offset: 0, dst, dst_offset: 0, bytes });
    }

    /// Copies rows of `src`, `row_bytes` apart, to a texture.
    pub fn copy_to_texture(&mut self, src: BufferId, offset: u64, row_bytes: u32, dst: TextureId) {
        self.push(Command::CopyToTexture { src, offset, row_bytes, dst });
    }

    /// Runs `kernel` over `grid`; an empty grid is left out.
    pub fn compute(&mut self, kernel: &Kernel, bindings: &Bindings, grid: Grid) {
        if !grid.is_empty() {
            let (kernel, bindings) = (kernel.clone(), bindings.clone());
            self.push(Command::Compute(ComputePass::new(kernel, bindings, Groups::Grid(grid))));
        }
    }

    /// Runs `kernel` over as many groups as `buffer` says from byte `offset` on.
    pub fn compute_indirect(&mut self, kernel: &Kernel, bindings: &Bindings, buffer: BufferId, offset: u64) {
        let (kernel, bindings, groups) = (kernel.clone(), bindings.clone(), Groups::Indirect { buffer, offset });
        self.push(Command::Compute(ComputePass::new(kernel, bindings, groups)));
    }

    /// Draws.
    pub fn raster(&mut self, pass: RasterPass) {
        self.push(Command::Raster(pass));
    }

    /// Brings `bytes` bytes of `src` back.
    pub fn read_buffer(&mut self, src: BufferId, offset: u64, bytes: u64) -> Ticket {
        let ticket = Ticket::next();
        self.push(Command::ReadBuffer { src, offset, bytes, ticket });
        ticket
    }

    /// Brings a texture back.
    pub fn read_texture(&mut self, src: TextureId) -> Ticket {
        let ticket = Ticket::next();
        self.push(Command::ReadTexture { src, ticket });
        ticket
    }

    /// The compute and raster passes with their labels, in order.
    pub fn passes(&self) -> impl Iterator<Item = (Label, &Command)> {
        self.commands.iter().filter(|command| command.is_pass()).map(|command| (command.name(), command))
    }

    /// Labels of the compute and raster passes, in order.
    pub fn labels(&self) -> impl Iterator<Item = Label> {
        self.passes().map(|(label, _)| label)
    }
}

impl fmt::Debug for PassList {
    /// A frame as text, one command a line.
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        writeln!(out, "{} commands, {} bytes of uploads", self.commands.len(), self.bytes.len())?;
        for (index, command) in self.commands.iter().enumerate() {
            write!(out, "{index:4} {}", command.name())?;
            if let Some(scope) = command.scope() {
                write!(out, " of {scope}")?;
            }
            match command {
                Command::Upload { dst, offset, data } => writeln!(out, " {} bytes to {dst:?} at {offset}", data.len()),
                Command::Clear { dst, offset, bytes } => writeln!(out, " {bytes} bytes of {dst:?} at {offset}"),
                Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                    writeln!(out, " {bytes} bytes of {src:?} at {src_offset} to {dst:?} at {dst_offset}")
                }
                Command::CopyToTexture { src, offset, dst, .. } => writeln!(out, " {src:?} at {offset} to {dst:?}"),
                Command::Compute(pass) => writeln!(out, " over {:?}, {:?}", pass.groups, pass.bindings.all()),
                Command::Raster(pass) => {
                    writeln!(out, " {} draws to {:?} {:?}", pass.draws.len(), pass.colors, pass.depth)
                }
                Command::ReadBuffer { src, offset, bytes, .. } => {
                    writeln!(out, " {bytes} bytes of {src:?} at {offset}")
                }
                Command::ReadTexture { src, .. } => writeln!(out, " {src:?}"),
            }?;
        }
        Ok(())
    }
}
