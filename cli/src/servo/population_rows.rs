//! The figures of `trendid loop --population`: keys of JSON, titles of the table.

use trendid_host_tests::servo::population::summary::{
    CommissioningFigures, ControllerFigures, Summary,
};

/// The controllers side by side: name in JSON (none for the top level), title, figures.
pub(super) type Column<'a> = (Option<&'static str>, &'static str, &'a ControllerFigures);

pub(super) fn columns(summary: &Summary) -> [Column<'_>; 4] {
    [
        (None, "loop", &summary.adaptive),
        (Some("fixed_gains"), "fixed gains", &summary.fixed),
        (Some("baseline"), "searched gains", &summary.practitioner),
        (
            Some("baseline_same_axes"),
            "searched, same axes",
            &summary.practitioner_same,
        ),
    ]
}

/// A figure: key, unit, title, value.
pub(super) type Row<F> = (&'static str, &'static str, &'static str, fn(&F) -> f64);

/// Figures of a controller.
pub(super) const ROWS: [Row<ControllerFigures>; 11] = [
    ("end_stop_pct", "%", "strikes an end stop", |c| {
        c.end_stops.struck_pct
    }),
    ("end_stop_max_mm_s", "mm/s", "hardest blow", |c| {
        c.end_stops.hardest_mm_s
    }),
    ("given_up_pct", "%", "gives up in control", |c| {
        c.motion.given_up_pct
    }),
    ("limit_cycle_pct", "%", "cycles at rest", |c| {
        c.motion.limit_cycle_pct
    }),
    ("undetected_cycle_pct", "%", "cycles unnoticed", |c| {
        c.motion.undetected_cycle_pct
    }),
    (
        "steady_state_median_mm",
        "mm",
        "steady state, median",
        |c| c.motion.steady_state_median_mm,
    ),
    ("steady_state_p90_mm", "mm", "steady state, 90 %", |c| {
        c.motion.steady_state_p90_mm
    }),
    (
        "small_step_median_mm",
        "mm",
        "excursion of a step of 0.05 mm, median",
        |c| c.motion.small_step_median_mm,
    ),
    (
        "wear_median",
        "u",
        "change of the command per sample, rms, median",
        |c| c.motion.wear_median,
    ),
    (
        "sine_no_worse_pct",
        "%",
        "large sines no worse than searched gains",
        |c| c.motion.sine_no_worse_pct,
    ),
    (
        "small_sine_no_worse_pct",
        "%",
        "small sines no worse than searched gains",
        |c| c.motion.small_sine_no_worse_pct,
    ),
];

/// Figures of the commissioning.
pub(super) const COMMISSIONING: [Row<CommissioningFigures>; 13] = [
    ("accepted_pct", "%", "accepted within 3 s", |c| {
        c.accepted_pct
    }),
    ("accepted_6s_pct", "%", "accepted within 6 s", |c| {
        c.accepted_6s_pct
    }),
    (
        "verified_median_s",
        "s",
        "time to acceptance, median",
        |c| c.verified_median_s,
    ),
    ("verified_p95_s", "s", "time to acceptance, 95 %", |c| {
        c.verified_p95_s
    }),
    (
        "wrong_reason_pct",
        "%",
        "refused for a fault that is none",
        |c| c.wrong_reason_pct,
    ),
    ("wrong_sign_pct", "%", "accepted with the wrong sign", |c| {
        c.wrong_sign_pct
    }),
    (
        "w0_within_10pct",
        "% of accepted",
        "natural frequency within 10 %",
        |c| c.w0_within_10pct,
    ),
    (
        "c_within_20pct",
        "% of accepted",
        "velocity gain within 20 %",
        |c| c.c_within_20pct,
    ),
    (
        "grossly_wrong_pct",
        "% of accepted",
        "one of both wrong by more than 50 %",
        |c| c.grossly_wrong_pct,
    ),
    ("dead_zone_p90", "u", "error of the dead zone, 90 %", |c| {
        c.dead_zone_p90
    }),
    ("offset_p90", "u", "error of the offset, 90 %", |c| {
        c.offset_p90
    }),
    ("delay_p90_ms", "ms", "error of the delay, 90 %", |c| {
        c.delay_p90_ms
    }),
    (
        "commissioning_struck_pct",
        "%",
        "strikes an end stop",
        |c| c.struck_pct,
    ),
];
