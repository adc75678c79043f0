//! The end that asks: from the protocol's version to rows of numbers.

use std::collections::VecDeque;

use super::frame::{Frame, Framer, Kind, put};
use super::message::{Text, Version, granted, listed};
use super::{Recipe, RtdeError, Type, type_of};

/// What is wanted of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Wish {
    pub rate_hz: f64,
    /// Without these there is nothing to talk about.
    pub needed: Vec<String>,
    /// Left out where the controller does not know them.
    pub welcome: Vec<String>,
}

/// What comes of it.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    Controller(Version),
    /// These are unknown to the controller.
    Missing(Vec<String>),
    /// Rows of this recipe follow.
    Started(Recipe),
    Row(Vec<f64>),
    Text(Text),
    Paused,
    Resumed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    AsksProtocol,
    AsksVersion,
    AsksOutputs,
    AsksStart,
    Runs,
    AsksPause,
    Paused,
    AsksResume,
}

/// The client's side of a talk. Push in what comes, send what is [`Client::outgoing`], take events.
#[derive(Debug)]
pub struct Client {
    state: State,
    wish: Wish,
    names: Vec<String>,
    recipe: Recipe,
    framer: Framer,
    out: Vec<u8>,
    events: VecDeque<Event>,
}

const PROTOCOL: u16 = 2;

impl Client {
    pub fn new(wish: Wish) -> Self {
        let names = wish.needed.iter().chain(&wish.welcome).cloned().collect();
        let mut out = Vec::new();
        put(Kind::ProtocolVersion, &PROTOCOL.to_be_bytes(), &mut out);
        Self {
            state: State::AsksProtocol,
            wish,
            names,
            recipe: Recipe::default(),
            framer: Framer::default(),
            out,
            events: VecDeque::new(),
        }
    }

    /// What is to be sent now.
    pub fn outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Asks the controller to send nothing for a while.
    pub fn pause(&mut self) {
        if self.state == State::Runs {
            self.ask(State::AsksPause, Kind::Pause, &[]);
        }
    }

    /// Asks it to go on.
    pub fn resume(&mut self) {
        if self.state == State::Paused {
            self.ask(State::AsksResume, Kind::Start, &[]);
        }
    }

    /// Whether rows are coming.
    pub fn runs(&self) -> bool {
        self.state == State::Runs
    }

    /// Whether the controller was asked to be silent.
    pub fn is_paused(&self) -> bool {
        matches!(self.state, State::AsksPause | State::Paused)
    }

    /// # Errors
    /// If that is not what a controller says; the talk is over then.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), RtdeError> {
        self.framer.push(bytes);
        while let Some(frame) = self.framer.next_frame()? {
            self.take(&frame)?;
        }
        Ok(())
    }

    fn take(&mut self, frame: &Frame) -> Result<(), RtdeError> {
        use State::{
            AsksOutputs, AsksPause, AsksProtocol, AsksResume, AsksStart, AsksVersion, Runs,
        };
        match (frame.kind, self.state) {
            (Kind::Text, _) => {
                self.events.push_back(Event::Text(Text::read(&frame.body, PROTOCOL)?));
            }
            // Some are on their way when a pause is asked for.
            (Kind::Data, Runs | AsksPause | AsksResume) => {
                self.events.push_back(Event::Row(self.recipe.row(&frame.body)?));
            }
            (Kind::ProtocolVersion, AsksProtocol) => match granted(frame)? {
                true => self.ask(AsksVersion, Kind::ControllerVersion, &[]),
                false => return Err(RtdeError::Protocol),
            },
            (Kind::ControllerVersion, AsksVersion) => {
                self.events.push_back(Event::Controller(Version::read(frame)?));
                self.ask_outputs();
            }
            (Kind::SetupOutputs, AsksOutputs) => self.agree(&frame.body)?,
            (Kind::Start, AsksStart | AsksResume) => {
                if !granted(frame)? {
                    return Err(RtdeError::Refused("start"));
                }
                self.events.push_back(match self.state {
                    AsksStart => Event::Started(self.recipe.clone()),
                    _ => Event::Resumed,
                });
                self.state = Runs;
            }
            (Kind::Pause, AsksPause) => {
                if !granted(frame)? {
                    return Err(RtdeError::Refused("pause"));
                }
                self.state = State::Paused;
                self.events.push_back(Event::Paused);
            }
            (kind, _) => return Err(RtdeError::Unexpected(kind)),
        }
        Ok(())
    }

    fn ask(&mut self, state: State, kind: Kind, body: &[u8]) {
        self.state = state;
        put(kind, body, &mut self.out);
    }

    fn ask_outputs(&mut self) {
        let names = self.names.join(",");
        let body = [&self.wish.rate_hz.to_be_bytes()[..], names.as_bytes()].concat();
        self.ask(State::AsksOutputs, Kind::SetupOutputs, &body);
    }

    /// Takes the types of what was asked for; what the controller does not know is asked for no more.
    fn agree(&mut self, body: &[u8]) -> Result<(), RtdeError> {
        let (id, types) = body.split_first().ok_or(RtdeError::Text)?;
        let types = listed(types)?;
        if types.len() != self.names.len() {
            return Err(RtdeError::Types { asked: self.names.len(), given: types.len() });
        }
        let missing: Vec<String> = self
            .names
            .iter()
            .zip(&types)
            .filter(|(_, t)| **t == "NOT_FOUND")
            .map(|(n, _)| n.clone())
            .collect();
        if let Some(name) = missing.iter().find(|name| self.wish.needed.contains(name)) {
            return Err(RtdeError::NotFound(name.clone()));
        }
        if !missing.is_empty() {
            self.names.retain(|name| !missing.contains(name));
            self.events.push_back(Event::Missing(missing));
            self.ask_outputs();
            return Ok(());
        }
        let fields = self.names.iter().zip(types).map(|(name, t)| typed(name, t));
        self.recipe = Recipe { id: *id, fields: fields.collect::<Result<_, _>>()? };
        self.ask(State::AsksStart, Kind::Start, &[]);
        Ok(())
    }
}

/// A quantity of the type that RTDE gives it; one that is not known here is believed.
fn typed(name: &str, given: &str) -> Result<(String, Type), RtdeError> {
    let unknown =
        || RtdeError::UnknownType { name: name.into(), given: given.chars().take(40).collect() };
    let given = Type::named(given).ok_or_else(unknown)?;
    match type_of(name) {
        Some(expected) if expected != given => Err(RtdeError::OtherType {
            name: name.into(),
            given: given.name(),
            expected: expected.name(),
        }),
        _ => Ok((name.into(), given)),
    }
}
