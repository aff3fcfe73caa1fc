//! The middle: what the target says goes to the pages, what the page in control asks goes to the
//! target.
//!
//! Everything here has a bound: samples, estimates and events that a new page gets, messages that
//! wait for a slow page, orders that wait for the target.

mod course;
mod kept;
mod known;
mod message;
mod page;
mod page_request;
mod pages;
mod reading;
mod report;
mod said;
mod target;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Receiver;
use trendid_link::telemetry::{Client, Sample};

use crate::args::Args;
use crate::claimed::Claimed;
#[cfg(feature = "mcap")]
use crate::mcap::Mcap;
use crate::outputs::{Format, Output};
use crate::record::Recorder;
use crate::source::Source;
use course::Course;
pub(crate) use course::Summary;
use kept::Kept;
use known::Known;
use page::Page;
pub(crate) use said::{FromPage, Tally};

/// Between two messages of samples: a page redraws after each, at most at every second picture of a
/// display of 60 Hz or three of four, so that more than thirty a second are seen.
const REDRAW: Duration = Duration::from_millis(25);

/// How often the target hears that somebody is there.
const ALIVE: Duration = Duration::from_millis(200);

/// The middle.
pub(crate) struct Hub {
    source: Source,
    client: Client,
    begin: Instant,
    watchdog: u16,
    out: PathBuf,
    known: Known,
    pub(crate) tally: Tally,
    kept: Kept,
    pages: BTreeMap<u64, Page>,
    in_control: Option<u64>,
    /// Orders whose answer a page waits for, with its words.
    orders: VecDeque<(u32, u64, String)>,
    recorder: Option<Recorder>,
    wanted: Option<Claimed>,
    /// Why a record ended before its time, or never began.
    unrecorded: Option<String>,
    outputs: Vec<Output>,
    #[cfg(feature = "mcap")]
    mcap: Option<Mcap>,
    course: Course,
}

impl Hub {
    /// A hub with its source.
    pub(crate) fn new(args: &Args) -> Result<Self, String> {
        let source = Source::start(args)?;
        let wanted = args.outputs.csv.clone().map(Claimed::create).transpose()?;
        let mut outputs = Vec::new();
        if let Some(to) = args.outputs.teleplot {
            outputs.push(Output::new(to, Format::Teleplot)?);
        }
        if let Some(to) = args.outputs.plotjuggler {
            outputs.push(Output::new(to, Format::Json)?);
        }
        let mut first = [0; 4];
        getrandom::fill(&mut first).map_err(|error| format!("no random numbers: {error}"))?;
        let now = Instant::now();
        Ok(Self {
            source,
            client: Client::new(u32::from_le_bytes(first)),
            begin: now,
            watchdog: args.watchdog,
            out: args.out.clone(),
            known: Known::nothing(),
            tally: Tally::default(),
            kept: Kept::new(),
            pages: BTreeMap::new(),
            in_control: None,
            orders: VecDeque::new(),
            recorder: None,
            wanted,
            unrecorded: None,
            outputs,
            #[cfg(feature = "mcap")]
            mcap: args.outputs.mcap.as_deref().map(Mcap::create).transpose()?,
            course: Course::new(now),
        })
    }

    /// Runs until `end`; gives what came in.
    pub(crate) async fn run(
        mut self,
        mut pages: Receiver<FromPage>,
        end: Option<Duration>,
    ) -> Summary {
        let mut redraw = tokio::time::interval(REDRAW);
        let mut alive = tokio::time::interval(ALIVE);
        redraw.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        alive.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Skip);
        let over = async {
            match end {
                Some(end) => tokio::time::sleep(end).await,
                None => std::future::pending().await,
            }
        };
        let asked = asked_to_end();
        tokio::pin!(over, asked);
        let mut there = true;
        loop {
            tokio::select! {
                said = self.source.said.recv(), if there => match said {
                    Some(said) => self.hear(said),
                    None => there = false,
                },
                said = pages.recv() => match said {
                    Some(said) => self.serve(said),
                    None => break,
                },
                _ = redraw.tick() => self.redraw(),
                _ = alive.tick() => if self.known.up.is_some() && self.client.is_quiet() {
                    let _ = self.client.ask(self.known.alive());
                },
                () = &mut over => break,
                () = &mut asked => break,
            }
            self.send_orders();
        }
        self.outputs.iter_mut().for_each(Output::flush);
        self.end_record("the monitor ends", false);
        let never = self.wanted.take().map(Claimed::give_up);
        never.into_iter().for_each(|why| self.unrecorded(why));
        #[cfg(feature = "mcap")]
        if let Some(Err(why)) = self.mcap.take().map(Mcap::finish) {
            self.unrecorded(why);
        }
        let summary = self.course.finish(self.tally, self.client.losses());
        Summary {
            unrecorded: self.unrecorded,
            up: self.known.up.ok_or(self.known.why),
            ..summary
        }
    }

    fn now(&self) -> u64 {
        self.begin.elapsed().as_millis() as u64
    }

    fn redraw(&mut self) {
        if self.kept.fresh > 0 {
            let begin = self.kept.samples.len() - self.kept.fresh.min(self.kept.samples.len());
            let rows = message::rows(self.kept.samples.range(begin..));
            self.tell(&rows);
            self.kept.fresh = 0;
        }
        for output in &mut self.outputs {
            output.flush();
        }
        let up = self.known.up.is_some();
        if self.course.turn(Instant::now(), self.tally.samples, up) {
            self.tell(&self.line());
        }
    }

    /// Begins a record in a file, which is there already where it was asked for at the start.
    fn begin_record(&mut self, file: Result<Claimed, String>) {
        let Some(identity) = &self.known.identity else {
            return;
        };
        match file.and_then(|file| Recorder::begin(file, identity)) {
            Ok(recorder) => {
                let told = message::record(true, &recorder.path, 0, "");
                self.recorder = Some(recorder);
                self.tell(&told);
            }
            Err(why) => {
                self.tell(&message::record(false, Path::new(""), 0, &why));
                self.unrecorded(why);
            }
        }
    }

    /// Ends a record; `early` where nobody asked for it.
    fn end_record(&mut self, why: &str, early: bool) {
        let Some(recorder) = self.recorder.take() else {
            return;
        };
        let told = match recorder.finish() {
            Ok((path, rows)) => {
                if early {
                    self.unrecorded(format!("{}: after {rows} samples: {why}", path.display()));
                }
                message::record(false, &path, rows, why)
            }
            Err(why) => {
                self.unrecorded(why.clone());
                message::record(false, Path::new(""), 0, &why)
            }
        };
        self.tell(&told);
    }

    /// Says at once what no record holds, and at the end again by the exit code.
    fn unrecorded(&mut self, why: String) {
        eprintln!("warning: {why}");
        self.unrecorded = Some(why);
    }

    fn hello(&self) -> String {
        message::hello(self.known.identity.as_ref(), &self.known.values)
    }

    fn line(&self) -> String {
        let words = self.known.up.as_deref().unwrap_or(&self.known.why);
        let recorded = self.recorder.as_ref().map(|recorder| recorder.rows);
        message::line(
            self.known.up.is_some(),
            words,
            (self.course.rate, self.course.silent),
            &self.tally,
            self.client.losses(),
            recorded,
        )
    }

    fn tell(&mut self, message: &str) {
        for page in self.pages.values_mut() {
            page.tell(message);
        }
    }

    fn tell_one(&mut self, id: u64, message: &str) {
        if let Some(page) = self.pages.get_mut(&id) {
            page.tell(message);
        }
    }

    fn report(&self) -> String {
        let samples: Vec<&Sample> = self.kept.samples.iter().collect();
        report::page(
            self.known.identity.as_ref(),
            self.known.up.as_deref(),
            &samples,
            self.kept.learned.back(),
            &self.kept.health,
            &self.kept.events,
        )
    }
}

/// Waits until somebody ends the program, so that an emulator ends with it.
async fn asked_to_end() {
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let Ok(mut terminate) = signal(SignalKind::terminate()) {
            tokio::select! {
                _ = tokio::signal::ctrl_c() => {}
                _ = terminate.recv() => {}
            }
            return;
        }
    }
    let _ = tokio::signal::ctrl_c().await;
}
