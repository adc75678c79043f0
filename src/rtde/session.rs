//! The end that answers: one client's talk with a controller.

use std::collections::BTreeMap;

use super::fields::input_type;
use super::frame::{Frame, Framer, Kind, put};
use super::message::{Level, Text, answer, listed};
use super::{Offer, Recipe, RtdeError, Type, Version};
use crate::limits::RECIPE;

/// What a client did that somebody may want to know.
#[derive(Debug, Clone, PartialEq)]
pub enum Heard {
    Text(Text),
    /// Rows of so many quantities, so many per second, are sent from now on.
    Started {
        quantities: usize,
        rate_hz: f64,
    },
    Paused,
}

/// Where the numbers of a data package are in a row of the offer.
#[derive(Debug)]
struct Output {
    rate_hz: f64,
    parts: Vec<(Type, usize)>,
}

/// The controller's side of a talk. A client that sends what it should not is told by an error, and is to
/// be dropped.
#[derive(Debug)]
pub struct Session {
    offer: std::sync::Arc<Offer>,
    protocol: u16,
    framer: Framer,
    output: Option<Output>,
    inputs: Vec<Recipe>,
    /// What was written into registers, by column of the offer.
    written: BTreeMap<usize, f64>,
    runs: bool,
    out: Vec<u8>,
    heard: Vec<Heard>,
}

/// Number of the one recipe that is sent.
const OUTPUT_RECIPE: u8 = 1;
/// Recipes that a client may write by.
const MOST_INPUTS: usize = 16;

impl Session {
    pub fn new(offer: std::sync::Arc<Offer>) -> Self {
        Self {
            offer,
            protocol: 1,
            framer: Framer::default(),
            output: None,
            inputs: Vec::new(),
            written: BTreeMap::new(),
            runs: false,
            out: Vec::new(),
            heard: Vec::new(),
        }
    }

    /// What is to be sent now.
    pub fn outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    pub fn heard(&mut self) -> Vec<Heard> {
        std::mem::take(&mut self.heard)
    }

    /// # Errors
    /// If that is not what a client says.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), RtdeError> {
        self.framer.push(bytes);
        while let Some(frame) = self.framer.next_frame()? {
            self.take(&frame)?;
        }
        Ok(())
    }

    /// Tells the client something.
    pub fn say(&mut self, level: Level, message: &str) {
        let text = Text { level, source: "armtwin".into(), message: message.into() };
        put(Kind::Text, &text.body(self.protocol), &mut self.out);
    }

    /// Sends row `k` of the offer, if this client wants that one.
    pub fn send(&mut self, k: u64, row: &[f64]) {
        let Some(output) = self.output.as_ref().filter(|_| self.runs) else { return };
        let share = output.rate_hz / self.offer.rate_hz;
        if k > 0 && (k as f64 * share).floor() == ((k - 1) as f64 * share).floor() {
            return;
        }
        let mut body = Vec::new();
        if self.protocol > 1 {
            body.push(OUTPUT_RECIPE);
        }
        for (t, at) in &output.parts {
            let own = &row[*at..at + t.width()];
            match self.written.range(*at..at + t.width()).next() {
                Some((_, value)) => t.write(&[*value], &mut body),
                None => t.write(own, &mut body),
            }
        }
        put(Kind::Data, &body, &mut self.out);
    }

    fn take(&mut self, frame: &Frame) -> Result<(), RtdeError> {
        match frame.kind {
            Kind::ProtocolVersion => {
                let body = super::message::sized(frame, 2)?;
                let asked = u16::from_be_bytes([body[0], body[1]]);
                let known = (1..=2).contains(&asked);
                if known {
                    self.protocol = asked;
                }
                answer(Kind::ProtocolVersion, known, &mut self.out);
            }
            Kind::ControllerVersion => {
                put(Kind::ControllerVersion, &self.offer.controller().body(), &mut self.out);
            }
            Kind::Text => {
                self.heard.push(Heard::Text(Text::read(&frame.body, self.protocol)?));
            }
            Kind::SetupOutputs => self.set_up_outputs(&frame.body)?,
            Kind::SetupInputs => self.set_up_inputs(&frame.body)?,
            Kind::Start => self.start(),
            Kind::Pause => {
                self.runs = false;
                self.heard.push(Heard::Paused);
                answer(Kind::Pause, true, &mut self.out);
            }
            Kind::Data => self.write(&frame.body)?,
        }
        Ok(())
    }

    fn start(&mut self) {
        self.runs = self.output.is_some();
        if let Some(output) = &self.output {
            let (quantities, rate_hz) = (output.parts.len(), output.rate_hz);
            self.heard.push(Heard::Started { quantities, rate_hz });
        }
        answer(Kind::Start, self.runs, &mut self.out);
    }

    fn set_up_outputs(&mut self, body: &[u8]) -> Result<(), RtdeError> {
        if self.runs {
            return Err(RtdeError::Unexpected(Kind::SetupOutputs));
        }
        let (rate_hz, names) = match (self.protocol, body.split_first_chunk::<8>()) {
            (1, _) => (self.offer.rate_hz, body),
            (_, Some((rate, names))) => (f64::from_be_bytes(*rate), names),
            _ => {
                return Err(RtdeError::Body {
                    kind: Kind::SetupOutputs,
                    bytes: body.len(),
                    expected: 9,
                });
            }
        };
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(RtdeError::Rate(rate_hz.to_string()));
        }
        let names = listed(names)?;
        RECIPE.allow(names.len() as u64)?;
        let parts: Vec<Option<(Type, usize)>> = names.iter().map(|n| self.offer.find(n)).collect();
        let types = parts.iter().map(|part| part.map_or("NOT_FOUND", |(t, _)| t.name()));
        let types = types.collect::<Vec<_>>().join(",");
        let all: Option<Vec<_>> = parts.into_iter().collect();
        let id = if all.is_some() { OUTPUT_RECIPE } else { 0 };
        let rate_hz = rate_hz.min(self.offer.rate_hz);
        self.output = all.filter(|all| !all.is_empty()).map(|parts| Output { rate_hz, parts });
        self.agree(Kind::SetupOutputs, id, &types);
        Ok(())
    }

    fn set_up_inputs(&mut self, body: &[u8]) -> Result<(), RtdeError> {
        let names = listed(body)?;
        RECIPE.allow(names.len() as u64)?;
        if self.inputs.len() >= MOST_INPUTS {
            return Err(RtdeError::Unexpected(Kind::SetupInputs));
        }
        let types: Vec<Option<Type>> = names.iter().map(|n| input_type(n)).collect();
        let words = types.iter().map(|t| t.map_or("NOT_FOUND", Type::name));
        let words = words.collect::<Vec<_>>().join(",");
        let known: Option<Vec<Type>> = types.into_iter().collect();
        let mut id = 0;
        if let Some(types) = known {
            id = self.inputs.len() as u8 + 1;
            let fields = names.iter().map(ToString::to_string).zip(types).collect();
            self.inputs.push(Recipe { id, fields });
        }
        self.agree(Kind::SetupInputs, id, &words);
        Ok(())
    }

    /// Answers a set-up. Protocol 1 numbers no recipes.
    fn agree(&mut self, kind: Kind, id: u8, types: &str) {
        let body = match (kind, self.protocol) {
            (Kind::SetupOutputs, 1) => types.as_bytes().to_vec(),
            _ => [&[id], types.as_bytes()].concat(),
        };
        put(kind, &body, &mut self.out);
    }

    /// Takes what a client writes; registers read back as they were written, the arm does not heed them.
    fn write(&mut self, body: &[u8]) -> Result<(), RtdeError> {
        let id = body.first().copied().unwrap_or(0);
        let recipe = self.inputs.iter().find(|recipe| recipe.id == id);
        let recipe = recipe.ok_or(RtdeError::Unexpected(Kind::Data))?;
        let mut values = recipe.row(body)?.into_iter();
        for (name, t) in &recipe.fields {
            let own: Vec<f64> = values.by_ref().take(t.width()).collect();
            if let (Some((_, at)), [value]) = (self.offer.find(name), &own[..]) {
                self.written.insert(at, *value);
            }
        }
        Ok(())
    }
}

impl Offer {
    /// The version a client is told: controllers of the e-series send 500 rows a second, older ones 125.
    pub fn controller(&self) -> Version {
        if self.rate_hz > 125.0 { super::CONTROLLER[1] } else { super::CONTROLLER[0] }
    }
}
