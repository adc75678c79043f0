//! The links from data.

use serde::Serialize;

use crate::identification::{self, Inertial, LEVEL, MethodResult, ParameterEstimate, RigidBody};
use crate::rigid_body::parameters;
use crate::robot::{Inertia, Robot};
use crate::statistics::normal_quantile;

/// Stands for the inertial parameters of all links among the effects to fit: no effect of the catalogue.
pub const INERTIA: &str = "inertia";

/// The rigid body as these data have it, for people and scripts.
#[derive(Serialize)]
pub struct Summary {
    /// How many base parameters the arm has beside rotors that are fitted, and how many of them this
    /// recording tells.
    pub rank: usize,
    pub told: usize,
    /// Condition number of the base parameters' columns, each in units of what the model's links could have.
    pub condition: f64,
    pub base: Vec<BaseRow>,
    /// What each joint's rotor inertia cannot be told from; empty where it is alone.
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
    pub found: RigidBody,
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
    pub mass_kg: LinkValue,
    pub centre_m: [f64; 3],
    pub centre_model_m: [f64; 3],
    /// About the centre, [xx, xy, xz, yy, yz, zz].
    pub inertia_kgm2: [f64; 6],
    pub inertia_model_kgm2: [f64; 6],
}

/// 99 % interval.
#[derive(Serialize)]
pub struct LinkValue {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub model: f64,
}

#[derive(Serialize)]
pub struct Left {
    pub recording: String,
    /// Left by the twin as given, by base parameters of least squares within their ranges, by the links, N.m.
    pub given_nm: Vec<f64>,
    pub least_squares_nm: Vec<f64>,
    pub links_nm: Vec<f64>,
}

/// Half of what links weigh, and more: what looks like links may be something else.
const IMPLAUSIBLE: f64 = 0.5;

/// What is printed and written of a rigid body that was found beside the base parameters of `inertial`.
pub fn summary(
    found: RigidBody,
    inertial: &Inertial,
    model: &Robot,
    results: &[MethodResult],
    sources: [Option<&str>; 2],
) -> Summary {
    let by_base = results.iter().find(|r| r.method == found.fitted.method).unwrap_or(&found.given);
    let torque = sources.into_iter().zip([false, true]).filter_map(|(source, checked)| {
        Some(Left {
            recording: source?.into(),
            given_nm: left(&found.given, checked),
            least_squares_nm: left(by_base, checked),
            links_nm: left(&found.fitted, checked),
        })
    });
    let torque = torque.collect();
    Summary {
        rank: found.base.len(),
        told: found.base.iter().filter(|row| row.identifiable).count(),
        condition: found.condition,
        base: base_rows(inertial, &found.base),
        beside_rotors: (0..model.dof()).map(|j| inertial.base.beside_rotor(j)).collect(),
        unseen: inertial.base.unseen.iter().map(|&i| parameters::name(i)).collect(),
        spread: found.links.spread,
        links: link_rows(&found.twin.robot, model, &found.links.covariance),
        notes: notes(&found, model),
        torque,
        found,
    }
}

fn notes(found: &RigidBody, model: &Robot) -> Vec<String> {
    let mended = found.mended.iter().map(|&i| {
        format!(
            "{}: the model's inertia is that of no body (moments break the triangle inequality); \
             what is nearest is taken",
            model.bodies[i].name
        )
    });
    let spread = found.links.spread;
    let implausible = (spread >= IMPLAUSIBLE).then(|| {
        format!(
            "links are off by {:.0} % of their masses: is something else missing, such as \
             rotor_inertia or payload (--with), or are the torque constants wrong?",
            100.0 * spread
        )
    });
    mended.chain(implausible).collect()
}

fn base_rows(inertial: &Inertial, rows: &[ParameterEstimate]) -> Vec<BaseRow> {
    let row = |(i, estimate): (usize, &ParameterEstimate)| BaseRow {
        estimate: estimate.clone(),
        group: inertial.base.group(i),
        model: inertial.model[i],
        size: inertial.sizes[i],
    };
    rows.iter().enumerate().map(row).collect()
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
            mass_kg: LinkValue {
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
