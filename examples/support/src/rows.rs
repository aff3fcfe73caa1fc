//! The structures that are checked bit for bit and counted.

use trendid::identifier::DelayBank;
use trendid::inputs::{self, dead_zone};
use trendid::trends::{ExactTrends, FilteredTrends, IntegralTrends, RawTrends, Scheme};
use trendid::{Config, ConfigError, Identifier, Structure};

use crate::record::SAMPLE_TIME;

/// Half-width of the dead zone in the rows with a dead zone.
pub const DEAD_ZONE: f32 = 0.03;

/// The reference structure b0 / (s (s^2 + a2 s + a1)) behind the paper's trends.
pub type Raw = Identifier<RawTrends<3>, 3, 3>;
/// The reference structure behind filtered trends.
pub type Filtered = Identifier<FilteredTrends<3>, 3, 3>;
/// The reference structure over spans of 70 samples.
pub type Integral = Identifier<IntegralTrends<3, 70>, 3, 3>;
/// The reference structure with one more column: a constant input or the start.
pub type Offset = Identifier<FilteredTrends<3>, 3, 4>;
/// The reference structure with a constant input and a command that is two samples late.
pub type Late = Identifier<FilteredTrends<3>, 3, 4, 1, 4>;
/// The default: constant and start as parameters.
pub type Default = Identifier<FilteredTrends<3>, 3, 5>;
/// The reference structure with both inputs of a dead zone and a constant.
pub type DeadZone = Identifier<FilteredTrends<3>, 3, 5, 2>;
/// The same with a dead zone whose width is measured.
pub type Valved = inputs::Valved<FilteredTrends<3>, 3, 5>;
/// Every a_i and b_i of order three.
pub type Full = Identifier<FilteredTrends<3>, 3, 6>;

/// The default with exact trends.
pub type Exact = Identifier<ExactTrends<3>, 3, 5>;
/// The default with standard deviations from blocks.
pub type Batched = trendid::batches::Batched<FilteredTrends<3>, 3, 5>;
/// The default with instruments beside it.
pub type Instrumented = trendid::instruments::Instrumented<FilteredTrends<3>, 3, 5, 1, 5>;
/// Eight candidates for the delay of the default.
pub type Bank = DelayBank<trendid::Servo<7>, 8>;

fn filter(scheme: Scheme) -> Result<FilteredTrends<3>, ConfigError> {
    FilteredTrends::try_new(scheme, SAMPLE_TIME, [25.0; 3])
}

/// The reference structure with raw trends of `scheme`.
pub fn raw(scheme: Scheme) -> Result<Raw, ConfigError> {
    let config = Config::new(Structure::INTEGRATING, 25.0, [1.0], 50.0);
    Raw::try_new(&config, RawTrends::try_new(scheme, SAMPLE_TIME)?)
}

/// The reference structure with filtered trends of `scheme`.
pub fn filtered(scheme: Scheme) -> Result<Filtered, ConfigError> {
    let config = Config::new(Structure::INTEGRATING, 25.0, [1.0], 50.0);
    Filtered::try_new(&config, filter(scheme)?)
}

/// The reference structure with a memory of one second.
pub fn forgetting() -> Result<Filtered, ConfigError> {
    let mut config = Config::new(Structure::INTEGRATING, 25.0, [1.0], 50.0);
    config.memory = Some(1.0);
    Filtered::try_new(&config, filter(Scheme::Tustin)?)
}

/// The default: constant and start as parameters, slow filter pole, nothing forgotten.
pub fn default() -> Result<Default, ConfigError> {
    let config = Config::new(Structure::SERVO, 20.0, [1.0], 50.0);
    Default::try_new(
        &config,
        FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?,
    )
}

/// The default with a memory of one second, and so with the pull that survives rest.
pub fn following() -> Result<Default, ConfigError> {
    let mut config = Config::new(Structure::SERVO, 20.0, [1.0], 50.0);
    config.memory = Some(1.0);
    Default::try_new(
        &config,
        FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?,
    )
}

/// The default with standard deviations from blocks.
pub fn batched() -> Result<Batched, ConfigError> {
    let config = Config::new(Structure::SERVO, 20.0, [1.0], 50.0);
    Batched::try_new(
        &config,
        FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?,
    )
}

/// The default with instruments.
pub fn instrumented() -> Result<Instrumented, ConfigError> {
    let config = Config::new(Structure::SERVO, 20.0, [1.0], 50.0);
    Instrumented::try_new(
        &config,
        FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?,
    )
}

/// The default with exact trends.
pub fn exact() -> Result<Exact, ConfigError> {
    let config = Config::new(Structure::SERVO, 20.0, [1.0], 50.0);
    Exact::try_new(&config, ExactTrends::for_bandwidth(SAMPLE_TIME, 20.0)?)
}

/// Delays of 0 to 7 samples of the default, side by side.
pub fn bank() -> Result<Bank, ConfigError> {
    let config = Config::new(Structure::SERVO, 20.0, [1.0], 50.0);
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?;
    Bank::try_new(&config, trends, 0)
}

/// The reference structure over spans.
pub fn integral() -> Result<Integral, ConfigError> {
    let config = Config::new(Structure::INTEGRATING, 20.0, [1.0], 50.0);
    Integral::try_new(
        &config,
        IntegralTrends::try_new(Scheme::Tustin, SAMPLE_TIME)?,
    )
}

/// With the start as a parameter.
pub fn started() -> Result<Offset, ConfigError> {
    let config = Config::new(Structure::INTEGRATING_WITH_INITIAL_STATE, 20.0, [1.0], 50.0);
    Offset::try_new(
        &config,
        FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?,
    )
}

/// With a constant input.
pub fn offset() -> Result<Offset, ConfigError> {
    let config = Config::new(Structure::INTEGRATING_WITH_CONSTANT, 25.0, [1.0], 50.0);
    Offset::try_new(&config, filter(Scheme::Tustin)?)
}

/// With a constant input and two samples of delay.
pub fn late() -> Result<Late, ConfigError> {
    let mut config = Config::new(Structure::INTEGRATING_WITH_CONSTANT, 25.0, [1.0], 50.0);
    config.delays = [2];
    Late::try_new(&config, filter(Scheme::Tustin)?)
}

/// With the inputs of a dead zone and a constant.
pub fn dead_zoned() -> Result<DeadZone, ConfigError> {
    let config = Config::new(Structure::INTEGRATING_WITH_CONSTANT, 25.0, [1.0; 2], 50.0);
    DeadZone::try_new(&config, filter(Scheme::Tustin)?)
}

/// The same behind a valve; no block ends within a million samples.
pub fn valved() -> Result<Valved, ConfigError> {
    let mut config = Config::new(Structure::INTEGRATING_WITH_CONSTANT, 25.0, [1.0; 2], 50.0);
    config.memory = Some(2.0);
    let zone = inputs::DeadZone::new(DEAD_ZONE, 4.0 * DEAD_ZONE, 1_000_000);
    Valved::try_new(&config, filter(Scheme::Tustin)?, zone)
}

/// Every a_i and b_i.
pub fn full() -> Result<Full, ConfigError> {
    let config = Config::new(Structure::FULL, 25.0, [1.0], 50.0);
    Full::try_new(&config, filter(Scheme::Tustin)?)
}

/// The inputs of the rows with a dead zone.
pub fn dead_zone_inputs(u: f32) -> [f32; 2] {
    dead_zone(u, DEAD_ZONE)
}
