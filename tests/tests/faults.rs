//! The suite under test: a backend with a fault must fail the cases that look for it, by their own assertions, and the same
//! backend without one none.

use tressfx_backend_wgpu::WgpuBackend;
use tressfx_conformance::faulty::{Fault, Faulty};
use tressfx_conformance::suite::{CASES, Outcome, promises, report};

mod support;

/// Holds that a case finds a fault, by an assertion in the file of its group.
fn assert_caught(fault: Fault, name: &str) {
    if support::gpu().is_none() {
        return;
    }
    let case = CASES.iter().find(|case| case.name == name).unwrap_or_else(|| panic!("there is no case {name}"));
    let group = name.split("::").next().unwrap_or_default();
    match case.outcome(|| WgpuBackend::headless().map(|backend| Faulty::new(backend, fault))) {
        Outcome::Failed(why) if why.contains(&format!("suite/{group}.rs:")) => {
            println!("{fault:?}: {name}: {}", why.lines().next().unwrap_or_default());
        }
        other => panic!("{fault:?}: {name} does not find it by an assertion of its own: {other}"),
    }
}

macro_rules! caught {
    ($($name:ident: $fault:ident in $($case:literal)+;)*) => {
        $(#[test] fn $name() { $(assert_caught(Fault::$fault, $case);)+ })*

        /// A fault that is not in the table does not compile.
        const _: fn(Fault) = |fault| match fault {
            Fault::None | Fault::CapsDeny $(| Fault::$fault)* => (),
        };
    };
}

caught! {
    uploads_first: UploadsFirst in "contract::uploads_take_effect_in_the_order_of_the_list" "hazards::upload_then_compute_then_upload";
    reads_last: ReadsLast in "contract::a_read_back_has_its_place_in_the_list" "hazards::read_back_then_write";
    reads_again: ReadsAgain in "contract::a_read_back_is_given_once";
    given_up_is_read: GivenUpIsRead in "contract::what_was_given_up_is_unknown";
    nothing_unknown: NothingUnknown in "contract::a_ticket_that_nobody_ran_gives_nothing";
    clears_all: ClearsAll in "contract::a_part_of_a_buffer_is_cleared_and_the_rest_stays";
    clears_nothing: ClearsNothing in "contract::a_whole_buffer_is_cleared";
    copies_from_the_start: CopiesFromTheStart in "contract::copies_begin_and_end_at_their_offsets";
    memory_never_freed: MemoryNeverFreed in "contract::memory_counts_what_is_made_and_destroyed" "contract::what_fails_half_way_is_freed";
    rules_late: RulesLate in "contract::a_list_that_breaks_a_rule_does_nothing" "rules::every_mistake_of_a_copy_is_answered";
    rules_ignored: RulesIgnored in "rules::every_mistake_of_a_copy_is_answered" "rules::every_mistake_of_a_pass_is_answered";
    stale_ids_live: StaleIdsLive in "stale::a_destroyed_buffer_is_noticed" "stale::a_destroyed_compute_pipeline_is_noticed";
    destroyed_at_once: DestroyedAtOnce in "stale::what_is_destroyed_lives_on_for_older_lists";
    foreign_ids_ignored: ForeignIdsIgnored in "stale::ids_of_another_backend_are_refused";
    caps_boast: CapsBoast in "caps::as_many_storage_buffers_as_claimed_are_bound";
    caps_boast_textures: CapsBoastTextures in "caps::as_many_storage_textures_as_claimed_are_written";
    caps_boast_threads: CapsBoastThreads in "caps::groups_are_as_large_as_claimed";
    caps_boast_memory: CapsBoastMemory in "caps::groups_are_as_large_as_claimed";
    caps_boast_uniforms: CapsBoastUniforms in "caps::uniforms_are_as_large_as_claimed";
    caps_boast_alignment: CapsBoastAlignment in "caps::parts_begin_at_every_offset_that_is_claimed";
    caps_boast_targets: CapsBoastTargets in "caps::as_many_targets_as_claimed_are_drawn_to";
    timings_reversed: TimingsReversed in "caps::timings_are_in_order_or_not_there";
    timings_zero: TimingsZero in "caps::timings_are_in_order_or_not_there";
    scopes_forgotten: ScopesForgotten in "caps::timings_are_in_order_or_not_there";
    cached_by_label: CachedByLabel in "shaders::constants_and_features_specialize";
    bindings_swapped: BindingsSwapped in "shaders::bindings_have_gaps_and_any_order";
    grid_flat: GridFlat in "shaders::groups_know_their_place_in_the_grid";
    instances_ignored: InstancesIgnored in "shaders::vertices_and_instances_are_counted";
    upside_down: UpsideDown in "shaders::up_is_up_and_left_is_left";
    passes_dropped: PassesDropped in "hazards::compute_changes_in_place_many_times";
    counts_ignored: CountsIgnored in "hazards::compute_writes_the_number_of_groups";
    ranges_from_the_start: RangesFromTheStart in "bindings::one_uniform_buffer_serves_many_passes" "bindings::a_part_is_all_that_a_shader_sees";
    ranges_to_the_end: RangesToTheEnd in "bindings::a_part_is_all_that_a_shader_sees";
    draw_counts_ignored: DrawCountsIgnored in "draws::a_buffer_says_how_much_is_drawn";
    viewport_ignored: ViewportIgnored in "draws::a_viewport_is_where_clip_space_lies" "draws::nothing_is_drawn_beyond_a_viewport";
    fragmentless_dropped: FragmentlessDropped in "draws::without_a_fragment_stage_depth_is_drawn";
    samplers_swapped: SamplersSwapped in "textures::nearest_takes_the_nearest_texel" "textures::linear_lies_between_texels";
    rows_from_the_start: RowsFromTheStart in "textures::rows_of_a_buffer_become_a_texture";
    rows_not_copied: RowsNotCopied in "textures::a_copy_replaces_what_was_drawn" "formats::every_format_is_copied_to_and_loaded";
    storage_writes_lost: StorageWritesLost in "textures::compute_writes_every_storage_format" "textures::compute_changes_textures_in_place";
    rows_padded: RowsPadded in "formats::rows_come_back_tight_whatever_the_width";
    red_is_blue: RedIsBlue in "formats::rgba8";
    srgb_linear: SrgbLinear in "formats::rgba8_srgb";
    ten_bits_are_eight: TenBitsAreEight in "formats::rgb10a2";
    integers_clear_to_zero: IntegersClearToZero in "formats::r32_uint_is_cleared_and_drawn";
    over_replaces: OverReplaces in "state::over_lays_premultiplied_color_over";
    sums_are_products: SumsAreProducts in "state::add_adds" "state::multiply_multiplies";
    min_is_max: MinIsMax in "state::min_takes_the_smaller" "state::max_takes_the_larger";
    targets_swapped: TargetsSwapped in "state::targets_have_their_own_colors";
    keep_clears: KeepClears in "state::color_is_kept";
    clear_keeps: ClearKeeps in "state::color_is_cleared_before_the_first_draw";
    depth_swapped: DepthSwapped in "depth::nearer_passes_in_standard_order";
    depth_forgotten: DepthForgotten in "depth::farther_is_hidden_in_standard_order";
    depth_test_writes: DepthTestWrites in "depth::tested_alone_depth_stays";
}

/// What a backend denies, the cases that need it are skipped for: on a backend that is told to have it that fails.
#[test]
fn caps_deny() {
    if support::gpu().is_none() {
        return;
    }
    let case = CASES.iter().find(|case| case.name == "hazards::compute_writes_twice").unwrap();
    let outcome = case.outcome(|| WgpuBackend::headless().map(|backend| Faulty::new(backend, Fault::CapsDeny)));
    assert!(matches!(outcome, Outcome::Skipped(_)), "{outcome}");
    let kept = promises(&WgpuBackend::headless().unwrap(), &[(case.name, outcome)]);
    assert!(kept.unwrap_err().contains(case.name));
}

#[test]
fn without_a_fault_every_case_passes() {
    if support::gpu().is_none() {
        return;
    }
    let outcomes = report(|| WgpuBackend::headless().map(|backend| Faulty::new(backend, Fault::None)));
    for (name, outcome) in &outcomes {
        assert!(!matches!(outcome, Outcome::Failed(_)), "{name}: {outcome}");
    }
    promises(&WgpuBackend::headless().unwrap(), &outcomes).unwrap();
}
