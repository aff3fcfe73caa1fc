//! The numbers of `octave/test_trendid.m`.

use trendid::identifier::Identifier;
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Outcome, Servo, Structure};
use trendid_example_support::record::SAMPLE_TIME;

use crate::record::{Error, table};

fn line(name: &str, numbers: &[f32]) {
    let digits: String = numbers
        .iter()
        .map(|number| format!("{:08x}", number.to_bits()))
        .collect();
    println!("{name} {digits}");
}

pub(crate) fn octave() -> Result<(), Error> {
    let rows = table()?;
    let mut servo = Servo::<0>::new(SAMPLE_TIME, 20.0, 0.4, 50.0)?;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?;
    let mut config = Config::new(Structure::<2, 3, 2>::INTEGRATING, 20.0, [0.4; 2], 50.0);
    config.memory = Some(1.0);
    config.set_delay(0, 1.5);
    config.set_delay(1, 2.0);
    config.holds[1] = Hold::First;
    config.follow_changes = true;
    let mut two: Identifier<_, 2, 3, 2, 4> = Identifier::try_new(&config, trends)?;
    let (mut innovations, mut last) = (Vec::new(), 0.0);
    for &(u, y) in &rows {
        innovations.extend(match servo.update(u, y) {
            Outcome::Replaced { innovation } => Some(innovation),
            other => other.innovation(),
        });
        let _ = two.update_inputs([u, last], y);
        last = u;
    }
    let found = servo.estimate();
    let physical = found.physical();
    let mut numbers = found.theta().to_vec();
    numbers.extend(found.std());
    numbers.extend(found.covariance().as_flattened());
    numbers.extend(
        [physical.gain, physical.omega0, physical.damping].map(|value| value.unwrap_or(f32::NAN)),
    );
    numbers.push(found.physical_std().map_or(f32::NAN, |std| std[1]));
    numbers.extend(innovations);
    line("servo", &numbers);
    let found = two.estimate();
    line("two", &[found.theta(), found.std()].concat());
    println!("refusals ok");
    Ok(())
}
