//! Telemetry over lines that damage, cut, repeat and lose.

mod damage;
mod ends;
mod line;
mod starts;
mod stop;
mod values;
