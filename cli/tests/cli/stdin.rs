//! Records in drawn forms from the standard input: what is printed is that of the file.

use crate::common::{Scratch, piped, trendid};
use crate::draws::Uniform;

/// `y' = -a y + b u` with a ripple, in one of the forms of tables; a broken one is refused.
fn table(draw: &mut Uniform, broken: bool) -> String {
    let separator = draw.one(&[",", ";", "\t"]);
    let line_end = draw.one(&["\n", "\r\n", "\r"]);
    let mark = draw.one(&["", "\u{feff}"]);
    let (decay, gain) = (0.9 + 0.08 * draw.next(), 1.0 + draw.next());
    let (mut u, mut y) = (0.0, 0.0);
    let mut text = mark.to_owned() + &["t", "u", "y"].join(separator) + line_end;
    for k in 0..1200 {
        if k % 9 == 0 {
            u = draw.one(&[-1.0, 1.0]);
        }
        if draw.below(50) == 0 {
            text += &format!("# remark{line_end}");
        }
        let measured = match broken && k == 700 {
            true => "x".to_owned(),
            false => format!("{:.6}", y + 1e-3 * draw.normal()),
        };
        let cells = [
            format!("{:.2}", 0.01 * f64::from(k)),
            u.to_string(),
            measured,
        ];
        text += &(cells.join(separator) + line_end);
        y = decay * y + (1.0 - decay) * gain * u;
    }
    text
}

#[test]
fn every_command_reads_the_standard_input_as_a_file() {
    let dir = Scratch::new("piped");
    let commands: [&[&str]; 4] = [
        &["identify", "FILE", "--order", "1", "--delay", "auto"],
        &["identify", "FILE", "--order", "1", "--json"],
        &["select", "FILE", "--max-order", "1"],
        &["tune", "record", "FILE", "--order", "1"],
    ];
    for seed in 1..=12_u64 {
        let mut draw = Uniform::of(seed);
        let broken = seed % 4 == 0;
        let text = table(&mut draw, broken);
        let file = dir.file("record.csv", &text);
        let command = commands[seed as usize % 3 + usize::from(seed > 6)];
        let with = |name| -> Vec<&str> {
            let args = command.iter();
            args.map(|arg| if *arg == "FILE" { name } else { *arg })
                .collect()
        };
        let (from_file, from_pipe) = (trendid(&with(&file)), piped(&with("-"), &text));
        assert_eq!(from_file.status.success(), !broken, "{seed}, {command:?}");
        assert_eq!(from_file.status, from_pipe.status, "{seed}, {command:?}");
        for (file_text, piped) in [
            (&from_file.stdout, &from_pipe.stdout),
            (&from_file.stderr, &from_pipe.stderr),
        ] {
            let file_text = String::from_utf8_lossy(file_text).replace(&file, "-");
            assert_eq!(
                file_text,
                String::from_utf8_lossy(piped),
                "{seed}, {command:?}"
            );
        }
    }
}
