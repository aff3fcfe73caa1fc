//! The middle: what the target says goes to the pages, what the page in control asks goes to the target.
//!
//! Everything here has a bound: samples, estimates and events that a new page gets, messages that wait for a slow page,
//! orders that wait for the target.

mod message;
mod report;
mod said;
mod wish;

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

use tokio::sync::mpsc::{Receiver, Sender};
use trendid_link::telemetry::settings::SETTINGS;
use trendid_link::telemetry::{
    Client, Content, Event, Health, Identity, Learned, NumberedEvent, Outcome, Refusal, Request,
    Sample,
};

use crate::args::Args;
use crate::outputs::{Format, Output};
use crate::record::Recorder;
use crate::source::{Said, Source};
pub(crate) use said::{FromPage, Tally};
use wish::Wish;

/// Samples, estimates and events that are kept for a page that comes.
const SAMPLES: usize = 30_000;
const ESTIMATES: usize = 3000;
const EVENTS: usize = 500;

/// Samples in one message.
const CHUNK: usize = 2000;

/// Redraws per second.
const REDRAW: Duration = Duration::from_millis(33);

/// How often the target hears that somebody is there.
const ALIVE: Duration = Duration::from_millis(200);

/// A page that is open.
struct Page {
    messages: Sender<String>,
    /// Messages that it was too slow for.
    missed: u64,
}

/// The middle.
pub(crate) struct Hub {
    source: Source,
    client: Client,
    begin: Instant,
    watchdog: u16,
    out: PathBuf,
    up: Option<String>,
    why: String,
    identity: Option<Identity>,
    pub(crate) tally: Tally,
    samples: VecDeque<Sample>,
    /// Of them, those that the pages do not have yet.
    fresh: usize,
    learned: VecDeque<Learned>,
    events: VecDeque<NumberedEvent>,
    health: Health,
    values: [Option<f32>; SETTINGS.len()],
    pages: BTreeMap<u64, Page>,
    in_control: Option<u64>,
    /// Orders whose answer a page waits for, with its words.
    orders: VecDeque<(u32, u64, String)>,
    recorder: Option<Recorder>,
    wanted: Option<PathBuf>,
    outputs: Vec<Output>,
    second: (Instant, u64),
    rate: u64,
}

impl Hub {
    /// A hub with its source.
    pub(crate) fn new(args: &Args) -> Result<Self, String> {
        let mut outputs = Vec::new();
        if let Some(to) = args.teleplot {
            outputs.push(Output::new(to, Format::Teleplot)?);
        }
        if let Some(to) = args.plotjuggler {
            outputs.push(Output::new(to, Format::Json)?);
        }
        let mut first = [0; 4];
        getrandom::fill(&mut first).map_err(|error| format!("no random numbers: {error}"))?;
        let now = Instant::now();
        Ok(Self {
            source: Source::start(args),
            client: Client::new(u32::from_le_bytes(first)),
            begin: now,
            watchdog: args.watchdog,
            out: args.out.clone(),
            up: None,
            why: "waits for the source".into(),
            identity: None,
            tally: Tally::default(),
            samples: VecDeque::with_capacity(SAMPLES),
            fresh: 0,
            learned: VecDeque::with_capacity(ESTIMATES),
            events: VecDeque::with_capacity(EVENTS),
            health: Health::default(),
            values: [None; SETTINGS.len()],
            pages: BTreeMap::new(),
            in_control: None,
            orders: VecDeque::new(),
            recorder: None,
            wanted: args.csv.clone(),
            outputs,
            second: (now, 0),
            rate: 0,
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
        tokio::pin!(over);
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
                _ = alive.tick() => if self.up.is_some() {
                    let _ = self.client.ask(Request::Alive);
                },
                () = &mut over => break,
                _ = tokio::signal::ctrl_c() => break,
            }
            self.send_orders();
        }
        self.end_record("the monitor ends");
        Summary {
            tally: self.tally,
            losses: self.client.losses(),
            seconds: self.begin.elapsed().as_secs_f64(),
        }
    }

    fn now(&self) -> u64 {
        self.begin.elapsed().as_millis() as u64
    }

    fn send_orders(&mut self) {
        let now = self.now();
        let bytes: Vec<u8> = std::iter::from_fn(|| self.client.next_byte(now)).collect();
        if !bytes.is_empty() {
            // A source that takes nothing is a line that is lost: the order is sent again, or given up.
            let _ = self.source.asked.try_send(bytes);
        }
        if let Some(id) = self.client.given_up() {
            self.answered(id, Err("the target does not answer".into()));
        }
    }

    fn hear(&mut self, said: Said) {
        match said {
            Said::Up(what) => {
                self.client.disconnect();
                self.up = Some(what);
                self.tally.starts += 1;
                let watchdog = Request::Watchdog(self.watchdog);
                let setup = [Request::Hello, Request::Stream(1), watchdog];
                let gets = (0..SETTINGS.len()).map(|place| Request::Get(place as u8));
                for request in setup.into_iter().chain(gets) {
                    let _ = self.client.ask(request);
                }
                self.tell(&self.line());
            }
            Said::Down(why) => {
                self.client.disconnect();
                self.up = None;
                self.why = why;
                for (id, ..) in std::mem::take(&mut self.orders) {
                    self.answered(id, Err("the line is lost".into()));
                }
                self.end_record("the line is lost");
                self.tell(&self.line());
            }
            Said::Bytes(bytes) => {
                for byte in bytes {
                    if let Some(content) = self.client.push(byte) {
                        self.take(content);
                    }
                }
            }
        }
    }

    fn take(&mut self, content: Content) {
        match content {
            Content::Identity(identity) => {
                self.identity = Some(identity);
                let hello = self.hello();
                self.tell(&hello);
                if let Some(path) = self.wanted.take() {
                    self.begin_record(path);
                }
            }
            Content::Sample(sample) => self.sample(sample),
            Content::Learned(learned) => {
                keep(&mut self.learned, learned, ESTIMATES);
                self.tell(&message::learned(&learned));
            }
            Content::Health(health) => {
                let before = self.health.dropped;
                self.tally.dropped += health.dropped.saturating_sub(before);
                self.health = health;
                self.tell(&message::health(&health));
            }
            Content::Event(event) => {
                self.tally.events += 1;
                if let Event::Start { .. } = event.event {
                    // Ticks begin again.
                    self.samples.clear();
                    self.learned.clear();
                    self.fresh = 0;
                    self.health = Health::default();
                }
                self.tell(&message::event(&event));
                keep(&mut self.events, event, EVENTS);
            }
            Content::Answer(answer) => {
                let outcome = match answer.outcome {
                    Outcome::Done => Ok(()),
                    Outcome::Refused(refusal) => Err(refusal.to_string()),
                };
                self.answered(answer.id, outcome);
            }
            Content::Setting(value) => {
                if let Some(place) = self.values.get_mut(usize::from(value.setting)) {
                    *place = value.value;
                    self.tell(&message::setting(&value));
                }
            }
        }
    }

    fn sample(&mut self, sample: Sample) {
        self.tally.samples += 1;
        if let Some(last) = self.samples.back() {
            let gap = sample.tick.wrapping_sub(last.tick);
            if gap > 1 && gap < u32::MAX / 2 {
                self.tally.missing += u64::from(gap - 1);
            }
        }
        if let Some(recorder) = &mut self.recorder
            && let Err(why) = recorder.take(&sample)
        {
            self.end_record(&why);
        }
        let sample_time = self.identity.as_ref().map_or(1e-3, |i| i.sample_time);
        for output in &mut self.outputs {
            output.take(&sample, sample_time);
        }
        keep(&mut self.samples, sample, SAMPLES);
        self.fresh = (self.fresh + 1).min(SAMPLES);
    }

    fn redraw(&mut self) {
        if self.fresh > 0 {
            let begin = self.samples.len() - self.fresh.min(self.samples.len());
            let rows = message::rows(self.samples.range(begin..));
            self.tell(&rows);
            self.fresh = 0;
        }
        for output in &mut self.outputs {
            output.flush();
        }
        let (begin, count) = self.second;
        if begin.elapsed() >= Duration::from_secs(1) {
            let seconds = begin.elapsed().as_secs_f64();
            self.rate = ((self.tally.samples - count) as f64 / seconds).round() as u64;
            self.second = (Instant::now(), self.tally.samples);
            self.tell(&self.line());
        }
    }

    fn serve(&mut self, said: FromPage) {
        match said {
            FromPage::Came(id, messages) => {
                if self.in_control.is_none() {
                    self.in_control = Some(id);
                }
                self.pages.insert(
                    id,
                    Page {
                        messages,
                        missed: 0,
                    },
                );
                self.welcome(id);
                self.tell_control();
            }
            FromPage::Gone(id) => {
                self.pages.remove(&id);
                if self.in_control == Some(id) {
                    self.in_control = None;
                }
                self.tell_control();
            }
            FromPage::Message(id, text) => match wish::read(&text) {
                Ok(wish) => self.grant(id, wish, &text),
                Err(why) => self.tell_one(id, &message::answer(&text, Err(&why))),
            },
            FromPage::Report(to) => {
                // A page that did not wait gets none.
                let _ = to.send(self.report());
            }
        }
    }

    /// Everything that a page needs to begin.
    fn welcome(&mut self, id: u64) {
        let mut messages = vec![self.hello(), self.line()];
        let samples: Vec<&Sample> = self.samples.iter().collect();
        messages.extend(
            samples
                .chunks(CHUNK)
                .map(|part| message::rows(part.iter().copied())),
        );
        messages.extend(self.learned.iter().map(message::learned));
        messages.extend(self.events.iter().map(message::event));
        messages.push(message::health(&self.health));
        // In one portion, so that the page does not draw in between.
        self.tell_one(id, &format!("[{}]", messages.join(",")));
        self.fresh = 0;
    }

    fn grant(&mut self, id: u64, wish: Wish, text: &str) {
        let controls = self.in_control == Some(id);
        match wish {
            Wish::Control => {
                self.in_control = Some(id);
                self.tell_control();
            }
            // Anybody may stop.
            Wish::Ask(request) if controls || request == Request::Stop => {
                if self.up.is_none() {
                    let why = "the line is lost";
                    return self.tell_one(id, &message::answer(text, Err(why)));
                }
                let set = match request {
                    Request::Set { setting, .. } => Some(setting),
                    _ => None,
                };
                match self.client.ask(request) {
                    Some(order) => self.orders.push_back((order, id, text.to_owned())),
                    None => {
                        let why = "too many requests wait";
                        self.tell_one(id, &message::answer(text, Err(why)));
                    }
                }
                if let Some(setting) = set {
                    let _ = self.client.ask(Request::Get(setting));
                }
            }
            Wish::Record(true) if controls && self.recorder.is_none() => {
                let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
                let seconds = now.map_or(0, |since| since.as_millis());
                self.begin_record(self.out.join(format!("record-{seconds}.csv")));
                self.tell_one(id, &message::answer(text, Ok(())));
            }
            Wish::Record(false) if controls => {
                self.end_record("");
                self.tell_one(id, &message::answer(text, Ok(())));
            }
            Wish::Record(true) if controls => {
                self.tell_one(id, &message::answer(text, Err("a record is being written")));
            }
            _ => {
                let why = Refusal::NotYours.to_string();
                self.tell_one(id, &message::answer(text, Err(&why)));
            }
        }
    }

    fn answered(&mut self, order: u32, outcome: Result<(), String>) {
        let Some(place) = self.orders.iter().position(|(id, ..)| *id == order) else {
            return;
        };
        if let Some((_, page, text)) = self.orders.remove(place) {
            let outcome = outcome.as_ref().copied().map_err(String::as_str);
            self.tell_one(page, &message::answer(&text, outcome));
        }
    }

    fn begin_record(&mut self, path: PathBuf) {
        let Some(identity) = &self.identity else {
            return;
        };
        match Recorder::create(path, identity) {
            Ok(recorder) => {
                let told = message::record(true, &recorder.path, 0, "");
                self.recorder = Some(recorder);
                self.tell(&told);
            }
            Err(why) => self.tell(&message::record(false, Path::new(""), 0, &why)),
        }
    }

    fn end_record(&mut self, why: &str) {
        let Some(recorder) = self.recorder.take() else {
            return;
        };
        let told = match recorder.finish() {
            Ok((path, rows)) => message::record(false, &path, rows, why),
            Err(why) => message::record(false, Path::new(""), 0, &why),
        };
        self.tell(&told);
    }

    fn hello(&self) -> String {
        message::hello(self.identity.as_ref(), &self.values)
    }

    fn line(&self) -> String {
        let words = self.up.as_deref().unwrap_or(&self.why);
        let recorded = self.recorder.as_ref().map(|recorder| recorder.rows);
        message::line(
            self.up.is_some(),
            words,
            self.rate,
            &self.tally,
            self.client.losses(),
            recorded,
        )
    }

    fn tell_control(&mut self) {
        let count = self.pages.len();
        let ids: Vec<u64> = self.pages.keys().copied().collect();
        for id in ids {
            let yours = self.in_control == Some(id);
            self.tell_one(
                id,
                &message::control(yours, self.in_control.is_some(), count),
            );
        }
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
        let samples: Vec<&Sample> = self.samples.iter().collect();
        report::page(
            self.identity.as_ref(),
            self.up.as_deref(),
            &samples,
            self.learned.back(),
            &self.health,
            &self.events,
        )
    }
}

impl Page {
    /// Gives a message; a page that is too slow misses it and hears how many.
    fn tell(&mut self, message: &str) {
        if self.missed > 0 {
            let missed = message::missed(self.missed);
            if self.messages.try_send(missed).is_err() {
                self.missed += 1;
                return;
            }
            self.missed = 0;
        }
        if self.messages.try_send(message.to_owned()).is_err() {
            self.missed += 1;
        }
    }
}

/// What came in, for the end.
pub(crate) struct Summary {
    pub tally: Tally,
    pub losses: trendid_link::telemetry::Losses,
    pub seconds: f64,
}

fn keep<T>(queue: &mut VecDeque<T>, item: T, most: usize) {
    if queue.len() >= most {
        queue.pop_front();
    }
    queue.push_back(item);
}
