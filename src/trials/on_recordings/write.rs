//! A planned case as files.

use std::path::Path;

use super::plan::Plan;
use super::shape::placed;
use super::size::Graft;
use super::{Ground, Planned, graft};
use crate::effects::{Parameter, Scope};
use crate::recording::{Recording, write_csv};
use crate::trials::case::{CHECK, FIT, TWIN, new_folder, write_settings, write_text};
use crate::trials::truth::{SCHEMA, place};
use crate::trials::{Hidden, Kind, TrialError, TrueValue, Truth, seal};

impl Planned<'_> {
    /// Writes the case of a plan into `out`, its truth into the sealed folder.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, plan: &Plan, graft: Option<&Graft>, out: &Path) -> Result<(), TrialError> {
        let folder = out.join(plan.name());
        new_folder(&folder)?;
        for (i, (ground, file)) in self.pair(plan).into_iter().zip([FIT, CHECK]).enumerate() {
            write_csv(&self.recording(ground, graft, i == 0), &folder.join(file))?;
        }
        let twin = folder.join(TWIN);
        write_text(&twin, &self.twin.to_toml_at(&twin))?;
        write_settings(&folder, &self.how.settings)?;
        seal::write_truth(out, &self.truth(plan, graft))
    }

    /// The recording with the graft on it; a push acts while the first recording is made, not the second.
    pub fn recording(&self, ground: &Ground, graft: Option<&Graft>, first: bool) -> Recording {
        match graft {
            Some(g) if first || g.effect().about().name != "external_contact" => {
                graft::onto(ground, &placed(&g.injection, ground), &self.twin.drive)
            }
            _ => ground.recording.clone(),
        }
    }

    pub fn truth(&self, plan: &Plan, graft: Option<&Graft>) -> Truth {
        let pair = self.pair(plan);
        Truth {
            schema: SCHEMA.into(),
            armtwin: env!("CARGO_PKG_VERSION").into(),
            case: plan.name(),
            kind: graft.map_or(Kind::Untouched, Graft::kind),
            effects: graft.map(|g| hidden(g, pair[0])).into_iter().collect(),
            family: "recordings".into(),
            noise_nm: Vec::new(),
            third: false,
            recordings: pair.map(|g| g.recording.provenance.source.clone()).into(),
            base: plan.base.clone(),
            made: serde_json::json!({
                "draw": self.how,
                "wanted": plan.graft.map(|w| w.effect),
                "left_by_the_twin_nm": pair[0].left_nm,
            }),
        }
    }
}

fn hidden(graft: &Graft, fit: &Ground) -> Hidden {
    let injection = placed(&graft.injection, fit);
    let about = injection.effect.about();
    let joints: Vec<usize> = injection.joints.iter().map(|j| j + 1).collect();
    let value = |(i, p): (usize, &Parameter)| TrueValue {
        name: p.name.into(),
        values: injection.values.iter().map(|row| row[i]).collect(),
    };
    Hidden {
        effect: about.name.into(),
        joints: match about.scope {
            Scope::Arm => Vec::new(),
            _ => place(&joints, fit.dof()),
        },
        parameters: about.parameters.iter().enumerate().map(value).collect(),
        strength: graft.strength.clone(),
    }
}
