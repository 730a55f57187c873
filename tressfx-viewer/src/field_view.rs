//! What hair collides with, to be looked at: `--show`.

use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_sim::field::{FieldSurface, Fields, SurfaceSize};
use tressfx_viewer::scene::SceneMesh;

use crate::run::Run;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Show {
    /// The zero surface of the signed distance fields of `--collide sdf`
    Sdf,
}

/// The surfaces of fields that are drawn in place of their meshes.
#[derive(Debug, Default)]
pub(crate) struct FieldViews {
    surfaces: Vec<FieldSurface>,
    /// Of the list that was recorded last.
    sizes: Vec<Ticket>,
}

impl FieldViews {
    /// Views of all fields of a run, which makes them from now on in the rest pose too, and the meshes that draw them.
    pub(crate) fn new(run: &mut Run) -> Result<(Self, Vec<SceneMesh>)> {
        run.shows_fields = true;
        let Some(fields) = &run.fields else { bail!("--show sdf: there is no field; ask for one with --collide sdf") };
        let backend = &mut *run.backend;
        let surface = |index| FieldSurface::new(backend, fields, index);
        let surfaces = (0..Fields::len(fields)).map(surface).collect::<Result<Vec<_>, _>>()?;
        let views = Self { surfaces, sizes: Vec::new() };
        let meshes = views.surfaces.iter().map(|surface| SceneMesh::of_surface(&mut *run.backend, &surface.buffers()));
        let meshes = meshes.collect::<Result<_, _>>()?;
        Ok((views, meshes))
    }

    /// Records the passes that make the surfaces; none where none was asked for.
    pub(crate) fn record(&mut self, list: &mut PassList) {
        self.sizes = self.surfaces.iter().map(|surface| surface.record(list)).collect();
    }

    /// Makes room for the surfaces of the list that was just run. Says whether any had too little; then the meshes are others.
    pub(crate) fn make_room(&mut self, run: &mut Run, meshes: &mut [SceneMesh]) -> Result<bool> {
        let mut had_too_little = false;
        for ((surface, ticket), mesh) in self.surfaces.iter_mut().zip(self.sizes.drain(..)).zip(meshes) {
            let size = SurfaceSize::from_bytes(&run.fetch(ticket)?).context("the size of a surface is cut off")?;
            if surface.make_room(&mut *run.backend, size)? {
                let new = SceneMesh::of_surface(&mut *run.backend, &surface.buffers())?;
                std::mem::replace(mesh, new).destroy(&mut *run.backend);
                had_too_little = true;
            }
        }
        Ok(had_too_little)
    }
}
