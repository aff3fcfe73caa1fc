//! What the C edge costs: instructions of a call in Rust and through the C interface, in one image, on one record.
//!
//! `cargo xtask capi --edge` runs it in the emulator. The image writes one line `name;rust;worst;c;worst` per call. What is
//! counted is the function from its first instruction to its return, as a caller has it. Both programs read theta and the whole
//! estimate, so that both have the code of the read-out once. Behind them lines `name;bytes`, the stack of a call of C.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod target {
    use core::hint::black_box;
    use core::ptr::null_mut;

    use cortex_m_rt::entry;
    use trendid::hardware::{Axis, PositionSensor, Scale, Valve};
    use trendid::servo::{self, ServoLoop, Travel};
    use trendid::{Outcome, Servo, ValveServo};
    use trendid_capi as c;
    use trendid_example_support::board::{exit, line};
    use trendid_example_support::clock::Clock;
    use trendid_example_support::drive::Drive;
    use trendid_example_support::{record, stack};

    // For memory.x: the objects lie on the stack.
    core::arch::global_asm!(".global __trendid_deep_stack", "__trendid_deep_stack = 1");

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
        line(format_args!("{info}"));
        exit(false)
    }

    /// The loop of Rust with the same edge: a code that is put in, a command that is taken as it is.
    struct Code(i32);

    impl PositionSensor for Code {
        type Error = ();

        fn counts(&mut self) -> Result<i32, ()> {
            Ok(self.0)
        }
    }

    struct Still;

    impl Valve for Still {
        type Error = ();

        fn drive(&mut self, command: f32) -> Result<f32, ()> {
            Ok(command)
        }
    }

    type Loop = ServoLoop<Code, Still>;

    #[inline(never)]
    fn rust_servo(servo: &mut Servo<7>, u: f32, y: f32) -> Outcome {
        servo.update(u, y)
    }

    #[inline(never)]
    fn rust_valve(
        (servo, zone): &mut (trendid::ValveServo<7>, trendid::inputs::DeadZone),
        u: f32,
        y: f32,
    ) -> Outcome {
        zone.identify(servo, u, y)
    }

    #[inline(never)]
    fn rust_theta(servo: &Servo<7>) -> [f32; 5] {
        servo.theta()
    }

    /// What `trendid_identifier_estimate` gives.
    #[inline(never)]
    fn rust_estimate(servo: &Servo<7>) -> impl Sized {
        let found = servo.estimate();
        (
            found.theta(),
            found.std(),
            found.transfer_function(),
            found.physical(),
            found.physical_std(),
        )
    }

    #[inline(never)]
    fn rust_loop(servo: &mut Loop, code: i32) -> servo::Report {
        servo.sensor_mut().0 = code;
        servo.update()
    }

    /// A function of one instruction, its return.
    #[inline(never)]
    fn nothing(u: f32) -> f32 {
        u
    }

    /// Counts of one call.
    #[derive(Default)]
    struct Count {
        sum: u64,
        worst: u32,
        calls: u32,
    }

    impl Count {
        /// Out of line: inlined, its arithmetic would be moved between the readings of the clock.
        #[inline(never)]
        fn take(&mut self, ticks: u32) {
            self.sum += u64::from(ticks);
            self.worst = self.worst.max(ticks);
            self.calls += 1;
        }

        fn mean(&self) -> f32 {
            (self.sum as f64 / f64::from(self.calls)) as f32
        }
    }

    /// One row: both calls on every sample.
    fn row(
        clock: &Clock,
        idle: f32,
        name: &str,
        mut step: impl FnMut(usize, f32, f32) -> [u32; 2],
    ) {
        let mut counts = [Count::default(), Count::default()];
        for (k, (u, y)) in record::samples().enumerate() {
            let both = step(k, black_box(u), black_box(y));
            for (count, ticks) in counts.iter_mut().zip(both) {
                count.take(ticks);
            }
        }
        let mean = |count: &Count| clock.units(count.mean() - idle) + 1.0;
        let worst = |count: &Count| clock.units(count.worst as f32 - idle) + 1.0;
        let [rust, edge] = counts;
        line(format_args!(
            "{name};{:.1};{:.0};{:.1};{:.0}",
            mean(&rust),
            worst(&rust),
            mean(&edge),
            worst(&edge)
        ));
    }

    /// The functions of C, as pointers that the optimiser must not see through.
    type Update = unsafe extern "C" fn(*mut c::Identifier, f32, f32, *mut c::Outcome) -> c::Error;
    type Theta = unsafe extern "C" fn(*const c::Identifier, *mut f32, usize) -> c::Error;
    type Estimate = unsafe extern "C" fn(*const c::Identifier, *mut c::Estimate) -> c::Error;
    type LoopUpdate = unsafe extern "C" fn(*mut c::Loop, i32, *mut c::Report) -> c::Error;

    /// Ends the image where a call of C fails.
    fn done(error: c::Error) {
        if error != c::Error::Ok {
            line(format_args!("{error:?}"));
            exit(false);
        }
    }

    #[inline(never)]
    fn identifiers(clock: &Clock, idle: f32) -> Result<(), trendid::ConfigError> {
        // SAFETY: every pointer is to a value of this function, or NULL where the header allows it.
        unsafe {
            let mut settings = core::mem::MaybeUninit::uninit();
            done(c::trendid_settings_init(
                settings.as_mut_ptr(),
                0.001,
                20.0,
                1.0,
                50.0,
            ));
            let mut settings: c::Settings = settings.assume_init();
            let mut memory = core::mem::MaybeUninit::<c::Servo3>::uninit();
            let mut handle = null_mut();
            done(c::trendid_servo3_init(
                memory.as_mut_ptr(),
                &settings,
                &mut handle,
                null_mut(),
            ));
            let mut native = Servo::<7>::with_delay(0.001, 20.0, 1.0, 50.0, 0)?;
            let update = black_box(c::trendid_identifier_update as Update);
            let mut outcome = c::Outcome::from(Outcome::WarmingUp { remaining: 0 });
            row(clock, idle, "servo3 update", |_, u, y| {
                let rust = clock.ticks(|| rust_servo(&mut native, u, y));
                let edge = clock.ticks(|| update(handle, u, y, &raw mut outcome));
                [rust, edge]
            });
            let theta = black_box(c::trendid_identifier_theta as Theta);
            let mut found = [0.0_f32; 5];
            row(clock, idle, "servo3 theta", |_, u, y| {
                let _ = rust_servo(&mut native, u, y);
                let _ = update(handle, u, y, &raw mut outcome);
                let rust = clock.ticks(|| rust_theta(&native));
                let edge = clock.ticks(|| theta(handle, found.as_mut_ptr(), 5));
                [rust, edge]
            });
            let estimate = black_box(c::trendid_identifier_estimate as Estimate);
            let mut found = core::mem::MaybeUninit::<c::Estimate>::uninit();
            row(clock, idle, "servo3 estimate", |_, u, y| {
                let _ = rust_servo(&mut native, u, y);
                let _ = update(handle, u, y, &raw mut outcome);
                let rust = clock.ticks(|| rust_estimate(&native));
                let edge = clock.ticks(|| estimate(handle, found.as_mut_ptr()));
                [rust, edge]
            });
            settings.memory = 0.7;
            settings.dead_zone_max = 0.1;
            let mut memory = core::mem::MaybeUninit::<c::Valve3>::uninit();
            done(c::trendid_valve3_init(
                memory.as_mut_ptr(),
                &settings,
                &mut handle,
                null_mut(),
            ));
            let mut config = trendid::Config::new(trendid::Structure::SERVO, 20.0, [1.0; 2], 50.0);
            config.memory = Some(0.7);
            let trends = trendid::trends::FilteredTrends::for_bandwidth(
                trendid::trends::Scheme::Tustin,
                0.001,
                20.0,
            )?;
            let mut native = (
                ValveServo::<7>::try_new(&config, trends)?,
                trendid::inputs::DeadZone::new(0.0, 0.1, 300),
            );
            row(clock, idle, "valve3 update", |_, u, y| {
                let rust = clock.ticks(|| rust_valve(&mut native, u, y));
                let edge = clock.ticks(|| update(handle, u, y, &raw mut outcome));
                [rust, edge]
            });
        }
        Ok(())
    }

    /// Code of the middle of the axis.
    const ORIGIN: i32 = 8_000_000;

    #[inline(never)]
    fn position_loop(clock: &Clock, idle: f32) -> Result<(), servo::Error> {
        let mut memory = core::mem::MaybeUninit::<c::Loop>::uninit();
        let travel = Travel {
            min: 0.0,
            max: 400.0,
        };
        let config = servo::Config::new(0.001, 20.0, travel);
        let axis = Axis {
            scale: const { Scale::new(0.005).unwrap() },
            reference: ORIGIN,
        };
        let mut native = Loop::try_new(&config, axis, Code(0), Still)?;
        native.commission();
        // SAFETY: every pointer is to a value of this function.
        unsafe {
            let mut settings = core::mem::MaybeUninit::<c::LoopSettings>::uninit();
            done(c::trendid_loop_settings_init(
                settings.as_mut_ptr(),
                0.001,
                0.0,
                400.0,
                0.005,
                ORIGIN,
            ));
            let mut settings = settings.assume_init();
            settings.bandwidth = 20.0;
            let memory = memory.as_mut_ptr();
            done(c::trendid_loop_init(memory, &settings, null_mut()));
            done(c::trendid_loop_commission(memory));
            let update = black_box(c::trendid_loop_update as LoopUpdate);
            let mut report = core::mem::MaybeUninit::<c::Report>::zeroed();
            let mut drive = Drive::new(ORIGIN);
            let mut valve = trendid_example_support::drive::SimulatedValve;
            row(clock, idle, "loop update", |k, _, _| {
                let Ok(code) = drive.counts();
                if k % 1000 == 999 {
                    let target = if k % 2000 == 999 { 250.0 } else { 150.0 };
                    let _ = native.move_to(target);
                    done(c::trendid_loop_move_to(memory, target, null_mut()));
                }
                let rust = clock.ticks(|| rust_loop(&mut native, code));
                let edge = clock.ticks(|| update(memory, code, report.as_mut_ptr()));
                let _ = valve.drive(report.assume_init().command);
                [rust, edge]
            });
        }
        Ok(())
    }

    /// Most stack of a call that is looked for, in bytes.
    const PAINTED: usize = 64 * 1024;

    /// A line with the stack of a call, which must succeed.
    fn stack_of(name: &str, call: impl FnOnce() -> c::Error) {
        let mut error = c::Error::Other;
        let bytes = stack::peak_within(PAINTED, || error = call());
        done(error);
        // More than was painted is not known.
        if bytes >= PAINTED {
            exit(false);
        }
        line(format_args!("{name};{bytes}"));
    }

    /// Stack of what a program calls once, and of the read-out.
    #[inline(never)]
    fn stacks() {
        // SAFETY: every pointer is to a value of this function, or NULL where the header allows it.
        unsafe {
            let mut settings = core::mem::MaybeUninit::uninit();
            done(c::trendid_settings_init(
                settings.as_mut_ptr(),
                0.001,
                20.0,
                1.0,
                50.0,
            ));
            let mut settings: c::Settings = settings.assume_init();
            settings.dead_zone_max = 0.1;
            let mut handle = null_mut();
            let mut memory = core::mem::MaybeUninit::<c::Servo3>::uninit();
            stack_of("servo3 init", || {
                c::trendid_servo3_init(memory.as_mut_ptr(), &settings, &mut handle, null_mut())
            });
            stack_of("servo3 update", || {
                c::trendid_identifier_update(handle, 0.1, 0.2, null_mut())
            });
            let mut found = core::mem::MaybeUninit::<c::Estimate>::uninit();
            stack_of("servo3 estimate", || {
                c::trendid_identifier_estimate(handle, found.as_mut_ptr())
            });
            let mut memory = core::mem::MaybeUninit::<c::ValveCoulomb3>::uninit();
            stack_of("valve_coulomb3 init", || {
                c::trendid_valve_coulomb3_init(
                    memory.as_mut_ptr(),
                    &settings,
                    &mut handle,
                    null_mut(),
                )
            });
            stack_of("valve_coulomb3 estimate", || {
                c::trendid_identifier_estimate(handle, found.as_mut_ptr())
            });
            let mut memory = core::mem::MaybeUninit::<c::DelayBank>::uninit();
            stack_of("delay bank init", || {
                c::trendid_delay_bank_init(memory.as_mut_ptr(), &settings, null_mut())
            });
            let mut settings = core::mem::MaybeUninit::<c::LoopSettings>::uninit();
            done(c::trendid_loop_settings_init(
                settings.as_mut_ptr(),
                0.001,
                0.0,
                400.0,
                0.005,
                ORIGIN,
            ));
            let mut memory = core::mem::MaybeUninit::<c::Loop>::uninit();
            stack_of("loop init", || {
                c::trendid_loop_init(memory.as_mut_ptr(), settings.as_ptr(), null_mut())
            });
            loop_stack(memory.as_mut_ptr());
        }
    }

    /// Stack of the samples of a loop: the most of a commissioning and of what comes behind it.
    ///
    /// # Safety
    /// The loop is initialised, and nobody else uses it.
    unsafe fn loop_stack(servo: *mut c::Loop) {
        use core::mem::MaybeUninit;
        let mut report = MaybeUninit::<c::Report>::zeroed();
        let mut drive = Drive::new(ORIGIN);
        let mut valve = trendid_example_support::drive::SimulatedValve;
        let mut most = 0;
        // SAFETY: the loop is initialised; the report is one of this function, and zeros are one.
        unsafe {
            done(c::trendid_loop_commission(servo));
            for _ in 0..4000 {
                let Ok(code) = drive.counts();
                let bytes = stack::peak_within(PAINTED / 4, || {
                    c::trendid_loop_update(servo, code, report.as_mut_ptr())
                });
                most = most.max(bytes);
                let _ = valve.drive(report.assume_init().command);
            }
        }
        if most >= PAINTED / 4 {
            exit(false);
        }
        line(format_args!("loop update;{most}"));
    }

    #[entry]
    fn main() -> ! {
        let Some(mut core) = cortex_m::Peripherals::take() else {
            exit(false)
        };
        let [clock, _] = Clock::start(&mut core);
        line(format_args!(
            "# {}: {:.4} ticks per unit of {:?}",
            clock.name,
            clock.rate(),
            clock.unit
        ));
        let mut idle = Count::default();
        for (u, _) in record::samples() {
            idle.take(clock.ticks(|| nothing(black_box(u))));
        }
        let idle = idle.mean();
        let done = identifiers(&clock, idle).is_ok() && position_loop(&clock, idle).is_ok();
        stacks();
        exit(done)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    println!("`cargo xtask capi --edge` counts instructions on the emulated target");
}
