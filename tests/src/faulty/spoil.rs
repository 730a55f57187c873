//! What is done instead of the commands of a list.

use tressfx_core::backend::{Backend, TextureDesc};
use tressfx_core::hazards::accesses;
use tressfx_core::id::{Resource, TextureId};
use tressfx_core::pass::{Command, ComputePass, Count, Grid, Groups, Load, PassList, RasterPass};
use tressfx_core::shader::{Binding, Bindings, Sampler, Shader};

use super::{Fault, Faulty};

impl<B: Backend> Faulty<B> {
    /// What is run instead of a list.
    pub(super) fn spoiled(&mut self, list: &PassList) -> PassList {
        let mut commands = list.commands().to_vec();
        match self.fault {
            Fault::UploadsFirst => commands.sort_by_key(|command| !matches!(command, Command::Upload { .. })),
            Fault::ReadsLast => commands.sort_by_key(|command| matches!(command, Command::ReadBuffer { .. })),
            _ => {}
        }
        list.with_commands(commands.into_iter().flat_map(|command| self.spoil(command)).collect())
    }

    /// What is done instead of a command.
    fn spoil(&mut self, mut command: Command) -> Vec<Command> {
        match (self.fault, &mut command) {
            (Fault::ClearsAll, Command::Clear { dst, offset, bytes }) => {
                (*offset, *bytes) = (0, self.sizes.get(&(*dst).into()).copied().unwrap_or(*bytes));
            }
            (Fault::ClearsNothing, Command::Clear { .. }) => return Vec::new(),
            (Fault::ForeignIdsIgnored, command) if accesses(command).iter().any(|(id, _)| self.is_foreign(*id)) => {
                return Vec::new();
            }
            (Fault::RowsFromTheStart, Command::CopyToTexture { offset, .. }) => *offset = 0,
            (Fault::RowsNotCopied, Command::CopyToTexture { .. }) => return Vec::new(),
            (Fault::StorageWritesLost, Command::Compute(pass)) if pass.kernel.shader.storage_textures() > 0 => {
                return Vec::new();
            }
            (Fault::CopiesFromTheStart, Command::Copy { src_offset, .. }) => *src_offset = 0,
            (Fault::PassesDropped, Command::Compute(_) | Command::Raster(_)) => {
                self.passes += 1;
                return if self.passes.is_multiple_of(5) { Vec::new() } else { vec![command] };
            }
            (_, Command::Compute(pass)) => self.spoil_compute(pass),
            (Fault::DepthForgotten, Command::Raster(pass)) => return forgetful(pass),
            (_, Command::Raster(pass)) => self.spoil_raster(pass),
            (_, Command::ReadTexture { src, ticket }) => {
                self.textures.get(src).map(|desc| self.pictures.insert(*ticket, *desc));
            }
            _ => {}
        }
        vec![command]
    }

    fn spoil_compute(&self, pass: &mut ComputePass) {
        match (self.fault, &mut pass.groups) {
            (Fault::GridFlat, Groups::Grid(Grid(groups))) => groups[2] = 1,
            (Fault::CountsIgnored, groups @ Groups::Indirect { .. }) => *groups = Groups::Grid(Grid([1; 3])),
            (Fault::BindingsSwapped, _) => pass.bindings = swapped(&pass.kernel.shader, &pass.bindings),
            (fault, _) => pass.bindings = bound(fault, &pass.bindings),
        }
    }

    fn spoil_raster(&self, pass: &mut RasterPass) {
        for draw in &mut pass.draws {
            draw.bindings = bound(self.fault, &draw.bindings);
            match (self.fault, &mut draw.count) {
                (Fault::InstancesIgnored, Count::Direct { instances, .. }) => *instances = (*instances).min(1),
                (Fault::DrawCountsIgnored, count @ Count::Indirect { .. }) => {
                    *count = Count::Direct { vertices: 3, instances: 1 };
                }
                _ => {}
            }
        }
        match self.fault {
            Fault::ViewportIgnored => pass.viewport = None,
            Fault::FragmentlessDropped => pass.draws.retain(|draw| draw.pipeline.shader.has_fragment_stage()),
            Fault::IntegersClearToZero => pass.colors.iter_mut().for_each(|(target, load)| {
                let is_uint = self.textures.get(target).is_some_and(|desc| desc.format.is_uint());
                if let (true, Load::Clear(value)) = (is_uint, load) {
                    *value = [0.0; 4];
                }
            }),
            Fault::KeepClears => pass.colors.iter_mut().for_each(|(_, load)| {
                if *load == Load::Keep {
                    *load = Load::Clear([0.0; 4]);
                }
            }),
            Fault::ClearKeeps => pass.colors.iter_mut().for_each(|(_, load)| *load = Load::Keep),
            Fault::TargetsSwapped => {
                let format = |id: &TextureId| self.textures.get(id).map(|desc| desc.format);
                if pass.colors.len() > 1 && format(&pass.colors[0].0) == format(&pass.colors[1].0) {
                    pass.colors.swap(0, 1);
                }
            }
            _ => {}
        }
    }

    /// Whether a resource was not made here.
    fn is_foreign(&self, resource: Resource) -> bool {
        !self.sizes.contains_key(&resource) && !self.destroyed.contains(&resource)
    }

    /// What a picture comes back as.
    pub(super) fn picture(&self, bytes: Vec<u8>, desc: &TextureDesc) -> Vec<u8> {
        let row = (desc.size[0] * desc.format.bytes()) as usize;
        match self.fault {
            Fault::UpsideDown => bytes.chunks(row).rev().flatten().copied().collect(),
            Fault::RowsPadded => {
                let padding = vec![0; row.next_multiple_of(256) - row];
                bytes.chunks(row).flat_map(|row| row.iter().chain(&padding)).copied().collect()
            }
            _ => bytes,
        }
    }
}

/// The bindings with the first two of one kind swapped.
fn swapped(shader: &Shader, bindings: &Bindings) -> Bindings {
    let slots = &shader.slots;
    let mut all = bindings.all().to_vec();
    let pairs = (0..slots.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    if let Some((i, j)) = pairs.into_iter().find(|&(i, j)| slots[i].kind == slots[j].kind) {
        all.swap(i, j);
    }
    Bindings::new(&all)
}

/// What is bound instead.
fn bound(fault: Fault, bindings: &Bindings) -> Bindings {
    let mut all = bindings.all().to_vec();
    for binding in &mut all {
        match (fault, binding) {
            (Fault::RangesFromTheStart, Binding::Buffer { offset, .. }) => *offset = 0,
            (Fault::RangesToTheEnd, Binding::Buffer { bytes, .. }) => *bytes = None,
            (Fault::SamplersSwapped, Binding::Sampler(sampler)) => {
                *sampler = if *sampler == Sampler::Linear { Sampler::Nearest } else { Sampler::Linear };
            }
            _ => {}
        }
    }
    Bindings::new(&all)
}

/// A pass for each draw, which begins with the depth that the whole pass began with.
fn forgetful(pass: &RasterPass) -> Vec<Command> {
    let mut keeping = pass.clone();
    keeping.colors.iter_mut().for_each(|(_, load)| *load = Load::Keep);
    let one = |(i, draw)| {
        let mut pass = if i == 0 { pass.clone() } else { keeping.clone() };
        pass.draws = vec![draw];
        Command::Raster(pass)
    };
    match pass.draws.len() {
        0 | 1 => vec![Command::Raster(pass.clone())],
        _ => pass.draws.iter().cloned().enumerate().map(one).collect(),
    }
}
