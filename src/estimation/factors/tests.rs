use super::*;

/// Rows that excite three parameters: a deterministic mixture.
fn row(k: usize) -> [f32; 3] {
    let wave = |period: usize| (k % period) as f32 / period as f32 - 0.5;
    [wave(7), wave(11), wave(5)]
}

fn folded(forgetting: f32, rows: usize) -> Factors<3> {
    let mut factors = Factors::independent(&[100.0; 3]);
    for k in 0..rows {
        let _ = factors.fold(&row(k), forgetting, 1.0 / forgetting);
    }
    factors
}

#[test]
fn all_of_the_covariance_at_once_has_the_same_bits() {
    for rows in [0, 3, 200] {
        let factors = folded(0.99, rows);
        let all = factors.covariances();
        for (i, row) in all.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert_eq!(entry.to_bits(), factors.covariance(i, j).to_bits());
            }
        }
    }
}

#[test]
fn covariance_is_the_inverse_of_the_information() {
    let factors = folded(1.0, 200);
    let mut information = [[0.0_f32; 3]; 3];
    for i in 0..3 {
        information[i][i] = 1e-4;
    }
    for k in 0..200 {
        let phi = row(k);
        for i in 0..3 {
            for j in 0..3 {
                information[i][j] += phi[i] * phi[j];
            }
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let product: f32 = (0..3)
                .map(|k| information[i][k] * factors.covariance(k, j))
                .sum();
            let unit = if i == j { 1.0 } else { 0.0 };
            assert!((product - unit).abs() < 1e-4, "{i} {j}: {product}");
        }
    }
}

#[test]
fn of_a_beginning_again_variances_are_left_and_what_is_known() {
    let mut factors = Factors::independent(&[2.0, 0.0, 10.0]);
    factors.fold(&[1.0, 2.0, -1.0], 0.99, 1.0 / 0.99);
    assert!(factors.covariance(0, 2) != 0.0);
    factors.begin_again(&[4.0, 9.0, 16.0]);
    assert_eq!(factors, Factors::independent(&[2.0, 0.0, 4.0]));
}

#[test]
fn a_covariance_grows_up_to_its_limits() {
    let before = Factors::independent(&[2.0, 3.0, 10.0]);
    let limit = [100.0, 20.0, 50.0];
    for (scale, exact) in [
        (5.0, [20.0, 20.0, 100.0]),
        (30.0, [100.0, 20.0, 100.0]),
        // What is beyond its limit shrinks like everything else.
        (0.5, [2.0, 4.5, 50.0]),
        (1.0, [4.0, 9.0, 100.0]),
    ] {
        let mut factors = before;
        factors.grow_within(scale, &limit);
        assert_eq!(*factors.diagonal(), exact, "{scale}");
    }
}

#[test]
fn widening_of_five_adds_to_the_last_variance_only() {
    let mut number = numbers(77);
    let mut before = Factors::<5>::independent(&[30.0; 5]);
    for _ in 0..40 {
        let phi: [f32; 5] = core::array::from_fn(|_| number());
        let _ = before.fold(&phi, 0.99, 1.0 / 0.99);
    }
    let mut after = before;
    after.inflate_last(3.0);
    for i in 0..5 {
        for j in 0..5 {
            let added = after.covariance(i, j) - before.covariance(i, j);
            let wanted = if (i, j) == (4, 4) { 3.0 } else { 0.0 };
            assert!((added - wanted).abs() < 1e-4, "{i} {j}: {added}");
        }
    }
}

#[test]
fn widening_adds_to_the_last_variance_only() {
    let before = folded(0.99, 100);
    let mut after = before;
    after.inflate_last(3.0);
    for i in 0..3 {
        for j in 0..3 {
            let added = after.covariance(i, j) - before.covariance(i, j);
            let wanted = if (i, j) == (2, 2) { 3.0 } else { 0.0 };
            assert!((added - wanted).abs() < 1e-5, "{i} {j}: {added}");
        }
    }
}

/// Numbers in -1..1, always the same.
fn numbers(mut seed: u32) -> impl FnMut() -> f32 {
    move || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 * (2.0 / 16_777_216.0) - 1.0
    }
}

/// P behind an observation of the row z with U'z = `f` and the variance `r`, by the textbook's
/// formula.
fn observed<const N: usize>(factors: &Factors<N>, f: &[f32; N], r: f32) -> [[f32; N]; N] {
    let pz: [f32; N] = core::array::from_fn(|l| {
        let terms = (0..N).map(|j| factors.upper[j][l] * factors.diagonal[j] * f[j]);
        terms.sum()
    });
    let spread: f32 = (0..N).map(|j| factors.diagonal[j] * f[j] * f[j]).sum();
    core::array::from_fn(|i| {
        core::array::from_fn(|j| factors.covariance(i, j) - pz[i] * pz[j] / (r + spread))
    })
}

fn agrees<const N: usize>(factors: &Factors<N>, wanted: &[[f32; N]; N], what: &str) {
    assert!(factors.diagonal.iter().all(|d| *d > 0.0), "{what}");
    for i in 0..N {
        for j in 0..N {
            let size = (wanted[i][i] * wanted[j][j]).sqrt();
            let error = factors.covariance(i, j) - wanted[i][j];
            assert!(
                error.abs() < 1e-4 * size,
                "{what}: {i} {j} {error} of {size}"
            );
        }
    }
}

fn both_parts<const N: usize>(seed: u32) {
    let mut number = numbers(seed);
    let mut factors = Factors::<N>::independent(&[30.0; N]);
    for _ in 0..seed % 50 {
        let phi: [f32; N] = core::array::from_fn(|_| 0.1 * number());
        let _ = factors.fold(&phi, 0.99, 1.0 / 0.99);
    }
    for index in 0..N {
        let whole: [f32; N] = core::array::from_fn(|j| factors.upper[j][index]);
        let mut first = whole;
        first[Factors::<N>::FIRST..].fill(0.0);
        let wanted = [first, whole].map(|f| observed(&factors, &f, 8.0));
        let (before, row) = factors.fold_unit(index, || 8.0, 0.0);
        agrees(&factors, &wanted[0], "first part");
        let (between, after) = (factors.covariance(index, index), wanted[1][index][index]);
        assert!(between <= 1.0001 * before && after <= 1.0001 * between);
        let row = factors.fold_unit_rest(index, row.unwrap());
        agrees(&factors, &wanted[1], "both parts");
        assert!((row.alpha / (8.0 + before) - 1.0).abs() < 1e-5);
    }
}

#[test]
fn each_part_of_a_unit_row_is_an_observation() {
    for seed in 220_100..220_300 {
        both_parts::<1>(seed);
        both_parts::<2>(seed);
        both_parts::<3>(seed);
        both_parts::<5>(seed);
        both_parts::<8>(seed);
    }
}

#[test]
fn an_observation_of_what_is_known_or_has_no_bound_says_nothing() {
    let before = folded(1.0, 50);
    for variance in [0.0, 1e-45, f32::INFINITY, f32::NAN] {
        for index in 0..3 {
            let mut factors = before;
            factors.observe(index, variance);
            assert_eq!(factors, before, "{variance}");
        }
    }
    // A parameter that is known stays so, whatever it is observed with.
    let mut known = Factors::independent(&[0.0, 2.0]);
    known.observe(0, 1e-3);
    known.observe(1, f32::MIN_POSITIVE);
    let numbers = [known.covariance(0, 0), known.covariance(0, 1)];
    assert_eq!(numbers, [0.0, 0.0]);
    assert!(known.covariance(1, 1).is_finite());
}

#[test]
fn the_spread_of_a_row_is_its_square_in_the_covariance() {
    let mut number = numbers(31);
    for rows in 0..60 {
        let factors = folded(0.97, rows);
        let z: [f32; 3] = core::array::from_fn(|_| number());
        let exact: f32 = (0..3)
            .flat_map(|i| (0..3).map(move |j| (i, j)))
            .map(|(i, j)| z[i] * factors.covariance(i, j) * z[j])
            .sum();
        let size: f32 = (0..3).map(|i| z[i] * z[i] * factors.covariance(i, i)).sum();
        assert!((factors.spread(z) - exact).abs() < 1e-4 * size, "{rows}");
    }
}

#[test]
fn squares_of_vectors_are_added_but_no_further_than_the_limit() {
    let before = folded(0.99, 100);
    let vectors = [[0.3, -0.1, 0.2], [0.0, 0.4, -0.5], [f32::NAN, 1.0, 1.0]];
    let mut after = before;
    after.widen(vectors.into_iter(), &[1e9; 3]);
    for i in 0..3 {
        for j in 0..3 {
            let square = |vector: [f32; 3]| vector[i] * vector[j];
            let wanted = square(vectors[0]) + square(vectors[1]);
            let added = after.covariance(i, j) - before.covariance(i, j);
            assert!((added - wanted).abs() < 1e-5, "{i} {j}: {added}");
        }
    }
    // However large, no factor exceeds the limit, or what it was.
    let limit = [1e-9, 2.0, 2.0];
    after = before;
    after.widen([[1e3, -2e3, 3e3]; 20].into_iter(), &limit);
    after.widen([[1e3, -2e3, 3e3]; 20].into_iter(), &limit);
    for ((d, before), limit) in after.diagonal().iter().zip(before.diagonal()).zip(limit) {
        assert!(*d <= before.max(limit) && *d >= *before);
    }
    // What is known stays known, whatever a vector says of it.
    let mut known = Factors::independent(&[1.0, 0.0, 2.0]);
    known.widen([[1.0; 3]].into_iter(), &[1e9; 3]);
    for (i, j, wanted) in [(1, 1, 0.0), (0, 0, 2.0), (0, 2, 1.0), (2, 2, 5.0)] {
        assert!((known.covariance(i, j) - wanted).abs() < 1e-6, "{i} {j}");
    }
}

#[test]
fn a_known_parameter_stays_known_when_the_last_one_is_widened() {
    let mut factors = Factors::independent(&[0.0, 0.0, 2.0]);
    factors.inflate_last(5.0);
    assert_eq!(factors, Factors::independent(&[0.0, 0.0, 3.0]));
    // Nothing known to nothing known.
    let mut nothing = Factors::independent(&[0.0; 3]);
    nothing.inflate_last(0.0);
    assert_eq!(nothing, Factors::independent(&[0.0; 3]));
}
