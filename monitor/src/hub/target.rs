//! The side of the target: what it is asked, and what it says.

use trendid_link::telemetry::settings::SETTINGS;
use trendid_link::telemetry::{Content, Event, Outcome, Request, Sample};

use crate::hub::{Hub, message};
use crate::source::Said;

impl Hub {
    pub(super) fn send_orders(&mut self) {
        let now = self.now();
        let bytes: Vec<u8> = std::iter::from_fn(|| self.client.next_byte(now)).collect();
        if !bytes.is_empty() {
            // A source that takes nothing is a line that is lost: the order is sent again, or given
            // up.
            let _ = self.source.asked.try_send(bytes);
        }
        while let Some(id) = self.client.given_up() {
            let why = "the target does not answer, or a stop came before";
            self.answered(id, Err(why.into()));
        }
    }

    pub(super) fn hear(&mut self, said: Said) {
        match said {
            Said::Up(what) => {
                self.client.disconnect();
                self.known.up = Some(what);
                self.tally.starts += 1;
                self.known.started = None;
                self.set_up();
                self.tell(&self.line());
            }
            Said::Down(why) => {
                self.client.disconnect();
                self.known.up = None;
                eprintln!("line: {why}");
                self.known.why = why;
                for (id, ..) in std::mem::take(&mut self.orders) {
                    self.answered(id, Err("the line is lost".into()));
                }
                self.end_record("the line is lost", true);
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

    /// What a target is asked at its start.
    pub(super) fn set_up(&mut self) {
        self.known.introduced = false;
        let watchdog = Request::Watchdog(self.watchdog);
        let setup = [Request::Hello, Request::Stream(1), watchdog];
        let gets = (0..SETTINGS.len()).map(|place| Request::Get(place as u8));
        for request in setup.into_iter().chain(gets) {
            let _ = self.client.ask(request);
        }
    }

    pub(super) fn take(&mut self, content: Content) {
        match content {
            Content::Identity(identity) => {
                self.known.identity = Some(identity);
                self.known.introduced = true;
                let hello = self.hello();
                self.tell(&hello);
                if let Some(file) = self.wanted.take() {
                    self.begin_record(Ok(file));
                }
            }
            Content::Sample(sample) => self.sample(sample),
            Content::Learned(learned) => {
                self.kept.learn(learned);
                self.tell(&message::learned(&learned));
            }
            Content::Health(health) => {
                let before = self.kept.health.dropped;
                self.tally.dropped += health.dropped.saturating_sub(before);
                self.kept.health = health;
                self.tell(&message::health(&health));
            }
            Content::Event(event) => {
                self.tally.events += 1;
                if self
                    .known
                    .started
                    .replace(event.start)
                    .is_some_and(|start| start != event.start)
                {
                    // It began again while the line lived, and has forgotten what it was asked.
                    self.set_up();
                }
                if let Event::Start { .. } = event.event {
                    self.kept.restart();
                }
                self.tell(&message::event(&event));
                self.kept.event(event);
            }
            Content::Answer(answer) => {
                let outcome = match answer.outcome {
                    Outcome::Done => Ok(()),
                    Outcome::Refused(refusal) => Err(refusal.to_string()),
                };
                self.answered(answer.id, outcome);
            }
            Content::Setting(value) => {
                if let Some(place) = self.known.values.get_mut(usize::from(value.setting)) {
                    *place = value.value;
                    self.tell(&message::setting(&value));
                }
            }
        }
    }

    pub(super) fn sample(&mut self, sample: Sample) {
        self.tally.samples += 1;
        if let Some(last) = self.kept.samples.back() {
            let gap = sample.tick.wrapping_sub(last.tick);
            if gap > 1 && gap < u32::MAX / 2 {
                self.tally.missing += u64::from(gap - 1);
            }
        }
        if let Some(recorder) = &mut self.recorder
            && let Err(why) = recorder.take(&sample)
        {
            self.end_record(&why, true);
        }
        let sample_time = self.known.identity.as_ref().map_or(1e-3, |i| i.sample_time);
        for output in &mut self.outputs {
            output.take(&sample, sample_time);
        }
        #[cfg(feature = "mcap")]
        if let Some(Err(why)) = self
            .mcap
            .as_mut()
            .map(|file| file.take(&sample, sample_time))
        {
            self.unrecorded(why);
            self.mcap = None;
        }
        self.kept.sample(sample);
    }

    pub(super) fn answered(&mut self, order: u32, outcome: Result<(), String>) {
        let outcome = outcome.as_ref().copied().map_err(String::as_str);
        // Stops that wait together are one order.
        while let Some(place) = self.orders.iter().position(|(id, ..)| *id == order)
            && let Some((_, page, text)) = self.orders.remove(place)
        {
            self.tell_one(page, &message::answer(&text, outcome));
        }
    }
}
