//! Raster passes.

use super::{Known, Rule};
use crate::backend::{BufferUses, Depth, Format, RasterDesc, TextureUses};
use crate::error::Need;
use crate::id::Resource;
use crate::pass::{Count, Draw, Load, RasterPass};

/// The targets of a pass.
struct TargetFormats {
    size: [u32; 2],
    colors: Vec<Format>,
    depth: bool,
}

impl Known<'_> {
    pub(super) fn raster(&self, pass: &RasterPass) -> Rule {
        let targets = self.targets(pass)?;
        if let Some(viewport) = pass.viewport {
            let ends = [0, 1].map(|axis| viewport.origin[axis].checked_add(viewport.size[axis]));
            let inside = (0..2).all(|axis| ends[axis].is_some_and(|end| end <= targets.size[axis]));
            if !inside || viewport.size.contains(&0) {
                return Err(format!("{viewport:?} is empty or leaves targets of {:?}", targets.size));
            }
        }
        let mut used: Vec<(Resource, bool)> = Vec::new();
        for (index, draw) in pass.draws.iter().enumerate() {
            self.draw(draw, &targets)
                .map_err(|message| format!("draw {index}, `{}`: {message}", draw.pipeline.label()))?;
            let slots = &draw.pipeline.shader.slots;
            let bound = slots
                .iter()
                .zip(draw.bindings.all())
                .filter_map(|(slot, binding)| Some((binding.resource()?, slot.kind.is_written())));
            used.extend(bound);
            if let Count::Indirect { buffer, .. } = draw.count {
                used.push((buffer.into(), false));
            }
        }
        let drawn = pass.colors.iter().map(|(id, _)| *id).chain(pass.depth.iter().map(|(id, _)| *id));
        for target in drawn.map(Resource::Texture) {
            if used.iter().any(|(resource, _)| *resource == target) {
                return Err(format!("{target:?} is drawn to and bound in the same pass"));
            }
        }
        self.used_alike(&used)
    }

    fn targets(&self, pass: &RasterPass) -> Rule<TargetFormats> {
        let mut found: Option<TargetFormats> = None;
        let ids: Vec<_> = pass.colors.iter().map(|(id, _)| *id).chain(pass.depth.iter().map(|(id, _)| *id)).collect();
        for (index, &id) in ids.iter().enumerate() {
            let desc = self.texture(id, TextureUses::TARGET)?;
            let wants_depth = index >= pass.colors.len();
            if desc.format.is_depth() != wants_depth {
                return Err(format!("`{}` of the format {:?} is no such target", desc.label, desc.format));
            }
            if ids[..index].contains(&id) {
                return Err(format!("`{}` is a target twice", desc.label));
            }
            let targets = found.get_or_insert(TargetFormats { size: desc.size, colors: Vec::new(), depth: false });
            if targets.size != desc.size {
                return Err(format!("`{}` has the size {:?}, other targets {:?}", desc.label, desc.size, targets.size));
            }
            match wants_depth {
                true => targets.depth = true,
                false => targets.colors.push(desc.format),
            }
        }
        let targets = found.ok_or("the pass has no target")?;
        self.need(Need::ColorTargets(targets.colors.len() as u32))?;
        match pass.depth {
            Some((_, Load::Clear(depth))) if !(0.0..=1.0).contains(&depth) => {
                Err(format!("depth is cleared to {depth}: it is from 0 to 1"))
            }
            _ => {
                let clears = pass.colors.iter().zip(&targets.colors);
                clears.into_iter().try_for_each(|((_, load), format)| clear(*load, *format))?;
                Ok(targets)
            }
        }
    }

    fn draw(&self, draw: &Draw, targets: &TargetFormats) -> Rule {
        let id = draw.pipeline.pipeline;
        let made = self
            .all
            .raster(id, self.epoch)
            .ok_or_else(|| format!("{id:?} is no raster pipeline of this backend, or it was destroyed"))?;
        self.same_shader(&made.shader, &draw.pipeline.shader)?;
        self.bindings(&made.shader, &draw.bindings)?;
        fits(made, targets)?;
        match draw.count {
            Count::Direct { .. } => Ok(()),
            Count::Indirect { buffer, offset } => self.range(buffer, offset, 16, BufferUses::INDIRECT),
        }
    }
}

/// Whether a target of a format can be cleared so.
fn clear(load: Load<[f32; 4]>, format: Format) -> Rule {
    let Load::Clear(color) = load else { return Ok(()) };
    if color.iter().any(|channel| !channel.is_finite()) {
        return Err(String::from("a colour is cleared to what is not finite"));
    }
    // 2^32 is the smallest that no `u32` holds.
    let fits = |channel: f32| (0.0..4_294_967_296.0).contains(&channel) && channel.fract() == 0.0;
    match format.is_uint() && !fits(color[0]) {
        true => Err(format!("{format:?} is cleared to {}, which is no unsigned integer", color[0])),
        false => Ok(()),
    }
}

/// Whether a pipeline was made for such targets.
fn fits(made: &RasterDesc, targets: &TargetFormats) -> Rule {
    let formats: Vec<_> = made.targets.iter().map(|(format, _)| *format).collect();
    if formats != targets.colors {
        return Err(format!("it was made for targets of {formats:?}, these are {:?}", targets.colors));
    }
    if (made.depth != Depth::Off) != targets.depth {
        return Err(format!(
            "it was made for {:?}, the pass has {} depth",
            made.depth,
            if targets.depth { "a" } else { "no" }
        ));
    }
    Ok(())
}
