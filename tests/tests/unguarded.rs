//! Which forgotten barriers the validation layer notices: the hazard cases of the suite on raw Vulkan, without a barrier where
//! each has its hazard.

use tressfx_backend_vulkan::{VulkanBackend, VulkanOptions};
use tressfx_conformance::suite::{CASES, Outcome};
use tressfx_core::backend::{
    Backend, BufferDesc, Caps, ComputeDesc, Memory, RasterDesc, ReadBack, Run, TextureDesc, Timing,
};
use tressfx_core::error::Result;
use tressfx_core::id::{BufferId, PipelineId, Resource, TextureId};
use tressfx_core::pass::{Command, PassList, Ticket};
use tressfx_core::shader::{Kernel, RasterPipeline};

/// Raw Vulkan that leaves barriers out. The uploads that a list begins with and the read-backs that it ends with run with
/// barriers in lists of their own: they are the case's preparation and its proof.
struct Unguarded(VulkanBackend);

fn unguarded() -> Result<Unguarded> {
    VulkanBackend::headless_with(&VulkanOptions { validation: true, ..Default::default() }).map(Unguarded)
}

impl Unguarded {
    fn run_part(&mut self, list: &PassList, commands: &[Command], left_out: bool) -> Result<()> {
        self.0.leave_out_barriers(left_out);
        self.0.run(&list.with_commands(commands.to_vec()))
    }
}

impl Run for Unguarded {
    fn run(&mut self, list: &PassList) -> Result<()> {
        let is_upload = |command: &Command| matches!(command, Command::Upload { .. });
        let is_read = |command: &Command| matches!(command, Command::ReadBuffer { .. } | Command::ReadTexture { .. });
        let uploads = list.commands().iter().take_while(|command| is_upload(command)).count();
        let (uploads, rest) = list.commands().split_at(uploads);
        let reads = rest.iter().rev().take_while(|command| is_read(command)).count();
        let (middle, reads) = rest.split_at(rest.len() - reads);
        // Even without uploads: new textures and buffers are filled with zeros here.
        self.run_part(list, uploads, false)?;
        self.run_part(list, middle, true)?;
        self.run_part(list, reads, false)
    }
}

impl Backend for Unguarded {
    fn caps(&self) -> &Caps {
        self.0.caps()
    }

    fn create_buffer(&mut self, desc: &BufferDesc) -> Result<BufferId> {
        self.0.create_buffer(desc)
    }

    fn create_texture(&mut self, desc: &TextureDesc) -> Result<TextureId> {
        self.0.create_texture(desc)
    }

    fn create_compute(&mut self, desc: &ComputeDesc) -> Result<Kernel> {
        self.0.create_compute(desc)
    }

    fn create_raster(&mut self, desc: &RasterDesc) -> Result<RasterPipeline> {
        self.0.create_raster(desc)
    }

    fn destroy(&mut self, resource: Resource) {
        self.0.destroy(resource);
    }

    fn destroy_pipeline(&mut self, pipeline: PipelineId) {
        self.0.destroy_pipeline(pipeline);
    }

    fn read(&mut self, ticket: Ticket) -> ReadBack {
        self.0.read(ticket)
    }

    fn cancel_read(&mut self, ticket: Ticket) {
        self.0.cancel_read(ticket);
    }

    fn timings(&mut self) -> Vec<Timing> {
        self.0.timings()
    }

    fn memory(&self) -> Memory {
        self.0.memory()
    }
}

/// Cases in which the layer 1.3.239 says SYNC-HAZARD: a copy, an upload or a clear meets a use within one list.
const BY_HAZARD: [&str; 12] = [
    "hazards::upload_then_compute_then_upload",
    "hazards::a_uniform_changes_between_passes",
    "hazards::copy_then_compute",
    "hazards::clear_between_compute_passes",
    "hazards::read_back_then_write",
    "hazards::across_lists",
    "hazards::across_runs_of_one_list",
    "hazards::the_number_of_groups_is_read_before_it_changes",
    "raster_hazards::upload_then_raster_then_upload",
    "raster_hazards::fragments_write_then_copy",
    "raster_hazards::a_picture_is_drawn_then_loaded_then_drawn",
    "raster_hazards::a_picture_is_drawn_then_read_back_then_drawn",
];

/// Cases in which it only says that a texture is not in the layout that it is used in, whatever the hazard of the case is.
const BY_LAYOUT: [&str; 9] = [
    "raster_hazards::compute_writes_then_vertices_pull",
    "raster_hazards::compute_writes_then_fragments_read",
    "raster_hazards::compute_writes_then_compute_reads_then_raster_reads",
    "raster_hazards::vertices_pull_then_compute_writes",
    "raster_hazards::fragments_read_then_compute_writes",
    "raster_hazards::two_pictures_are_drawn_from_each_other",
    "raster_hazards::a_picture_is_loaded_after_it_was_read_back",
    "raster_hazards::depth_is_drawn_then_loaded_in_compute",
    "raster_hazards::depth_is_drawn_then_loaded_by_fragments",
];

/// What is in neither table passes unnoticed there, and so does what raw Vulkan forgets in it. There are three reasons: the layer
/// takes what our shaders write for read, so that it sees no hazard between passes; it does not look at the targets of
/// dynamic rendering; and it looks at each command buffer by itself. So its silence is no proof of the barriers between
/// compute passes. `hazards.rs` is, which holds them against a model of memory.
#[test]
fn what_the_validation_layer_notices_without_barriers() {
    if let Err(error) = unguarded()
        && std::env::var_os("TRESSFX_NO_GPU").is_some()
    {
        return eprintln!("skipped: {error}");
    }
    for case in CASES.iter().filter(|case| case.name.contains("hazards::")) {
        let said = match case.outcome(unguarded) {
            Outcome::Failed(why) => why,
            _ => String::new(),
        };
        let (hazard, layout) = (said.contains("SYNC-HAZARD"), said.contains("in layout VK_IMAGE_LAYOUT"));
        println!(
            "{}: {}",
            case.name,
            if hazard {
                "hazard"
            } else if layout {
                "layout"
            } else {
                "unnoticed"
            }
        );
        assert!(hazard || !BY_HAZARD.contains(&case.name), "{}: {said}", case.name);
        assert!(hazard || layout || !BY_LAYOUT.contains(&case.name), "{}: {said}", case.name);
    }
    let known = |name: &&&str| CASES.iter().any(|case| case.name == **name);
    assert_eq!(BY_HAZARD.iter().chain(&BY_LAYOUT).filter(known).count(), BY_HAZARD.len() + BY_LAYOUT.len());
}
