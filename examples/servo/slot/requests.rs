//! What a person asks for with the button, and what is asked over the wire.
//!
//! Over the wire every request is answered: done, or refused and why. A machine that is stopped
//! does nothing but to be acknowledged. Settings and models are taken while the loop does not
//! control: a loop is built, or poles are searched, which takes many slots; they are not counted,
//! since nothing moves meanwhile, and the watchdog waits longer.

use core::sync::atomic::{AtomicU8, Ordering};

use trendid::servo::Config;
use trendid_example_support::button::Request;
use trendid_example_support::machine::{self, AXIS, Verified};
use trendid_example_support::slots::Slots;
use trendid_example_support::watchdog::set_period;
use trendid_link::telemetry::{self, Refusal, SettingValue, operate, settings};

use crate::slot::{Slot, UNWATCHED, WATCHDOG_MS};
use crate::wiring::{Chip, Panel};
use crate::{live, survival};

/// Time in ms for a request that takes many slots.
const LONG_MS: u32 = 500;

const NOTHING: u8 = 0;
const DONE: u8 = 1;
const FAILED: u8 = 2;

/// What came of storing the model, from the idle loop.
static STORED: AtomicU8 = AtomicU8::new(NOTHING);

/// Says whether the model was stored that the slot asked for.
pub(crate) fn stored(done: bool) {
    STORED.store(if done { DONE } else { FAILED }, Ordering::Relaxed);
}

impl Slot {
    /// What a person asks for.
    pub(super) fn answer(&mut self, request: Request) {
        match request {
            // A restart is the state that is known best: nothing moves, and the next request is
            // heard.
            Request::Acknowledge if self.now.stopped => restart(),
            Request::Acknowledge => {}
            Request::Run if self.now.stopped => {
                self.now.refused = self.now.refused.saturating_add(1);
            }
            Request::Stop => self.servo.abort(),
            // By the wire, since the button was pressed.
            Request::Run if self.moves() => self.servo.abort(),
            Request::Run => {
                self.guided = false;
                self.servo.commission();
            }
        }
    }

    /// What is asked over the wire.
    pub(super) fn over_the_wire(&mut self) {
        match STORED.swap(NOTHING, Ordering::Relaxed) {
            NOTHING => {}
            DONE => self.reply(Ok(())),
            _ => self.reply(Err(Refusal::Storage)),
        }
        while let Some(request) = self.wire.as_mut().and_then(|wire| wire.request()) {
            if let Some(done) = self.carry_out(&request).transpose() {
                self.reply(done);
            }
        }
    }

    fn reply(&mut self, done: Result<(), Refusal>) {
        if let Some(wire) = &mut self.wire {
            wire.answer(done.into());
        }
    }

    /// Carries a request out; `None` when it is answered later.
    fn carry_out(&mut self, request: &telemetry::Request) -> Result<Option<()>, Refusal> {
        use telemetry::Request;
        match *request {
            // The order comes again after the restart, and is answered then.
            Request::Acknowledge if self.now.stopped => restart(),
            Request::Acknowledge => {}
            Request::Get(setting) => {
                let value = settings::get(&self.config, setting)?;
                if let Some(wire) = &mut self.wire {
                    wire.setting(SettingValue { setting, value });
                }
            }
            Request::Play(trick) => match self.panel {
                Panel::Emulated => live::play(trick),
                Panel::Button(..) => return Err(Refusal::Unsupported),
            },
            _ if self.now.stopped => return Err(Refusal::Latched),
            Request::Set { .. } | Request::Limits { .. } => {
                self.configure(settings::requested(&self.config, request)?)?;
            }
            // The emulator has no flash controller.
            Request::Store if matches!(self.panel, Panel::Emulated) => {
                return Err(Refusal::Unsupported);
            }
            Request::Store => {
                let verified = Verified::of(&self.servo, &self.config);
                self.now.verified = Some(verified.ok_or(Refusal::NoModel)?);
                self.now.store = true;
                let sent = self.send();
                self.now.store = false;
                return if sent {
                    Ok(None)
                } else {
                    Err(Refusal::Storage)
                };
            }
            // In motion no slot has time for it, and none for the refusal either.
            Request::Install(_) if self.moves() => return Err(Refusal::Moving),
            Request::Install(_) => {
                self.unhurried(|slot| operate(&mut slot.servo, request))?;
                self.guided = true;
            }
            _ => {
                operate(&mut self.servo, request)?;
                self.guided = true;
            }
        }
        Ok(Some(()))
    }

    /// Whether the loop commissions or controls, or comes to rest for it.
    pub(super) fn moves(&self) -> bool {
        machine::moves(&self.servo, self.now.state)
    }

    /// A loop with other settings, idle; what was found before is forgotten.
    fn configure(&mut self, config: Config) -> Result<(), Refusal> {
        if self.moves() {
            return Err(Refusal::Moving);
        }
        self.unhurried(|slot| {
            slot.servo.reconfigure(&config, AXIS)?;
            slot.config = config;
            Ok(())
        })
    }

    /// Does what takes many slots, while the loop does not control.
    fn unhurried(
        &mut self,
        act: impl FnOnce(&mut Self) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        let longer = set_period(&mut Chip, LONG_MS);
        let done = act(self);
        let _ = self.timer.wait();
        self.slots = Slots::new(self.period);
        if !(longer && set_period(&mut Chip, WATCHDOG_MS)) {
            self.stop(UNWATCHED);
        }
        done
    }
}

/// The fault is acknowledged: the chip begins again.
fn restart() -> ! {
    survival::update(|survivor| survivor.acknowledge());
    survival::restart()
}
