//! `TWIN.toml`: read, checked key by key, written back.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Twin;
use super::parts::{DriveTable, PerJoint, ServoTable, named_from, read_robot};
use crate::effects::{self, Parameter, Scope};
use crate::files::write_whole;
use crate::limits::read_settings;
use crate::robot::{Chain, RobotError, plausible};

/// Names the file, and the key where there is one.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    #[error("{}: cannot read the twin: {source}", file.display())]
    Read { file: PathBuf, source: io::Error },
    #[error("{}: cannot write the twin: {source}", file.display())]
    Write { file: PathBuf, source: io::Error },
    /// Not TOML, or a key or type that does not belong there.
    #[error("{}: {problem}", file.display())]
    Syntax { file: PathBuf, problem: String },
    #[error("{}: `{key}` {problem}", file.display())]
    Value { file: PathBuf, key: String, problem: String },
    #[error("{}: `robot`: {source}", file.display())]
    Robot { file: PathBuf, source: RobotError },
    #[error("{}: {}{source}", file.display(), table(source))]
    Drive { file: PathBuf, source: RobotError },
}

/// Where a wrong value stands, for messages; a servo's says so itself.
fn table(wrong: &RobotError) -> &'static str {
    if matches!(wrong, RobotError::Servo(_)) { "" } else { "`[drive]`: " }
}

/// The file as written; what is left out takes the UR5's value where there is one.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Contents {
    robot: Option<String>,
    /// Links between which the arm is, if the robot is more than an arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    base: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tip: Option<String>,
    /// What loads are bolted to, if more of the arm moves beyond that.
    #[serde(skip_serializing_if = "Option::is_none")]
    flange: Option<String>,
    drive: DriveTable,
    /// Where the motors are position servos.
    #[serde(skip_serializing_if = "Option::is_none")]
    servo: Option<ServoTable>,
    twin: TwinTable,
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct TwinTable {
    effects: Option<Vec<String>>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    values: BTreeMap<String, PerJoint>,
}

impl Twin {
    /// Reads and checks a `TWIN.toml`. A URDF's path counts from the folder of the file.
    ///
    /// # Errors
    /// If the file cannot be read, is not TOML, has an unknown key, or a value does not fit.
    pub fn load(path: &Path) -> Result<Self, TwinError> {
        let text =
            read_settings(path).map_err(|source| TwinError::Read { file: path.into(), source })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a `TWIN.toml`; `file` is for messages and relative paths.
    ///
    /// # Errors
    /// As [`Twin::load`].
    pub fn parse(text: &str, file: &Path) -> Result<Self, TwinError> {
        let contents: Contents = toml::from_str(text).map_err(|e| TwinError::Syntax {
            file: file.into(),
            problem: e.to_string().trim_end().to_string(),
        })?;
        let name = contents.robot.unwrap_or_else(|| Self::default().source);
        let chain = Chain { base: contents.base, tip: contents.tip, flange: contents.flange };
        let (source, loaded) = read_robot(&name, &chain, file)
            .map_err(|source| TwinError::Robot { file: file.into(), source })?;
        let (robot, notes) = (loaded.robot, loaded.notes);
        let drive = contents
            .drive
            .on(&source, robot.dof(), contents.servo.as_ref())
            .map_err(|source| TwinError::Drive { file: file.into(), source })?;
        let wrong = |(key, problem)| TwinError::Value { file: file.into(), key, problem };
        let effects = contents.twin.effects.unwrap_or_else(|| Self::default().effects);
        check_effects(&effects).map_err(wrong)?;
        let values = check_values(&contents.twin.values, &effects, robot.dof()).map_err(wrong)?;
        let twin = Self { source, chain, robot, notes, drive, effects, values };
        twin.refuse_absurd_links().map_err(wrong)?;
        Ok(twin)
    }

    /// Refuses links that, with the loads and changes that are known, are not like those of a machine.
    fn refuse_absurd_links(&self) -> Result<(), Wrong> {
        self.refuse_impossible()?;
        let wrong = |key: &str, joint: usize, problem: String| {
            (format!("twin.values.{key}"), format!("is impossible: link {}'s {problem}", joint + 1))
        };
        for (joint, body) in self.robot.bodies.iter().enumerate() {
            let change = self.values.get("link_mass").and_then(|v| v.get(joint)).unwrap_or(&0.0);
            if body.inertia.mass + change <= 0.0 {
                let mass = body.inertia.mass;
                let problem = format!("mass of {mass} kg changes by {change} kg, nothing is left");
                return Err(wrong("link_mass", joint, problem));
            }
        }
        for (joint, body) in self.laden().bodies.iter().enumerate() {
            let key = if joint + 1 == self.robot.dof() { "payload_mass" } else { "link_mass" };
            plausible::body(&body.inertia).map_err(|e| wrong(key, joint, e))?;
        }
        Ok(())
    }

    /// The text of a `TWIN.toml` that [`Twin::parse`] reads back as the same twin.
    pub fn to_toml(&self) -> String {
        let values = self.values.iter().map(|(k, v)| (k.clone(), PerJoint::Each(v.clone())));
        let twin = TwinTable { effects: Some(self.effects.clone()), values: values.collect() };
        let Chain { base, tip, flange } = self.chain.clone();
        let drive = DriveTable::of(&self.drive);
        let servo = self.drive.servo.as_ref().map(ServoTable::of);
        let contents =
            Contents { robot: Some(self.source.clone()), base, tip, flange, drive, servo, twin };
        // Strings, lists and numbers under fixed keys: nothing TOML cannot hold.
        toml::to_string(&contents).unwrap_or_default()
    }

    /// Text for a file at `path`, which names a URDF from its own folder: both can be moved together.
    pub fn to_toml_at(&self, path: &Path) -> String {
        match named_from(&self.source, path) {
            Some(source) => Self { source, ..self.clone() }.to_toml(),
            None => self.to_toml(),
        }
    }

    /// Writes [`Twin::to_toml_at`] under `path`, whole or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), TwinError> {
        write_whole(path, |out| out.write_all(self.to_toml_at(path).as_bytes()))
            .map_err(|source| TwinError::Write { file: path.into(), source })
    }
}

/// Key and what is wrong with it.
type Wrong = (String, String);

fn check_effects(names: &[String]) -> Result<(), Wrong> {
    for (i, name) in names.iter().enumerate() {
        let wrong = |problem| Err(("twin.effects".to_string(), problem));
        if effects::find(name).is_none() {
            let known = effects::names();
            return wrong(format!("has the unknown effect `{name}`; choose from {known}"));
        }
        if names[..i].contains(name) {
            return wrong(format!("lists `{name}` twice; drop one"));
        }
    }
    Ok(())
}

/// Every value belongs to a listed effect and fits its parameter.
fn check_values(
    given: &BTreeMap<String, PerJoint>,
    effects: &[String],
    dof: usize,
) -> Result<BTreeMap<String, Vec<f64>>, Wrong> {
    let abouts: Vec<_> =
        effects.iter().filter_map(|name| effects::find(name)).map(|e| e.about()).collect();
    let parameters = || abouts.iter().flat_map(|a| a.parameters.iter().map(|p| (a.scope, p)));
    let mut values = BTreeMap::new();
    for (name, value) in given {
        let Some((scope, parameter)) = parameters().find(|(_, p)| p.name == name) else {
            let known: Vec<_> = parameters().map(|(_, p)| p.name).collect();
            let problem = format!(
                "belongs to none of the effects in twin.effects; their parameters are {}",
                known.join(", ")
            );
            return Err((format!("twin.values.{name}"), problem));
        };
        let count = if scope == Scope::Arm { 1 } else { dof };
        let each = value.expand(count);
        check_value(parameter, &each, count)
            .map_err(|problem| (format!("twin.values.{name}"), problem))?;
        values.insert(name.clone(), each);
    }
    Ok(values)
}

fn check_value(parameter: &Parameter, values: &[f64], count: usize) -> Result<(), String> {
    if values.len() != count {
        return Err(format!(
            "has {} values, {count} expected: give {}",
            values.len(),
            if count == 1 { "one for the whole arm" } else { "one per joint or one for all" }
        ));
    }
    let signed = |v: f64| v >= 0.0 || parameter.min < 0.0;
    let positive = |v: f64| v > 0.0 || parameter.min <= 0.0;
    match values.iter().find(|&&v| parameter.is_absurd(v) || !(signed(v) && positive(v))) {
        None => Ok(()),
        Some(v) if v.abs() >= 1e9 => Err(format!(
            "has the value {v:e}; physical values are {} to {} {}",
            parameter.min, parameter.max, parameter.unit
        )),
        Some(v) => Err(format!(
            "has the value {v}; physical values are {} to {} {}",
            parameter.min, parameter.max, parameter.unit
        )),
    }
}
