//! What is read and what is refused.

use super::error::TIME;
use super::*;

fn parse(text: &str, signals: &[&str]) -> Result<Record, RecordError> {
    let signals: Vec<String> = signals.iter().map(|s| (*s).to_owned()).collect();
    Record::parse(
        Path::new("x.csv"),
        text.as_bytes(),
        Clock::SECONDS,
        &signals,
    )
}

fn refusal(text: &str) -> String {
    parse(text, &["u", "y"]).unwrap_err().to_string()
}

#[test]
fn signals_come_in_the_order_asked_for_with_the_comments() {
    let r = parse(
        "# a valve\n# [mm]\nt,u,y\n0.5,1,2\n0.6,3,4\n0.7,5,6\n",
        &["y", "u"],
    )
    .unwrap();
    assert_eq!(r.comments, ["a valve", "[mm]"]);
    assert_eq!(r.signals, [[2.0, 4.0, 6.0], [1.0, 3.0, 5.0]]);
    assert_eq!(r.start, 0.5);
    assert!((r.dt - 0.1).abs() < 1e-12);
}

#[test]
fn spreadsheet_habits_are_understood() {
    let plain = parse("t,u,y\n0,1,2\n1,3,4\n", &["u", "y"]).unwrap();
    for text in [
        "\u{feff}t,u,y\r\n0,1,2\r\n1,3,4\r\n",
        "\"t\",\"u\",\"y\"\n\"0\",\"1\",\"2\"\n1,3,4",
        "t;u;y\n0;1;2\n1;3;4\n",
        "t\tu\ty\n0\t1\t2\n1\t3\t4\n",
        " t , u , y \n 0 , 1 , 2 \n\n 1 , 3 , 4 \n\n",
    ] {
        assert_eq!(parse(text, &["u", "y"]).unwrap(), plain, "{text:?}");
    }
}

#[test]
fn columns_not_asked_for_may_hold_anything() {
    assert!(parse("t,u,y,note\n0,1,2,start\n1,3,4,\n", &["u", "y"]).is_ok());
}

#[test]
fn a_missing_file_is_named() {
    let e = Record::read(Path::new("no/such.csv"), Clock::SECONDS, &[]).unwrap_err();
    assert_eq!(e.to_string(), "cannot read `no/such.csv`: no such file");
}

#[test]
fn a_missing_column_names_what_exists() {
    assert_eq!(
        refusal("t,v,y\n0,1,2\n1,3,4\n"),
        "`x.csv` has no column `u`; it has `t`, `v`, `y`"
    );
    assert_eq!(
        refusal("t,u,u,y\n0,1,2,3\n"),
        "`x.csv` has more than one column `u`"
    );
    assert_eq!(
        refusal("# only words\n\n"),
        "`x.csv` holds no header line with column names"
    );
}

#[test]
fn a_bad_cell_is_named_with_line_and_column() {
    // Comments, quotes and blank lines count as lines of the file.
    let text = "# one\n# two\nt,u,y\n0,1,2\n\n1,3,abc\n";
    assert_eq!(
        refusal(text),
        "line 6, column `y`: `abc` is not a number (expected one like -1.5e-3)"
    );
    assert_eq!(
        refusal("t,u,y\r\n0,1,2\r\n1,,4\r\n"),
        "line 3, column `u`: `` is not a number (expected one like -1.5e-3)"
    );
    assert_eq!(
        refusal("t,u,y\n0,1,2\n1,NaN,4\n"),
        "line 3, column `u`: `NaN` is not finite (expected a finite number)"
    );
    assert_eq!(
        refusal("t,u,y\n0,1,2\n1,3\n"),
        "line 3 ends before column `y`: it has 2 of 3 cells"
    );
}

#[test]
fn the_first_irregular_step_is_named() {
    let text = "t,u,y\n0,1,2\n0.1,3,4\n0.2,3,4\n0.35,3,4\n0.45,3,4\n";
    assert_eq!(
        refusal(text),
        "line 5: irregular time stamps, a step of 0.1500 s where 0.1000 s was expected (column `t`); --dt S takes the rows as equally spaced"
    );
    assert!(refusal("t,u,y\n0,1,2\n0,3,4\n0,3,4\n").starts_with("line 3: time does not advance"));
    assert!(refusal("t,u,y\n2,1,2\n1,3,4\n0,3,4\n").starts_with("line 3: time does not advance"));
    // A step within one percent is the rounding of the file.
    assert!(parse("t,u,y\n0,1,2\n0.1004,3,4\n0.2,3,4\n", &["u"]).is_ok());
}

#[test]
fn too_few_samples_are_counted() {
    assert_eq!(
        refusal("t,u,y\n"),
        "only 0 samples in the record, but at least 2 are needed"
    );
    let r = parse("t,u,y\n0,1,2\n1,3,4\n2,5,6\n3,7,8\n", &["u"]).unwrap();
    assert_eq!(
        r.window(Some(1.0), Some(2.0), 3).unwrap_err().to_string(),
        "only 2 samples between 1 s and 2 s, but at least 3 are needed"
    );
    assert!(r.window(Some(9.0), None, 1).is_err());
    assert!(r.window(None, Some(-1.0), 1).is_err());
}

#[test]
fn a_window_keeps_both_bounds() {
    let r = parse("t,u,y\n0,1,2\n1,3,4\n2,5,6\n3,7,8\n", &["u"]).unwrap();
    let w = r.window(Some(1.0), Some(2.0), 2).unwrap();
    assert_eq!((w.start, w.signals[0].clone()), (1.0, vec![3.0, 5.0]));
    assert_eq!(r.window(None, None, 4).unwrap(), r);
}

#[test]
fn the_unit_of_a_clock_is_in_its_name() {
    let read = |text: &str, column, unit| {
        let clock = Clock {
            column,
            unit,
            ..Clock::SECONDS
        };
        let signals = ["u".to_owned()];
        Record::parse(Path::new("x.csv"), text.as_bytes(), clock, &signals)
    };
    let in_ms = "t_ms,u\n0,1\n2,3\n4,5\n";
    // The only column of its kind stands for `t`.
    for column in ["t_ms", TIME] {
        let found = read(in_ms, column, None).unwrap();
        assert!((found.dt - 2e-3).abs() < 1e-15);
        assert_eq!(found.notes.granted.unwrap(), "`t_ms` counts ms by its name");
    }
    let told = read(in_ms, "t_ms", Some(1e-6)).unwrap();
    assert!((told.dt - 2e-6).abs() < 1e-15 && told.notes.granted.is_none());
    let two = read("t_ms,time_us,u\n0,0,1\n2,2000,3\n", TIME, None);
    assert!(matches!(two, Err(RecordError::MissingColumn { .. })));
    // Whole numbers may count anything.
    let whole = read("t,u\n0,1\n2,3\n4,5\n", TIME, None).unwrap();
    assert_eq!(whole.dt, 2.0);
    assert!(whole.notes.granted.unwrap().contains("--time-unit ms"));
    let fractions = read("t,u\n0,1\n0.5,3\n1,5\n", TIME, None).unwrap();
    assert_eq!(fractions.notes.granted, None);
    for (name, unit) in [
        ("time [us]", Some("us")),
        ("t (ms)", Some("ms")),
        ("t", None),
        ("time_s", None),
        ("terms", None),
    ] {
        assert_eq!(unit_of(name).map(|(name, _)| name), unit, "{name}");
    }
}

#[test]
fn fast_steps_are_told_apart() {
    let text = "t,u,y\n0,1,2\n1e-7,3,4\n2e-7,3,4\n3.5e-7,3,4\n";
    assert_eq!(
        refusal(text),
        "line 5: irregular time stamps, a step of 1.500e-7 s where 1.000e-7 s was expected (column `t`); --dt S takes the rows as equally spaced"
    );
}

#[test]
fn control_bytes_are_not_repeated() {
    let said = refusal("\u{7f}ELF\u{1}\u{0},\u{1b}[2J\n\u{0},1\n");
    assert!(!said.chars().any(char::is_control), "{said:?}");
    let said = refusal("t,u,y\n0,1,2\n1,\u{1b}[31m,2\n");
    assert_eq!(
        said,
        "line 3, column `u`: `\\u{1b}[31m` is not a number (expected one like -1.5e-3)"
    );
}

#[test]
fn a_name_over_two_lines_is_shown_in_one() {
    let text = refusal("\"t\n[ms]\",u,y\n0,0,0\nx,0,0\n");
    assert!(
        text.contains("column `t\\n[ms]`") && !text.contains('\n'),
        "{text}"
    );
}

#[test]
fn jitter_is_moved_to_equal_intervals_and_said() {
    let text = "t,y,u\n0,0,1\n1.1,2.2,0\n2,4,0\n2.9,5.8,1\n4,8,1\n";
    let found = parse(text, &["y", "u"]).unwrap();
    assert_eq!((found.dt, found.signals[0].len()), (1.0, 5));
    // The median step is 1.1, the others 0.9.
    assert!((found.notes.resampling.jitter.unwrap() - 0.2 / 1.1).abs() < 1e-12);
    for (k, y) in found.signals[0].iter().enumerate() {
        assert!((y - 2.0 * k as f64).abs() < 1e-12);
    }
    let regular = parse("t,u\n0,1\n1,2\n2,3\n", &["u"]).unwrap();
    assert_eq!(regular.notes.resampling, Resampling::default());
}

/// A ramp of 2 in y under steps of the input, without the rows of some samples.
fn without(missing: &[usize], samples: usize) -> String {
    let rows = (0..samples).filter(|k| !missing.contains(k));
    let row = |k: usize| format!("{},{},{}\n", 0.5 * k as f64, 2 * k, usize::from(k > 150));
    "t,y,u\n".to_owned() + &rows.map(row).collect::<String>()
}

#[test]
fn missing_samples_are_filled_and_said() {
    let found = parse(&without(&[7, 150, 151], 400), &["y", "u"]).unwrap();
    assert_eq!((found.dt, found.len()), (0.5, 400));
    let wanted = Resampling {
        jitter: None,
        filled: 3,
    };
    assert_eq!(found.notes.resampling, wanted);
    for (k, (y, u)) in found.signals[0].iter().zip(&found.signals[1]).enumerate() {
        assert!((y - 2.0 * k as f64).abs() < 1e-9, "{k}: {y}");
        // Held through the gap.
        assert_eq!(*u, f64::from(u8::from(k > 151)), "{k}");
    }
}

#[test]
fn more_missing_samples_than_can_be_filled_are_refused() {
    assert_eq!(
        refusal(&without(&[7, 200, 201, 202, 203], 1000)),
        "line 201: 4 samples missing before it (column `t`), 5 of 1000 in all; 3 in a row and 1 % of all are filled at most: --from and --to choose a part without, --dt S takes the rows as equally spaced where none is missing"
    );
    let said = refusal("t,u,y\n0,1,2\n0.1,3,4\n0.2,3,4\n1e30,3,4\n");
    assert!(said.starts_with("line 5: 1"), "{said}");
    let said = refusal(&without(&[7, 9, 11], 200));
    assert!(
        said.starts_with("line 9: 1 sample missing before it"),
        "{said}"
    );
    let share = |missing| parse(&without(missing, 202), &["y", "u"]);
    assert!(share(&[7, 9]).is_ok() && share(&[7, 9, 11]).is_err());
}

#[test]
fn stamps_outside_of_the_span_are_not_judged() {
    let text = without(&[7, 300, 301, 302, 303], 400);
    let clock = Clock {
        span: [Some(5.0), Some(149.0)],
        ..Clock::SECONDS
    };
    let found = Record::parse(
        Path::new("x.csv"),
        text.as_bytes(),
        clock,
        &["y".to_owned()],
    );
    let found = found.unwrap().window(Some(5.0), Some(149.0), 2).unwrap();
    assert_eq!((found.start, found.len()), (5.0, 289));
    assert!(!found.notes.resampling.is_any());
}

#[test]
fn a_given_interval_needs_no_time_stamps() {
    let clock = Clock {
        dt: Some(0.25),
        ..Clock::SECONDS
    };
    let text = b"u,y\n1,2\n3,4\n";
    let names = ["y".to_owned(), "u".to_owned()];
    let found = Record::parse(Path::new("x.csv"), text, clock, &names).unwrap();
    assert_eq!((found.dt, found.start), (0.25, 0.0));
    assert_eq!(found.signals, [[2.0, 4.0], [1.0, 3.0]]);
}

#[test]
fn decimal_commas_are_hinted_at() {
    assert_eq!(
        refusal("t;u;y\n0;1,5;2\n1;2;3\n"),
        "line 2, column `u`: `1,5` has a decimal comma; write a point"
    );
    assert_eq!(
        refusal("t,u,y\n0,0,1,5,2,0\n"),
        "line 2 has 6 cells under 3 names; decimal commas need another separator, such as `;`, and then points"
    );
}
