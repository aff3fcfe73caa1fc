//! The side of the pages: what they ask, who is in control, what they miss.

use std::time::SystemTime;

use trendid_link::telemetry::{Refusal, Request, Sample};

use crate::claimed::Claimed;
use crate::hub::page::Page;
use crate::hub::page_request::{self, PageRequest};
use crate::hub::{FromPage, Hub, message};

/// Samples in one message.
const CHUNK: usize = 2000;

impl Hub {
    pub(super) fn serve(&mut self, said: FromPage) {
        match said {
            FromPage::Came(id, messages) => {
                if self.in_control.is_none() {
                    self.in_control = Some(id);
                }
                self.pages.insert(id, Page::new(messages));
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
            FromPage::Message(id, text) => match page_request::read(&text) {
                Ok(request) => self.grant(id, request, &text),
                Err(why) => self.tell_one(id, &message::answer(&text, Err(&why))),
            },
            FromPage::Report(to) => {
                // A page that did not wait gets none.
                let _ = to.send(self.report());
            }
        }
    }

    /// Everything that a page needs to begin.
    pub(super) fn welcome(&mut self, id: u64) {
        let mut messages = vec![self.hello(), self.line()];
        let samples: Vec<&Sample> = self.kept.samples.iter().collect();
        messages.extend(
            samples
                .chunks(CHUNK)
                .map(|part| message::rows(part.iter().copied())),
        );
        messages.extend(self.kept.learned.iter().map(message::learned));
        messages.extend(self.kept.events.iter().map(message::event));
        messages.push(message::health(&self.kept.health));
        // In one portion, so that the page does not draw in between.
        self.tell_one(id, &format!("[{}]", messages.join(",")));
        self.kept.fresh = 0;
    }

    pub(super) fn grant(&mut self, id: u64, request: PageRequest, text: &str) {
        let controls = self.in_control == Some(id);
        match request {
            PageRequest::Control => {
                self.in_control = Some(id);
                self.tell_control();
            }
            // Anybody may stop.
            PageRequest::Target(request) if controls || request == Request::Stop => {
                if self.known.up.is_none() {
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
            PageRequest::Record(true) if controls && self.recorder.is_none() => {
                let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
                let seconds = now.map_or(0, |since| since.as_millis());
                let path = self.out.join(format!("record-{seconds}.csv"));
                self.begin_record(Claimed::create(path));
                self.tell_one(id, &message::answer(text, Ok(())));
            }
            PageRequest::Record(false) if controls => {
                self.end_record("", false);
                self.tell_one(id, &message::answer(text, Ok(())));
            }
            PageRequest::Record(true) if controls => {
                self.tell_one(id, &message::answer(text, Err("a record is being written")));
            }
            _ => {
                let why = Refusal::NotYours.to_string();
                self.tell_one(id, &message::answer(text, Err(&why)));
            }
        }
    }

    pub(super) fn tell_control(&mut self) {
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
}
