"""The cases that every release passes, with the tests of each. A test checks that these exist."""

from __future__ import annotations

from pathlib import Path

BAD_INPUT = "tests/python_api/test_bad_input.py"
STOPPED = "tests/python_api/test_stopped_runs.py"
SOLUTION = "tests/python_api/test_solution.py"
EVENT_CLASSES = "tests/events/test_event_classes.py"
ROUND_TRIPS = "tests/effects/test_effect_round_trips.py"
SIMULATE = "tests/python_api/test_simulate.py"
HARD = "tests/methods/test_hard_cases.py"
STICK = "tests/switching/test_stick.py"
SLIP = "tests/switching/test_stick_slip.py"
JOINTS = "tests/switching/test_stuck_joints.py"
BOUNCES = "tests/switching/test_bounces.py"
BOUNCING = "tests/switching/test_bounces_of_chains.py"
CONTACT = "tests/switching/test_contact.py"
IMPACTS = "tests/switching/test_impacts.py"
EVENTS = "tests/events/test_events.py"
FORCES = "tests/methods/test_hard_forces.py"
CHAINS = "tests/switching/test_chains_in_contact.py"
COUNTS = "tests/methods/test_counts.py"
AT_ONCE = "tests/switching/test_laws_that_meet.py"
LONG = "tests/core/test_long_runs.py"

LISTED: dict[str, tuple[str, ...]] = {
    "an interval of no length, and of 100 units in the last place": (
        f"{SIMULATE}::test_a_run_of_no_length_is_its_start",
        f"{HARD}::test_a_span_of_a_few_units_in_the_last_place_ends_where_it_should",
    ),
    "t0 so large that t + h = t": (
        f"{HARD}::test_where_time_is_coarser_than_the_motion_no_step_is_taken",
    ),
    "backward is the mirror of forward; there and back": (
        "tests/core/test_symmetries.py::"
        "test_without_losses_the_past_is_the_future_of_the_reversed_start",
        "tests/core/test_symmetries.py::test_there_and_back_is_where_it_began",
    ),
    "at rest in both equilibria; upright, with the time of the fall": (
        "tests/core/test_exact_answers.py::test_hanging_at_rest_it_stays",
        f"{HARD}::test_upright_falls_when_theory_says",
    ),
    "at rest with all links horizontal": (
        f"{HARD}::test_all_links_horizontal_at_rest_begins_to_fall_at_once",
    ),
    "a start that is not finite": (
        f"{BAD_INPUT}::test_a_start_that_is_not_finite_is_named_with_its_place",
    ),
    "not a number in mid-run": (
        f"{FORCES}::test_what_is_no_number_beyond_a_time_or_an_angle_ends_there",
        f"{STOPPED}::test_a_run_that_is_not_finite_says_which_rate_and_whose_force",
    ),
    "blow-up in finite time": (f"{FORCES}::test_a_blow_up_ends_at_its_pole",),
    "tolerances of 1e30, and below eps; atol 0 with a zero component": (
        f"{HARD}::test_absurd_tolerances_end_in_a_solution",
        f"{HARD}::test_tolerances_beyond_measure_end_as_the_status_says",
        f"{HARD}::test_no_absolute_tolerance_with_components_that_stay_zero",
    ),
    "ratios of mass and length of 1e+-12; a payload of 1e6 links": (
        f"{FORCES}::test_extreme_ratios_of_mass_keep_energy_and_motion",
        f"{FORCES}::test_two_rods_of_which_one_is_next_to_a_point_swing_as_one",
        f"{FORCES}::test_a_payload_of_a_million_links_swings_as_a_pendulum_on_a_string",
    ),
    "a spin of 1e6 rad/s; angles of 1e8 rad; denormal states": (
        f"{HARD}::test_a_spin_of_a_million_keeps_its_energy_and_momentum",
        f"{HARD}::test_angles_of_a_hundred_million_turn_as_small_ones_do",
        f"{HARD}::test_denormal_rates_are_not_lost",
    ),
    "no gravity; units of microns and of astronomy": (
        "tests/core/test_exact_answers.py::test_without_gravity_energy_and_angular_momentum_stay",
        f"{HARD}::test_the_units_do_not_matter",
    ),
    "stiff damping and a stiff PD: bounded work, flagged": (
        "tests/methods/test_stiff.py::test_a_damper_is_found_stiff_and_the_remedy_named",
        "tests/methods/test_stiff.py::test_what_cannot_turn_moves_as_if_it_were_locked",
    ),
    "a shaken pivot at the border of stability": (
        "tests/core/test_kapitza.py::test_the_border_of_stability_is_where_floquet_says",
    ),
    "dry friction that holds a rod for 1e6 s": (
        f"{STICK}::test_a_rod_held_at_30_degrees_under_a_hum_moves_by_nothing_in_1e6_s",
    ),
    "stick and slip under drive, in one joint and in several": (
        f"{SLIP}::test_under_a_sinusoidal_torque_each_slide_begins_and_ends_when_it_should",
        f"{SLIP}::test_stick_and_slip_of_a_rod_that_a_spring_tows_slowly",
        f"{JOINTS}::test_what_sticks_is_what_is_free_of_contradiction",
        f"{CHAINS}::test_sticking_sliding_and_lasting_contact_follow_the_solution_mode_by_mode",
    ),
    "accumulating bounces, of one rod and of chains": (
        f"{BOUNCES}::test_accumulating_bounces_end_when_the_series_says",
        f"{BOUNCING}::test_bounces_of_chains_are_all_there_down_to_the_capture_speed",
        f"{BOUNCING}::test_bounces_of_chains_end_when_the_series_says",
        f"{BOUNCING}::test_chains_that_have_bounced_lean_and_are_let_go_as_bounce_by_bounce",
    ),
    "impacts on chains, several stops at once": (
        f"{IMPACTS}::test_an_impact_turns_the_joint_and_jerks_the_others_as_the_law_says",
        f"{IMPACTS}::test_stops_hit_at_once_share_the_impulse_by_complementarity",
    ),
    "impacts that alternate ever faster between two stops, to the end": (
        f"{IMPACTS}::test_a_run_through_a_corner_ends_where_its_impacts_lead",
    ),
    "a stop that is never reached": (
        f"{CONTACT}::test_a_stop_that_is_never_reached_changes_no_bit",
    ),
    "lasting contact in chains, beside stick": (
        f"{CHAINS}::test_sticking_sliding_and_lasting_contact_follow_the_solution_mode_by_mode",
    ),
    "bounces over 1e4 s, crossings over 5000 s": (
        f"{COUNTS}::test_over_ten_thousand_seconds_no_bounce_is_missed_and_nothing_gets_through",
        f"{COUNTS}::test_over_five_thousand_seconds_every_crossing_is_found_once",
    ),
    "pulses that are narrower than the steps, also onto what is stuck": (
        f"{FORCES}::test_a_narrow_pulse_of_a_table_gives_a_turning_rod_its_impulse",
        f"{FORCES}::test_a_narrow_pulse_of_a_table_knocks_a_stuck_rod_as_far_as_friction_lets_it",
    ),
    "laws that change at one time, in steps too coarse to tell": (
        f"{AT_ONCE}::test_friction_stops_a_rod_with_quadratic_damping",
        f"{CHAINS}::test_laws_that_meet_lead_on",
    ),
    "spans of a few units in the last place, time scales from 1e-100 s to 1e100 s": (
        f"{HARD}::test_a_span_of_a_few_units_in_the_last_place_ends_where_it_should",
        f"{HARD}::test_an_oscillation_of_any_frequency_is_followed_over_ten_radians",
    ),
    "grazing contact": (
        f"{CONTACT}::test_a_grazing_stop_is_hit_if_and_only_if_the_swing_reaches_it",
    ),
    "two event roots in one step; an event at t0, at t_end, at a step's end": (
        f"{EVENTS}::test_both_passages_of_a_mark_just_short_of_the_turn_are_found_in_every_swing",
        f"{EVENTS}::test_a_mark_at_the_start_is_no_event_and_one_at_the_end_is_one",
        f"{EVENTS}::test_roots_in_one_step_or_at_its_ends_are_found_once_each",
    ),
    "a chain of 1000 links": (f"{FORCES}::test_a_chain_of_a_thousand_links_keeps_its_energy",),
    "swings next to the separatrix": (
        f"{HARD}::test_a_swing_next_to_the_separatrix_takes_the_time_of_the_elliptic_integral",
    ),
    "long energy drift": (
        f"{LONG}::test_over_half_a_million_steps_the_energy_keeps_to_the_methods_own_error",
        f"{LONG}::test_roundings_that_are_carried_on_walk_a_hundred_times_less_far",
        f"{HARD}::test_energy_drifts_with_the_tolerance_alone",
    ),
    "inputs that are read-only, strided, of the wrong shape or type": (
        f"{SIMULATE}::test_the_same_start_in_any_form_gives_the_same_bits",
        f"{BAD_INPUT}::test_a_start_of_the_wrong_shape_is_refused_with_the_right_one",
        f"{BAD_INPUT}::test_what_is_no_real_number_is_refused",
    ),
    "Ctrl-C within 0.1 s": (f"{HARD}::test_ctrl_c_is_heard_within_a_tenth_of_a_second",),
    "threads that share a scene; a fork": (
        "tests/core/test_threads.py::"
        "test_threads_on_one_scene_and_one_solution_compute_what_one_alone_does",
        "tests/effects/test_own_effects.py::test_threads_share_a_scene_with_a_function",
        f"{HARD}::test_a_fork_may_simulate_too",
    ),
    "pickling of everything": (
        f"{SOLUTION}::test_a_solution_comes_back_whole",
        f"{SOLUTION}::test_what_a_solution_and_a_scene_tell_comes_back_from_pickle",
        f"{EVENT_CLASSES}::test_an_event_comes_back_from_its_repr_pickle_copy_and_toml",
        "tests/core/test_energy.py::test_a_run_with_a_ledger_comes_back_whole",
        f"{ROUND_TRIPS}::test_an_effect_comes_back_from_its_repr_and_from_pickle",
        f"{ROUND_TRIPS}::test_a_scene_comes_back_from_its_repr_and_from_pickle",
    ),
}


def missing(root: Path) -> list[str]:
    """List the tests that are not where the list says."""
    found = []
    for tests in LISTED.values():
        for test in tests:
            file, _, name = test.partition("::")
            path = root / file
            if not path.exists() or f"def {name}(" not in path.read_text(encoding="utf-8"):
                found.append(test)
    return found
