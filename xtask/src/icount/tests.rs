//! Growth and limits of the counts.

use super::*;

fn row(mean: f64, worst: f64) -> Row {
    Row {
        row: "r".into(),
        n: 3,
        mean,
        worst,
        text: 0,
        ram: 0,
        stack: 0,
        opt: "3".into(),
    }
}

#[test]
fn growth_and_missing_rows_fail() {
    assert!(compare(&[row(100.0, 100.0)], &[row(102.0, 102.0)]).is_ok());
    assert!(compare(&[row(100.0, 100.0)], &[row(50.0, 50.0)]).is_ok());
    assert!(compare(&[row(100.0, 100.0)], &[row(102.1, 100.0)]).is_err());
    assert!(compare(&[row(100.0, 100.0)], &[row(100.0, 103.0)]).is_err());
    assert!(compare(&[row(100.0, 100.0)], &[]).is_err());
}

#[test]
fn limits_of_rows_and_of_what_the_bound_costs() {
    let named = |name: &str, n: u32, mean: f64, worst: f64| Row {
        row: name.into(),
        n,
        ..row(mean, worst)
    };
    let mut rows: Vec<_> = LIMITS
        .map(|(name, n, [mean, worst])| named(name, n, mean.min(1.0), worst))
        .into();
    for (n, full) in FULL_MATRIX {
        rows.push(named("bare estimator", n, full / 2.1, full));
        rows.push(named("bare, bounded at rest", n, full, 1.5 * full));
    }
    assert_eq!(within(&rows), Ok(()));
    for index in 0..rows.len() {
        let changed = |mean: f64, worst: f64| {
            let mut rows = rows.clone();
            rows[index].mean *= mean;
            rows[index].worst *= worst;
            within(&rows)
        };
        // Beside its own limits, a recursion without a bound that is cheaper makes the other
        // one dear.
        let faults = match rows[index].row.as_str() {
            "bare estimator" => vec![changed(0.99, 1.0)],
            "bare, bounded at rest" => vec![changed(1.01, 1.0), changed(1.0, 1.01)],
            _ => vec![changed(1.0, 1.01)],
        };
        assert!(faults.iter().all(Result::is_err), "{:?}", rows[index]);
        let mut fewer = rows.clone();
        fewer.remove(index);
        assert!(within(&fewer).is_err());
    }
}
