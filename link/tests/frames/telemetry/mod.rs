//! Telemetry over lines that damage, cut, repeat and lose.

mod damage;
mod ends;
mod events;
mod line;
mod orders;
mod starts;
mod stop;
mod values;
