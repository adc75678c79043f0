//! Cases made elsewhere: a folder of `case-*` folders with two recordings and `truth.json` each,
//! and one `twin.toml` for all.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;

use super::case::{CHECK, FIT, TWIN, case_folders, new_folder, write_settings};
use super::truth::{SCHEMA, place, seen};
use super::{Hidden, Kind, Seals, Strength, TrialError, Truth, seal};
use crate::diagnosis::Settings;
use crate::effects;
use crate::limits::read_settings;
use crate::twin::Twin;

/// What a foreign maker calls files and effects.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Names {
    /// Names of the two recordings and the label in every case folder.
    pub fit: String,
    pub check: String,
    pub truth: String,
    /// Foreign name -> name of the catalogue; `none` for nothing.
    pub effects: BTreeMap<String, String>,
}

impl Default for Names {
    fn default() -> Self {
        let pairs = [
            ("none", "none"),
            ("clean", "none"),
            ("flexibility", "joint_flexibility"),
            ("joint_offset", "encoder_offset"),
        ];
        Self {
            fit: "identification.csv.gz".into(),
            check: "validation.csv.gz".into(),
            truth: "truth.json".into(),
            effects: pairs.map(|(a, b)| (a.to_string(), b.to_string())).into(),
        }
    }
}

impl Names {
    /// # Errors
    /// If the file cannot be read or has an unknown key.
    pub fn load(file: &Path) -> Result<Self, TrialError> {
        let text = read_settings(file).map_err(TrialError::io(file, "read"))?;
        let mut names: Self = toml::from_str(&text).map_err(|e| TrialError::file(file, e))?;
        for (foreign, known) in Self::default().effects {
            names.effects.entry(foreign).or_insert(known);
        }
        Ok(names)
    }
}

/// A foreign label; what else it holds is kept as it comes.
#[derive(Debug, Deserialize)]
struct Label {
    effect: String,
    #[serde(default)]
    joints: Vec<usize>,
    #[serde(default)]
    outside_catalogue: bool,
    #[serde(default)]
    gap_over_noise: BTreeMap<String, Vec<f64>>,
}

/// Copies the cases of `from` into `out`, their labels sealed.
///
/// # Errors
/// If a file is missing, or an effect has a name that neither the catalogue nor `names` knows.
pub fn import(
    from: &Path,
    out: &Path,
    names: &Names,
    settings: &Settings,
) -> Result<Seals, TrialError> {
    let twin_file = from.join(TWIN);
    let twin = Twin::load(&twin_file)?;
    seal::make_folder(out)?;
    for folder in case_folders(from)? {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let to = out.join(&name);
        new_folder(&to)?;
        copy(&folder.join(&names.fit), &to.join(FIT))?;
        copy(&folder.join(&names.check), &to.join(CHECK))?;
        copy(&twin_file, &to.join(TWIN))?;
        write_settings(&to, settings)?;
        let truth = truth(&name, &folder.join(&names.truth), names, twin.robot.dof())?;
        seal::write_truth(out, &truth)?;
    }
    seal::seal(out, format!("cases of {}", from.display()))
}

fn copy(from: &Path, to: &Path) -> Result<(), TrialError> {
    let bytes = fs::read(from).map_err(TrialError::io(from, "read"))?;
    crate::files::write_own(to, |out| out.write_all(&bytes)).map_err(TrialError::io(to, "written"))
}

fn truth(case: &str, file: &Path, names: &Names, dof: usize) -> Result<Truth, TrialError> {
    let text = fs::read_to_string(file).map_err(TrialError::io(file, "read"))?;
    let made: serde_json::Value =
        serde_json::from_str(&text).map_err(|e| TrialError::file(file, e))?;
    let label: Label = serde_json::from_str(&text).map_err(|e| TrialError::file(file, e))?;
    let effect = names.effects.get(&label.effect).unwrap_or(&label.effect);
    let kind = match effect.as_str() {
        "none" => Kind::Clean,
        _ if label.outside_catalogue => Kind::Foreign,
        name if effects::find(name).is_none() => {
            let problem = format!(
                "the catalogue has no effect `{name}`; map it to one of its names under [effects] \
                 in the file given by --names"
            );
            return Err(TrialError::file(file, problem));
        }
        name if !seen(name) => Kind::Unseen,
        _ => Kind::Single,
    };
    let gap = label.gap_over_noise.get("identification").cloned().unwrap_or_default();
    let hidden = Hidden {
        effect: effect.clone(),
        joints: place(&label.joints, dof),
        parameters: Vec::new(),
        strength: Strength { drawn: None, own: Vec::new(), gap },
    };
    Ok(Truth {
        schema: SCHEMA.into(),
        armtwin: env!("CARGO_PKG_VERSION").into(),
        case: case.into(),
        kind,
        effects: if kind == Kind::Clean { Vec::new() } else { vec![hidden] },
        family: "elsewhere".into(),
        noise_nm: Vec::new(),
        third: false,
        recordings: Vec::new(),
        base: None,
        made,
    })
}
