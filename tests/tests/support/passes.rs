//! What passes have left in their buffers.
#![allow(dead_code, reason = "each test takes what it needs")]

use tressfx_conformance::render::{Groom, Screen};
use tressfx_core::error::Label;
use tressfx_core::pass::{Command, PassList};
use tressfx_core::shader::Binding;
use tressfx_render::{SectionDraw, ViewDraw};

/// What a pass binds under a name; of several passes of one label, the first.
pub(crate) fn bound(list: &PassList, label: Label, name: &str) -> Binding {
    let (_, command) = list.passes().find(|(of, _)| *of == label).unwrap_or_else(|| panic!("no pass is {label}"));
    let Command::Compute(pass) = command else { panic!("{label} is no compute pass") };
    let slot = pass.kernel.shader.slots.iter().position(|slot| slot.name == name);
    pass.bindings.all()[slot.unwrap_or_else(|| panic!("{label} binds no `{name}`"))]
}

/// Draws grooms over the scene that is there, and reads what passes bound under these names.
pub(crate) fn read<const N: usize>(
    screen: &mut Screen,
    grooms: &[&Groom],
    names: [(Label, &str, u64); N],
) -> [Vec<u32>; N] {
    let mut list = PassList::new();
    let sections: Vec<_> = grooms.iter().map(|groom| screen.section(&mut list, groom)).collect();
    let draws: Vec<_> = sections
        .iter()
        .zip(grooms)
        .map(|(strands, groom)| SectionDraw::new(strands, &groom.material, groom.pose))
        .collect();
    let (view, lights, targets) = (screen.view, screen.lights.clone(), screen.targets());
    screen.renderer.grow_to_predicted(&mut *screen.backend, &view, &draws).unwrap();
    screen.renderer.draw(&mut list, &[ViewDraw::new(&view, &lights, targets)], &draws).unwrap();
    let tickets = names.map(|(label, name, count)| {
        let Binding::Buffer { id, offset, bytes } = bound(&list, label, name) else { panic!("`{name}` is no buffer") };
        assert!(bytes.is_none_or(|bytes| bytes >= 4 * count), "{label}: `{name}` is shorter");
        list.read_buffer(id, offset, 4 * count)
    });
    screen.backend.run(&list).unwrap();
    tickets.map(|ticket| bytemuck::pod_collect_to_vec(&screen.backend.read(ticket).ready().expect("it has run")))
}
