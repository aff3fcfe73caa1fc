//! Every setting reaches the core as what it says.

use core::mem::MaybeUninit;

use trendid::estimation::Terms;
use trendid::inputs::{DeadZone, Valved};
use trendid::trends::{FilteredTrends, Hold, Scheme};
use trendid::{Config, Structure};
use trendid_capi as c;

use crate::kinds::{Drive, Kind, Object, command, settings};

/// Everything that can be said of an axis with a valve and friction.
fn all_of_them() -> c::Settings {
    let mut settings = settings();
    settings.input_range = [0.8, 1.25];
    settings.output_noise = 0.02;
    settings.memory = 0.9;
    settings.follow_changes = 1;
    settings.settling = 0.18;
    settings.offset_significance = 1.5;
    settings.hold = [c::Hold::First as i32, c::Hold::Mean as i32];
    settings.delay = [1.25, 0.5];
    settings.initial_input = [-0.3, 1.0];
    settings.friction_input = 1;
    settings.initial[..7].copy_from_slice(&[500.0, 15.0, 8e5, 0.0, 1e3, 0.0, 0.0]);
    settings.prior_std[..7].copy_from_slice(&[300.0, 0.0, 5e5, 1e5, 1e4, 1e4, 1.0]);
    settings.known = 0b10;
    settings.dead_zone = 0.25;
    settings.dead_zone_max = 0.3;
    settings.dead_zone_block = 250;
    settings
}

/// The theta of a kind behind 1500 samples.
fn theta<const N: usize>(object: &mut Object) -> [f32; N] {
    let mut drive = Drive::default();
    for k in 0..1500 {
        let sign = c::trendid_sign_of_velocity(drive.velocity(), 1.0);
        let _ = object.update(command(k), sign, drive.position());
        drive.run(command(k));
    }
    let mut theta = [0.0; N];
    // SAFETY: an initialised identifier with so many parameters.
    let done = unsafe { c::trendid_identifier_theta(object.handle(), theta.as_mut_ptr(), N) };
    assert_eq!(done, c::Error::Ok);
    theta
}

#[test]
fn what_the_core_makes_of_every_setting_is_the_same() {
    let settings = all_of_them();
    let mut object = Kind::of("valve_coulomb3").begin(&settings).unwrap();

    let inputs = [Terms::of(&[0]), Terms::of(&[0]), Terms::of(&[1])];
    let structure = Structure::try_with_initial_state(Terms::of(&[1, 2]), inputs, true).unwrap();
    let mut config = Config::<3, 7, 3>::new(structure, 20.0, [0.8, 1.0, 1.25], 50.0);
    config.output_noise = 0.02;
    config.memory = Some(0.9);
    config.follow_changes = true;
    config.settling = 0.18;
    config.offset_significance = 1.5;
    // The sign of the command comes with the command; in equilibrium it is that of -0.3.
    config.holds = [Hold::First, Hold::First, Hold::Mean];
    (config.delays, config.delay_parts) = ([1, 1, 0], [0.25, 0.25, 0.5]);
    config.initial_input = [-0.3, -1.0, 1.0];
    config.friction_input = Some(2);
    config.initial = [500.0, 15.0, 8e5, 0.0, 1e3, 0.0, 0.0];
    config.prior_std = Some([300.0, 0.0, 5e5, 1e5, 1e4, 1e4, 1.0]);
    config.known[1] = true;
    let trends = FilteredTrends::for_bandwidth(Scheme::Tustin, 0.001, 20.0).unwrap();
    let zone = DeadZone::new(0.25, 0.3, 250);
    let mut native: Valved<_, 3, 7, 3, 7> = Valved::try_new(&config, trends, zone).unwrap();
    let mut drive = Drive::default();
    for k in 0..1500 {
        let sign = c::trendid_sign_of_velocity(drive.velocity(), 1.0);
        let _ = native.update_inputs(command(k), [0.0, 0.0, sign], drive.position());
        drive.run(command(k));
    }
    assert_eq!(theta::<7>(&mut object), native.identifier().theta());
    let status = object.read().status;
    assert_eq!(status.dead_zone, native.dead_zone().delta());
    assert_eq!(status.changes, native.identifier().changes());
}

/// A setting, and another value of it.
type Other = (&'static str, fn(&mut c::Settings));

/// Another value of one setting: another estimate.
#[test]
fn no_setting_is_left_out() {
    let changes: [Other; 19] = [
        ("bandwidth", |of| of.bandwidth = 25.0),
        ("input_range", |of| of.input_range[0] = 1.0),
        ("input_range", |of| of.input_range[1] = 1.0),
        ("output_range", |of| of.output_range = 40.0),
        ("output_noise", |of| of.output_noise = 0.0),
        ("memory", |of| of.memory = 1.0),
        ("settling", |of| of.settling = 0.0),
        ("offset_significance", |of| of.offset_significance = 0.0),
        ("hold", |of| of.hold[0] = 0),
        ("hold", |of| of.hold[1] = 0),
        ("delay", |of| of.delay[0] = 1.0),
        ("delay", |of| of.delay[1] = 0.0),
        ("initial_input", |of| of.initial_input[0] = 0.0),
        ("initial_input", |of| of.initial_input[1] = 0.0),
        ("friction_input", |of| of.friction_input = -1),
        ("initial", |of| of.initial[1] = 20.0),
        ("prior_std", |of| of.prior_std[0] = 30.0),
        ("dead_zone", |of| of.dead_zone = 0.0),
        ("dead_zone_block", |of| of.dead_zone_block = 0),
    ];
    let of = |settings: &c::Settings| {
        let mut object = Kind::of("valve_coulomb3").begin(settings).unwrap();
        theta::<7>(&mut object)
    };
    let all = of(&all_of_them());
    for (name, change) in changes {
        let mut changed = all_of_them();
        change(&mut changed);
        assert_ne!(of(&changed), all, "{name}");
    }
}

/// A drive with a gain that changes is followed where that is asked for, and counted.
#[test]
fn a_change_of_the_drive_is_followed_and_counted() {
    let changes = |follow_changes: i32| {
        let mut settings = settings();
        settings.memory = 2.0;
        settings.follow_changes = follow_changes;
        let mut object = Kind::of("servo3").begin(&settings).unwrap();
        let mut drive = Drive::default();
        for k in 0..6000 {
            let _ = object.update(command(k), 0.0, drive.position());
            drive.run(if k < 3000 { 1.0 } else { 0.3 } * command(k));
        }
        object.read().status.changes
    };
    assert_eq!(changes(0), 0);
    assert!(changes(1) > 0);
}

/// The defaults of a dead zone follow from the range of the command when it is made.
#[test]
fn a_dead_zone_of_which_nothing_is_said_is_that_of_its_defaults() {
    let of = |largest: f32, block: u32| {
        let mut settings = settings();
        settings.memory = 0.7;
        settings.input_range[0] = 0.4;
        (settings.dead_zone_max, settings.dead_zone_block) = (largest, block);
        let mut object = Kind::of("valve3").begin(&settings).unwrap();
        let mut drive = Drive::default();
        let mut widths = Vec::new();
        for k in 0..1500 {
            let _ = object.update(command(k), 0.0, drive.position());
            drive.run(command(k));
            if k % 100 == 0 {
                let found = object.read();
                widths.push((found.status.dead_zone, found.estimate.gain_std.to_bits()));
            }
        }
        widths
    };
    assert_eq!(of(0.0, 0), of(0.1, 300));
    assert_ne!(of(0.0, 0), of(0.3, 300));
    assert_ne!(of(0.0, 0), of(0.1, 250));
}

/// The mean sign of the velocity is that of the core.
#[test]
fn a_turn_between_two_samples_is_that_of_the_core() {
    let mut memory = MaybeUninit::<c::Friction>::uninit();
    let mut native = trendid::inputs::Coulomb::new(0.5);
    // SAFETY: every pointer is to a value of this function.
    unsafe {
        let done = c::trendid_friction_init(memory.as_mut_ptr(), 0.5, core::ptr::null_mut());
        assert_eq!(done, c::Error::Ok);
        for velocity in [-7.0, -3.0, 1.0, 0.0, f32::NAN, 4.0, 2.5, -1.0] {
            let mut sign = f32::NAN;
            let done = c::trendid_friction_update(memory.as_mut_ptr(), velocity, &mut sign);
            assert_eq!((done, sign), (c::Error::Ok, native.update(velocity)));
        }
    }
}
