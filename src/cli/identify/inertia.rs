//! `identify --with inertia`: the links from data.

use anyhow::{Context, bail};
use serde::Serialize;

use super::{Args, Loaded};
use crate::identification::{
    self, Inertial, LEVEL, Located, Method, MethodResult, ParameterEstimate, Settings, Terms,
};
use crate::report::{table, to_uncertainty};
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
    rank: usize,
    told: usize,
    /// Of the base parameters' columns, each in units of what the model's links could have.
    condition: f64,
    base: Vec<BaseRow>,
    /// Per joint, what its rotor inertia cannot be told from; empty where it is alone.
    beside_rotors: Vec<String>,
    /// Parameters without any torque.
    unseen: Vec<String>,
    /// How far links are from the model's, as a share of a mass, that the data call for.
    spread: f64,
    links: Vec<Link>,
    notes: Vec<String>,
    /// Root mean square that is left at each joint, N.m.
    torque: Vec<Left>,
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
struct BaseRow {
    #[serde(flatten)]
    estimate: ParameterEstimate,
    /// The sum that it stands for.
    group: String,
    model: f64,
    /// What the model's links could have.
    size: f64,
}

#[derive(Serialize)]
struct Link {
    link: String,
    mass_kg: Value,
    centre_m: [f64; 3],
    centre_model_m: [f64; 3],
    /// About the centre, [xx, xy, xz, yy, yz, zz].
    inertia_kgm2: [f64; 6],
    inertia_model_kgm2: [f64; 6],
}

/// 99 % interval.
#[derive(Serialize)]
struct Value {
    value: f64,
    low: f64,
    high: f64,
    model: f64,
}

#[derive(Serialize)]
struct Left {
    recording: String,
    /// By the twin as it was given, by the base parameters of least squares, by the links.
    given_nm: Vec<f64>,
    least_squares_nm: Vec<f64>,
    links_nm: Vec<f64>,
}

/// More than this from the model, and what looks like links is something else.
const IMPLAUSIBLE: f64 = 1.0;

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

pub fn print(body: &RigidBody) {
    println!(
        "\nRigid body: {} base parameters, of which this recording tells {}; condition number {:.0}",
        body.rank, body.told, body.condition
    );
    println!("{}", table(&BASE, 1, body.base.iter().map(base_cells)));
    for (joint, with) in body.beside_rotors.iter().enumerate().filter(|(_, with)| !with.is_empty())
    {
        println!("rotor inertia of joint {} is told with {with} only", joint + 1);
    }
    not_told(body).iter().for_each(|line| println!("not told: {line}"));
    println!(
        "\nLinks: the most probable ones that bodies can have; these data call for links {:.1} % from \
         the model's",
        100.0 * body.spread
    );
    println!("{}", table(&LINKS, 1, body.links.iter().map(link_cells)));
    body.notes.iter().for_each(|note| println!("note: {note}"));
    println!("\nTorque left, N.m (root mean square)");
    let joints = body.torque.first().map_or(0, |t| t.given_nm.len());
    let mut header = vec!["recording".to_string(), "rigid body".to_string()];
    header.extend((1..=joints).map(|j| format!("joint {j}")));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    println!("{}", table(&header, 2, body.torque.iter().flat_map(torque_cells)));
}

/// Which base parameters these data do not tell, one line per reason.
fn not_told(body: &RigidBody) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for e in body.base.iter().map(|b| &b.estimate) {
        let Some(why) = e.why_not.as_deref() else { continue };
        match reasons.iter_mut().find(|(reason, _)| *reason == why) {
            Some((_, names)) => names.push(&e.name),
            None => reasons.push((why, vec![&e.name])),
        }
    }
    reasons.iter().map(|(why, names)| format!("{}: {why}", names.join(", "))).collect()
}

const BASE: [&str; 7] = ["parameter", "unit", "value", "99 % low", "high", "model", "stands for"];
const LINKS: [&str; 6] = ["link", "mass kg", "99 % low", "high", "model", "centre m (model)"];

fn base_cells(row: &BaseRow) -> Vec<String> {
    let e = &row.estimate;
    let [value, low, high] = to_uncertainty(e.value, e.low, e.high);
    let [low, high] = if e.identifiable { [low, high] } else { ["-".into(), "-".into()] };
    vec![
        e.name.clone(),
        e.unit.clone(),
        value,
        low,
        high,
        format!("{:.4}", row.model),
        row.group.clone(),
    ]
}

fn link_cells(link: &Link) -> Vec<String> {
    let Value { value, low, high, model } = link.mass_kg;
    let [value, low, high] = to_uncertainty(value, low, high);
    let point = |p: &[f64; 3]| format!("{:.3} {:.3} {:.3}", p[0], p[1], p[2]);
    let centre = format!("{} ({})", point(&link.centre_m), point(&link.centre_model_m));
    vec![link.link.clone(), value, low, high, format!("{model:.3}"), centre]
}

fn torque_cells(left: &Left) -> Vec<Vec<String>> {
    let row = |name: &str, what: &str, values: &[f64]| {
        let mut cells = vec![name.to_string(), what.to_string()];
        cells.extend(values.iter().map(|v| format!("{v:.3}")));
        cells
    };
    let path = std::path::Path::new(&left.recording);
    let file = path.file_name().map_or(left.recording.clone(), |f| f.to_string_lossy().into());
    vec![
        row(&file, "as given", &left.given_nm),
        row("", "least squares", &left.least_squares_nm),
        row("", "possible links", &left.links_nm),
    ]
}
