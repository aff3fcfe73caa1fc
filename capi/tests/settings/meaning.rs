//! What means nothing for a kind is refused by its name, and calls that it does not offer.

use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid_capi as c;

use crate::kinds::{KINDS, Kind, settings};
use crate::words::{name, no_detail};

/// Every setting that somebody may have changed in vain, and the kinds that use it.
type Vain = (&'static str, i32, fn(&mut c::Settings), fn(&Kind) -> bool);

const VAIN: [Vain; 15] = [
    ("input_range", 1, |of| of.input_range[1] = 2.0, two_inputs),
    ("delay", 1, |of| of.delay[1] = 1.0, two_inputs),
    ("hold", 1, |of| of.hold[1] = 1, two_inputs),
    (
        "initial_input",
        1,
        |of| of.initial_input[1] = 0.1,
        two_inputs,
    ),
    ("friction_input", -1, |of| of.friction_input = 1, two_inputs),
    ("dead_zone", -1, |of| of.dead_zone = 0.01, is_valve),
    ("dead_zone_max", -1, |of| of.dead_zone_max = 0.1, is_valve),
    (
        "dead_zone_block",
        -1,
        |of| of.dead_zone_block = 300,
        is_valve,
    ),
    (
        "offset_significance",
        -1,
        |of| of.offset_significance = 0.0,
        has_constant,
    ),
    ("initial", 6, |of| of.initial[6] = 1.0, has_seven),
    ("initial", 7, |of| of.initial[7] = 1.0, never),
    ("prior_std", 7, |of| of.prior_std = [1.0; 8], never),
    ("known", -1, |of| of.known = 1 << 6, has_seven),
    ("known", -1, |of| of.known = 1 << 31, never),
    ("follow_changes", -1, |of| of.follow_changes = 1, never),
];

fn two_inputs(kind: &Kind) -> bool {
    kind.inputs == 2
}

fn is_valve(kind: &Kind) -> bool {
    kind.name.starts_with("valve")
}

fn has_constant(kind: &Kind) -> bool {
    kind.name != "any without constant"
}

fn has_seven(kind: &Kind) -> bool {
    kind.parameters == 7
}

fn never(_: &Kind) -> bool {
    false
}

#[test]
fn a_setting_that_means_nothing_is_refused() {
    for kind in &KINDS {
        assert!(kind.begin(&settings()).is_ok(), "{}", kind.name);
        for (setting, index, change, uses) in VAIN {
            let mut changed = settings();
            change(&mut changed);
            let case = format!("{} {setting}", kind.name);
            match kind.begin(&changed) {
                Ok(_) => assert!(uses(kind), "{case} is taken"),
                Err(detail) => {
                    assert!(!uses(kind), "{case}: {detail:?}");
                    assert_eq!(detail.error, c::Error::OutOfRange, "{case}");
                    let place = match setting {
                        "prior_std" => kind.parameters as i32,
                        _ => index,
                    };
                    assert_eq!(
                        (name(&detail).as_str(), detail.index),
                        (setting, place),
                        "{case}"
                    );
                }
            }
        }
    }
}

/// The inputs of the model behind a valve are the command, its sign and what the caller gives.
#[test]
fn an_input_is_counted_as_the_caller_does() {
    for kind in KINDS.iter().filter(|kind| kind.inputs == 2) {
        let mut wrong = settings();
        wrong.input_range[1] = -1.0;
        let detail = kind.begin(&wrong).err().unwrap();
        assert_eq!(
            (name(&detail).as_str(), detail.index),
            ("input_range", 1),
            "{}",
            kind.name
        );
        let mut object = kind.begin(&settings()).unwrap();
        let outcome = object.update(0.0, f32::NAN, 0.0);
        assert_eq!(
            (outcome.kind, outcome.input),
            (c::SampleKind::InputRefused, 1)
        );
        let outcome = object.update(f32::NAN, 0.0, 0.0);
        assert_eq!(
            (outcome.kind, outcome.input),
            (c::SampleKind::InputRefused, 0)
        );
    }
}

/// A prior of some parameters would make the others known in silence.
#[test]
fn a_prior_is_one_of_all_parameters() {
    let mut some = settings();
    some.prior_std[0] = 300.0;
    let detail = Kind::of("servo3").begin(&some).err().unwrap();
    assert_eq!(detail.error, c::Error::NotPositive);
    assert_eq!((name(&detail).as_str(), detail.index), ("prior_std", 1));
    some.known = 0b11110;
    assert!(Kind::of("servo3").begin(&some).is_ok());
}

#[test]
fn instruments_refuse_another_filter_alone() {
    for kind in &KINDS {
        let mut settings = settings();
        settings.memory = 1.0;
        let mut object = kind.begin(&settings).unwrap();
        let (handle, n) = (object.handle(), kind.parameters);
        let (theta, std) = (vec![0.0; n], vec![1.0; n]);
        let mut detail = no_detail();
        // SAFETY: an initialised identifier, and lists of this function.
        let errors = unsafe {
            [
                c::trendid_identifier_warm_start(
                    handle,
                    theta.as_ptr(),
                    std.as_ptr(),
                    n,
                    &mut detail,
                ),
                c::trendid_identifier_retune(handle, 22.0, null_mut()),
                c::trendid_identifier_set_nominal(handle),
            ]
        };
        let retuned = match kind.name.starts_with("instrumented") {
            true => c::Error::NotOffered,
            false => c::Error::Ok,
        };
        let expected = [c::Error::Ok, retuned, c::Error::Ok];
        assert_eq!(errors, expected, "{}", kind.name);
    }
}

#[test]
fn a_rest_that_is_no_velocity_is_refused() {
    let mut memory = MaybeUninit::<c::Friction>::uninit();
    let mut sign = 0.0;
    for rest in [f32::NAN, f32::INFINITY, -1.0] {
        let mut detail = no_detail();
        // SAFETY: every pointer is to a value of this function.
        unsafe {
            let error = c::trendid_friction_init(memory.as_mut_ptr(), rest, &mut detail);
            assert_eq!(
                (error, name(&detail).as_str()),
                (c::Error::OutOfRange, "rest")
            );
            // A refusal leaves no object.
            let error = c::trendid_friction_update(memory.as_mut_ptr(), 1.0, &mut sign);
            assert_eq!(error, c::Error::NotInitialised);
        }
    }
}
