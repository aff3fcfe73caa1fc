//! Trends as nested differences and means of neighbouring samples (equations 4 and 8).

/// How the derivative becomes a difference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Scheme {
    /// Goodwin's delta operator `(q-1)/Delta`, equation (4). What it finds is off by the order of
    /// omega Delta, which is in the standard deviations, but for a light damping, of which more is.
    Goodwin,
    /// The modified Tustin transformation, equation (8).
    #[default]
    Tustin,
}

/// The trends of one signal: orders 0..m-1 and the highest order m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trends<const M: usize> {
    /// Orders 0 to m-1.
    pub lower: [f32; M],
    /// Order m, the left-hand side of (5).
    pub top: f32,
}

/// Applies `(1+q^-1)/2` `times` times to the newest sample and the M before it.
#[inline(always)]
fn average<const M: usize>(mut newest: f32, mut past: [f32; M], times: usize) -> f32 {
    for t in 0..times {
        newest = 0.5 * (newest + past[0]);
        for j in 0..M.saturating_sub(t + 1) {
            past[j] = 0.5 * (past[j] + past[j + 1]);
        }
    }
    newest
}

/// Trends of (8) over `newest` and the `order` samples before it, divided by `(2 Delta)^order`.
///
/// `lower[i] = ((1-q^-1)/Delta)^i ((1+q^-1)/2)^(order-i)`, by nested differences:
/// neighbouring samples are subtracted first, which is exact in f32 where the
/// products with a kernel 1, -3, 3, -1 would round.
#[inline(always)]
pub(crate) fn tustin<const M: usize>(
    newest: f32,
    past: &[f32; M],
    order: usize,
    rate: f32,
) -> Trends<M> {
    let mut trends = Trends {
        lower: [0.0; M],
        top: 0.0,
    };
    let mut head = newest;
    let mut tail = *past;
    for i in 0..M {
        if i > order {
            break;
        }
        trends.lower[i] = average(head, tail, order - i);
        difference(&mut head, &mut tail, i, rate);
    }
    // With order = M the loop leaves the highest difference in `head`.
    trends.top = head;
    trends
}

/// Trends of (4) over the M past samples, divided by `Delta^M`.
///
/// `lower[i] = ((1-q^-1)/Delta)^i q^-(M-i)`.
#[inline(always)]
pub(crate) fn goodwin<const M: usize>(newest: f32, past: &[f32; M], rate: f32) -> Trends<M> {
    let mut trends = Trends {
        lower: [0.0; M],
        top: 0.0,
    };
    let mut head = newest;
    let mut tail = *past;
    for i in 0..M {
        trends.lower[i] = tail[M - 1 - i];
        difference(&mut head, &mut tail, i, rate);
    }
    trends.top = head;
    trends
}

/// One more `(1-q^-1)/Delta`, on a series that has been differenced `level` times.
#[inline(always)]
fn difference<const M: usize>(head: &mut f32, tail: &mut [f32; M], level: usize, rate: f32) {
    *head = (*head - tail[0]) * rate;
    for j in 0..M.saturating_sub(level + 1) {
        tail[j] = (tail[j] - tail[j + 1]) * rate;
    }
}
