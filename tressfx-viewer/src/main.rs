//! The program `tressfx`: simulates, renders, inspects and converts grooms, and compares pictures of them. It holds no hair logic.

#![forbid(unsafe_code)]

mod backend;
mod bind;
mod body;
mod both;
mod camera;
mod cli;
mod collide;
mod compare;
mod convert;
mod develop;
mod field_view;
mod groom;
mod grow;
mod hair_output;
mod info;
mod info_body;
mod interpolate;
mod light_params;
mod lod;
mod motion;
mod oit;
mod own_look;
mod params;
mod passes;
mod picture;
mod reference;
mod reference_light;
mod render;
mod run;
mod say;
mod shaders;
mod shadows;
mod simulate;
mod stats;
mod studio;
mod trace;

use std::process::ExitCode;

use clap::Parser;

use crate::cli::{BackendName, Cli, Command};

/// Exit codes: 0 when all is well, 1 when something failed, 2 (by clap) when the words on the command line are wrong.
fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Info(args) => info::run(&args),
        Command::Render(args) if args.scene.backend == BackendName::Both => both::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Bind(args) => bind::run(&args),
        Command::Grow(args) => grow::run(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Adapters => backend::adapters(),
        Command::Compare(args) => compare::run(&args),
        Command::Shaders(args) => shaders::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
