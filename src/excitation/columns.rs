//! What is asked for, and what is open besides, as columns of torque along a motion.

use super::ask::{Ask, Term};
use crate::effects::{Effect, Motion, Parameter, Role, Scope, find};
use crate::rigid_body::parameters;
use crate::robot::{Robot, body_regressor_series};
use crate::series::JointSeries;
use crate::twin::Twin;

/// One unknown.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    pub name: String,
    pub unit: &'static str,
    /// What it belongs to: `link 3`, `coulomb, joint 2`, `payload`.
    pub group: String,
    /// How large it, or an error of it, may well be.
    pub size: f64,
}

/// N.m per unit, one list of all samples per joint; empty where a joint feels nothing of it.
pub type Column = Vec<Vec<f64>>;

/// A block of unknowns whose columns are worked out together.
#[derive(Clone)]
enum Source {
    Link(usize),
    Effect { effect: &'static dyn Effect, joint: usize, nonlinear: Vec<f64> },
}

/// Unknowns and how their columns come about.
#[derive(Clone)]
pub struct Unknowns {
    pub all: Vec<Unknown>,
    sources: Vec<Source>,
}

/// What no twin knows for sure and every fit has along, whatever is asked for.
const ALWAYS_OPEN: [&str; 4] = ["coulomb", "viscous", "rotor_inertia", "current_offset"];

/// Share of a moment of inertia by which CAD is commonly wrong.
const INERTIA_ERROR: f64 = 0.1;
/// Least size of a moment of inertia, so that a link of no size has one, kg.m2.
const LEAST_INERTIA: f64 = 1e-6;

impl Unknowns {
    fn none() -> Self {
        Self { all: Vec::new(), sources: Vec::new() }
    }

    /// Unknown parameters of some effects.
    pub fn of<'a>(terms: impl IntoIterator<Item = &'a Term>, robot: &Robot) -> Self {
        let mut unknowns = Self::none();
        for term in terms {
            term.joints.iter().for_each(|&joint| unknowns.add_effect(term.effect, joint, robot));
        }
        unknowns
    }

    /// All inertial parameters of all links.
    pub fn of_links(robot: &Robot) -> Self {
        let mut unknowns = Self::none();
        (0..robot.dof()).for_each(|link| unknowns.add_link(link, robot));
        unknowns
    }

    /// What is open besides what is asked for: what every fit has along and what the twin leaves
    /// to be fitted.
    pub fn besides(ask: &Ask, twin: &Twin) -> Self {
        let always = ALWAYS_OPEN.iter().filter_map(|name| find(name));
        let open = twin.open().filter(|e| !ALWAYS_OPEN.contains(&e.about().name));
        let mut unknowns = Self::none();
        for effect in always.chain(open) {
            let name = effect.about().name;
            let asked = |joint: usize| {
                ask.terms().iter().any(|t| t.name() == name && t.joints.contains(&joint))
            };
            let joints = if effect.about().scope == Scope::Arm { 1 } else { twin.robot.dof() };
            for joint in (0..joints).filter(|j| !asked(*j)) {
                unknowns.add_effect(effect, joint, &twin.robot);
            }
        }
        unknowns
    }

    pub fn and(mut self, more: Self) -> Self {
        self.all.extend(more.all);
        self.sources.extend(more.sources);
        self
    }

    fn add_link(&mut self, link: usize, robot: &Robot) {
        self.sources.push(Source::Link(link));
        let group = format!("link {}", link + 1);
        for (i, size) in link_sizes(robot, link).into_iter().enumerate() {
            let (name, unit) = (parameters::NAMES[i].into(), parameters::unit(i));
            self.all.push(Unknown { name, unit, group: group.clone(), size });
        }
    }

    fn add_effect(&mut self, effect: &'static dyn Effect, joint: usize, robot: &Robot) {
        let about = effect.about();
        let of = |role| about.parameters.iter().filter(move |p| p.role == role);
        let nonlinear = of(Role::Nonlinear).map(|p| p.typical).collect();
        self.sources.push(Source::Effect { effect, joint, nonlinear });
        let group = match about.scope {
            Scope::Arm => about.name.to_string(),
            Scope::Joint | Scope::Link => format!("{}, joint {}", about.name, joint + 1),
        };
        let linear: Vec<_> = of(Role::Linear).collect();
        for (p, size) in linear.iter().zip(effect_sizes(effect, &linear, robot, joint)) {
            self.all.push(Unknown {
                name: p.name.into(),
                unit: p.unit,
                group: group.clone(),
                size,
            });
        }
    }

    /// Columns of the unknowns along a motion, in the order of `all`.
    pub fn columns(&self, motion: &Motion<'_>) -> Vec<Column> {
        self.sources.iter().flat_map(|s| s.columns(motion)).collect()
    }
}

impl Source {
    fn columns(&self, motion: &Motion<'_>) -> Vec<Column> {
        let dof = motion.robot.dof();
        match self {
            // A link's motion loads the joints before it.
            Source::Link(link) => {
                let series =
                    body_regressor_series(motion.robot, motion.q, motion.qd, motion.qdd, *link);
                series.iter().map(|s| lists(s, |joint| joint <= *link)).collect()
            }
            Source::Effect { effect, joint, nonlinear } if effect.about().scope == Scope::Joint => {
                let alone = |column: Vec<f64>| {
                    let mut lists = vec![Vec::new(); dof];
                    lists[*joint] = column;
                    lists
                };
                effect.columns(motion, *joint, nonlinear).into_iter().map(alone).collect()
            }
            Source::Effect { effect, joint, nonlinear } => {
                let series = effect.reach(motion, *joint, nonlinear);
                series.iter().map(|s| lists(s, |_| true)).collect()
            }
        }
    }
}

fn lists(series: &JointSeries, felt: impl Fn(usize) -> bool) -> Column {
    let joints = 0..series.joints();
    joints.map(|j| if felt(j) { series.joint(j).to_vec() } else { Vec::new() }).collect()
}

/// What CAD is commonly wrong by, of each of the ten.
fn link_sizes(robot: &Robot, link: usize) -> [f64; parameters::PER_LINK] {
    let inertia = INERTIA_ERROR * robot.bodies[link].inertia.about_origin().trace() / 3.0;
    let known = find("link_inertia").map_or(Vec::new(), |e| e.expected(robot, link, &[]));
    let at = |i: usize| known.get(i).copied().filter(|x| *x > 0.0).unwrap_or(LEAST_INERTIA);
    std::array::from_fn(|i| if i < 4 { at(i) } else { inertia.max(LEAST_INERTIA) })
}

/// Expected or typical size of each; where that is zero, what is typical of another parameter of its unit.
fn effect_sizes(
    effect: &dyn Effect,
    linear: &[&Parameter],
    robot: &Robot,
    joint: usize,
) -> Vec<f64> {
    let expected = effect.expected(robot, joint, &[]);
    let expected = |i: usize| expected.get(i).copied().filter(|x| x.is_finite() && *x > 0.0);
    let like = |p: &Parameter| {
        let same = linear.iter().filter(|o| o.unit == p.unit).map(|o| o.typical.abs());
        match (p.typical.abs(), same.fold(0.0, f64::max)) {
            (own, _) if own > 0.0 => own,
            (_, other) if other > 0.0 => other,
            _ => 0.01 * (p.max - p.min),
        }
    };
    linear.iter().enumerate().map(|(i, p)| expected(i).unwrap_or_else(|| like(p))).collect()
}
