//! The engine in bad weather, for as many frames as a test has time for: see the example.

#[path = "../stress_vulkan/frames.rs"]
mod frames;
#[path = "../stress_vulkan/gpu.rs"]
mod gpu;
#[path = "../stress_vulkan/stress.rs"]
mod stress;
#[path = "../stress_vulkan/targets.rs"]
mod targets;

#[test]
fn an_engine_in_bad_weather_never_waits_and_leaves_nothing_behind() {
    // Without the layer the test is worth less, and still runs.
    let layer = std::path::Path::new("/usr/share/vulkan/explicit_layer.d/VkLayer_khronos_validation.json").exists();
    let ran = stress::run(130, layer);
    if ran.is_err() && std::env::var_os("TRESSFX_NO_GPU").is_some() {
        return;
    }
    let figures = ran.unwrap();
    println!("{figures:#?}");
    figures.check().unwrap();
    assert!(figures.submitted > 100 && figures.thrown_away > 3, "{figures:?}");
    assert!(figures.grooms >= 4 && figures.resizes >= 3 && figures.minimized > 5, "{figures:?}");
    assert!(figures.late_lists > 10, "{figures:?}");
}
