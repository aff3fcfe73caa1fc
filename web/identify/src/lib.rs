//! Records identified in the browser: the page puts u and y into the buffer and gets JSON.

use std::cell::RefCell;

use serde_json::{Value, json};
use trendid_identify::{
    Choice, Estimate, Freedom, Options, Problem, Signals, Structure, identify, select,
};

/// Most samples of a record.
const LONGEST: usize = 500_000;

/// Points of the simulated output that a picture gets.
const POINTS: usize = 2000;

thread_local! {
    /// u, then y; and the last answer.
    static RECORD: RefCell<(Vec<f64>, Vec<u8>)> = const { RefCell::new((Vec::new(), Vec::new())) };
}

/// Makes room for `samples` of u, then of y; gives its address, 0 for too many.
#[unsafe(no_mangle)]
pub extern "C" fn room(samples: usize) -> *mut f64 {
    RECORD.with_borrow_mut(|(record, _)| {
        if samples > LONGEST {
            return std::ptr::null_mut();
        }
        record.clear();
        record.resize(2 * samples, 0.0);
        record.as_mut_ptr()
    })
}

/// Address of the answer.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    RECORD.with_borrow(|(_, answer)| answer.as_ptr())
}

/// Identifies a structure; gives the length of the answer. Flags: 1 integrator, 2 constant, 4 the
/// delay is searched.
#[unsafe(no_mangle)]
pub extern "C" fn identify_record(dt: f64, order: usize, zeros: usize, flags: u32) -> usize {
    respond(|u, y| {
        let structure = Structure {
            order,
            integrator: flags & 1 != 0,
            zeros,
            constant: flags & 2 != 0,
        };
        one(u, y, dt, structure, freedom(flags))
    })
}

/// Compares structures up to an order; gives the length of the answer. Flags as above, for all
/// structures; both with and without an integrator are compared.
#[unsafe(no_mangle)]
pub extern "C" fn select_structure(dt: f64, max_order: usize, flags: u32) -> usize {
    respond(|u, y| many(u, y, dt, max_order, flags))
}

fn respond(act: impl FnOnce(&[f64], &[f64]) -> Result<Value, String>) -> usize {
    RECORD.with_borrow_mut(|(record, answer)| {
        let (u, y) = record.split_at(record.len() / 2);
        let value = act(u, y).unwrap_or_else(|why| json!({"error": why}));
        *answer = value.to_string().into_bytes();
        answer.len()
    })
}

fn freedom(flags: u32) -> Freedom {
    let mut freedom = Freedom::default();
    if flags & 4 != 0 {
        freedom.delay = Choice::Auto;
    }
    freedom
}

fn one(
    u: &[f64],
    y: &[f64],
    dt: f64,
    structure: Structure,
    freedom: Freedom,
) -> Result<Value, String> {
    let signals = Signals::held(dt, u, y);
    let problem =
        Problem::new(&signals, structure, Options::default()).map_err(|e| e.to_string())?;
    let found = identify(&problem, freedom, 0, &()).map_err(|e| e.to_string())?;
    let simulated = found.free_run.as_ref().map(|run| {
        let part = run.y.len().div_ceil(POINTS).max(1);
        let begin = y.len() - run.y.len();
        let points: Vec<[f64; 2]> = (0..run.y.len())
            .step_by(part)
            .map(|k| [(begin + k) as f64 * dt, run.y[k]])
            .collect();
        json!({"points": points, "fit": run.fit_x0, "fit_constant": run.fit_x0c})
    });
    Ok(json!({
        "model": model(&found.estimate),
        "pole": found.pole,
        "delay": found.delay,
        "simulated": simulated,
    }))
}

fn model(estimate: &Estimate) -> Value {
    let reading = &estimate.reading;
    json!({
        "a": estimate.a,
        "b": estimate.b.first(),
        "constant": estimate.constant,
        "theta": estimate.theta,
        "sigma": estimate.sigma,
        "gain": reading.gain,
        "omega0": reading.omega0,
        "damping": reading.damping,
        "stable": reading.stable,
        "reading_sigma": estimate.reading_sigma,
    })
}

fn many(u: &[f64], y: &[f64], dt: f64, max_order: usize, flags: u32) -> Result<Value, String> {
    let range = trendid_identify::structure_choice::Range {
        max_order,
        integrating: false,
        constant: flags & 2 != 0,
    };
    let signals = Signals::held(dt, u, y);
    let selection = select(&signals, range, Options::default(), freedom(flags), &())
        .map_err(|e| e.to_string())?;
    let rows: Vec<Value> = selection
        .candidates
        .iter()
        .enumerate()
        .map(|(place, candidate)| {
            json!({
                "order": candidate.structure.order,
                "integrator": candidate.structure.integrator,
                "zeros": candidate.structure.zeros,
                "constant": candidate.structure.constant,
                "delay": candidate.delay,
                "fit": candidate.fit_x0c,
                "recommended": place == selection.recommended,
            })
        })
        .collect();
    Ok(json!({"candidates": rows}))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lag() -> (Vec<f64>, Vec<f64>) {
        let decay = (-0.02_f64).exp();
        let u: Vec<f64> = (0..2000)
            .map(|k| if (k / 70) % 2 == 0 { 1.0 } else { -0.5 })
            .collect();
        let mut y = vec![0.0];
        for k in 0..1999 {
            y.push(decay * y[k] + 3.0 * (1.0 - decay) * u[k]);
        }
        (u, y)
    }

    #[test]
    fn a_lag_is_found_and_recommended() {
        let (u, y) = lag();
        let structure = Structure {
            order: 1,
            integrator: false,
            zeros: 0,
            constant: false,
        };
        let found = one(&u, &y, 0.01, structure, freedom(0)).unwrap();
        let a0 = found["model"]["a"][0].as_f64().unwrap();
        assert!((a0 - 2.0).abs() < 1e-3, "{found}");
        let all = many(&u, &y, 0.01, 2, 0).unwrap();
        assert!(
            all["candidates"]
                .as_array()
                .is_some_and(|rows| rows.iter().any(|r| r["recommended"] == true))
        );
    }

    #[test]
    fn structures_are_compared_with_what_is_asked_for() {
        let (u, y) = lag();
        let late: Vec<f64> = (0..y.len())
            .map(|k| 0.7 + k.checked_sub(5).map_or(0.0, |k| y[k]))
            .collect();
        let rows = |flags| {
            let all = many(&u, &late, 0.01, 1, flags).unwrap();
            all["candidates"].as_array().unwrap().clone()
        };
        assert!(
            rows(0)
                .iter()
                .all(|r| r["constant"] == false && r["delay"] == 0)
        );
        let asked = rows(6);
        assert!(asked.iter().all(|r| r["constant"] == true));
        let best = asked.iter().find(|r| r["recommended"] == true).unwrap();
        assert_eq!(best["delay"], 5, "{asked:?}");
        let fit = |rows: &[Value]| rows[0]["fit"].as_f64().unwrap();
        assert!(fit(&asked) > fit(&rows(0)), "{asked:?}");
    }

    #[test]
    fn what_cannot_be_identified_is_said() {
        let structure = Structure {
            order: 3,
            integrator: true,
            zeros: 0,
            constant: false,
        };
        assert!(one(&[0.0; 100], &[0.0; 100], 0.001, structure, freedom(0)).is_err());
        assert!(one(&[], &[], 0.001, structure, freedom(0)).is_err());
        assert!(many(&[f64::NAN; 9], &[0.0; 9], 0.001, 2, 0).is_err());
    }
}
