//! What a page asks for, from its JSON.

use serde_json::Value;
use trendid_link::telemetry::settings::SETTINGS;
use trendid_link::telemetry::{Request, Trick};

/// What a page asks for.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PageRequest {
    /// To be in control.
    Control,
    /// A request to the target.
    Target(Request),
    /// A record, begun or ended.
    Record(bool),
}

/// Reads a message of a page; what it does not understand is refused in one sentence.
pub(super) fn read(text: &str) -> Result<PageRequest, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
    let message = Message(&value);
    match message.word("do") {
        "control" => Ok(PageRequest::Control),
        "record" => {
            let on = value.get("on").and_then(Value::as_bool);
            on.map(PageRequest::Record)
                .ok_or_else(|| "`on` is not true or false".into())
        }
        done => message.request(done).map(PageRequest::Target),
    }
}

/// A message of a page.
struct Message<'a>(&'a Value);

impl<'a> Message<'a> {
    /// A text; empty where there is none.
    fn word(&self, name: &str) -> &'a str {
        self.0.get(name).and_then(Value::as_str).unwrap_or_default()
    }

    fn number(&self, name: &str) -> Result<f32, String> {
        let found = self.0.get(name).and_then(finite);
        found.ok_or_else(|| format!("`{name}` is not a finite number"))
    }

    fn request(&self, done: &str) -> Result<Request, String> {
        Ok(match done {
            "commission" => Request::Commission,
            "move" => Request::Move(self.number("target")?),
            "oscillate" => Request::Oscillate {
                amplitude: self.number("amplitude")?,
                frequency: self.number("frequency")?,
            },
            "stop" => Request::Stop,
            "limits" => Request::Limits {
                velocity: self.number("velocity")?,
                acceleration: self.number("acceleration")?,
                jerk: self.number("jerk")?,
            },
            "set" => self.setting()?,
            "install" => Request::Install(self.model()?),
            "store" => Request::Store,
            "acknowledge" => Request::Acknowledge,
            "play" => Request::Play(trick(self.word("trick"))?),
            other => return Err(format!("`{}` is nothing that can be asked", short(other))),
        })
    }

    fn setting(&self) -> Result<Request, String> {
        let name = self.word("name");
        let setting = SETTINGS
            .iter()
            .position(|setting| setting.name == name)
            .ok_or_else(|| format!("there is no setting `{}`", short(name)))?
            as u8;
        let value = match self.0.get("value") {
            Some(Value::Null) => None,
            _ => Some(self.number("value")?),
        };
        Ok(Request::Set { setting, value })
    }

    fn model(&self) -> Result<[f32; 6], String> {
        let model = self.0.get("model").and_then(Value::as_array);
        let numbers: Option<Vec<f32>> = model.and_then(|model| model.iter().map(finite).collect());
        numbers
            .and_then(|numbers| numbers.try_into().ok())
            .ok_or_else(|| "`model` is not a1, a2, b0, dead zone, offset, friction".into())
    }
}

/// A number that is finite as an `f32`, too.
fn finite(value: &Value) -> Option<f32> {
    let number = value.as_f64().map(|x| x as f32);
    number.filter(|x| x.is_finite())
}

fn trick(name: &str) -> Result<Trick, String> {
    Ok(match name {
        "heal" => Trick::Heal,
        "freeze" => Trick::FreezeSensor,
        "lose" => Trick::LoseReadings,
        "close" => Trick::CloseValve,
        "mass" => Trick::TripleMass,
        _ => return Err(format!("there is no trick `{}`", short(name))),
    })
}

/// The begin of a word that a page has sent.
fn short(word: &str) -> String {
    word.chars().take(20).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn every_request_is_understood() {
        let ask = |text: &str| read(text).unwrap();
        assert_eq!(
            ask(r#"{"do":"move","target":120}"#),
            PageRequest::Target(Request::Move(120.0))
        );
        assert_eq!(
            ask(r#"{"do":"record","on":true}"#),
            PageRequest::Record(true)
        );
        assert_eq!(
            ask(r#"{"do":"play","trick":"freeze"}"#),
            PageRequest::Target(Request::Play(Trick::FreezeSensor))
        );
        let memory = SETTINGS.iter().position(|s| s.name == "memory");
        let set = Request::Set {
            setting: memory.unwrap() as u8,
            value: Some(2.0),
        };
        assert_eq!(
            ask(r#"{"do":"set","name":"memory","value":2}"#),
            PageRequest::Target(set)
        );
        for word in ["control", "commission", "stop", "store", "acknowledge"] {
            ask(&format!(r#"{{"do":"{word}"}}"#));
        }
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        for target in ["null", "\"1\"", "1e39", "[]", "{}", "true"] {
            assert!(
                read(&format!(r#"{{"do":"move","target":{target}}}"#)).is_err(),
                "{target}"
            );
        }
        assert!(read(r#"{"do":"install","model":[1,2,3,4,5]}"#).is_err());
        assert!(read(r#"{"do":"set","name":"no","value":1}"#).is_err());
        assert!(read("").is_err() && read("[]").is_err() && read("{}").is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

        #[test]
        fn any_text_is_refused_or_understood(text in ".{0,200}") {
            let _ = read(&text);
        }

        #[test]
        fn whatever_is_asked_is_finite(name in "[a-z]{0,12}", x in any::<f64>(), key in "[a-z]{0,9}") {
            let text = serde_json::json!({"do": name, key: x, "target": x, "amplitude": x, "frequency": x}).to_string();
            if let Ok(PageRequest::Target(Request::Move(x) | Request::Oscillate { amplitude: x, .. })) = read(&text) {
                prop_assert!(x.is_finite());
            }
        }
    }
}
