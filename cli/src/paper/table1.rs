//! `trendid paper table1`: the paper's Table 1 again, with the core, the bound and two opponents on
//! the same records.

use trendid_host_tests::paper::statistics::{COLUMNS, Line, summary};
use trendid_host_tests::paper::trial::{Method, Setting, Trial, trial};

use crate::output::{self, Refusal};
use crate::paper::args::{ReadingName, Table1Args, check};
use crate::paper::{table1_picture as picture, table1_text as text};
use crate::seeds::seeds;

/// Runs the trials and prints them.
pub(super) fn run(args: &Table1Args) -> Result<(), Refusal> {
    check(args.duration)?;
    let seeds = seeds("--seeds", args.seeds, args.first_seed)?;
    let settings = settings(args);
    if args.plot.is_some() && !settings.iter().any(|s| s.vary == "white") {
        return Err(Refusal::new("--plot needs the block white"));
    }
    let lines = lines(args, &settings, &seeds);
    let mut text = if args.csv {
        let rows: Vec<String> = lines.iter().map(Line::csv).collect();
        format!("{COLUMNS}\n{}\n", rows.join("\n"))
    } else if args.brief {
        text::brief(args, &lines)
    } else if args.check {
        text::check(args, &lines)
    } else {
        text::markdown(args, &lines)
    };
    if let Some(dir) = &args.plot {
        let path = picture::save(dir, args, &lines)?;
        // A table for machines or for a document has no place for it.
        if args.check {
            text += &format!("wrote {}\n", path.display());
        }
    }
    output::emit(&text)?;
    Ok(())
}

fn settings(args: &Table1Args) -> Vec<Setting> {
    ReadingName::ALL
        .into_iter()
        .filter(|name| args.reading.is_none_or(|wanted| wanted == *name))
        .flat_map(|name| Setting::all(name.into()))
        .filter(|s| args.vary.is_empty() || args.vary.iter().any(|b| b.name() == s.vary))
        .collect()
}

fn lines(args: &Table1Args, settings: &[Setting], seeds: &[u64]) -> Vec<Line> {
    let mut methods = Method::all();
    if args.brief {
        methods = vec![Method::OutputError, Method::Kalman, Method::DEFAULT];
    }
    if args.check {
        // What the comparison does not show needs not run.
        methods.retain(|m| match m {
            Method::Core { .. } | Method::Instruments => text::checked(*m),
            Method::Kalman => true,
            Method::OutputError => args.plot.is_some(),
        });
    }
    let bar = output::progress(args.seeds * settings.len() as u64, "records");
    let lines = settings
        .iter()
        .flat_map(|setting| {
            let duration = args.duration.unwrap_or_else(|| setting.usual_duration());
            let trials: Vec<Trial> = output::under(&bar, seeds, |seed| {
                trial(setting, duration, *seed, &methods)
            });
            summary(setting, duration, &methods, &trials)
        })
        .collect();
    bar.finish_and_clear();
    lines
}
