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
    assert!((evidence.seen - 2.44).abs() < 1e-6);
    evidence.forget();
    assert_eq!(evidence, Evidence::NONE);
}

#[test]
fn errors_that_are_hidden_count_for_and_against_no_model() -> Result<(), Error> {
    let design = design()?;
    // Whatever hides the errors of the model in use hides those of the load that would win.
    let bank = LOAD;
    let used = of_share(bank[bank::USED]);
    for (hidden, wins) in [(0.0, true), (0.1 * used, true), (used, false)] {
        let slow = Sums {
            hidden,
            ..window(bank, 0.0)
        };
        let mut evidence = Evidence::NONE;
        let won = (0..100).any(|_| matches!(after(&mut evidence, &design, &slow), Ok(Some(_))));
        assert_eq!(won, wins, "{hidden}");
    }
    Ok(())
}

#[test]
fn a_share_of_the_windows_is_that_of_the_errors_in_errors_and_motion() {
    let window = Sums {
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
        hidden: 0.0,
    };
    let shares = window.shares();
    for (share, exact) in shares.bank.iter().zip([0.0, 0.2, 0.5, 0.75, 1.0, 1.0, 1.0]) {
        assert!((share - exact).abs() < 1e-6, "{share}, not {exact}");
    }
    assert_eq!(shares.challenger, Some(0.5));
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
    assert_eq!(challenger.seen, 2.0);
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
