//! The topics of a bag while its messages come in: what concerns the arm is kept, the rest passes.

use std::collections::HashMap;

use super::cdr::Malformed;
use super::message::{JOINT_STATE, JointState, NUMBERS, decode_numbers, unpacked};
use super::{OWN_TOPICS, bad};
use crate::limits::{self, COLUMNS, Expansion, ROWS, TOPICS, TooMuch};
use crate::recording::RecordingError;
use crate::recording::bag::joints::Joints;
use crate::recording::bag_map::BagMap;

/// Characters; ROS types have some thirty.
const LONGEST_KIND: usize = 200;

pub struct Topics<'m> {
    pub file: String,
    map: &'m BagMap,
    topics: Vec<Topic>,
    /// Index among the topics, by name.
    known: HashMap<String, usize>,
    /// How many numbers were kept so far, clocks included.
    kept: usize,
    /// Bytes of all messages in the file against bytes unpacked from them.
    expansion: Expansion,
    /// Topics of the file being read: its number of a topic -> ours.
    numbers: HashMap<u64, usize>,
}

struct Topic {
    name: String,
    kind: String,
    messages: usize,
    content: Content,
}

enum Content {
    Joints(Box<Joints>),
    Numbers(Numbers),
    /// What is not about the arm, or not asked for.
    Other,
}

/// Columns that this program wrote beside the joint states.
#[derive(Default)]
pub struct Numbers {
    pub label: String,
    pub logged: Vec<i64>,
    pub columns: Vec<Vec<f64>>,
}

impl<'m> Topics<'m> {
    pub fn new(file: String, map: &'m BagMap) -> Self {
        Self {
            file,
            map,
            topics: Vec::new(),
            known: HashMap::new(),
            kept: 0,
            expansion: Expansion::default(),
            numbers: HashMap::new(),
        }
    }

    /// A bag may go on in another file, which numbers its topics anew.
    pub fn next_file(&mut self) {
        self.numbers.clear();
    }

    /// Joint states so far.
    pub fn joint_states(&self) -> usize {
        let joints = |t: &&Topic| matches!(t.content, Content::Joints(_));
        self.topics.iter().filter(joints).map(|t| t.messages).sum()
    }

    /// The file's topic `number`; `encoding` is how its messages are written ("cdr").
    pub fn add(
        &mut self,
        number: u64,
        name: &str,
        kind: &str,
        encoding: &str,
    ) -> Result<(), RecordingError> {
        let at = match self.known.get(name) {
            Some(at) => *at,
            None => {
                let content = self.content(name, kind, encoding)?;
                // A kind may be the same for many topics, and as long as a file.
                let kind = kind.chars().take(LONGEST_KIND).collect();
                let topic = Topic { name: name.into(), kind, messages: 0, content };
                self.topics.push(topic);
                TOPICS.allow(self.topics.len() as u64).map_err(|e| self.too_much(e))?;
                self.known.insert(name.into(), self.topics.len() - 1);
                self.topics.len() - 1
            }
        };
        self.numbers.insert(number, at);
        Ok(())
    }

    fn content(&self, name: &str, kind: &str, encoding: &str) -> Result<Content, RecordingError> {
        let asked = self.map.topic.as_ref().is_none_or(|t| t == name);
        let joints = kind == JOINT_STATE || kind == "sensor_msgs/JointState";
        if joints && asked && encoding != "cdr" {
            return Err(bad(
                &self.file,
                format!("the joint states of {name} are encoded as {encoding:?}, not as CDR"),
                "convert the bag to ROS 2 (rosbags-convert)",
            ));
        }
        Ok(match kind {
            _ if joints && asked => Content::Joints(Box::default()),
            NUMBERS if name.starts_with(OWN_TOPICS) => Content::Numbers(Numbers::default()),
            _ => Content::Other,
        })
    }

    /// Whether the messages of this topic of the file are needed.
    pub fn wants(&self, number: u64) -> bool {
        let topic = self.numbers.get(&number).and_then(|at| self.topics.get(*at));
        topic.is_some_and(|t| !matches!(t.content, Content::Other))
    }

    /// A message as recorded at `logged`, ns.
    pub fn message(&mut self, number: u64, logged: i64, data: &[u8]) -> Result<(), RecordingError> {
        let Some(topic) = self.numbers.get(&number).and_then(|at| self.topics.get_mut(*at)) else {
            return Ok(());
        };
        topic.messages += 1;
        self.expansion.take(data.len() as u64);
        let before = topic.content.numbers();
        let taken = unpacked(data, &mut self.expansion).and_then(|data| match &mut topic.content {
            Content::Joints(joints) => JointState::decode(&data)
                .and_then(|state| joints.add(&state, logged, self.map).map_err(Malformed)),
            Content::Numbers(numbers) => numbers.add(logged, &data),
            Content::Other => Ok(()),
        });
        self.kept += topic.content.numbers() - before;
        let rows = topic.content.rows() as u64;
        taken.map_err(|Malformed(what)| RecordingError::Message {
            file: self.file.clone(),
            topic: topic.name.clone(),
            message: topic.messages,
            what,
        })?;
        let few = ROWS.allow(rows).and_then(|()| limits::NUMBERS.allow(self.kept as u64));
        few.map_err(|limit| self.too_much(limit))
    }

    fn too_much(&self, limit: TooMuch) -> RecordingError {
        RecordingError::TooMuch { file: self.file.clone(), limit }
    }

    /// The one topic with the arm's joint states, its name, and the columns written beside it.
    pub fn settle(self) -> Result<(String, Joints, Vec<Numbers>), RecordingError> {
        let listed = self.listed();
        let (mut arms, mut numbers, mut strangers) = (Vec::new(), Vec::new(), None);
        for topic in self.topics {
            match topic.content {
                Content::Joints(joints) if joints.samples() > 0 => arms.push((topic.name, *joints)),
                Content::Joints(joints) if topic.messages > 0 => strangers = Some(joints.strangers),
                Content::Numbers(found) if !found.columns.is_empty() => numbers.push(found),
                _ => {}
            }
        }
        let file = &self.file;
        match (arms.len(), &self.map.topic, strangers) {
            (1, ..) => {}
            (2.., ..) => {
                let names: Vec<_> = arms.iter().map(|(name, _)| name.as_str()).collect();
                let what = format!("joint states on {} topics: {}", arms.len(), names.join(", "));
                return Err(bad(file, what, "say which in a column map: [bag] topic = \"...\""));
            }
            (_, _, Some(names)) => {
                return Err(bad(
                    file,
                    format!("none of the joints is known as an arm's: {}", names.join(", ")),
                    "name them from base to wrist in a column map: [bag] joints = [\"...\"]",
                ));
            }
            (_, Some(topic), None) => {
                let what = format!("no joint states on topic {topic:?}; topics there: {listed}");
                return Err(bad(file, what, "correct the column map"));
            }
            (_, None, None) => {
                let what = format!("no topic with {JOINT_STATE} messages; topics there: {listed}");
                return Err(bad(file, what, "record /joint_states too"));
            }
        }
        let (name, joints) = arms.remove(0);
        Ok((name, joints, numbers))
    }

    /// Topics and their types, the first few.
    fn listed(&self) -> String {
        let shown = |t: &Topic| format!("{} ({}, {} messages)", t.name, t.kind, t.messages);
        let mut all: Vec<String> = self.topics.iter().take(8).map(shown).collect();
        if self.topics.len() > all.len() {
            all.push(format!("... ({} in all)", self.topics.len()));
        }
        if all.is_empty() { "none".into() } else { all.join(", ") }
    }
}

impl Content {
    fn rows(&self) -> usize {
        match self {
            Self::Joints(joints) => joints.samples(),
            Self::Numbers(numbers) => numbers.logged.len(),
            Self::Other => 0,
        }
    }

    /// How many numbers are kept, clocks included.
    fn numbers(&self) -> usize {
        match self {
            Self::Joints(joints) => joints.samples() * (joints.columns() + 2),
            Self::Numbers(numbers) => numbers.logged.len() * (numbers.columns.len() + 1),
            Self::Other => 0,
        }
    }
}

impl Numbers {
    fn add(&mut self, logged: i64, data: &[u8]) -> Result<(), Malformed> {
        let (label, values) = decode_numbers(data)?;
        COLUMNS.allow(values.len() as u64).map_err(|e| Malformed(e.to_string()))?;
        if self.columns.is_empty() {
            self.label = label.into();
            self.columns = vec![Vec::new(); values.len()];
        }
        if values.len() != self.columns.len() || self.label != label {
            let (found, before) = (values.len(), self.columns.len());
            return Err(Malformed(format!("it has {found} numbers where {before} came before")));
        }
        self.logged.push(logged);
        self.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        Ok(())
    }
}
