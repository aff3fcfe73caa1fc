//! Trends: discrete substitutes for time derivatives (equations 1-8).
//!
//! Model (5) of order m, with `q^-1` the back shift and Delta the sample time:
//!
//! ```text
//! R_m y = - sum_i a_i R_i y + sum_i b_i P_i u          i = 0..m-1
//! ```
//!
//! | operator | symbol | use |
//! |---|---|---|
//! | [`RawTrends`] | `R_i`, `P_i` of (4) and (8) | the paper's trends, for data without noise |
//! | [`FilteredTrends`] | `R_i / R_A`, `P_i / R_A` | the same through one stable filter: the default |
//! | [`ExactTrends`] | numerators of the hold in place of `P_i` | the same without discretisation error, for slow sampling |
//! | [`IntegralTrends`] | `R_i ((1-q^-L)/(1-q^-1))^m` | the same over a span of L samples, for comparison |
//! | [`AnyTrends`] | - | one of the first three, chosen at run time |
//!
//! B. Ninness, G. C. Goodwin: The relationship between discrete time and continuous time linear
//! estimation. 1991. Trends (4).
//!
//! Trend i has the unit of the signal times s^(m-i) (filtered) or s^-i (raw), s being a second, and
//! that of the raw one over a span; so theta is the transfer function's in SI units.

pub(crate) mod any;
pub(crate) mod bilinear;
pub(crate) mod chain;
pub(crate) mod delay_line;
pub(crate) mod design;
pub(crate) mod difference;
pub(crate) mod exact;
pub(crate) mod fading_step;
pub(crate) mod filter;
pub(crate) mod filtered;
pub(crate) mod hold;
pub(crate) mod integral;
pub(crate) mod noise_gain;
pub(crate) mod operator;
pub(crate) mod raw;
mod trapezoids;

pub use any::{AnyMemory, AnyTrends};
pub use chain::Chain;
pub use delay_line::DelayLine;
pub use design::{Design, Mapped};
pub use difference::{Scheme, Trends};
pub use exact::ExactTrends;
pub use filter::polynomial_of_poles;
pub use filtered::FilteredTrends;
pub use integral::{IntegralTrends, Span};
pub use noise_gain::NoiseGain;
pub use operator::{Form, Hold, Memory, TrendOperator};
pub use raw::{RawTrends, Window};
