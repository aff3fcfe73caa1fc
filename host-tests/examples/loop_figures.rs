//! Figures of the adaptive position loop per scenario: `loop_figures [SCENARIO|all] [--seeds N] [--first N] [--fixed] [--linear]`.

use trendid_host_tests::scenario::{Figures, Options, Scenario, run};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let flag = |name: &str| arguments.iter().any(|a| a == name);
    let number = |name: &str, default: u64| {
        arguments
            .iter()
            .position(|a| a == name)
            .and_then(|i| arguments.get(i + 1)?.parse().ok())
            .unwrap_or(default)
    };
    let (seeds, first) = (number("--seeds", 20), number("--first", 1));
    let named: Vec<Scenario> = arguments
        .iter()
        .filter_map(|a| Scenario::from_name(a))
        .collect();
    let chosen = if named.is_empty() {
        Scenario::ALL.to_vec()
    } else {
        named
    };
    for scenario in chosen {
        println!("{}: {}", scenario.name(), scenario.description());
        let rows: Vec<Figures> = (first..first + seeds)
            .map(|seed| {
                let options = Options {
                    fixed: flag("--fixed"),
                    linear: flag("--linear"),
                    seed,
                };
                run(scenario, &options, &mut |_, _| {})
            })
            .collect();
        if flag("--rows") {
            for row in &rows {
                println!("{row:?}");
            }
        }
        summary("verified s", &rows, |f| f.verified_at_s);
        summary("steady mm", &rows, |f| f.steady_state_mm);
        summary("rise ms", &rows, |f| f.rise_ms);
        summary("overshoot %", &rows, |f| f.overshoot_pct);
        summary("0.5 Hz mm", &rows, |f| f.tracking_0p5hz_mm);
        summary("1 Hz mm", &rows, |f| f.tracking_1hz_mm);
        summary("recovered s", &rows, |f| f.recovered_s);
        summary("rest mm", &rows, |f| f.rest_range_mm);
        let kept = rows.iter().filter(|f| f.gains_kept == Some(true)).count();
        println!("  gains kept {kept} of {}", rows.len());
        for row in &rows {
            print!(" [{}]", row.state);
        }
        println!();
    }
}

fn summary(name: &str, rows: &[Figures], figure: impl Fn(&Figures) -> Option<f64>) {
    let mut values: Vec<f64> = rows.iter().filter_map(figure).collect();
    values.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (values.first(), values.last()) else {
        return;
    };
    println!(
        "  {name:12} min {least:8.4} median {:8.4} max {most:8.4}  ({} of {} runs)",
        values[values.len() / 2],
        values.len(),
        rows.len()
    );
}
