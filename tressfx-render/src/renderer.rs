//! The renderer: it writes the passes that draw hair in a frame.

use tressfx_core::backend::{Backend, Format, Owner};
use tressfx_core::error::{Error, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::shader::Binding;
use tressfx_core::view::View;

use crate::counters::Counters;
use crate::draw_error::{DrawError, check_lights, check_section};
use crate::lights::Lights;
use crate::output::Output;
use crate::reach::{self, Ball, Drawn};
use crate::region::Region;
use crate::shade::Shade;
use crate::shadow::{ShadowDesc, Shadows};
use crate::strands::SectionDraw;
use crate::technique::{Technique, TechniqueInstance};
use crate::velocity::{Seen, Velocity};
use crate::views::{MAX_VIEWS, ViewDraw, Views};

/// The pool is made this many times as large as predicted or measured, since the next frame may need more.
pub(crate) const HEADROOM: f64 = 1.25;

/// What a pool is made for that has to hold this much.
pub(crate) fn with_headroom(wanted: u64) -> u64 {
    times(wanted, HEADROOM)
}

/// So many times as much.
pub(crate) fn times(wanted: u64, factor: f64) -> u64 {
    (wanted as f64 * factor) as u64
}

/// Describes a renderer that is to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RenderDesc {
    /// Width and height in pixels of the largest view.
    pub size: [u32; 2],
    /// Format of the colour targets.
    pub target: Format,
    /// How fragments of hair behind each other are sorted and blended.
    pub technique: Technique,
    /// Whether compute passes lay hair over the picture instead of drawing it there: see [`RenderDesc::storage_target`](Self::storage_target()).
    pub storage_target: bool,
    /// Whether depth and coverage of the hair are written too: see [`Targets::hair`].
    pub hair_output: bool,
    /// Whether the motion of hair on the screen is written too: see [`Targets::velocity`].
    pub velocity_output: bool,
    /// Whether strands may bring colours of their own along: see [`ShadedStrands::with_own_look`](crate::ShadedStrands::with_own_look).
    pub own_colors: bool,
    /// Whether strands may have copies: see [`Material::copies`](crate::Material::copies).
    pub copies: bool,
    /// How shadows are made; none lights every strand as if it were alone.
    pub shadows: Option<ShadowDesc>,
    /// The most views of a frame, 1 to [`MAX_VIEWS`].
    pub views: usize,
}

impl RenderDesc {
    /// The default technique, lists of fragments for each pixel, and shadows.
    pub fn new(size: [u32; 2], target: Format) -> Self {
        let shadows = Some(ShadowDesc::default());
        let technique = Technique::default();
        Self {
            size,
            target,
            technique,
            storage_target: false,
            hair_output: false,
            velocity_output: false,
            own_colors: false,
            copies: false,
            shadows,
            views: MAX_VIEWS,
        }
    }

    /// The same with other shadows, or with none.
    #[must_use]
    pub fn shadows(self, shadows: impl Into<Option<ShadowDesc>>) -> Self {
        Self { shadows: shadows.into(), ..self }
    }

    /// The same with at most so many views in a frame: tiles keep 20 bytes for each 8 x 8 pixels of each of them.
    #[must_use]
    pub fn views(self, views: usize) -> Self {
        Self { views, ..self }
    }

    /// The same with another technique.
    #[must_use]
    pub fn technique(self, technique: impl Into<Technique>) -> Self {
        Self { technique: technique.into(), ..self }
    }

    /// The same, with a compute pass that lays hair over the picture instead of drawing it there. For GPUs that have few raster units: an H200 takes a tenth of
    /// the time. [`Targets::color`] needs [`TextureUses::STORAGE`](tressfx_core::backend::TextureUses::STORAGE) then and is [`Format::Rgba16F`] or [`Format::Rgba8`]; the device has
    /// [`Caps::read_write_textures`](tressfx_core::backend::Caps::read_write_textures). Not together with [`RenderDesc::hair_output`].
    #[must_use]
    pub fn storage_target(self, storage_target: bool) -> Self {
        Self { storage_target, ..self }
    }

    /// The same with or without depth and coverage of the hair, which take 4 more bytes a pixel, and 4 more where lists are bounded.
    #[must_use]
    pub fn hair_output(self, hair_output: bool) -> Self {
        Self { hair_output, ..self }
    }

    /// The same with or without the motion of hair, which takes 8 bytes a pixel, and strands with room for their past
    /// ([`ShadedStrands::with_past`](crate::ShadedStrands::with_past)). What does not ask for it pays nothing.
    #[must_use]
    pub fn velocity_output(self, velocity_output: bool) -> Self {
        Self { velocity_output, ..self }
    }

    /// The same with or without strands that bring colours of their own along, for which kernels of their own are compiled. What does not ask for it pays nothing.
    #[must_use]
    pub fn own_colors(self, own_colors: bool) -> Self {
        Self { own_colors, ..self }
    }

    /// The same with or without strands that have copies, for which kernels of their own are compiled. What does not ask for it pays nothing.
    #[must_use]
    pub fn copies(self, copies: bool) -> Self {
        Self { copies, ..self }
    }

    fn output(&self) -> Output {
        let Self { target: color, hair_output: hair, copies, storage_target: storage, views, .. } = *self;
        Output { color, hair, copies, storage, views }
    }
}

/// The textures that hair is drawn to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Targets {
    /// The picture so far; hair is blended over it.
    pub color: TextureId,
    /// Depth of the opaque scene, [`Format::Depth32F`], in the order of the view. Hair is tested against it and does not
    /// write it.
    pub depth: TextureId,
    /// Depth and coverage of the hair, [`HAIR_FORMAT`](crate::HAIR_FORMAT), of the same size; where
    /// [`RenderDesc::hair_output`] is set, and only there.
    ///
    /// Red is depth as the opaque scene has it, in the order of the view: that of the nearest fragment of the pixel with an alpha
    /// of at least 0.02, or of the nearest one where all are fainter. Green is `1 - transmittance`, the alpha with which hair is blended
    /// over the picture. Pixels without hair keep what they have, so the caller clears them.
    pub hair: Option<TextureId>,
    /// Motion of the hair on the screen, [`VELOCITY_FORMAT`](crate::VELOCITY_FORMAT), of the same size; where
    /// [`RenderDesc::velocity_output`] is set, and only there.
    ///
    /// Red and green are where the hair is less where it was in the frame before: pixels, to the right and down, without the
    /// [jitter](View::with_jitter) of either frame. It is that of the axis of the segment whose depth [`Targets::hair`] has. The camera of the frame before is
    /// [`View::with_previous`], the strands' positions are what [`ShadedStrands::keep_past`](crate::ShadedStrands::keep_past) has kept; without that, hair moves with
    /// the camera alone. What was not before the eye has a motion of 0. Pixels without hair keep what they have.
    pub velocity: Option<TextureId>,
}

impl Targets {
    /// Two textures of one size.
    pub fn new(color: TextureId, depth: TextureId) -> Self {
        Self { color, depth, hair: None, velocity: None }
    }

    /// The same with a texture for depth and coverage of the hair.
    #[must_use]
    pub fn hair(self, hair: TextureId) -> Self {
        Self { hair: Some(hair), ..self }
    }

    /// The same with a texture for the motion of the hair.
    #[must_use]
    pub fn velocity(self, velocity: TextureId) -> Self {
        Self { velocity: Some(velocity), ..self }
    }
}

/// Draws hair: strands are shaded for a view and turned into fragments, which a [`Technique`] sorts and blends.
///
/// The same strands and view give exactly the same picture, bit for bit, as long as all that is to be kept finds room. What does not
/// find room, before the renderer has measured how much there is, depends on the GPU.
#[derive(Debug)]
pub struct HairRenderer {
    desc: RenderDesc,
    views: Views,
    shadows: Option<Shadows>,
    /// The light in which shadows were cast for the frame that is drawn next, and whether there is any.
    cast: Option<(Lights, bool)>,
    shade: Shade,
    order: Box<dyn TechniqueInstance>,
    velocity: Option<Velocity>,
    /// What the newest frame has drawn.
    drawn: Drawn,
    /// Frees everything above.
    owner: Owner,
}

impl HairRenderer {
    /// Compiles the kernels and makes the buffers whose size depends on that of the view.
    ///
    /// # Errors
    /// A `k` that the technique does not take, a number of views that no frame has, a setting of shadows out of its range, a format that no compute pass writes where one is to, what the device lacks, or what the backend says.
    pub fn new(backend: &mut dyn Backend, desc: &RenderDesc) -> Result<Self> {
        if !(1..=MAX_VIEWS).contains(&desc.views) {
            let message = format!("{} views in a frame, there can be 1 to {MAX_VIEWS}", desc.views);
            return Err(Error::rule("hair.render", message));
        }
        let ((order, velocity, views, shadows, shade), owner) = Owner::build(backend, |backend| {
            let order = desc.technique.make(backend, desc.size, desc.output())?;
            let velocity = desc.velocity_output.then(|| Velocity::new(backend, desc.size, desc.copies)).transpose()?;
            let shadows = desc.shadows.map(|shadows| Shadows::new(backend, &shadows, desc.copies)).transpose()?;
            let shade = Shade::new(backend, shadows.is_some(), desc.own_colors)?;
            Ok::<_, Error>((order, velocity, Views::new(backend)?, shadows, shade))
        })?;
        Ok(Self { desc: *desc, views, shadows, cast: None, shade, order, velocity, drawn: Drawn::default(), owner })
    }

    /// What it was made from.
    pub fn desc(&self) -> &RenderDesc {
        &self.desc
    }

    /// Changes settings of the technique between frames: `k`, `tail` and `cap` of lists, `closed_below` of tiles. A kernel that was not
    /// used before is compiled, and kept. Lists that were written before stay valid.
    ///
    /// # Errors
    /// Another technique, another value of what is not named above, a `k` out of its range, or what the backend says. The
    /// renderer is unchanged then.
    pub fn retune(&mut self, backend: &mut dyn Backend, technique: impl Into<Technique>) -> Result<()> {
        let technique = technique.into();
        self.owner.change(backend, |backend| self.order.retune(backend, &technique))?;
        self.desc.technique = technique;
        Ok(())
    }

    /// Bytes of the buffers in which the technique keeps fragments and pixels at present.
    pub fn technique_bytes(&self) -> u64 {
        self.order.bytes()
    }

    /// Bytes of the buffers in which shadows are made.
    pub fn shadow_bytes(&self) -> u64 {
        self.shadows.as_ref().map_or(0, Shadows::bytes)
    }

    /// Bytes of the buffers with which the motion of hair is found.
    pub fn velocity_bytes(&self) -> u64 {
        self.velocity.as_ref().map_or(0, Velocity::bytes)
    }

    /// What the newest frame has drawn and left out.
    pub fn drawn(&self) -> Drawn {
        self.drawn
    }

    /// Whether tiles draw the next frame: [`Technique::Auto`] may choose them, and lists again.
    pub fn uses_tiles(&self) -> bool {
        self.order.uses_tiles()
    }

    /// How many fragments the pool can hold at present, or references where the technique has tiles; all that can be counted
    /// where it has none.
    pub fn capacity(&self) -> u32 {
        self.order.capacity()
    }

    /// Makes the buffers whose size depends on that of the view again, for views of at most this size. Lists that were
    /// written before stay valid.
    ///
    /// # Errors
    /// As [`HairRenderer::new`]. If it fails, the renderer is unchanged.
    pub fn resize(&mut self, backend: &mut dyn Backend, size: [u32; 2]) -> Result<()> {
        let Self { order, velocity, owner, .. } = self;
        owner.change(backend, |backend| {
            let seen = velocity.as_ref().map(|_| Seen::new(backend, size)).transpose()?;
            order.resize(backend, size)?;
            velocity.iter_mut().zip(seen).for_each(|(velocity, seen)| velocity.resize(backend, seen));
            Ok::<_, Error>(())
        })?;
        self.desc.size = size;
        Ok(())
    }

    /// Enlarges the pool to what a view is predicted to need. Call it for each view, before the first frame, whenever the camera
    /// jumps, and whenever sections come: tiles draw no more vertices than there is room for.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size, and sections that cannot be drawn; the pool is unchanged then.
    pub fn grow_to_predicted(&mut self, backend: &mut dyn Backend, view: &View, draws: &[SectionDraw]) -> Result<()> {
        if view.is_empty() {
            return Ok(());
        }
        let draws: Vec<SectionDraw> = draws.iter().filter(|draw| !draw.is_empty()).copied().collect();
        draws.iter().try_for_each(check_section).map_err(|error| Error::rule("hair.render", error.to_string()))?;
        self.owner.change(backend, |backend| self.order.make_room(backend, view, &draws))
    }

    /// Enlarges the pool to what a view has needed in an earlier frame; nothing happens if it is large enough. `counters`
    /// are those that [`HairRenderer::request_counters`] has brought back. Lists that would need more than their limit hold the
    /// nearest fragments of each pixel from then on, and merge the others, see [`PpllDesc::cap`](crate::PpllDesc::cap).
    ///
    /// What was more than twice as large as needed for 120 frames, of which at least 30 measurements came, is made smaller: a groom
    /// that leaves gives its memory back.
    ///
    /// Returns whether the same frame would now find more room.
    ///
    /// # Errors
    /// As [`HairRenderer::grow_to_predicted`].
    pub fn grow_to_measured(&mut self, backend: &mut dyn Backend, counters: &Counters) -> Result<bool> {
        self.owner.change(backend, |backend| self.order.measured(backend, counters))
    }

    /// Casts the shadows of the next frame before it is drawn, so that the surfaces of the caller can be shaded with what hair leaves of the light:
    /// see [`HairRenderer::shadow_bindings`]. [`HairRenderer::draw`] with the same sections then makes no shadows again for views in this
    /// light. Without this call it makes them itself.
    ///
    /// # Errors
    /// [`DrawError`]; nothing is written then.
    pub fn cast(
        &mut self,
        list: &mut PassList,
        lights: &Lights,
        draws: &[SectionDraw],
    ) -> std::result::Result<(), DrawError> {
        check_lights(lights)?;
        draws.iter().try_for_each(check_section)?;
        self.check_copies(draws)?;
        let Some(shadows) = &mut self.shadows else { return Ok(()) };
        shadows.begin();
        let draws: Vec<SectionDraw> = draws.iter().filter(|draw| !draw.is_empty()).copied().collect();
        draws.iter().for_each(|draw| draw.upload(list));
        let has_any = shadows.passes(list, 0, lights, &draws)?;
        self.cast = Some((lights.clone(), has_any));
        Ok(())
    }

    /// What a shader binds that imports the module `hair_shadow` of [`SHADOW_MODULES`](crate::SHADOW_MODULES); nothing where the renderer makes no shadows. Right
    /// for passes behind [`HairRenderer::cast`] and before [`HairRenderer::draw`].
    pub fn shadow_bindings(&self) -> Vec<(&'static str, Binding)> {
        self.shadows.iter().flat_map(Shadows::bindings).collect()
    }

    /// Which of the sections a frame of these views reads: those that are seen, and those that may throw shadows on them. For strands that are made each frame (`Interpolation`
    /// of the simulation); [`HairRenderer::cast`] reads all that it is given.
    pub fn reads(&self, views: &[ViewDraw], draws: &[SectionDraw]) -> Vec<bool> {
        let (kept, _) = reach::split(views, draws, self.shadows.is_some());
        let is_kept = |draw: &SectionDraw| kept.iter().any(|kept| std::ptr::eq(kept.strands, draw.strands));
        draws.iter().map(is_kept).collect()
    }

    /// Draws all sections into all views; their fragments are sorted together. For an empty section or view no pass is
    /// written, nor for a section that no view can see ([`StrandInfo::reach`](crate::StrandInfo::reach)), but for those of the shadows that it may throw on others:
    /// [`HairRenderer::drawn`] counts them.
    ///
    /// # Errors
    /// [`DrawError`]; nothing is written then.
    pub fn draw(
        &mut self,
        list: &mut PassList,
        views: &[ViewDraw],
        draws: &[SectionDraw],
    ) -> std::result::Result<(), DrawError> {
        // Also where nothing is drawn after all: what was cast counts for this frame alone.
        let cast = self.cast.take();
        self.check(views, draws)?;
        let (draws, drawn) = reach::split(views, draws, self.shadows.is_some());
        let (casting, draws) = (&draws, &draws[..drawn.sections]);
        self.order.check(draws)?;
        if !self.desc.own_colors && draws.iter().any(|draw| draw.strands.own_colors().is_some()) {
            return Err(DrawError::OwnColors);
        }
        self.check_copies(casting)?;
        self.drawn = drawn;
        self.order.begin(list, views.len(), draws);
        self.shade.begin();
        self.velocity.iter_mut().for_each(Velocity::begin_frame);
        if cast.is_none() {
            self.shadows.iter_mut().for_each(Shadows::begin);
        }
        if draws.is_empty() || views.iter().all(|draw| draw.view.is_empty()) {
            return Ok(());
        }
        let regions: Vec<_> = views.iter().map(|seen| Region::of(seen.view, draws.iter().map(Ball::of))).collect();
        self.views.upload(list, views, &regions);
        casting.iter().for_each(|draw| draw.upload(list));
        draws.iter().for_each(|draw| self.shade.upload(list, draw));
        // What arrives does not depend on the eye: views in the same light share it.
        let mut lit = cast.as_ref().map(|(lights, has_any)| (lights, *has_any));
        for (index, seen) in views.iter().enumerate().filter(|(_, seen)| !seen.view.is_empty()) {
            let view = self.views.bound(index, seen.view, regions[index]);
            let is_new = lit.is_none_or(|(lights, _)| lights != seen.lights);
            if let Some(shadows) = self.shadows.as_mut().filter(|_| is_new) {
                lit = Some((seen.lights, shadows.passes(list, 1 + index, seen.lights, casting)?));
            }
            let is_shadowed = lit.is_some_and(|(_, has_any)| has_any);
            for draw in draws {
                self.shade.pass(list, &view, draw, is_shadowed)?;
            }
            self.order.draw(list, &view, &seen.targets, draws)?;
            if let (Some(velocity), Some(target)) = (&mut self.velocity, seen.targets.velocity) {
                velocity.passes(list, &view, [seen.targets.depth, target], draws, self.order.hairy())?;
            }
        }
        Ok(())
    }

    fn check(&self, views: &[ViewDraw], draws: &[SectionDraw]) -> std::result::Result<(), DrawError> {
        if views.len() > self.desc.views {
            return Err(DrawError::Views { given: views.len(), most: self.desc.views });
        }
        for draw in views {
            check_lights(draw.lights)?;
            match (self.desc.hair_output, draw.targets.hair) {
                (true, None) => return Err(DrawError::NoHairTarget),
                (false, Some(_)) => return Err(DrawError::UnusedHairTarget),
                _ => (),
            }
            self.check_velocity(draw)?;
            let (view, renderer) = (draw.view.size(), self.desc.size);
            if !draw.view.is_empty() && (view[0] > renderer[0] || view[1] > renderer[1]) {
                return Err(DrawError::Size { view, renderer });
            }
        }
        draws.iter().try_for_each(check_section)?;
        let has_past = || draws.iter().all(|draw| draw.is_empty() || draw.strands.past.is_some());
        if self.velocity.is_some() && !has_past() { Err(DrawError::NoPast) } else { Ok(()) }
    }

    fn check_copies(&self, draws: &[SectionDraw]) -> std::result::Result<(), DrawError> {
        let has_any = || draws.iter().any(|draw| draw.material.copies > 1);
        if !self.desc.copies && has_any() { Err(DrawError::Copies) } else { Ok(()) }
    }

    fn check_velocity(&self, draw: &ViewDraw) -> std::result::Result<(), DrawError> {
        let is_finite = |view: &View| {
            view.previous_matrices().iter().all(|matrix| matrix.is_finite())
                && view.jitter().iter().all(|j| j.is_finite())
        };
        match (&self.velocity, draw.targets.velocity) {
            (Some(_), None) => Err(DrawError::NoVelocityTarget),
            (None, Some(_)) => Err(DrawError::UnusedVelocityTarget),
            (Some(_), _) if !draw.view.is_empty() && !is_finite(draw.view) => Err(DrawError::PreviousView),
            _ => Ok(()),
        }
    }

    /// Reads back the counters of a view, as they are at this place of the list; [`Counters::from_bytes`] decodes them.
    ///
    /// # Panics
    /// If a frame cannot have so many views.
    pub fn request_counters(&self, list: &mut PassList, view: usize) -> Ticket {
        let (buffer, offset) = self.order.counters(view);
        list.read_buffer(buffer, offset, Counters::BYTES)
    }

    /// Frees everything that it made.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}

#[cfg(test)]
mod tests;
