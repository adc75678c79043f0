//! `identify --with inertia`: the links from data.

use anyhow::{Context, bail};
use serde::Serialize;

use super::{Args, Loaded};
use crate::identification::{
    self, Inertial, LEVEL, Located, Method, MethodResult, ParameterEstimate, Settings, Terms,
};
use crate::rigid_body::{made_possible, parameters};
use crate::robot::{Inertia, Robot};
use crate::statistics::normal_quantile;
use crate::twin::Twin;

/// What the name stands for in `--with` and `--terms`: no effect of the catalogue.
pub const NAME: &str = "inertia";

/// The rigid body as these data have it.
#[derive(Serialize)]
pub struct RigidBody {
    /// How many base parameters the arm has beside rotors that are fitted, and how many of them this
    /// recording tells.
    pub rank: usize,
    pub told: usize,
    /// Of the base parameters' columns, each in units of what the model's links could have.
    pub condition: f64,
    pub base: Vec<BaseRow>,
    /// Per joint, what its rotor inertia cannot be told from; empty where it is alone.
    pub beside_rotors: Vec<String>,
    /// Parameters without any torque.
    pub unseen: Vec<String>,
    /// How far links are from the model's, as a share of a mass, that the data call for.
    pub spread: f64,
    pub links: Vec<Link>,
    pub notes: Vec<String>,
    /// Root mean square that is left at each joint, N.m.
    pub torque: Vec<Left>,
    #[serde(skip)]
    pub fitted: Fitted,
}

/// The twin with the links found, and everything else fitted again beside them.
pub struct Fitted {
    pub around: Twin,
    pub fit: Loaded,
    pub result: MethodResult,
}

#[derive(Serialize)]
pub struct BaseRow {
    #[serde(flatten)]
    pub estimate: ParameterEstimate,
    /// The sum that it stands for.
    pub group: String,
    pub model: f64,
    /// What the model's links could have.
    pub size: f64,
}

#[derive(Serialize)]
pub struct Link {
    pub link: String,
    pub mass_kg: Value,
    pub centre_m: [f64; 3],
    pub centre_model_m: [f64; 3],
    /// About the centre, [xx, xy, xz, yy, yz, zz].
    pub inertia_kgm2: [f64; 6],
    pub inertia_model_kgm2: [f64; 6],
}

/// 99 % interval.
#[derive(Serialize)]
pub struct Value {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub model: f64,
}

#[derive(Serialize)]
pub struct Left {
    pub recording: String,
    /// By the twin as it was given, by base parameters of least squares within their ranges, by the links.
    pub given_nm: Vec<f64>,
    pub least_squares_nm: Vec<f64>,
    pub links_nm: Vec<f64>,
}

/// Half of what links weigh, and more: what looks like links may be something else.
const IMPLAUSIBLE: f64 = 0.5;

/// What the inertial parameters are fitted beside.
pub struct Beside<'a> {
    pub args: &'a Args,
    pub terms: &'a Terms,
    pub around: &'a Twin,
    pub located: &'a [Located],
    pub settings: &'a Settings,
}

impl Beside<'_> {
    /// Adds the base parameters to both problems.
    pub fn attach(&self, fit: &mut Loaded, check: Option<&mut Loaded>) -> anyhow::Result<Inertial> {
        let mut inertial = Inertial::of(self.around, self.terms);
        for loaded in std::iter::once(fit).chain(check) {
            inertial.attach(&mut loaded.problem, &loaded.samples, self.around)?;
        }
        Ok(inertial)
    }

    /// Takes the rigid body out of `results` and works out its links; `given` are the problems
    /// without it.
    pub fn rigid_body(
        &self,
        inertial: &Inertial,
        results: &mut [MethodResult],
        given: (Loaded, Option<Loaded>),
        fit: &Loaded,
        check: Option<&Loaded>,
    ) -> anyhow::Result<RigidBody> {
        let settings = Settings { methods: vec![Method::Nlse], ..self.settings.clone() };
        let by = |fit: &Loaded, check: Option<&Loaded>| -> anyhow::Result<MethodResult> {
            let check = check.map(|c| &c.problem);
            let mut all = identification::identify(&fit.problem, check, &settings)?;
            all.pop().context("nothing was fitted")
        };
        let as_given = by(&given.0, given.1.as_ref())?;
        let (model, mut notes) = possible(&self.around.robot);
        let place = results.iter().position(|r| r.method == Method::Nlse.name()).unwrap_or(0);
        let links = inertial
            .links(&fit.problem, &results[place], &model, self.args.total_mass)
            .context("a link of the model has no mass or extent")?;
        if links.spread >= IMPLAUSIBLE {
            notes.push(format!(
                "links are off by {:.0} % of their masses: is something else missing, such as \
                 rotor_inertia or payload (--with), or are the torque constants wrong?",
                100.0 * links.spread
            ));
        }
        let condition = inertial.condition(&fit.problem, &results[place]);
        let mut rows: Vec<_> = results.iter_mut().map(|r| inertial.take(&fit.problem, r)).collect();
        let base: Vec<BaseRow> = base_rows(inertial, rows.swap_remove(place));
        let robot = parameters::built_into(&self.around.robot, &links.parameters);
        let around = Twin { robot, ..self.around.clone() };
        let again =
            |loaded: Loaded| self.args.assembled(loaded.parts(), &around, self.terms, self.located);
        let fit_again = again(given.0)?;
        let check_again = given.1.map(again).transpose()?;
        let result = by(&fit_again, check_again.as_ref())?;
        let torque = [(Some(fit), false), (check, true)].into_iter();
        let torque = torque.filter_map(|(loaded, checked)| {
            let of = |r: &MethodResult| left(r, checked);
            Some(Left {
                recording: loaded?.recording.provenance.source.clone(),
                given_nm: of(&as_given),
                least_squares_nm: of(&results[place]),
                links_nm: of(&result),
            })
        });
        let torque = torque.collect();
        let dof = self.around.robot.dof();
        Ok(RigidBody {
            rank: base.len(),
            told: base.iter().filter(|b| b.estimate.identifiable).count(),
            condition,
            base,
            beside_rotors: (0..dof).map(|j| inertial.base.beside_rotor(j)).collect(),
            unseen: inertial.base.unseen.iter().map(|&i| parameters::name(i)).collect(),
            spread: links.spread,
            links: link_rows(&around.robot, &self.around.robot, &links.covariance),
            notes,
            torque,
            fitted: Fitted { around, fit: fit_again, result },
        })
    }
}

impl Args {
    pub fn asks_for_inertia(&self) -> bool {
        self.terms.iter().chain(&self.with).any(|name| name == NAME)
    }

    /// What goes with the rigid body makes sense beside it alone.
    pub fn check_inertia(&self) -> anyhow::Result<()> {
        let asked = self.asks_for_inertia();
        if !asked && (self.save_urdf.is_some() || self.total_mass.is_some()) {
            bail!("--save-urdf and --total-mass are of the links: add --with {NAME}");
        }
        if asked && self.save_twin.is_some() && self.save_urdf.is_none() {
            bail!("--save-twin with {NAME} refers to the links found: add --save-urdf FILE");
        }
        if asked
            && self.with.iter().chain(&self.terms).any(|n| n == "payload" || n == "link_inertia")
        {
            bail!(
                "--with {NAME}: a payload or a link's change cannot be told from the links themselves; \
                 leave `payload` and `link_inertia` out"
            );
        }
        match self.total_mass {
            Some(mass) if !(mass > 0.0 && mass.is_finite()) => {
                bail!("--total-mass {mass}: give the mass of all moving links, kg")
            }
            _ => Ok(()),
        }
    }
}

/// The robot with inertias that bodies can have.
fn possible(robot: &Robot) -> (Robot, Vec<String>) {
    let mut all = robot.clone();
    let mut notes = Vec::new();
    for body in &mut all.bodies {
        let mended = made_possible(&body.inertia);
        if mended != body.inertia {
            notes.push(format!(
                "{}: the model's inertia is that of no body (moments break the triangle \
                 inequality); what is nearest is taken",
                body.name
            ));
        }
        body.inertia = mended;
    }
    (all, notes)
}

fn base_rows(inertial: &Inertial, rows: Vec<ParameterEstimate>) -> Vec<BaseRow> {
    let row = |(i, estimate): (usize, ParameterEstimate)| BaseRow {
        estimate,
        group: inertial.base.group(i),
        model: inertial.model[i],
        size: inertial.sizes[i],
    };
    rows.into_iter().enumerate().map(row).collect()
}

fn link_rows(found: &Robot, model: &Robot, covariance: &nalgebra::DMatrix<f64>) -> Vec<Link> {
    let z = normal_quantile(1.0 - LEVEL);
    let both = found.bodies.iter().zip(&model.bodies).enumerate();
    let row = |(i, (new, old)): (usize, (&crate::robot::Body, &crate::robot::Body))| {
        let place = parameters::PER_LINK * i;
        let half = z * covariance[(place, place)].sqrt();
        let mass = new.inertia.mass;
        Link {
            link: new.name.clone(),
            mass_kg: Value {
                value: mass,
                low: (mass - half).max(0.0),
                high: mass + half,
                model: old.inertia.mass,
            },
            centre_m: new.inertia.com.into(),
            centre_model_m: old.inertia.com.into(),
            inertia_kgm2: six(&new.inertia),
            inertia_model_kgm2: six(&old.inertia),
        }
    };
    both.map(row).collect()
}

fn six(inertia: &Inertia) -> [f64; 6] {
    let i = inertia.about_com;
    [i.m11, i.m12, i.m13, i.m22, i.m23, i.m33]
}

fn left(result: &MethodResult, checked: bool) -> Vec<f64> {
    let of = |j: &identification::JointEstimate| if checked { j.check } else { Some(j.fit) };
    result.joints.iter().map(|j| of(j).map_or(f64::NAN, |g| g.mse_nm2.sqrt())).collect()
}
