//! Every option of the core: where its cost is counted, and what it gains over many records.

use std::ops::Range;

use indicatif::ProgressBar;
use trendid_host_tests::paper::options::{self as runs, Pair};

use super::cost::Cost;
use crate::output::under;

/// One option: what it costs, and where it is tried.
pub(super) struct Tried {
    pub option: &'static str,
    pub cost: Cost,
    pub condition: &'static str,
    /// Errors of one run without and with the option.
    run: fn(u64) -> Pair,
}

/// Gain of an option: rms errors of C, omega0, xi in percent without it and with it.
pub(super) struct Gain {
    pub tried: &'static Tried,
    pub without: [f64; 3],
    pub with: [f64; 3],
}

/// All of them.
static OPTIONS: [Tried; 9] = [
    Tried {
        option: "filtered trends, not raw",
        cost: sample(("filtered Tustin", 3), ("raw Tustin", 3)),
        condition: "0.1 mm of white noise, 0.5 s",
        run: runs::filtered,
    },
    Tried {
        option: "noise bias out at the read-out",
        cost: Cost::Call("estimate, per call"),
        condition: "N/S 16.7 %, 3 s",
        run: runs::compensated,
    },
    Tried {
        option: "start as a parameter",
        cost: sample(("with start", 4), ("filtered Tustin", 3)),
        condition: "0.1 mm of white noise, 0.7 s from a motion on",
        run: runs::start,
    },
    Tried {
        option: "constant input",
        cost: sample(("default", 5), ("with start", 4)),
        condition: "offset of 10 % of u, 10 um, 1 s",
        run: runs::constant,
    },
    Tried {
        option: "inputs of a dead zone",
        cost: sample(("dead zone measured", 5), ("default with memory", 5)),
        condition: "dead zone of 3 %, closed loop, 20 um, 4 s",
        run: runs::dead_zone,
    },
    Tried {
        option: "covariance bounded at rest",
        cost: sample(("bare, bounded at rest", 4), ("bare estimator", 4)),
        condition: "20 s at rest, 30 um, memory 0.2 s: drift",
        run: runs::bounded,
    },
    Tried {
        option: "filter retuned on the way",
        cost: Cost::Call("retune, per call"),
        condition: "bandwidth given 3 times too high, N/S 16.7 %, 3 s",
        run: runs::retuned,
    },
    Tried {
        option: "delay bank of 8",
        cost: Cost::Commissioning {
            with: ("delay bank of 8", 5),
            without: ("default", 5),
        },
        condition: "3 samples of delay, 0.1 mm, 0.5 s",
        run: runs::banked,
    },
    Tried {
        option: "exact hold, retuned on the way",
        cost: Cost::Both {
            with: ("default, exact hold", 5),
            without: ("default", 5),
            call: "exact estimate, per call",
        },
        condition: "60 rad/s, damping 0.3, sampled every 5 ms, 10 um, 4 s",
        run: runs::exact,
    },
];

/// Every option over the seeds.
pub(super) fn gains(seeds: &Range<u64>, bar: &ProgressBar) -> Vec<Gain> {
    bar.set_length(OPTIONS.len() as u64 * (seeds.end - seeds.start));
    let gain = |tried: &'static Tried| {
        let all: Vec<u64> = seeds.clone().collect();
        let pairs: Vec<Pair> = under(bar, &all, |seed| (tried.run)(*seed));
        let rms = |which: usize| {
            core::array::from_fn(|i| {
                let sum: f64 = pairs.iter().map(|pair| pair[which][i].powi(2)).sum();
                (sum / pairs.len() as f64).sqrt()
            })
        };
        Gain {
            tried,
            without: rms(0),
            with: rms(1),
        }
    };
    OPTIONS.iter().map(gain).collect()
}

const fn sample(with: (&'static str, u64), without: (&'static str, u64)) -> Cost {
    Cost::Sample { with, without }
}
