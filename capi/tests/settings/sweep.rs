//! Every number of the settings of every kind at every value that makes no sense: refused by its
//! name with value and limits, or an identifier whose read-outs are numbers.

use core::mem::MaybeUninit;

use trendid_capi as c;

use crate::kinds::{Drive, KINDS, Kind, command, settings};
use crate::words::{Fields, Type, name, no_detail, set_word, tells, values, words};

const FIELDS: &Fields = &[
    ("sample_time", Type::Float, 1),
    ("bandwidth", Type::Float, 1),
    ("input_range", Type::Float, 2),
    ("output_range", Type::Float, 1),
    ("output_noise", Type::Float, 1),
    ("memory", Type::Float, 1),
    ("follow_changes", Type::Int, 1),
    ("settling", Type::Float, 1),
    ("offset_significance", Type::Float, 1),
    ("hold", Type::Int, 2),
    ("delay", Type::Float, 2),
    ("initial_input", Type::Float, 2),
    ("friction_input", Type::Int, 1),
    ("initial", Type::Float, 8),
    ("prior_std", Type::Float, 8),
    ("known", Type::Unsigned, 1),
    ("dead_zone", Type::Float, 1),
    ("dead_zone_max", Type::Float, 1),
    ("dead_zone_block", Type::Unsigned, 1),
];

/// Settings that are taken, with what a value of this field needs.
fn base(kind: &Kind, field: &str, memory: f32) -> c::Settings {
    let mut settings = settings();
    settings.memory = memory;
    if field == "prior_std" {
        settings.prior_std[..kind.parameters].fill(1e6);
    }
    settings
}

/// Whether a refusal may name this setting: the limits of a bandwidth follow from the sample time.
fn may_name(field: &str, found: &str, memory: f32) -> bool {
    let of_time = ["bandwidth"].contains(&found) || found == "memory" && memory != 0.0;
    found == field || field == "sample_time" && of_time
}

/// Runs an identifier; what is not a number in its read-outs.
fn run(object: &mut crate::kinds::Object) -> Vec<String> {
    let mut drive = Drive::default();
    for k in 0..2000 {
        let u = command(k);
        let sign = c::trendid_sign_of_velocity(drive.velocity(), 1.0);
        let outcome = object.update(u, sign, drive.position());
        assert!(outcome.innovation.is_finite(), "sample {k}: {outcome:?}");
        drive.run(u);
    }
    let found = object.read();
    let estimate = &found.estimate;
    let mut numbers = estimate.theta.to_vec();
    numbers.extend(estimate.a);
    numbers.extend(estimate.b.as_flattened());
    numbers.extend(estimate.time_constants);
    numbers.extend([
        estimate.constant,
        estimate.gain,
        estimate.omega0,
        estimate.damping,
    ]);
    let status = &found.status;
    numbers.extend([status.prediction, status.noise_std, status.ise, status.iae]);
    numbers.extend([status.dead_zone, status.blocks]);
    numbers.extend(
        found
            .poles
            .iter()
            .flatten()
            .flat_map(|pole| [pole.re, pole.im]),
    );
    let mut deviations = estimate.std.to_vec();
    deviations.extend([estimate.gain_std, estimate.omega0_std, estimate.damping_std]);
    deviations.push(status.dead_zone_std);
    let mut wrong = Vec::new();
    if !numbers.iter().all(|number| number.is_finite()) {
        wrong.push(format!("{estimate:?} {status:?} {:?}", found.poles));
    }
    if !deviations.iter().all(|std| *std >= 0.0) || found.covariance.iter().any(|v| v.is_nan()) {
        wrong.push(format!("deviations of {estimate:?} {:?}", found.covariance));
    }
    wrong
}

/// Whether no kind may take a value of this field.
fn makes_no_sense(field: &str, kind: Type, value: f32) -> bool {
    let signed = ["initial", "initial_input"].contains(&field);
    kind == Type::Float && (!value.is_finite() || value < 0.0 && !signed)
}

#[test]
fn a_setting_is_refused_by_its_name_or_works() {
    let words = words(FIELDS);
    assert_eq!(
        4 * words.len(),
        size_of::<c::Settings>(),
        "a field is left out"
    );
    let (mut refused, mut ran) = (0, 0);
    let mut wrong = Vec::new();
    // Of the two orders of a kind one forgets.
    for (kind, memory) in KINDS.iter().zip([0.0, 1.0].into_iter().cycle()) {
        for (word, &(field, index, of)) in words.iter().enumerate() {
            for (bits, value) in values(of) {
                let mut settings = base(kind, field, memory);
                set_word(&mut settings, word, bits);
                let case = format!("{} {field}[{index}] = {value:e}", kind.name);
                match kind.begin(&settings) {
                    Err(detail) if field == name(&detail) => {
                        refused += 1;
                        // The prior is compared where the recursion has it.
                        let elsewhere = field == "initial" && value.is_finite();
                        if detail.index != index || !(tells(&detail, value) || elsewhere) {
                            wrong.push(format!("{case}: {detail:?}"));
                        }
                    }
                    Err(detail) if may_name(field, &name(&detail), memory) => refused += 1,
                    Err(detail) => {
                        wrong.push(format!("{case}: {} in {detail:?}", name(&detail)));
                    }
                    Ok(_) if makes_no_sense(field, of, value) => {
                        wrong.push(format!("{case} is taken"));
                    }
                    Ok(mut object) => {
                        ran += 1;
                        let found = run(&mut object);
                        wrong.extend(found.into_iter().map(|text| format!("{case}: {text}")));
                    }
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
    assert!(refused > 1000 && ran > 500, "{refused} refused, {ran} ran");
}

/// A bank takes what its candidates take, but for the delay, which it looks for.
#[test]
fn a_bank_refuses_what_its_kind_refuses_and_every_delay() {
    let mut memory = Box::new(MaybeUninit::<c::DelayBank>::uninit());
    let mut delays = 0;
    for (word, (field, index, of)) in words(FIELDS).into_iter().enumerate() {
        for (bits, value) in values(of) {
            let mut settings = base(Kind::of("servo3"), field, 1.0);
            set_word(&mut settings, word, bits);
            let alone = Kind::of("servo3").begin(&settings).err();
            let mut detail = no_detail();
            // SAFETY: every pointer is to a value of this function.
            let error =
                unsafe { c::trendid_delay_bank_init(memory.as_mut_ptr(), &settings, &mut detail) };
            let case = format!("{field}[{index}] = {value:e}: {detail:?}");
            if field == "delay" && index == 0 && value > 0.0 && alone.is_none() {
                delays += 1;
                assert_eq!((error, detail.high), (c::Error::OutOfRange, 0.0), "{case}");
                assert_eq!(name(&detail), field, "{case}");
                continue;
            }
            let refused = alone.map_or(c::Error::Ok, |detail| detail.error);
            assert_eq!(error, refused, "{case}");
            assert_eq!(
                name(&detail),
                alone.map_or(String::new(), |of| name(&of)),
                "{case}"
            );
        }
    }
    assert!(delays > 0);
}
