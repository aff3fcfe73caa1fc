//! What the windows of an evidence add up to.

use super::*;

#[test]
fn earlier_windows_count_with_eight_tenths() {
    let mut evidence = Evidence::NONE;
    for bank in [POOR, GOOD, LOAD] {
        evidence.add(&alone(bank));
    }
    for (k, sum) in evidence.sums.iter().enumerate() {
        let exact = 0.8 * (0.8 * POOR[k] + GOOD[k]) + LOAD[k];
        assert!((sum - exact).abs() < 1e-5, "{k}: {sum}, not {exact}");
    }
    assert!((evidence.moved - 2.44).abs() < 1e-6);
    evidence.forget();
    assert_eq!(evidence, Evidence::NONE);
}

#[test]
fn a_part_of_a_window_counts_and_forgets_by_its_weight() {
    // Four quarters that show the same are one window, but for what the first ones forget.
    let mut evidence = Evidence::NONE;
    evidence.add(&alone(GOOD));
    let quarter = WindowSums {
        weight: 0.25,
        ..alone(POOR)
    };
    for _ in 0..4 {
        evidence.add(&quarter);
    }
    let kept = [0.95 * 0.95 * 0.95, 0.95 * 0.95, 0.95, 1.0];
    let parts: f32 = kept.iter().map(|kept| 0.25 * kept).sum();
    let whole = 0.95 * kept[0];
    for (k, sum) in evidence.sums.iter().enumerate() {
        let exact = whole * GOOD[k] + parts * POOR[k];
        assert!((sum - exact).abs() < 1e-5, "{k}: {sum}, not {exact}");
    }
    assert!((evidence.moved - whole - parts).abs() < 1e-5);
}

#[test]
fn a_challenger_wins_by_as_many_parts_as_make_its_windows() -> Result<(), Error> {
    let design = design()?;
    for (weight, parts) in [(1.0, 2), (0.5, 4), (0.25, 8), (0.125, 16)] {
        let mut evidence = Evidence::NONE;
        evidence.propose(&estimate(2.0));
        let part = WindowSums {
            weight,
            ..window(POOR, 0.01)
        };
        for k in 1..=parts {
            let found = after(&mut evidence, &design, &part);
            let won = found.is_ok_and(|winner| winner.is_some());
            assert_eq!(won, k == parts, "{weight}: part {k}");
        }
    }
    Ok(())
}

#[test]
fn a_share_of_the_windows_is_that_of_the_errors_in_errors_and_motion() {
    let window = WindowSums {
        bank: [
            0.0,
            25.0,
            100.0,
            300.0,
            1e9,
            f32::INFINITY,
            f32::NAN,
            0.0,
            0.0,
        ],
        challenger: Some(100.0),
        moved: 100.0,
        weight: 1.0,
    };
    let shares = window.shares();
    for (share, exact) in shares.bank.iter().zip([0.0, 0.2, 0.5, 0.75, 1.0, 1.0, 1.0]) {
        assert!((share - exact).abs() < 1e-6, "{share}, not {exact}");
    }
    assert_eq!((shares.challenger, shares.moved), (Some(0.5), 1.0));
}

#[test]
fn the_windows_of_a_challenger_are_added_up_without_those_before_it() {
    let mut evidence = Evidence::NONE;
    evidence.add(&alone(POOR));
    evidence.propose(&estimate(2.0));
    // One in which it did not run is none of its own.
    evidence.add(&alone(POOR));
    evidence.add(&window(GOOD, 0.25));
    evidence.add(&window(LOAD, 0.5));
    let Some(challenger) = evidence.challenger else {
        panic!("there is none");
    };
    assert_eq!(challenger.moved, 2.0);
    assert!((challenger.own - 0.75).abs() < 1e-6);
    for (k, sum) in challenger.bank.iter().enumerate() {
        assert!((sum - GOOD[k] - LOAD[k]).abs() < 1e-6, "{k}: {sum}");
    }
}

#[test]
fn a_lighter_load_after_a_heavier_one_has_to_win_more_windows() -> Result<(), Error> {
    let design = design()?;
    let won_after = |evidence: &mut Evidence, load: f32| {
        evidence.forget();
        evidence.propose(&estimate(load));
        let poor = window(POOR, 0.01);
        for windows in 1..20 {
            if let Ok(Some((model, _))) = after(evidence, &design, &poor) {
                evidence.replaced(&USED, &model);
                return Some(windows);
            }
        }
        None
    };
    let mut evidence = Evidence::NONE;
    // None came before; what is not much lighter is no other load.
    assert_eq!(won_after(&mut evidence, 2.0), Some(2));
    assert_eq!(won_after(&mut evidence, 0.5), Some(2));
    assert_eq!(won_after(&mut evidence, 1.19), Some(2));
    assert_eq!(won_after(&mut evidence, 2.0), Some(6));
    // After a lighter one they are alike again.
    assert_eq!(won_after(&mut evidence, 2.0), Some(2));
    Ok(())
}
