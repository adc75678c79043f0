//! The `[effects.NAME]` tables of a scenario, checked against the catalogue.

use std::collections::BTreeMap;

use super::Injection;
use crate::effects::{self, Effect, Parameter, Scope};
use crate::twin::PerJoint;

/// The key that limits an effect to some joints, counted from 1.
pub(super) const JOINTS: &str = "joints";

/// One injection per table; the values of effects named in `beyond` may leave the catalogue's
/// range. Messages name the key.
pub(super) fn injections(
    tables: &BTreeMap<String, BTreeMap<String, PerJoint>>,
    beyond: &[String],
    dof: usize,
) -> Result<Vec<Injection>, String> {
    if let Some(name) = beyond.iter().find(|name| !tables.contains_key(*name)) {
        return Err(format!("beyond_range has {name}, but there is no table [effects.{name}]"));
    }
    let free = |name| beyond.iter().any(|b| b == name);
    tables.iter().map(|(name, table)| injection(name, table, free(name), dof)).collect()
}

fn injection(
    name: &str,
    table: &BTreeMap<String, PerJoint>,
    beyond_range: bool,
    dof: usize,
) -> Result<Injection, String> {
    let effect = effects::find(name).ok_or_else(|| {
        format!("effects.{name}: no such effect; choose from {}", effects::names())
    })?;
    let parameters = effect.about().parameters;
    refuse_unknown(name, table, parameters)?;
    let joints = acting_joints(name, effect, table.get(JOINTS), dof)?;
    let rows = if effect.about().scope == Scope::Arm { 1 } else { joints.len() };
    let mut values = vec![Vec::with_capacity(parameters.len()); rows];
    for p in parameters {
        let Some(given) = table.get(p.name) else {
            if let Some(usual) = p.left_out() {
                values.iter_mut().for_each(|row| row.push(usual));
                continue;
            }
            let Parameter { name: key, typical, unit, .. } = p;
            return Err(format!("effects.{name} lacks {key}: give it (typical: {typical} {unit})"));
        };
        let each = given.expand(rows);
        if each.len() != rows {
            return Err(format!(
                "effects.{name}.{} has {} values for {rows}: give one number for all or a list \
                 of {rows}",
                p.name,
                each.len()
            ));
        }
        for ((row, value), joint) in values.iter_mut().zip(each).zip(&joints) {
            row.push(if beyond_range {
                finite(name, p, value)
            } else {
                in_range(name, p, value, joint + 1)
            }?);
        }
    }
    for row in &mut values {
        let given = row.clone();
        let place = |key| parameters.iter().position(|p| p.name == key && table.contains_key(key));
        *row =
            effects::complete(effect, |key| place(key).map(|i| given[i])).unwrap_or(given.clone());
    }
    Ok(Injection { effect, joints, values })
}

fn refuse_unknown(
    name: &str,
    table: &BTreeMap<String, PerJoint>,
    parameters: &[Parameter],
) -> Result<(), String> {
    let known = |key: &String| key == JOINTS || parameters.iter().any(|p| p.name == key);
    match table.keys().find(|key| !known(key)) {
        None => Ok(()),
        Some(key) => {
            let names: Vec<_> = parameters.iter().map(|p| p.name).collect();
            let names = names.join(", ");
            Err(format!("effects.{name}.{key}: no such parameter; {name} has {names}"))
        }
    }
}

fn acting_joints(
    name: &str,
    effect: &dyn Effect,
    given: Option<&PerJoint>,
    dof: usize,
) -> Result<Vec<usize>, String> {
    let Some(given) = given else { return Ok((0..dof).collect()) };
    if effect.about().scope == Scope::Arm {
        return Err(format!("effects.{name}.{JOINTS}: this effect has no joints; drop the key"));
    }
    let numbers = match given {
        PerJoint::All(one) => vec![*one],
        PerJoint::Each(list) => list.clone(),
    };
    let mut joints: Vec<usize> = Vec::new();
    for number in numbers {
        let joint = number as usize;
        let valid = joint as f64 == number && (1..=dof).contains(&joint);
        if !valid || joints.contains(&(joint - 1)) {
            return Err(format!(
                "effects.{name}.{JOINTS}: {number} is not a joint or comes twice: give different \
                 whole numbers from 1 to {dof}"
            ));
        }
        joints.push(joint - 1);
    }
    Ok(joints)
}

fn in_range(effect: &str, p: &Parameter, value: f64, joint: usize) -> Result<f64, String> {
    if (p.min..=p.max).contains(&value) {
        return Ok(value);
    }
    let Parameter { name, unit, min, max, .. } = p;
    Err(format!(
        "effects.{effect}.{name} = {value} {unit} at joint {joint} is out of range: give {min} to \
         {max} {unit}"
    ))
}

fn finite(effect: &str, p: &Parameter, value: f64) -> Result<f64, String> {
    let Parameter { name, min, max, .. } = p;
    let message = || {
        format!(
            "effects.{effect}.{name} = {value:e}: beyond its range ({min} to {max}) it may be a \
             thousand times as large"
        )
    };
    (!p.is_absurd(value)).then_some(value).ok_or_else(message)
}
