//! A simulation that goes on frame by frame: what `render` and `simulate` share.

use anyhow::{Context, Result};
use glam::Vec4;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};
use tressfx_asset::mesh::Mesh;
use tressfx_core::backend::Caps;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::strands::Strands;
use tressfx_core::view::Pose;
use tressfx_sim::bending_length::of_local_stiffness;
use tressfx_sim::field::Fields;
use tressfx_sim::metrics::{self, EdgeError};
use tressfx_sim::{ClockParams, Collider, HairSim, SectionDesc, SimParams, Solver, StepInput, VolumeParams, Wind};

use crate::backend;
use crate::body::Body;
use crate::cli::{self, BackendName};
use crate::groom::Groom;
use crate::motion;
use crate::params::Params;
use crate::say::say;
use crate::stats::{GroomStats, PassTimes, RenderStats, SimStats, Stats};
use crate::trace::Trace;

/// As often as that the simulation is told where the head is, at least.
const POSES_A_SECOND: f64 = 60.0;

/// A groom on its way through time.
pub(crate) struct Run {
    pub(crate) groom: Groom,
    pub(crate) params: Params,
    pub(crate) backend: Box<dyn tressfx_core::backend::Run>,
    pub(crate) sim: HairSim,
    /// What the hair grows on, if it moves.
    pub(crate) body: Option<Body>,
    pub(crate) times: PassTimes,
    pub(crate) trace: Trace,
    backend_name: &'static str,
    /// Frames that were simulated.
    frame: u32,
    wind: Option<Wind>,
    /// What is drawn with the hair.
    pub(crate) meshes: Vec<Mesh>,
    /// Of the meshes, if the hair collides with them.
    pub(crate) fields: Option<Fields>,
    /// Whether fields are made in the rest pose too, where nothing collides.
    pub(crate) shows_fields: bool,
    /// What the hair collides with; it moves with the head.
    colliders: Vec<Collider<'static>>,
}

/// What moves a section: what was asked for, or rods where there is room for them. The rest pose alone asks for nothing, and what rods want
/// at rest takes time.
fn solver(args: &cli::Scene, strands: &Strands, caps: &Caps) -> Solver {
    if let Some(name) = args.solver {
        return name.solver();
    }
    let bytes = Solver::Direct.state_bytes(strands);
    let has_room = bytes <= caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
    if args.frames > 0 && !has_room {
        eprintln!(
            "{}: rods take {bytes} bytes in a buffer, more than this device has: the solver is `tressfx`",
            strands.name
        );
    }
    if args.frames > 0 && has_room { Solver::Direct } else { Solver::TressFx }
}

/// The parameters of a section, with the material that was asked for.
fn material(args: &cli::Scene, strands: &Strands, params: SimParams) -> SimParams {
    let Some(local_stiffness) = args.local_stiffness else {
        return args.preset.map_or(params.clone(), |preset| preset.on(params));
    };
    let lengths = strands.rest_lengths.chunks(strands.vertices as usize).map(|edges| edges.iter().sum::<f32>());
    let length = median(lengths.collect()) * strands.metres_per_unit;
    let bending_length = of_local_stiffness(local_stiffness, strands.vertices, length);
    eprintln!(
        "{}: a local stiffness of {local_stiffness} is a bending length of {:.1} mm, in strands of {:.0} mm and {} vertices",
        strands.name,
        1e3 * bending_length,
        1e3 * length,
        strands.vertices
    );
    SimParams { bending_length, ..params }
}

fn median(mut numbers: Vec<f32>) -> f32 {
    numbers.sort_by(f32::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}

/// Says which strands were made stiffer so that they stand in the pose of their file.
fn say_standing(sim: &HairSim, section: usize, strands: &Strands) {
    let Some(standing) = sim.standing(section) else { return };
    if standing.raised > 0 {
        let (raised, factor) = (standing.raised, standing.largest_factor);
        let (name, guides) = (&strands.name, strands.guides);
        eprintln!(
            "{name}: the bending length of {raised} of {guides} guides is raised, up to {factor:.1} times: they stand"
        );
    }
    if standing.fallen > 0 {
        eprintln!("{}: {} of {} guides cannot stand: they sag", strands.name, standing.fallen, strands.guides);
    }
}

impl Run {
    pub(crate) fn new(args: &cli::Scene) -> Result<Self> {
        let groom = Groom::load(&args.grooms, args.follow)?;
        let params = Params::read(args.params.as_deref(), groom.sections.len())?;
        let mut backend = backend::open(args)?;
        let sections: Vec<_> = groom
            .sections
            .iter()
            .enumerate()
            .map(|(index, strands)| {
                let solver = solver(args, strands, backend.caps());
                let desc = SectionDesc::new(strands, material(args, strands, params.sim(index).clone()));
                let desc = desc.with_solver(solver);
                if args.body.is_given() { desc.with_own_roots() } else { desc }
            })
            .collect();
        let meshes: Vec<Mesh> = args.collision.mesh()?.into_iter().chain(groom.mesh.clone()).collect();
        let mut colliders = args.collision.capsules(&groom.capsules, &params.capsule);
        let mut uploads = PassList::new();
        let mut body = Body::read(&args.body, &mut *backend, &mut uploads)?;
        let fields = args.collision.fields(&mut *backend, &mut uploads, &meshes, body.as_ref())?;
        if let Some(fields) = &fields {
            for index in 0..fields.len() {
                colliders.push(Collider::with_head(fields.shape(index)?));
            }
        }
        let volume = params.volume.clone().or_else(|| args.volume.then(VolumeParams::default));
        let (most, gpu) = (colliders.len(), &mut *backend);
        let mut sim = match (&volume, &fields) {
            (Some(volume), _) => HairSim::with_volume(gpu, &mut uploads, &sections, most, fields.as_ref(), volume)?,
            (None, None) => HairSim::new(gpu, &mut uploads, &sections, most)?,
            (None, Some(fields)) => HairSim::with_fields(gpu, &mut uploads, &sections, most, fields)?,
        };
        if let Some(body) = &mut body {
            body.bind(&args.body, &mut *backend, &mut uploads, &sim, &groom.sections)?;
        }
        backend.run(&uploads)?;
        // A frame of any length is simulated whole, with what the one before it left over.
        let longest = 1.0 / args.fps + params.clock.sub_step;
        sim.set_clock_params(ClockParams { max_frame: params.clock.max_frame.max(longest), ..params.clock })?;
        groom.sections.iter().enumerate().for_each(|(index, strands)| say_standing(&sim, index, strands));
        let wind = match (args.wind, params.wind) {
            (Some(velocity), Some(wind)) => Some(Wind { velocity, ..wind }),
            (Some(velocity), None) => Some(Wind::new(velocity)),
            (None, wind) => wind,
        };
        let backend_name = match args.backend {
            BackendName::Vulkan => "vulkan",
            BackendName::Wgpu | BackendName::Both => "wgpu",
        };
        let (times, trace) = (PassTimes::default(), Trace::new());
        Ok(Self {
            groom,
            params,
            backend,
            sim,
            body,
            times,
            trace,
            backend_name,
            frame: 0,
            wind,
            meshes,
            fields,
            shows_fields: false,
            colliders,
        })
    }

    /// How many frames come out: of no simulated ones, the rest pose.
    pub(crate) fn frames(args: &cli::Scene) -> u32 {
        args.frames.max(1)
    }

    /// Records the next frame of the simulation; no time passes where no frames are to be simulated. The motion is known between frames too, so few frames do not make it coarser.
    pub(crate) fn step(&mut self, args: &cli::Scene) -> Result<PassList> {
        let mut list = PassList::new();
        if args.frames == 0 {
            if let Some(body) = &mut self.body {
                body.pose(&mut list, &mut self.sim, 0.0)?;
            }
            if self.shows_fields {
                self.refit(&mut list)?;
            }
            self.sim.step(&mut list, &StepInput::new(0.0, self.head(args)))?;
            return Ok(list);
        }
        if self.body.is_some() {
            self.step_with_body(args, &mut list)?;
            return Ok(list);
        }
        let parts = (POSES_A_SECOND / args.fps).ceil().clamp(1.0, POSES_A_SECOND);
        let at = |part: u32| self.head_at(args, f64::from(self.frame) + f64::from(part) / parts);
        let (path, head): (Vec<_>, _) = ((1..parts as u32).map(at).collect(), at(parts as u32));
        self.fields.iter_mut().for_each(|fields| fields.record(&mut list));
        let input = StepInput::new(1.0 / args.fps, head).with_path(&path).with_colliders(&self.colliders);
        self.sim.step(&mut list, &StepInput { wind: self.wind, ..input })?;
        self.frame += 1;
        Ok(list)
    }

    /// Records the next frame of hair on a body, which is posed anew for every sub-step: a fast head does not leave its roots behind.
    fn step_with_body(&mut self, args: &cli::Scene, list: &mut PassList) -> Result<()> {
        let parts = (1.0 / (args.fps * self.params.clock.sub_step)).round().clamp(1.0, POSES_A_SECOND);
        for part in 1..=parts as u32 {
            let frames = f64::from(self.frame) + f64::from(part) / parts;
            if let Some(body) = &mut self.body {
                body.pose(list, &mut self.sim, frames / args.fps)?;
            }
            self.refit(list)?;
            let input = StepInput::new(1.0 / (args.fps * parts), self.head_at(args, frames));
            let input = StepInput { wind: self.wind, ..input.with_colliders(&self.colliders) };
            self.sim.step(list, &input)?;
        }
        self.frame += 1;
        Ok(())
    }

    /// Makes the field of a body that has moved anew.
    fn refit(&mut self, list: &mut PassList) -> Result<()> {
        let Some(fields) = &mut self.fields else { return Ok(()) };
        if self.body.as_ref().is_some_and(Body::moves) {
            fields.mark_changed(0)?;
        }
        fields.record(list);
        // A field that was made anew has another shape: what sleeps on it wakes.
        let first = self.colliders.len() - fields.len();
        for (index, collider) in self.colliders[first..].iter_mut().enumerate() {
            *collider = Collider::with_head(fields.shape(index)?);
        }
        Ok(())
    }

    /// Where the head is in the frame that was recorded last.
    pub(crate) fn head(&self, args: &cli::Scene) -> Pose {
        self.head_at(args, f64::from(self.frame))
    }

    fn head_at(&self, args: &cli::Scene, frames: f64) -> Pose {
        motion::head(args.motion, frames / args.fps, &self.groom.bounds())
    }

    /// Runs a list and keeps the times of its passes.
    pub(crate) fn submit(&mut self, list: &PassList) -> Result<()> {
        let start = Instant::now();
        self.backend.run(list)?;
        self.trace.cpu("run", self.frame, start);
        let timings = self.backend.timings();
        self.trace.gpu(&timings, self.frame, start);
        self.times.add(&timings);
        Ok(())
    }

    /// What a read-back of the list that was just run brought.
    pub(crate) fn fetch(&mut self, ticket: Ticket) -> Result<Vec<u8>> {
        self.backend.read(ticket).ready().context("the list has run, but a read-back is missing")
    }

    /// Positions of all strands of each section about the centre of the groom, strand-major.
    pub(crate) fn positions(&mut self) -> Result<Vec<Vec<Vec4>>> {
        let mut list = PassList::new();
        let tickets = self.sim.read_positions(&mut list);
        self.backend.run(&list)?;
        let mut sections = Vec::new();
        for (section, ticket) in tickets.into_iter().enumerate() {
            let positions: Vec<Vec4> = bytemuck::pod_collect_to_vec(&self.fetch(ticket)?);
            sections.push(self.groom.sections[section].deinterleave(&positions));
        }
        Ok(sections)
    }

    /// Tells what was asked for: a table of costs, a trace, figures.
    pub(crate) fn report(&mut self, args: &cli::Scene, render: RenderStats) -> Result<()> {
        if args.profile {
            say(self.times.table())?;
        }
        if let Some(path) = &args.trace {
            self.trace.write(path)?;
        }
        match &args.stats {
            Some(path) => self.stats(render)?.write(path),
            None => Ok(()),
        }
    }

    /// Everything that is known about the run so far.
    fn stats(&mut self, render: RenderStats) -> Result<Stats> {
        let sim = self.sim_stats()?;
        Ok(Stats {
            groom: GroomStats { strands: self.groom.strands(), vertices: self.groom.vertices() },
            backend: self.backend_name,
            adapter: self.backend.caps().adapter.clone(),
            frames: self.frame,
            passes: self.times.summary(),
            sim,
            render: RenderStats { peak_gpu_bytes: self.backend.memory().peak, ..render },
        })
    }

    fn sim_stats(&mut self) -> Result<SimStats> {
        let mut list = PassList::new();
        let ticket = self.sim.read_non_finite(&mut list);
        self.backend.run(&list)?;
        let reset_strands: Vec<u32> = bytemuck::pod_collect_to_vec(&self.fetch(ticket)?);
        let positions = self.positions()?;
        let mut error = EdgeError::default();
        let mut bad = 0;
        for (strands, positions) in self.groom.sections.iter().zip(&positions) {
            error = error.with(metrics::edge_error(strands, positions));
            bad += metrics::non_finite(positions) as u64;
        }
        Ok(SimStats {
            max_edge_error: error.max,
            rms_edge_error: error.rms,
            non_finite: bad + u64::from(reset_strands[0]),
            // The first puts the strands where they begin.
            resets: self.sim.resets().saturating_sub(1),
        })
    }
}

/// A bar that shows up once its work has taken a second.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    begun: Instant,
}

impl Progress {
    /// Of `count` pieces, each a `unit`.
    pub(crate) fn new(count: u64, unit: &str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template(&format!("{{bar:40}} {unit} {{pos}} of {{len}}, {{eta}} left"));
        Self { bar: bar.with_style(style.expect("the template is fixed")), begun: Instant::now() }
    }

    pub(crate) fn advance(&self) {
        if self.bar.is_hidden() && self.begun.elapsed() > Duration::from_secs(1) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.inc(1);
    }

    /// One more piece is done, of a number that only now is known.
    pub(crate) fn advance_of(&self, count: u64) {
        self.bar.set_length(count);
        self.advance();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
