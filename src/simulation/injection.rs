//! Effects at work: catalogue entries with their values, joint by joint.

use crate::effects::{ArmState, CATALOGUE, Channels, Effect, JointLoad, Mechanism, Scope};

/// An effect and its parameter values at some joints (or for the whole arm).
#[derive(Clone)]
pub struct Injection {
    pub effect: &'static dyn Effect,
    /// Joints it acts on, from 0.
    pub joints: Vec<usize>,
    /// In the order of the effect's parameters; one row per entry of `joints`, a single row for
    /// an effect of the whole arm.
    pub values: Vec<Vec<f64>>,
}

impl Injection {
    fn row(&self, i: usize) -> &[f64] {
        match self.effect.about().scope {
            Scope::Joint | Scope::Link => &self.values[i],
            Scope::Arm => &self.values[0],
        }
    }
}

/// All injected effects, laid out for the simulation's inner loop.
#[derive(Clone, Default)]
pub struct Injections {
    acting: Vec<Acting>,
}

#[derive(Clone)]
struct Acting {
    effect: &'static dyn Effect,
    joint: usize,
    values: Vec<f64>,
    memory: Vec<f64>,
    /// An effect of the whole arm changes the mechanism once.
    builds: bool,
}

impl Acting {
    /// The same effect at the same joint, with the same values?
    fn is(&self, other: &Self) -> bool {
        let own = |a: &Self| (a.effect.about().name, a.joint);
        own(self) == own(other) && self.values == other.values
    }
}

impl Injections {
    pub fn new(list: &[Injection]) -> Self {
        let mut acting = Vec::new();
        for injection in list {
            let whole_arm = injection.effect.about().scope == Scope::Arm;
            for (i, &joint) in injection.joints.iter().enumerate() {
                acting.push(Acting {
                    effect: injection.effect,
                    joint,
                    values: injection.row(i).to_vec(),
                    memory: vec![0.0; injection.effect.about().memory],
                    builds: i == 0 || !whole_arm,
                });
            }
        }
        let place =
            |a: &Acting| CATALOGUE.iter().position(|e| e.about().name == a.effect.about().name);
        acting.sort_by_key(place);
        Self { acting }
    }

    /// What the effects change before the first step.
    pub fn build(&self, mechanism: &mut Mechanism) {
        for a in self.acting.iter().filter(|a| a.builds) {
            a.effect.build(&a.values, a.joint, mechanism);
        }
    }

    /// Those that others do not have with the same values at the same joint.
    pub fn beyond(&self, others: &Self) -> Self {
        let is_other = |a: &&Acting| !others.acting.iter().any(|b| a.is(b));
        Self { acting: self.acting.iter().filter(is_other).cloned().collect() }
    }

    pub fn is_empty(&self) -> bool {
        self.acting.is_empty()
    }

    /// Has any of them a memory?
    pub fn remember(&self) -> bool {
        self.acting.iter().any(|a| !a.memory.is_empty())
    }

    /// Does any of them act for a while only?
    pub fn any_lasts_a_while(&self) -> bool {
        self.acting.iter().any(|a| a.effect.lasts_a_while())
    }

    /// Does what any of them adds at one joint depend on the others?
    pub fn any_feels_other_joints(&self) -> bool {
        self.acting.iter().any(|a| a.effect.feels_other_joints())
    }

    /// As before the first step.
    pub fn forget(&mut self) {
        self.acting.iter_mut().for_each(|a| a.memory.fill(0.0));
    }

    /// What acts on each joint in the step that begins in the state `arm`. To be called once per
    /// step: effects with memory move on.
    pub fn loads(&mut self, arm: &ArmState<'_>, loads: &mut [JointLoad]) {
        loads.fill(JointLoad::default());
        for a in &mut self.acting {
            let at_once = a.effect.about().scope == Scope::Arm && a.memory.is_empty();
            match (at_once, a.builds) {
                (true, true) => a.effect.act_on_arm(&a.values, arm, loads),
                (true, false) => (),
                (false, _) => {
                    let (state, load) = (arm.joint(a.joint), &mut loads[a.joint]);
                    a.effect.act(&a.values, &state, &mut a.memory, load);
                }
            }
        }
    }

    /// What is recorded of `joint`, in the order of the catalogue.
    pub fn measure(&self, joint: usize, channels: &mut Channels) {
        for a in self.acting.iter().filter(|a| a.joint == joint) {
            a.effect.measure(&a.values, channels);
        }
    }
}
