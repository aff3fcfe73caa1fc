//! Tables of what was caught, and what is known of the rest.

use std::collections::BTreeMap;
use std::path::Path;

use crate::list::Mutant;
use crate::tests::Verdict;

/// Least share that must be caught.
const LEAST: f64 = 0.9;

/// What became of the mutants of a room.
#[derive(Debug, Default)]
struct Count {
    caught: usize,
    missed: usize,
    unviable: usize,
}

impl Count {
    fn row(&self, name: &str) -> String {
        let viable = self.caught + self.missed;
        let [low, high] = interval(self.caught, viable);
        format!(
            "| {name} | {} | {} | {} | {} | {:.1} | {:.0} to {:.0} |",
            viable + self.unviable,
            self.unviable,
            self.caught,
            self.missed,
            100.0 * self.caught as f64 / viable.max(1) as f64,
            100.0 * low,
            100.0 * high
        )
    }
}

/// Prints the tables; the rooms that are below the limit beyond doubt.
pub(crate) fn print(
    rooms: &[&str],
    mutants: &[Mutant],
    verdicts: &BTreeMap<u32, Verdict>,
    known: &Known,
) -> Vec<String> {
    let mut counts: BTreeMap<String, Count> = BTreeMap::new();
    let mut missed = Vec::new();
    for (number, mutant) in (0..).zip(mutants) {
        let verdict = verdicts.get(&number);
        for place in places(rooms, &mutant.file) {
            let count = counts.entry(place).or_default();
            match verdict {
                None => count.unviable += 1,
                Some(Verdict::Caught(_)) => count.caught += 1,
                Some(_) => count.missed += 1,
            }
        }
        if let Some(verdict @ (Verdict::Missed | Verdict::Unreached)) = verdict {
            missed.push((mutant, verdict));
        }
    }
    println!("| part | drawn | unviable | caught | missed | caught [%] | 95 % interval |");
    println!("|---|---|---|---|---|---|---|");
    let mut low = Vec::new();
    for (name, count) in &counts {
        println!("{}", count.row(name));
        let viable = count.caught + count.missed;
        if rooms.contains(&name.as_str()) && interval(count.caught, viable)[1] < LEAST {
            low.push(name.clone());
        }
    }
    if !missed.is_empty() {
        println!("\n| missed | why |\n|---|---|");
    }
    for (mutant, verdict) in missed {
        let why = match (known.reason(mutant), verdict) {
            (Some(reason), _) => reason,
            (None, Verdict::Unreached) => "**not explained**; no test comes there",
            _ => "**not explained**",
        };
        println!("| `{}` | {why} |", mutant.name.replace('|', "\\|"));
    }
    low
}

/// The room of a file and, where the room has several, its folder in it.
fn places(rooms: &[&str], file: &str) -> Vec<String> {
    let Some(room) = rooms.iter().find(|room| file.starts_with(**room)) else {
        return Vec::new();
    };
    let folder = file[room.len()..].split_once('/').map(|(folder, _)| folder);
    let mut places = vec![(*room).to_owned()];
    if *room == "src/servo/" {
        places.push(folder.map_or_else(
            || format!("{room}*.rs"),
            |folder| format!("{room}{folder}/"),
        ));
    }
    places
}

/// The interval of Wilson for `caught` of `viable`, 95 %.
fn interval(caught: usize, viable: usize) -> [f64; 2] {
    if viable == 0 {
        return [0.0, 1.0];
    }
    let (n, z) = (viable as f64, 1.96_f64);
    let share = caught as f64 / n;
    let scale = 1.0 / (1.0 + z * z / n);
    let middle = scale * (share + z * z / (2.0 * n));
    let half = scale * z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

/// Mutants that no test can or need notice, each with the reason.
///
/// A line of the file: source file, change without its place, line of the source, reason, with ` @
/// `
/// between them; `*` stands for every change of the line.
#[derive(Debug)]
pub(crate) struct Known(Vec<[String; 4]>, BTreeMap<String, Vec<String>>);

impl Known {
    /// The reasons, and the sources of these mutants.
    pub(crate) fn read(root: &Path, mutants: &[Mutant]) -> Result<Self, String> {
        let path = root.join("xtask/mutants/known.txt");
        let text =
            std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut entries: Vec<[String; 4]> = Vec::new();
        for line in text
            .lines()
            .filter(|l| !l.is_empty() && !l.starts_with('#'))
        {
            let parts: Vec<String> = line.splitn(4, " @ ").map(|p| p.trim().to_owned()).collect();
            let parts = parts
                .try_into()
                .map_err(|_| format!("four parts: {line}"))?;
            entries.push(parts);
        }
        for entry @ [file, _, source, _] in &entries {
            if !has_line(&root.join(file), source) {
                eprintln!("a reason for a line that is no more: {}", entry.join(" @ "));
            }
        }
        let mut sources = BTreeMap::new();
        for mutant in mutants {
            let source = std::fs::read_to_string(root.join(&mutant.file)).unwrap_or_default();
            let lines = source.lines().map(|line| line.trim().to_owned()).collect();
            sources.insert(mutant.file.clone(), lines);
        }
        Ok(Self(entries, sources))
    }

    fn reason(&self, mutant: &Mutant) -> Option<&str> {
        let number: usize = mutant.name.split(':').nth(1)?.parse().ok()?;
        let line = self.1.get(&mutant.file)?.get(number - 1)?;
        let entry = self.0.iter().find(|[file, change, source, _]| {
            *file == mutant.file && (change == "*" || change == mutant.change()) && source == line
        });
        entry.map(|entry| entry[3].as_str())
    }
}

/// Whether the source `file` has this line.
fn has_line(file: &Path, line: &str) -> bool {
    let source = std::fs::read_to_string(file).unwrap_or_default();
    source.lines().any(|own| own.trim() == line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_there_as_a_whole_or_is_no_more() {
        let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/report.rs");
        assert!(has_line(&own, "const LEAST: f64 = 0.9;"));
        assert!(!has_line(&own, "const LEAST: f64 = 0.8;"));
        assert!(!has_line(&own.join("none.rs"), ""));
    }

    #[test]
    fn the_interval_of_wilson() {
        // 9 of 10: 0.596 to 0.982 (Wilson's formula, by hand).
        let [low, high] = interval(9, 10);
        assert!((low - 0.5958).abs() < 1e-3 && (high - 0.9821).abs() < 1e-3);
        assert_eq!(interval(0, 0), [0.0, 1.0]);
    }

    #[test]
    fn a_reason_belongs_to_a_change_of_a_line() {
        let mutant = Mutant {
            name: "src/a.rs:2:5: replace < with <= in f".into(),
            file: "src/a.rs".into(),
            genre: "BinaryOperator".into(),
            range: 0..1,
            replacement: "<=".into(),
        };
        let entry = |line: &str| {
            ["src/a.rs", "replace < with <= in f", line, "never equal"].map(str::to_owned)
        };
        let sources =
            BTreeMap::from([("src/a.rs".to_owned(), vec![String::new(), "a < b".into()])]);
        let known = |line: &str| Known(vec![entry(line)], sources.clone());
        assert_eq!(known("a < b").reason(&mutant), Some("never equal"));
        assert_eq!(known("a < c").reason(&mutant), None);
    }

    #[test]
    fn parts_of_the_loop_are_counted_alone() {
        let rooms = ["src/estimation/", "src/servo/"];
        assert_eq!(places(&rooms, "src/estimation/a/b.rs"), ["src/estimation/"]);
        assert_eq!(
            places(&rooms, "src/servo/a.rs"),
            ["src/servo/", "src/servo/*.rs"]
        );
        assert_eq!(
            places(&rooms, "src/servo/a/b.rs"),
            ["src/servo/", "src/servo/a/"]
        );
        assert!(places(&rooms, "src/math/a.rs").is_empty());
    }
}
