// What lies before the hair that comes next.

@if(places)
import package::places::{Shares, all_places, mean_of, passed, stopped};

struct Front {
    color: vec3<f32>,
    @if(!places)
    transmittance: f32,
    // Of each place in the pixel.
    @if(places)
    transmittance: Shares,
    // How many there are.
    fragments: u32,
}

// Before any fragment. (A function: of a constant struct naga makes HLSL that some compilers refuse.)
fn nothing_yet() -> Front {
    @if(!places) { return Front(vec3(0.0), 1.0, 0u); }
    @if(places) { return Front(vec3(0.0), all_places(1.0), 0u); }
}

// What lies before what is behind so many fragments of one colour and opacity.
@if(!places)
fn over(front: Front, color: vec3<f32>, alpha: f32, fragments: u32) -> Front {
    let next = front.color + front.transmittance * alpha * color;
    return Front(next, front.transmittance * (1.0 - alpha), front.fragments + fragments);
}

@if(places)
fn over(front: Front, color: vec3<f32>, parts: Shares, fragments: u32) -> Front {
    let next = front.color + stopped(front.transmittance, parts) * color;
    return Front(next, passed(front.transmittance, parts), front.fragments + fragments);
}

// How much of what is behind is seen.
fn passes(front: Front) -> f32 {
    @if(!places) { return front.transmittance; }
    @if(places) { return mean_of(front.transmittance); }
}
