//! What pools are predicted to need, against what they need: five grooms at three distances. Nothing hides a part of them, which
//! no prediction can know.

mod support;

use std::ops::Range;

use tressfx_conformance::show::{Scene, Show};
use tressfx_render::{PpllDesc, Technique, TilesDesc};
use tressfx_sim::Solver;

/// The strands of the first two are a multiple of the samples that a prediction takes.
const GROOMS: [&str; 5] = ["long:4096:9", "wavy:4096:17", "curly:2000:48", "fur:20000:6", "straight:3000:16"];

/// How many times larger a pool is made than what is predicted.
const HEADROOM: f64 = 1.25;

/// Holds what is predicted to a range of what is needed.
fn hold(technique: Technique, range: Range<f64>) {
    for name in GROOMS {
        // What is predicted follows from the lengths of edges, and rods keep them.
        let groom = Scene::builtin(name, [320, 180]);
        let mut scene = Scene { technique, mesh: None, solver: Solver::Direct, ..groom };
        let mut ratios = Vec::new();
        for distance in [0.5, 1.0, 2.0] {
            scene.distance = distance;
            let Some(gpu) = support::gpu() else { return };
            let mut show = Show::new(*gpu, &scene);
            let predicted = f64::from(show.capacity()) / HEADROOM;
            show.play(1);
            let wanted = show.picture().1.wanted;
            assert!(wanted > 1 << 16, "{name} at {distance}: no more than every pool has");
            ratios.push(predicted / f64::from(wanted));
        }
        eprintln!("{name}: {ratios:.2?}");
        assert!(ratios.iter().all(|ratio| range.contains(ratio)), "{name}: {ratios:.2?}");
    }
}

#[test]
fn references_of_tiles_are_predicted_with_little_to_spare() {
    hold(TilesDesc::default().into(), 1.0..1.3);
}

#[test]
fn fragments_are_predicted() {
    hold(PpllDesc::default().into(), 0.97..1.2);
}
