//! The runs of `examples/c` in Rust, without the C interface: the lines that C must print; with `octave` or `fmu` those of these
//! edges.
//!
//! ```text
//! cargo run --release --example c-reference
//! ```

#[cfg(not(target_os = "none"))]
mod runs {
    use trendid::estimation::Terms;
    use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
    use trendid::identifier::{DelayBank, Identifier, Refusal};
    use trendid::inputs::{DeadZone, coulomb};
    use trendid::servo::store::{Identity, Record};
    use trendid::servo::{self, Report, ServoLoop, Travel};
    use trendid::trends::{FilteredTrends, Scheme};
    use trendid::{Config, ConfigError, Outcome, Servo, Structure};
    use trendid_example_support::drive::{Drive, SimulatedValve};
    use trendid_example_support::hash::Hash;
    use trendid_example_support::record::{SAMPLE_TIME, samples};

    type Error = Box<dyn std::error::Error>;

    const EVERY: usize = 10;
    const MEMORY: f32 = 0.7;

    fn take_all<const N: usize>(hash: &mut Hash, numbers: [f32; N]) {
        for number in numbers {
            hash.take(number);
        }
    }

    fn take_outcome(hash: &mut Hash, outcome: Outcome) {
        let (kind, remaining, innovation) = match outcome {
            Outcome::WarmingUp { remaining } => (0, remaining, 0.0),
            Outcome::Refused(Refusal::Input(_)) => (1, 0, 0.0),
            Outcome::Refused(_) => (2, 0, 0.0),
            Outcome::Replaced { innovation } => (3, 0, innovation),
            Outcome::Held { innovation } => (4, 0, innovation),
            Outcome::Estimated { innovation } => (5, 0, innovation),
            _ => (6, 0, 0.0),
        };
        hash.take_bits(kind);
        hash.take_bits(remaining);
        hash.take(innovation);
    }

    /// The record through an identifier; `update` gives the outcome, `inputs` of the caller and the dead zone after it.
    fn run<const M: usize, const N: usize, const I: usize, const D: usize>(
        name: &str,
        mut identifier: Identifier<FilteredTrends<M>, M, N, I, D>,
        mut update: impl FnMut(
            &mut Identifier<FilteredTrends<M>, M, N, I, D>,
            [f32; 2],
            f32,
        ) -> (Outcome, f32),
    ) {
        let mut hash = Hash::new();
        let (mut last, mut width) = (0.0, 0.0);
        for (k, (u, y)) in samples().enumerate() {
            let sign = coulomb((y - last) / SAMPLE_TIME, 50.0);
            last = y;
            let (outcome, now) = update(&mut identifier, [u, sign], y);
            width = now;
            take_outcome(&mut hash, outcome);
            take_all(&mut hash, identifier.theta());
            if k % EVERY == EVERY - 1 {
                let found = identifier.estimate();
                let physical = found.physical();
                take_all(&mut hash, found.std());
                hash.take(physical.gain.unwrap_or(0.0));
                hash.take(physical.omega0.unwrap_or(0.0));
                hash.take(physical.damping.unwrap_or(0.0));
                hash.take(found.physical_std().map_or(0.0, |std| std[1]));
            }
        }
        let errors = identifier.prediction_error();
        hash.take(identifier.prediction());
        hash.take(identifier.noise_std().unwrap_or(0.0));
        hash.take(errors.ise());
        hash.take(errors.iae());
        hash.take_bits(errors.samples());
        hash.take_bits(identifier.replaced());
        hash.take(width);
        println!("{name} {hash}");
    }

    /// An identifier for the record.
    fn of<const M: usize, const N: usize, const I: usize, const D: usize>(
        structure: Structure<M, N, I>,
        memory: Option<f32>,
        delay: usize,
    ) -> Result<Identifier<FilteredTrends<M>, M, N, I, D>, ConfigError> {
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?;
        let mut config = Config::new(structure, 20.0, [1.0; I], 50.0);
        config.memory = memory;
        if let Some(first) = config.delays.first_mut() {
            *first = delay;
        }
        Identifier::try_new(&config, trends)
    }

    /// The record through a valve: the command becomes two inputs.
    fn run_valve<const M: usize, const N: usize, const I: usize>(
        name: &str,
        structure: Structure<M, N, I>,
    ) -> Result<(), ConfigError> {
        let mut zone = DeadZone::new(0.0, 0.1, 300);
        run::<M, N, I, 7>(
            name,
            of(structure, Some(MEMORY), 0)?,
            |identifier, [u, sign], y| {
                let [command, direction] = zone.inputs(u);
                let all = [command, direction, sign];
                let outcome = identifier.update_inputs(std::array::from_fn(|input| all[input]), y);
                let _ = zone.update(identifier);
                (outcome, zone.delta())
            },
        );
        Ok(())
    }

    fn friction<const N: usize, const I: usize>() -> Result<Structure<3, N, I>, ConfigError> {
        let mut inputs = [Terms::of(&[0]); I];
        inputs[I - 1] = Terms::of(&[1]);
        Structure::try_with_initial_state(Terms::of(&[1, 2]), inputs, true)
    }

    fn identify() -> Result<(), ConfigError> {
        let forget = Some(MEMORY);
        run::<2, 4, 1, 7>(
            "servo2",
            of(Structure::SERVO, forget, 0)?,
            |id, [u, _], y| (id.update(u, y), 0.0),
        );
        run_valve::<2, 5, 2>("valve2", Structure::SERVO)?;
        run_valve::<3, 6, 2>("valve3", Structure::SERVO)?;
        run::<2, 5, 2, 7>("coulomb2", of(Structure::SERVO, forget, 0)?, |id, u, y| {
            (id.update_inputs(u, y), 0.0)
        });
        run::<3, 6, 2, 7>("coulomb3", of(friction()?, forget, 0)?, |id, u, y| {
            (id.update_inputs(u, y), 0.0)
        });
        run_valve::<2, 6, 3>("valve-coulomb2", Structure::SERVO)?;
        run_valve::<3, 7, 3>("valve-coulomb3", friction()?)?;
        run::<3, 5, 1, 0>("servo3", of(Structure::SERVO, None, 0)?, |id, [u, _], y| {
            (id.update(u, y), 0.0)
        });
        run::<3, 5, 1, 7>("late", of(Structure::SERVO, None, 2)?, |id, [u, _], y| {
            (id.update(u, y), 0.0)
        });
        bank()?;
        run::<3, 6, 1, 0>(
            "any-full3",
            of(Structure::FULL, None, 0)?,
            |id, [u, _], y| (id.update(u, y), 0.0),
        );
        Ok(())
    }

    fn bank() -> Result<(), ConfigError> {
        let mut bank = DelayBank::<Servo<7>, 8>::new(SAMPLE_TIME, 20.0, 1.0, 50.0)?;
        let mut hash = Hash::new();
        for (u, y) in samples() {
            take_outcome(&mut hash, bank.update(u, y));
        }
        hash.take_bits(bank.best().map_or(u32::MAX, |delay| delay as u32));
        hash.take(bank.margin().unwrap_or(0.0));
        take_all(
            &mut hash,
            bank.errors().map(|error| error.unwrap_or(f32::INFINITY)),
        );
        if let Some(chosen) = bank.chosen() {
            take_all(&mut hash, chosen.theta());
        }
        println!("delay-bank {hash}");
        Ok(())
    }

    /// A drive whose readings fail now and then; it moves on all the same.
    struct Failing {
        drive: Drive,
        every: Option<u32>,
        count: u32,
    }

    impl PositionSensor for Failing {
        type Error = ();

        fn counts(&mut self) -> Result<i32, ()> {
            let Ok(code) = self.drive.counts();
            let count = self.count;
            self.count += 1;
            match self.every {
                Some(every) if count % every == every - 1 => Err(()),
                _ => Ok(code),
            }
        }
    }

    fn take_report(hash: &mut Hash, report: &Report) {
        hash.take_bits(u32::from(report.state.code()));
        hash.take_bits(report.state.reason().map_or(0, |reason| reason as u32 + 1));
        hash.take_bits(u32::from(report.retuned));
        hash.take(report.command);
        hash.take(report.position);
        hash.take(report.setpoint.position);
        hash.take(report.innovation.unwrap_or(0.0));
    }

    /// Code of the sensor at the begin of the travel.
    const ORIGIN: i32 = 8_000_000;

    const TRAVEL: Travel = Travel {
        min: 0.0,
        max: 400.0,
    };

    fn axis() -> Result<Axis, Error> {
        let scale = Scale::new(0.005).ok_or("scale")?;
        Ok(Axis {
            scale,
            reference: ORIGIN,
        })
    }

    fn control() -> Result<(), Error> {
        let config = servo::Config::new(0.001, 20.0, TRAVEL);
        let sensor = Failing {
            drive: Drive::new(ORIGIN),
            every: Some(997),
            count: 0,
        };
        let mut first = ServoLoop::try_new(&config, axis()?, sensor, SimulatedValve)?;
        first.commission();
        let mut hash = Hash::new();
        for k in 0..12_000 {
            let report = first.update();
            match k {
                5000 => first.move_to(300.0)?,
                7000 => first.move_to(150.0)?,
                9000 => first.oscillate(20.0, 0.5)?,
                _ => {}
            }
            take_report(&mut hash, &report);
        }
        println!("loop {hash}");

        let identity = Identity::new(4711, &config);
        let bytes = first.record().ok_or("no model")?.to_bytes(&identity, 9);
        let mut stored = Hash::new();
        for byte in bytes {
            stored.take_bits(u32::from(byte));
        }
        println!("record {stored}");

        let (record, _) = Record::from_bytes(&bytes, &identity)?;
        let drive = std::mem::replace(&mut first.sensor_mut().drive, Drive::new(ORIGIN));
        // A new drive has set the command to zero, as the second loop of C begins.
        let sensor = Failing {
            drive,
            every: None,
            count: 0,
        };
        let mut second = ServoLoop::try_new(&config, axis()?, sensor, SimulatedValve)?;
        let _ = second.valve_mut().drive(0.0);
        second.resume(&record)?;
        let mut hash = Hash::new();
        for _ in 0..2000 {
            take_report(&mut hash, &second.update());
        }
        println!("resumed {hash}");
        Ok(())
    }

    /// Command and position of the record in text.
    fn table() -> Result<Vec<(f32, f32)>, Error> {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/servo.csv");
        let text = std::fs::read_to_string(path)?;
        let mut rows = Vec::new();
        for line in text.lines().skip(6) {
            let mut fields = line.split(',').skip(1).map(str::parse::<f32>);
            match (fields.next(), fields.next()) {
                (Some(u), Some(y)) => rows.push((u?, y?)),
                _ => return Err(format!("{path}: {line}").into()),
            }
        }
        Ok(rows)
    }

    fn line(name: &str, numbers: &[f32]) {
        let digits: String = numbers
            .iter()
            .map(|number| format!("{:08x}", number.to_bits()))
            .collect();
        println!("{name} {digits}");
    }

    /// The numbers of `octave/test_trendid.m`.
    pub(crate) fn octave() -> Result<(), Error> {
        let rows = table()?;
        let mut servo = Servo::<0>::new(SAMPLE_TIME, 20.0, 0.4, 50.0)?;
        let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, SAMPLE_TIME, 20.0)?;
        let mut config = Config::new(Structure::<2, 3, 2>::INTEGRATING, 20.0, [0.4; 2], 50.0);
        config.memory = Some(1.0);
        config.delays = [1, 2];
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
            [physical.gain, physical.omega0, physical.damping]
                .map(|value| value.unwrap_or(f32::NAN)),
        );
        numbers.push(found.physical_std().map_or(f32::NAN, |std| std[1]));
        numbers.extend(innovations);
        line("servo", &numbers);
        let found = two.estimate();
        line("two", &[found.theta(), found.std()].concat());
        println!("refusals ok");
        Ok(())
    }

    /// The numbers of `fmu/test_fmu.py`.
    pub(crate) fn fmu() -> Result<(), Error> {
        let mut servo = Servo::<0>::new(SAMPLE_TIME, 20.0, 0.4, 50.0)?;
        let mut hash = Hash::new();
        for (u, y) in table()? {
            let outcome = servo.update(u, y);
            let found = servo.estimate();
            take_all(&mut hash, found.theta());
            take_all(&mut hash, found.std());
            hash.take(servo.prediction());
            let (kind, innovation) = match outcome {
                Outcome::WarmingUp { .. } => (0, 0.0),
                Outcome::Refused(Refusal::Input(_)) => (1, 0.0),
                Outcome::Refused(_) => (2, 0.0),
                Outcome::Replaced { innovation } => (3, innovation),
                Outcome::Held { innovation } => (4, innovation),
                Outcome::Estimated { innovation } => (5, innovation),
                _ => (6, 0.0),
            };
            hash.take(innovation);
            hash.take_bits(kind);
        }
        println!("identifier {hash}");

        let config = servo::Config::new(0.001, 20.0, TRAVEL);
        let sensor = Failing {
            drive: Drive::new(ORIGIN),
            every: None,
            count: 0,
        };
        let mut servo = ServoLoop::try_new(&config, axis()?, sensor, SimulatedValve)?;
        servo.commission();
        let mut hash = Hash::new();
        for k in 0..6000 {
            if k == 5000 {
                servo.move_to(300.0)?;
            }
            let report = servo.update();
            hash.take(report.command);
            hash.take(report.position);
            hash.take(report.setpoint.position);
            hash.take(report.innovation.unwrap_or(0.0));
            hash.take_bits(u32::from(report.state.code()));
            hash.take_bits(report.state.reason().map_or(0, |reason| reason as u32 + 1));
        }
        println!("loop-fmu {hash}");
        println!("refusals ok");
        Ok(())
    }

    pub(crate) fn all() -> Result<(), Error> {
        identify()?;
        control()?;
        println!("refusals ok");
        Ok(())
    }
}

#[cfg(target_os = "none")]
compile_error!("the reference of the example in C runs on the host");

#[cfg(not(target_os = "none"))]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    match std::env::args().nth(1).as_deref() {
        None => runs::all(),
        Some("octave") => runs::octave(),
        Some("fmu") => runs::fmu(),
        Some(other) => Err(format!("no runs of the name {other}: octave, fmu or none").into()),
    }
}
