//! `armtwin identify` of position servos: values by which the simulated arm goes where the recorded one did.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, bail};
use serde::Serialize;

use super::{Args, Output, refuse_same_file};
use crate::cli::by::By;
use crate::cli::out;
use crate::cli::twin::Arm;
use crate::cli::{progress, save};
use crate::recording::{Provenance, Recording};
use crate::report::table;
use crate::servo::{
    self, Estimate, Fitted, Free, PositionGap, Settings, Track, free_parameters, replay,
};
use crate::signals::{Conditioning, condition};
use crate::twin::Twin;

/// What is fitted where nobody says what: a servo's own values and the simplest friction.
const USUAL: [&str; 6] =
    ["servo_gain", "servo_offset", "servo_delay", "coulomb", "viscous", "rotor_inertia"];

/// A recording and what servos saw of it.
struct Told {
    provenance: Provenance,
    track: Track,
}

struct Run<'a> {
    args: &'a Args,
    arm: &'a Arm,
    conditioning: Conditioning,
    settings: Settings,
    terms: Vec<String>,
    fit: Vec<Told>,
    check: Vec<Told>,
}

/// Fits to `first` (already read) and the recordings named after it.
pub fn run(args: &Args, arm: &Arm, first: Recording) -> anyhow::Result<()> {
    refuse_flags(args)?;
    let conditioning = args.conditioning.conditioning();
    let mut fit = vec![told(first, arm, &conditioning)?];
    let read = |path: &Path| -> anyhow::Result<Told> {
        let mut recording = args.work.read(path, arm, args.conditioning.floor_hz())?;
        args.by.choose(&mut arm.twin.clone(), &mut [&mut recording])?;
        told(recording, arm, &conditioning)
    };
    for path in &args.recordings[1..] {
        fit.push(read(path)?);
    }
    let mut check = Vec::new();
    for path in &args.check {
        args.recordings.iter().try_for_each(|r| refuse_same_file(r, path))?;
        check.push(read(path)?);
    }
    let terms = terms(args, &arm.twin);
    let settings = Settings::default();
    let run = Run { args, arm, conditioning, settings, terms, fit, check };
    run.fit()
}

fn told(recording: Recording, arm: &Arm, how: &Conditioning) -> anyhow::Result<Told> {
    let twin = &arm.twin;
    let name = recording.provenance.source.clone();
    let samples =
        condition(&recording, &twin.drive, twin.robot.dof(), how).with_context(|| name.clone())?;
    let servo = twin.drive.servo.as_ref().ok_or(servo::ServoError::NoServo)?;
    let track = Track::new(&samples, servo).with_context(|| name)?;
    Ok(Told { provenance: recording.provenance, track })
}

/// What a twin lists without values, or the usual; `--terms` replaces, `--with` adds.
fn terms(args: &Args, twin: &Twin) -> Vec<String> {
    let open: Vec<String> = twin.open().map(|e| e.about().name.to_string()).collect();
    let mut terms = match (args.terms.is_empty(), open.is_empty()) {
        (false, _) => args.terms.clone(),
        (true, false) => open,
        (true, true) => USUAL.map(String::from).to_vec(),
    };
    let more = args.with.iter().filter(|w| !terms.contains(w)).cloned().collect::<Vec<_>>();
    terms.extend(more);
    terms
}

/// What only torque can tell.
fn refuse_flags(args: &Args) -> anyhow::Result<()> {
    let flags = [
        ("--reduce", args.reduce),
        ("--report", args.report.is_some()),
        ("--save-urdf", args.save_urdf.is_some()),
        ("--loaded", args.load.is_given()),
        ("--with inertia", args.asks_for_inertia()),
    ];
    if let Some((flag, _)) = flags.iter().find(|(_, given)| *given) {
        bail!(
            "{flag} needs recorded torque: leave it out where an arm is identified by simulation"
        );
    }
    Ok(())
}

impl Run<'_> {
    fn fit(&self) -> anyhow::Result<()> {
        let twin = &self.arm.twin;
        let mut free = free_parameters(twin, &self.terms)?;
        self.bound(&mut free);
        let tracks: Vec<Track> = self.fit.iter().map(|t| t.track.clone()).collect();
        let clock = Instant::now();
        let spinner = progress::spinner("fitting by simulation");
        let fitted = servo::identify(twin, &tracks, &free, &self.settings)?;
        spinner.finish_and_clear();
        let seconds = clock.elapsed().as_secs_f64();
        let checked = self.checked(&fitted)?;
        out::page(&self.page(&fitted, &checked, seconds));
        if let Some(path) = &self.args.json {
            self.json(path, &fitted, &checked, seconds)?;
        }
        if let Some(path) = &self.args.save_twin {
            fitted.twin.save(path)?;
            println!("\nTwin with these values: {}", path.display());
        }
        Ok(())
    }

    fn bound(&self, free: &mut [Free]) {
        for (name, [low, high]) in &self.args.bounds {
            for f in free.iter_mut().filter(|f| f.parameter.name == name) {
                (f.min, f.max, f.start) = (*low, *high, f.start.clamp(*low, *high));
            }
        }
    }

    /// Errors on the recordings that were not fitted, before and after: each led through from its begin.
    fn checked(&self, fitted: &Fitted) -> anyhow::Result<Vec<[PositionGap; 2]>> {
        let of = |told: &Told| -> anyhow::Result<[PositionGap; 2]> {
            let stretches = told.track.stretches(f64::INFINITY);
            let gap = |twin: &Twin| -> anyhow::Result<PositionGap> {
                Ok(PositionGap::new(&told.track, &replay(twin, &told.track, &stretches)?))
            };
            Ok([gap(&self.arm.twin)?, gap(&fitted.twin)?])
        };
        self.check.iter().map(of).collect()
    }

    fn page(&self, fitted: &Fitted, checked: &[[PositionGap; 2]], seconds: f64) -> String {
        let mut page = format!("{}\n{}\n\n", self.arm.line(), By::Simulation.line());
        page += &values(&fitted.estimates);
        page += &format!(
            "\n{} position errors, {} simulations of all of it, {seconds:.1} s; ended: {}\n\n",
            fitted.samples,
            fitted.evaluations,
            if fitted.stop.converged() { "converged" } else { "at the most evaluations" },
        );
        page += "Position error, mean size and root mean square in mrad; rounding: what the encoder's steps \
                 alone leave\n";
        page += &self.errors(fitted, checked);
        page
    }

    fn errors(&self, fitted: &Fitted, checked: &[[PositionGap; 2]]) -> String {
        let head =
            ["recording", "joint", "mean before", "after", "rms before", "after", "rounding"];
        let mut lines = Vec::new();
        let mut rows = |kind: &str, told: &Told, before: &PositionGap, after: &PositionGap| {
            let source = Path::new(&told.provenance.source);
            let name = source.file_name().map_or_else(String::new, |n| n.to_string_lossy().into());
            for (b, a) in before.joints.iter().zip(&after.joints) {
                let mrad = |rad: f64| format!("{:.2}", 1e3 * rad);
                lines.push(vec![
                    format!("{kind} {name}"),
                    b.joint.to_string(),
                    mrad(b.mean_abs_rad),
                    mrad(a.mean_abs_rad),
                    mrad(b.rms_rad),
                    mrad(a.rms_rad),
                    mrad(b.rounding_rad),
                ]);
            }
        };
        for ((told, before), after) in self.fit.iter().zip(&fitted.before).zip(&fitted.after) {
            rows("fit", told, before, after);
        }
        for (told, [before, after]) in self.check.iter().zip(checked) {
            rows("check", told, before, after);
        }
        table(&head, 1, lines)
    }

    fn json(
        &self,
        path: &Output,
        fitted: &Fitted,
        checked: &[[PositionGap; 2]],
        seconds: f64,
    ) -> anyhow::Result<()> {
        let of = |told: &[Told]| told.iter().map(|t| t.provenance.clone()).collect::<Vec<_>>();
        let dof = self.arm.twin.robot.dof();
        let joint = |j: usize| {
            let own = |e: &&Estimate| e.joint == Some(j + 1);
            Joint {
                joint: j + 1,
                samples: fitted.samples / dof,
                cost: fitted.cost,
                evaluations: fitted.evaluations,
                seconds,
                stopped: fitted.stop,
                fit: Share::of(j, fitted.after.iter()),
                check: Share::of(j, checked.iter().map(|[_, after]| after)),
                parameters: fitted.estimates.iter().filter(own).collect(),
            }
        };
        let document = Document {
            schema: "armtwin.identification/1",
            version: env!("CARGO_PKG_VERSION"),
            by: By::Simulation,
            recordings: of(&self.fit),
            checks: of(&self.check),
            twin: self.arm.twin.source.clone(),
            servo: self.arm.twin.drive.servo.clone(),
            terms: self.terms.clone(),
            settings: self.settings,
            conditioning: &self.conditioning,
            methods: [MethodPart {
                method: "simulation",
                joints: (0..dof).map(joint).collect(),
                arm: fitted.estimates.iter().filter(|e| e.joint.is_none()).collect(),
                fit: Gaps { before: fitted.before.clone(), after: fitted.after.clone() },
                check: Gaps {
                    before: checked.iter().map(|[b, _]| b.clone()).collect(),
                    after: checked.iter().map(|[_, a]| a.clone()).collect(),
                },
            }],
        };
        save::document(path, &document)
    }
}

fn values(estimates: &[Estimate]) -> String {
    let head = ["parameter", "joint", "value", "99 % interval", "unit", ""];
    let row = |e: &Estimate| {
        let interval = match e.identifiable {
            true => format!("{:.4} .. {:.4}", e.low, e.high),
            false => String::new(),
        };
        let remark = match (e.identifiable, e.at_bound) {
            (false, _) => "not told by these data",
            (_, true) => "at its bound",
            _ => "",
        };
        vec![
            e.name.to_string(),
            e.joint.map_or_else(|| "arm".into(), |j| j.to_string()),
            format!("{:.4}", e.value),
            interval,
            e.unit.into(),
            remark.into(),
        ]
    };
    table(&head, 1, estimates.iter().map(row)) + "\n"
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    version: &'static str,
    by: By,
    recordings: Vec<Provenance>,
    checks: Vec<Provenance>,
    twin: String,
    servo: Option<crate::robot::Servo>,
    terms: Vec<String>,
    settings: Settings,
    conditioning: &'a Conditioning,
    methods: [MethodPart<'a>; 1],
}

#[derive(Serialize)]
struct MethodPart<'a> {
    method: &'static str,
    joints: Vec<Joint<'a>>,
    /// Values of the whole arm.
    arm: Vec<&'a Estimate>,
    /// Position errors, recording by recording.
    fit: Gaps,
    check: Gaps,
}

#[derive(Serialize)]
struct Gaps {
    before: Vec<PositionGap>,
    after: Vec<PositionGap>,
}

#[derive(Serialize)]
struct Joint<'a> {
    joint: usize,
    samples: usize,
    cost: f64,
    evaluations: usize,
    seconds: f64,
    stopped: crate::identification::levenberg_marquardt::Stop,
    fit: Option<Share>,
    check: Option<Share>,
    parameters: Vec<&'a Estimate>,
}

/// Errors of a joint over several recordings, each counting alike.
#[derive(Serialize)]
struct Share {
    r2: f64,
    mse_rad2: f64,
    mean_abs_rad: f64,
}

impl Share {
    fn of<'g>(j: usize, gaps: impl Iterator<Item = &'g PositionGap>) -> Option<Self> {
        let all: Vec<_> = gaps.map(|g| g.joints[j]).collect();
        let n = all.len() as f64;
        (!all.is_empty()).then(|| Self {
            r2: all.iter().map(|g| g.r2).sum::<f64>() / n,
            mse_rad2: all.iter().map(|g| g.rms_rad.powi(2)).sum::<f64>() / n,
            mean_abs_rad: all.iter().map(|g| g.mean_abs_rad).sum::<f64>() / n,
        })
    }
}
