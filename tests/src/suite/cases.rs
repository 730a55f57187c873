//! The table of all cases, cheap ones first.

use tressfx_core::error::Need;

use super::{
    Case, bindings, caps, contract, depth, draws, formats, hair, hazards, raster_hazards, rules, scale, shaders, stale,
    state, textures,
};

/// Gives the table to a macro: groups, and in them the names of the cases with what each needs.
#[doc(hidden)]
#[macro_export]
macro_rules! each_case {
    ($($then:tt)+) => {
        $($then)+! {
            contract {
                uploads_take_effect_in_the_order_of_the_list: [ReadBack];
                an_upload_goes_where_its_offset_says: [ReadBack];
                uploads_take_any_bytes: [ReadBack];
                a_whole_buffer_is_cleared: [ReadBack];
                a_part_of_a_buffer_is_cleared_and_the_rest_stays: [ReadBack];
                clears_and_uploads_take_turns: [ReadBack];
                copies_begin_and_end_at_their_offsets: [ReadBack];
                copies_chain: [ReadBack];
                a_part_of_a_buffer_comes_back: [ReadBack];
                a_read_back_has_its_place_in_the_list: [ReadBack];
                appended_commands_follow_with_their_bytes: [ReadBack];
                a_read_back_is_given_once: [ReadBack];
                what_was_given_up_is_unknown: [ReadBack];
                what_fails_half_way_is_freed: [];
                a_list_that_breaks_a_rule_does_nothing: [ReadBack];
                a_ticket_that_nobody_ran_gives_nothing: [];
                new_buffers_are_zero: [ReadBack];
                an_empty_read_back_is_empty: [ReadBack];
                what_follows_a_destroyed_buffer_is_zero: [ReadBack];
                an_empty_list_runs: [];
                a_list_run_again_does_the_same: [ReadBack];
                memory_counts_what_is_made_and_destroyed: [];
                memory_remembers_its_peak: [];
                the_smallest_buffers_can_be_made: [];
            }
            stale {
                a_destroyed_buffer_is_noticed: [];
                a_destroyed_buffer_is_not_read_back: [ReadBack];
                a_destroyed_buffer_is_noticed_in_a_pass: [Compute];
                a_destroyed_texture_is_noticed: [Raster];
                a_destroyed_compute_pipeline_is_noticed: [Compute];
                a_destroyed_raster_pipeline_is_noticed: [Raster];
                an_id_is_not_confused_with_its_successor: [];
                a_pipeline_is_not_confused_with_its_successor: [Compute];
                a_successor_in_the_same_place_is_bound: [Compute ReadBack];
                ids_of_another_backend_are_refused: [];
                what_is_destroyed_lives_on_for_older_lists: [ReadBack];
                a_destroyed_pipeline_lives_on_for_older_lists: [Compute ReadBack];
                an_appended_list_keeps_what_it_named_alive: [ReadBack];
                a_list_that_was_cleared_is_as_new: [];
            }
            rules {
                every_mistake_of_a_copy_is_answered: [ReadBack];
                every_mistake_of_a_pass_is_answered: [Compute Raster ReadBack];
                every_mistake_of_a_description_is_answered: [];
                what_is_not_refused_runs: [Compute Raster ReadBack];
            }
            caps {
                as_many_storage_buffers_as_claimed_are_bound: [Compute ReadBack];
                the_largest_binding_is_written_to_its_end: [Compute ReadBack];
                the_longest_textures_are_cleared_to_their_ends: [Raster ReadBack];
                buffers_beyond_the_caps_are_refused: [];
                textures_beyond_the_caps_are_refused: [];
                bindings_beyond_the_caps_are_refused: [Compute];
                groups_are_as_large_as_claimed: [Compute ReadBack];
                larger_groups_are_refused: [Compute];
                as_many_storage_textures_as_claimed_are_written: [Compute ReadBack];
                uniforms_are_as_large_as_claimed: [Compute ReadBack];
                parts_begin_at_every_offset_that_is_claimed: [Compute ReadBack];
                as_many_targets_as_claimed_are_drawn_to: [Raster ReadBack];
                kernels_are_made_or_refused_as_the_caps_say: [];
                timings_are_in_order_or_not_there: [Compute Raster];
                caps_fit_the_library: [];
            }
            shaders {
                constants_and_features_specialize: [Compute ReadBack];
                bindings_have_gaps_and_any_order: [Compute ReadBack];
                one_kernel_has_many_bindings: [Compute ReadBack];
                uniform_and_storage_read_the_same: [Compute ReadBack];
                arrays_know_their_length: [Compute ReadBack];
                what_lies_outside_of_a_buffer_is_not_touched: [Compute ReadBack];
                compute_adds_atomically: [Compute ReadBack];
                fragments_add_atomically: [Raster FragmentWrites ReadBack];
                groups_share_memory_between_barriers: [Compute ReadBack];
                groups_know_their_place_in_the_grid: [Compute ReadBack];
                more_groups_than_a_row_holds_are_folded: [Compute ReadBack];
                textures_know_their_size: [Compute Raster ReadBack];
                vertices_and_instances_are_counted: [Raster ReadBack];
                vertices_pull_from_many_buffers: [Raster ReadBack];
                up_is_up_and_left_is_left: [Raster ReadBack];
                up_is_up_for_those_who_load_it: [Compute Raster ReadBack];
                fragments_know_their_place: [Raster ReadBack];
            }
            hazards {
                compute_writes_then_compute_reads: [Compute ReadBack];
                compute_reads_then_compute_writes: [Compute ReadBack];
                compute_writes_twice: [Compute ReadBack];
                compute_changes_in_place_many_times: [Compute ReadBack];
                two_buffers_take_turns: [Compute ReadBack];
                upload_then_compute_then_upload: [Compute ReadBack];
                a_uniform_changes_between_passes: [Compute ReadBack];
                copy_then_compute: [Compute ReadBack];
                compute_then_copy_then_compute: [Compute ReadBack];
                clear_between_compute_passes: [Compute ReadBack];
                read_back_then_write: [Compute ReadBack];
                across_lists: [Compute ReadBack];
                across_runs_of_one_list: [Compute ReadBack];
                compute_writes_the_number_of_groups: [Compute ReadBack];
                the_number_of_groups_is_read_before_it_changes: [Compute ReadBack];
                no_groups_run_nothing: [Compute ReadBack];
                counts_are_storage_as_well: [Compute ReadBack];
            }
            raster_hazards {
                compute_writes_then_vertices_pull: [Compute Raster ReadBack];
                compute_writes_then_fragments_read: [Compute Raster ReadBack];
                compute_writes_then_compute_reads_then_raster_reads: [Compute Raster ReadBack];
                vertices_pull_then_compute_writes: [Compute Raster ReadBack];
                fragments_read_then_compute_writes: [Compute Raster ReadBack];
                upload_then_raster_then_upload: [Raster ReadBack];
                fragments_write_then_compute_reads: [Compute Raster FragmentWrites ReadBack];
                compute_and_fragments_take_turns: [Compute Raster FragmentWrites ReadBack];
                fragments_write_then_copy: [Raster FragmentWrites ReadBack];
                a_picture_is_drawn_then_loaded_then_drawn: [Compute Raster ReadBack];
                two_pictures_are_drawn_from_each_other: [Raster ReadBack];
                a_picture_is_drawn_then_read_back_then_drawn: [Raster ReadBack];
                a_picture_is_loaded_after_it_was_read_back: [Compute Raster ReadBack];
                depth_is_drawn_then_loaded_in_compute: [Compute Raster ReadBack];
                depth_is_drawn_then_loaded_by_fragments: [Raster ReadBack];
            }
            bindings {
                a_part_is_all_that_a_shader_sees: [Compute ReadBack];
                parts_of_two_buffers_are_read_and_written: [Compute ReadBack];
                one_uniform_buffer_serves_many_passes: [Compute ReadBack];
                one_buffer_is_read_in_two_parts: [Compute ReadBack];
                draws_are_given_parts: [Raster ReadBack];
            }
            draws {
                a_buffer_says_how_much_is_drawn: [Raster ReadBack];
                a_buffer_may_say_that_nothing_is_drawn: [Raster ReadBack];
                compute_writes_how_much_is_drawn: [Compute Raster ReadBack];
                a_viewport_is_where_clip_space_lies: [Raster ReadBack];
                nothing_is_drawn_beyond_a_viewport: [Raster ReadBack];
                fragments_know_their_place_in_the_target: [Raster ReadBack];
                without_a_fragment_stage_depth_is_drawn: [Raster ReadBack];
            }
            textures {
                nearest_takes_the_nearest_texel: [Compute ReadBack];
                linear_lies_between_texels: [Compute ReadBack];
                samplers_clamp: [Compute ReadBack];
                every_filterable_format_is_sampled: [Compute ReadBack];
                fragments_sample: [Raster ReadBack];
                rows_of_a_buffer_become_a_texture: [ReadBack];
                a_copy_replaces_what_was_drawn: [Compute Raster ReadBack];
                compute_writes_every_storage_format: [Compute ReadBack];
                what_compute_writes_is_sampled_and_drawn_over: [Compute Raster ReadBack];
                compute_changes_textures_in_place: [Compute Raster ReadBack];
                integers_are_loaded: [Compute ReadBack];
            }
            state {
                replace_replaces_alpha_and_all: [Raster ReadBack];
                over_lays_premultiplied_color_over: [Raster ReadBack];
                over_blends_floats: [Raster ReadBack];
                over_blends_srgb_as_light: [Raster ReadBack];
                over_takes_more_light_than_alpha: [Raster ReadBack];
                add_adds: [Raster ReadBack];
                add_of_bytes_ends_at_one: [Raster ReadBack];
                multiply_multiplies: [Raster ReadBack];
                min_takes_the_smaller: [Raster ReadBack];
                max_takes_the_larger: [Raster ReadBack];
                draws_of_a_pass_are_in_order: [Raster ReadBack];
                both_faces_are_drawn: [Raster ReadBack];
                counter_clockwise_is_the_front: [Raster ReadBack];
                color_is_kept: [Raster ReadBack];
                color_is_kept_across_lists: [Raster ReadBack];
                color_is_cleared_before_the_first_draw: [Raster ReadBack];
                targets_have_their_own_colors: [Raster ReadBack];
                targets_begin_each_in_its_own_way: [Raster ReadBack];
                no_vertices_and_no_instances_draw_nothing: [Raster ReadBack];
            }
            formats {
                new_textures_are_zero: [ReadBack];
                rgba8: [Raster ReadBack];
                rgba8_srgb: [Raster ReadBack];
                bgra8: [Raster ReadBack];
                bgra8_srgb: [Raster ReadBack];
                rgba16f: [Raster ReadBack];
                rgb10a2: [Raster ReadBack];
                r16f: [Raster ReadBack];
                rg16f: [Raster ReadBack];
                rg32f: [Raster ReadBack];
                r32f: [Raster ReadBack];
                r11g11b10f_is_drawn_to_or_refused: [Raster ReadBack];
                r32_uint_is_cleared_and_drawn: [Raster ReadBack];
                halves_round_to_the_nearest: [Raster ReadBack];
                every_format_is_copied_to_and_loaded: [Compute ReadBack];
                rgba16f_holds_more_than_one_and_less_than_nothing: [Raster ReadBack];
                depth32f: [Raster ReadBack];
                eight_bits_are_exact: [Raster ReadBack];
                what_is_loaded_is_linear_and_red_first: [Raster Compute ReadBack];
                rows_come_back_tight_whatever_the_width: [Raster ReadBack];
            }
            depth {
                nearer_passes_in_standard_order: [Raster ReadBack];
                nearer_passes_in_reverse_order: [Raster ReadBack];
                farther_is_hidden_in_standard_order: [Raster ReadBack];
                farther_is_hidden_in_reverse_order: [Raster ReadBack];
                equal_passes_in_standard_order: [Raster ReadBack];
                equal_passes_in_reverse_order: [Raster ReadBack];
                tested_alone_depth_stays: [Raster ReadBack];
                off_takes_the_last: [Raster ReadBack];
                depth_is_kept: [Raster ReadBack];
                depth_is_cleared: [Raster ReadBack];
                depth_alone_is_drawn: [Raster ReadBack];
            }
            scale {
                a_thousand_tiny_lists: [ReadBack];
                a_list_of_a_thousand_tiny_passes: [Compute ReadBack];
                a_thousand_buffers_live_at_once: [ReadBack];
                two_backends_do_not_know_of_each_other: [ReadBack];
                backends_run_on_two_threads_at_once: [ReadBack];
            }
            hair {
                tressfx_is_as_in_f64: [Compute ReadBack];
                a_strand_that_is_no_numbers_goes_to_rest: [Compute ReadBack];
                tangents_is_as_in_f64: [Compute ReadBack];
                a_second_is_as_in_f64: [Compute ReadBack];
                a_picture_is_as_in_f64_in_standard_order: [Compute Raster ReadBack];
                a_picture_is_as_in_f64_in_reverse_order: [Compute Raster ReadBack];
                a_picture_is_the_same_twice_to_the_bit: [Compute Raster ReadBack];
            }
        }
    };
}

macro_rules! table {
    ($($group:ident { $($case:ident: [$($need:ident)*];)* })*) => {
        /// All cases.
        pub const CASES: &[Case] = &[$($(Case {
            name: concat!(stringify!($group), "::", stringify!($case)),
            needs: &[$(Need::$need),*],
            run: $group::$case,
        },)*)*];
    };
}

each_case!(table);
