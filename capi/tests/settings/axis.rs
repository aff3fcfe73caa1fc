//! Every number of the settings of a loop at every value that makes no sense: refused by its name
//! with value and limits, or a loop whose reports are numbers.

use core::mem::MaybeUninit;
use core::ptr::null_mut;

use trendid_capi as c;

use crate::kinds::Drive;
use crate::words::{Fields, Type, name, no_detail, set_word, tells, values, words};

const FIELDS: &Fields = &[
    ("sample_time", Type::Float, 1),
    ("travel_min", Type::Float, 1),
    ("travel_max", Type::Float, 1),
    ("units_per_count", Type::Float, 1),
    ("reference_code", Type::Int, 1),
    ("bandwidth", Type::Float, 1),
    ("direction", Type::Int, 1),
    ("noise", Type::Float, 1),
    ("range", Type::Float, 1),
    ("rate", Type::Float, 1),
    ("command_steps", Type::Unsigned, 1),
    ("delay", Type::Float, 1),
    ("memory", Type::Float, 1),
    ("adaptive", Type::Int, 1),
    ("velocity", Type::Float, 1),
    ("acceleration", Type::Float, 1),
    ("jerk", Type::Float, 1),
    ("controller.bandwidth", Type::Float, 1),
    ("controller.blend", Type::Float, 1),
    ("controller.rest_window", Type::Float, 1),
    ("controller.dead_volume", Type::Float, 1),
    ("controller.imbalance", Type::Float, 1),
    ("controller.transition", Type::Float, 1),
    ("excitation", Type::Float, 1),
    ("time_limit", Type::Float, 1),
];

fn settings() -> c::LoopSettings {
    let mut made = MaybeUninit::uninit();
    // SAFETY: a pointer to a value of this function, which the call fills.
    let mut made = unsafe {
        let done = c::trendid_loop_settings_init(made.as_mut_ptr(), 0.001, -200.0, 200.0, 0.005, 0);
        assert_eq!(done, c::Error::Ok);
        made.assume_init()
    };
    made.velocity = 500.0;
    made.acceleration = 1e4;
    made.jerk = 1e6;
    made
}

fn begin(settings: &c::LoopSettings) -> Result<Box<MaybeUninit<c::Loop>>, c::Detail> {
    let mut memory = Box::new(MaybeUninit::<c::Loop>::zeroed());
    let mut detail = no_detail();
    // SAFETY: every pointer is to a value of this function.
    match unsafe { c::trendid_loop_init(memory.as_mut_ptr(), settings, &mut detail) } {
        c::Error::Ok => Ok(memory),
        error => {
            assert_eq!(error, detail.error);
            Err(detail)
        }
    }
}

/// Commissions a drive, where that is asked for, and moves it; what is not a number in a report.
fn run(servo: *mut c::Loop, commissioned: bool) -> Option<String> {
    let mut drive = Drive::default();
    let mut report = MaybeUninit::<c::Report>::uninit();
    for k in 0..2500 {
        // SAFETY: an initialised loop, and a report of this function.
        let report = unsafe {
            if k == 100 && commissioned {
                assert_eq!(c::trendid_loop_commission(servo), c::Error::Ok);
            }
            if k % 500 == 499 {
                // Refused while the commissioning lasts.
                let _ = c::trendid_loop_move_to(servo, 10.0, null_mut());
            }
            let code = (drive.position() / 0.005) as i32;
            let done = c::trendid_loop_update(servo, code, report.as_mut_ptr());
            assert_eq!(done, c::Error::Ok);
            report.assume_init()
        };
        let numbers = [
            report.position,
            report.reference,
            report.reference_velocity,
            report.innovation,
            report.derating,
        ];
        let good = numbers.iter().all(|number| number.is_finite());
        if !(good && report.command.abs() <= 1.0) {
            return Some(format!("sample {k}: {report:?}"));
        }
        drive.run(report.command);
    }
    None
}

fn is_stiff(field: &str, value: f32) -> bool {
    field == "controller.dead_volume" && value == f32::INFINITY
}

/// Whether the refusal of a finite value may be that of another setting, whose limits follow from
/// it, or of both.
fn is_related(field: &str, found: &str, detail: &c::Detail) -> bool {
    match field {
        "sample_time" => ["memory", "delay"].contains(&found),
        "travel_min" => found == "travel_max",
        "travel_max" | "bandwidth" => detail.error == c::Error::Unit,
        _ => false,
    }
}

#[test]
fn a_setting_is_refused_by_its_name_or_works() {
    let words = words(FIELDS);
    assert_eq!(
        4 * words.len(),
        size_of::<c::LoopSettings>(),
        "a field is left out"
    );
    let (mut refused, mut ran) = (0, 0);
    let mut wrong = Vec::new();
    for (word, &(field, index, of)) in words.iter().enumerate() {
        for (bits, value) in values(of) {
            let mut settings = settings();
            set_word(&mut settings, word, bits);
            let case = format!("{field} = {value:e}");
            match begin(&settings) {
                Err(detail) => {
                    refused += 1;
                    let found = name(&detail);
                    let told = found == field && detail.index == index && tells(&detail, value);
                    if !(told || is_related(field, &found, &detail)) {
                        wrong.push(format!("{case}: {found} in {detail:?}"));
                    }
                }
                // A drive that is as stiff everywhere.
                Ok(_) if of == Type::Float && !value.is_finite() && !is_stiff(field, value) => {
                    wrong.push(format!("{case} is taken"));
                }
                Ok(mut memory) => {
                    ran += 1;
                    wrong.extend(
                        run(memory.as_mut_ptr(), true).map(|text| format!("{case}: {text}")),
                    );
                }
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} cases:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(refused > 50 && ran > 20, "{refused} refused, {ran} ran");
}

/// A model with a field that makes no sense: refused with its reason, or the axis is controlled.
#[test]
fn a_model_is_refused_with_its_reason_or_controls() {
    let fields: &Fields = &[("model", Type::Float, 6)];
    assert_eq!(4 * words(fields).len(), size_of::<c::Model>());
    let good = c::Model {
        a1: 400.0,
        a2: 20.0,
        b0: 1e6,
        dead_zone: 0.03,
        offset: 0.0,
        friction: 0.0,
    };
    let (mut refused, mut wrong) = (0, Vec::new());
    for (word, (_, _, of)) in words(fields).into_iter().enumerate() {
        for (bits, value) in values(of) {
            let mut model = good;
            set_word(&mut model, word, bits);
            let mut memory = begin(&settings()).unwrap();
            let mut detail = no_detail();
            // SAFETY: every pointer is to a value of this function.
            let error =
                unsafe { c::trendid_loop_install(memory.as_mut_ptr(), &model, &mut detail) };
            match error {
                c::Error::Ok if !value.is_finite() => wrong.push(format!("{model:?} is taken")),
                c::Error::Ok => {
                    let found = run(memory.as_mut_ptr(), false);
                    wrong.extend(found.map(|text| format!("{model:?}: {text}")));
                }
                _ => {
                    refused += 1;
                    assert_eq!(error, c::Error::ModelRefused, "{model:?}");
                    assert_ne!(detail.reason, 0, "{model:?}");
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(refused > 20, "{refused}");
}
