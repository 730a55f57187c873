//! What each case is held against.

use anyhow::Result;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use tressfx_conformance::rod::links::Links;
use tressfx_conformance::rod::{G, elastica};
use tressfx_core::strands::Strands;
use tressfx_sim::reference::Simulation;
use tressfx_sim::{ClockParams, SectionDesc, Solver};

use crate::case::{Answer, CANTILEVER_RATIO, CHAIN_BENDING, Case, FPS, LENGTH};
use crate::drive::{Tips, distance, tips_of};

/// Links of the chain.
const LINKS: usize = 48;
/// Steps of the Runge-Kutta method in a frame.
const STEPS: usize = 400;

/// The answer to a case.
pub(crate) struct Truth {
    pub(crate) tips: Tips,
    /// How far it is from that with sub-steps of twice the length; none where it is of another kind.
    pub(crate) converged: Option<f64>,
}

/// The answer to a case for these strands, with so many sub-steps a second where it is simulated.
pub(crate) fn truth(case: &Case, strands: &Strands, rate: u32) -> Result<Truth> {
    match case.answer {
        Answer::Links => Ok(Truth { tips: links(case), converged: None }),
        Answer::Elastica => {
            let [along, up] = elastica::tip(CANTILEVER_RATIO);
            Ok(Truth { tips: vec![vec![DVec3::new(along, up, 0.0)]], converged: None })
        }
        Answer::ShortSteps => {
            let (half, tips) = (simulated(case, strands, rate / 2)?, simulated(case, strands, rate)?);
            Ok(Truth { converged: Some(distance(&half, &tips)), tips })
        }
    }
}

fn links(case: &Case) -> Tips {
    let mut chain = Links::straight(LENGTH, G * CHAIN_BENDING.powi(3), LINKS, FRAC_PI_2);
    let mut tips = Tips::new();
    for _ in 0..case.frames / 2 {
        chain.run(2.0 / f64::from(FPS), 2 * STEPS);
        let [along, up] = chain.places()[LINKS - 1];
        tips.push(vec![DVec3::new(along, up, 0.0) / LENGTH]);
    }
    tips
}

fn simulated(case: &Case, strands: &Strands, rate: u32) -> Result<Tips> {
    let desc = SectionDesc::new(strands, case.params.clone()).with_solver(Solver::Direct);
    let mut simulation = Simulation::new(&[desc])?;
    simulation.set_clock_params(ClockParams { sub_step: 1.0 / f64::from(rate), ..ClockParams::default() })?;
    let dt = 1.0 / f64::from(FPS);
    simulation.step(&case.input(0.0, 0.0, strands.metres_per_unit))?;
    let mut tips = Tips::new();
    for frame in 1..=case.frames {
        simulation.step(&case.input(f64::from(frame) * dt, dt, strands.metres_per_unit))?;
        if frame > case.after && frame % 2 == 0 {
            tips.push(tips_of(strands, &simulation.positions(0)));
        }
    }
    Ok(tips)
}
