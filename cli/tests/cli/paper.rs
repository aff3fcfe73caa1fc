//! The tables and the figure of the paper.

use crate::common::{Scratch, json, stdout};
use serde_json::Value;

#[test]
fn each_helps_with_an_example() {
    for part in ["table1", "table2", "fig1"] {
        let text = stdout(&["paper", part, "--help"]);
        assert!(text.contains("Example") && text.contains("--csv"));
        assert!(text.contains(&format!("trendid paper {part}")), "{part}");
    }
}

#[test]
fn table1_has_a_line_for_every_condition_and_method() {
    let text = stdout(&[
        "paper",
        "table1",
        "--csv",
        "--seeds",
        "1",
        "--duration",
        "0.3",
    ]);
    let mut lines = text.lines();
    let head = "vary,w_um,eta_um,eps_um,dt_ms,reading,scheme,filter,estimator,duration_s,seeds,ns_pct,\
        rms_c_pct,rms_omega0_pct,rms_xi_pct,mean_c_pct,mean_omega0_pct,mean_xi_pct,med_c_pct,med_omega0_pct,med_xi_pct,\
        bound_c_pct,bound_omega0_pct,bound_xi_pct,paper_c_pct,paper_omega0_pct,paper_xi_pct,conv,\
        tss_med_ms,tss_p95_ms,diverged,weak";
    assert_eq!(lines.next(), Some(head));
    let rows: Vec<Vec<&str>> = lines.map(|l| l.split(',').collect()).collect();
    assert!(rows.iter().all(|r| r.len() == head.split(',').count()));
    for reading in ["absolute", "relative"] {
        for (vary, conditions) in [
            ("drift", 5),
            ("noise", 4),
            ("resolution", 5),
            ("sampling", 5),
            ("white", 4),
        ] {
            for scheme in ["goodwin", "tustin"] {
                for filter in ["none", "default", "ramp", "span", "exact"] {
                    let found = rows.iter().filter(|r| {
                        (r[0], r[5], r[6], r[7], r[8]) == (vary, reading, scheme, filter, "ls")
                    });
                    // Exact trends have no scheme of Goodwin's.
                    let expected = if (scheme, filter) == ("goodwin", "exact") {
                        0
                    } else {
                        conditions
                    };
                    assert_eq!(
                        found.count(),
                        expected,
                        "{vary} {reading} {scheme} {filter}"
                    );
                }
            }
            for opponent in ["ekf", "output-error", "instruments"] {
                let found = rows
                    .iter()
                    .filter(|r| (r[0], r[5], r[8]) == (vary, reading, opponent));
                assert_eq!(found.count(), conditions, "{vary} {reading} {opponent}");
            }
        }
    }
}

/// The shortest run of Table 1.
const FEW: [&str; 8] = [
    "paper",
    "table1",
    "--seeds",
    "1",
    "--duration",
    "0.3",
    "--vary",
    "white",
];

#[test]
fn table1_says_how_the_noise_is_defined() {
    for form in [&[][..], &["--check"]] {
        let text = stdout(&[&FEW[..], form].concat());
        for word in [
            "ABSOLUTE",
            "RELATIVE",
            "Cramer-Rao",
            "first time after which",
        ] {
            assert!(text.contains(word), "{word} is missing with {form:?}");
        }
    }
}

#[test]
fn the_brief_table_has_one_row_per_condition() {
    let text = stdout(&[&FEW[..], &["--brief"]].concat());
    let rows: Vec<&str> = text.lines().filter(|l| l.starts_with("| ")).collect();
    // Four widths in two readings, under a head.
    assert_eq!(rows.len(), 9, "{text}");
    for name in ["paper", "Kalman", "trendid", "offline", "bound"] {
        assert!(rows[0].contains(name), "{name} in {}", rows[0]);
    }
    for row in rows {
        let cells: Vec<&str> = row.split('|').collect();
        assert!(cells.len() == 9 && cells.iter().skip(1).take(7).all(|c| !c.trim().is_empty()));
    }
}

/// The row of modified Tustin behind the filter for a structure.
fn row(table: &Value, m: u64, parameters: u64) -> &Value {
    table["rows"]
        .as_array()
        .expect("rows")
        .iter()
        .find(|r| {
            r["m"] == m
                && r["M"] == parameters
                && r["scheme"] == "tustin"
                && r["filter"] == "filtered"
        })
        .expect("the structure")
}

#[test]
#[cfg_attr(not(feature = "thorough"), ignore = "seconds: cargo xtask host")]
fn table2_finds_the_structure_and_absent_terms_near_zero() {
    let table = json(&["paper", "table2", "--json", "--first-seed", "200000"]);
    let number = |v: &Value| v.as_f64().expect("a number");
    let iq = |m, parameters| number(&row(&table, m, parameters)["iq"]);
    // The order: a thousand times too much below, nothing to win above.
    assert!(iq(1, 2) > 1000.0 * iq(2, 3));
    assert!(iq(2, 4) > 0.98 * iq(2, 3) && iq(3, 5) > 0.98 * iq(2, 3));
    assert!(iq(3, 6) > 0.98 * iq(2, 3));
    // The noise alone gives 2 (10^2 + 10^2)/12 um^2 per sample.
    assert!((iq(2, 3) / 0.1 - 1.0).abs() < 0.05, "{}", iq(2, 3));
    let full = row(&table, 2, 4);
    assert!(number(&full["median"]["b1"]).abs() < 2e-5, "{full}");
    for (name, truth, percent) in [("a1", 20.0, 0.05), ("a0", 400.0, 0.05), ("b0", 1.0, 0.05)] {
        let found = number(&full["median"][name]);
        assert!(
            (found / truth - 1.0).abs() < 1e-2 * percent,
            "{name} {found}"
        );
    }
    // m = 3: a common factor (s + c) is free, and a1 = 20 + a0 of the factor shows it: the servo is
    // in the product.
    let third = &row(&table, 3, 6)["median"];
    let [a3, a1, a0] = ["a3", "a1", "a0"].map(|n| number(&third[n]));
    assert!(number(&third["b2"]).abs() < 1e-6, "{third}");
    let c = 1.0 / a3 - 20.0;
    assert!((a1 / a3 - (400.0 + 20.0 * c)).abs() < 8.0, "{third}");
    assert!((a0 / a3 - 400.0 * c).abs() < 200.0, "{third}");
}

#[test]
fn fig1_draws_and_settles() {
    let dir = Scratch::new("fig1");
    let out = dir.path("pictures");
    let text = stdout(&["paper", "fig1", "--plot", &out]);
    assert!(text.contains("within 5 %"));
    let svg = std::fs::read_to_string(format!("{out}/fig1.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("a1 / 400"));
    let curves = json(&["paper", "fig1", "--json"]);
    let settled = curves["settled_ms"].as_f64().expect("settled");
    assert!(settled < 150.0, "{settled} ms");
}

#[test]
fn the_picture_of_table1_is_written() {
    let dir = Scratch::new("table1");
    let out = dir.path("pictures");
    let few = [
        "paper", "table1", "--seeds", "2", "--vary", "white", "--plot", &out,
    ];
    let _ = stdout(&few);
    let svg = std::fs::read_to_string(format!("{out}/table1.svg")).unwrap();
    for name in ["paper", "Kalman", "output-error", "trendid", "Cramer-Rao"] {
        assert!(svg.contains(name), "{name}");
    }
}
