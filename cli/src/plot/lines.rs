//! Drawing of a curve: ranges, ticks, bands and lines cut at the axes.

use std::ops::Range;

/// More points than the picture has pixels only make the file heavy.
const MAX_POINTS: usize = 2_000;

/// The range of the finite values, widened by `margin` of itself on both sides.
pub(super) fn extent(values: impl Iterator<Item = f64>, margin: f64) -> Range<f64> {
    let (lo, hi) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
            (lo.min(v), hi.max(v))
        });
    if lo > hi {
        return 0.0..1.0;
    }
    let pad = if hi > lo {
        margin * (hi - lo)
    } else {
        0.5 * hi.abs().max(1e-12)
    };
    (lo - pad)..(hi + pad)
}

/// A tick label with as many decimals as the range needs.
pub(super) fn tick(v: f64, range: &Range<f64>) -> String {
    let span = range.end - range.start;
    let largest = range.start.abs().max(range.end.abs());
    if !(1e-3..1e5).contains(&largest) {
        return format!("{v:.1e}");
    }
    let decimals = (1 - span.log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{v:.decimals$}");
    // Rounding must not leave a negative zero on the axis.
    if text
        .trim_start_matches('-')
        .bytes()
        .all(|b| b == b'0' || b == b'.')
    {
        text.replace('-', "")
    } else {
        text
    }
}

/// Outlines of the finite stretches of a band, cut at the axes, with at most
/// [`MAX_POINTS`] points to each edge.
pub(super) fn outline(
    points: &[(f64, f64)],
    band: &[(f64, f64)],
    range: &Range<f64>,
) -> Vec<Vec<(f64, f64)>> {
    let step = points.len().div_ceil(MAX_POINTS).max(1);
    let edges: Vec<(f64, f64, f64)> = points
        .iter()
        .zip(band)
        .step_by(step)
        .map(|(p, b)| (p.0, b.0, b.1))
        .collect();
    edges
        .split(|e| !(e.1.is_finite() && e.2.is_finite()))
        .filter(|run| run.len() > 1)
        .map(|run| {
            let cut = |v: f64| v.clamp(range.start, range.end);
            let upper = run.iter().map(|e| (e.0, cut(e.2)));
            upper
                .chain(run.iter().rev().map(|e| (e.0, cut(e.1))))
                .collect()
        })
        .collect()
}

/// The curve with each long run of points replaced by its lowest and highest,
/// in their order, so that no peak is lost.
pub(super) fn envelope(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let chunk = (2 * points.len()).div_ceil(MAX_POINTS).max(1);
    if chunk <= 2 {
        return points.to_vec();
    }
    points
        .chunks(chunk)
        .flat_map(|c| {
            let by = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
            let (lo, hi) = (c.iter().min_by(by), c.iter().max_by(by));
            match (lo, hi) {
                (Some(&lo), Some(&hi)) if lo.0 <= hi.0 => [lo, hi],
                (Some(&lo), Some(&hi)) => [hi, lo],
                _ => [c[0], c[0]],
            }
        })
        .collect()
}

/// The parts of a polyline inside `range`, cut where it crosses the bounds.
pub(super) fn inside(points: &[(f64, f64)], range: &Range<f64>) -> Vec<Vec<(f64, f64)>> {
    let mut runs: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    let within = |v: f64| v >= range.start && v <= range.end;
    let cut = |a: (f64, f64), b: (f64, f64)| {
        let bound = if a.1 > range.end || b.1 > range.end {
            range.end
        } else {
            range.start
        };
        (a.0 + (b.0 - a.0) * (bound - a.1) / (b.1 - a.1), bound)
    };
    let mut previous: Option<(f64, f64)> = None;
    for &p in points {
        if !p.1.is_finite() {
            runs.push(Vec::new());
            previous = None;
            continue;
        }
        let inside_now = within(p.1);
        if let Some(last) = previous {
            match (within(last.1), inside_now) {
                (true, false) => {
                    let edge = cut(last, p);
                    if let Some(run) = runs.last_mut() {
                        run.push(edge);
                    }
                    runs.push(Vec::new());
                }
                (false, true) => runs.push(vec![cut(last, p)]),
                _ => {}
            }
        }
        if inside_now && let Some(run) = runs.last_mut() {
            run.push(p);
        }
        previous = Some(p);
    }
    runs.retain(|r| r.len() > 1);
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_axes() {
        let runs = inside(&[(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)], &(-1.0..1.0));
        assert_eq!(
            runs,
            [vec![(0.0, 0.0), (0.5, 1.0)], vec![(1.5, 1.0), (2.0, 0.0)]]
        );
        assert_eq!(
            inside(
                &[(0.0, 0.0), (1.0, f64::NAN), (2.0, 0.0), (3.0, 0.0)],
                &(-1.0..1.0)
            )
            .len(),
            1
        );
    }

    #[test]
    fn thinning_keeps_the_peaks() {
        let mut points: Vec<_> = (0..30_000).map(|k| (f64::from(k), 0.0)).collect();
        points[12_345].1 = 7.0;
        points[20_001].1 = -3.0;
        let thin = envelope(&points);
        assert!(thin.len() <= MAX_POINTS + 2);
        assert!(thin.contains(&(12_345.0, 7.0)) && thin.contains(&(20_001.0, -3.0)));
    }
}
