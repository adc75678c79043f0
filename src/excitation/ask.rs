//! What a motion shall tell, as a user names it.

use crate::effects::{self, CATALOGUE, DriveKind, Effect, Scope, Seen};

/// What is asked of the motion.
#[derive(Clone)]
pub enum Ask {
    /// Values: the links' inertial parameters and those of effects, as sharply as possible.
    Learn { inertia: bool, terms: Vec<Term> },
    /// Which of the two is there.
    Apart([Term; 2]),
}

/// An effect at some joints, from 0; one entry for an effect of the whole arm.
#[derive(Clone)]
pub struct Term {
    pub effect: &'static dyn Effect,
    pub joints: Vec<usize>,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AskError {
    #[error("`{name}` is not known here: give `inertia`, `friction` or effects, {known}")]
    Unknown { name: String, known: String },
    #[error("`{name}` does not show as joint torque along a motion: give another of {known}")]
    NotTorque { name: String, known: String },
    #[error("`{text}`: {joint} is not a joint: count from 1 to {dof}")]
    Joint { text: String, joint: String, dof: usize },
    #[error("`{text}`: {name} is of the whole arm: leave the joint out")]
    WholeArm { text: String, name: &'static str },
    #[error("`{0}`: give two rivals, parted by a comma: payload,link_inertia@6")]
    Rivals(String),
    #[error("nothing is asked for: give `inertia`, `friction` or effects")]
    Nothing,
}

/// What `friction` stands for.
const FRICTION: [&str; 3] = ["coulomb", "viscous", "stribeck"];

impl Ask {
    /// `inertia`, `friction`, `EFFECT` (at every joint) and `EFFECT@JOINT`, parted by commas.
    ///
    /// # Errors
    /// Names what is not known, or not visible in torque.
    pub fn learn(list: &str, dof: usize) -> Result<Self, AskError> {
        let (mut inertia, mut terms) = (false, Vec::new());
        for word in words(list) {
            match word {
                "inertia" => inertia = true,
                "friction" => {
                    for name in FRICTION {
                        terms.push(Term::parse(name, dof)?);
                    }
                }
                other => terms.push(Term::parse(other, dof)?),
            }
        }
        match inertia || !terms.is_empty() {
            true => Ok(Self::Learn { inertia, terms }),
            false => Err(AskError::Nothing),
        }
    }

    /// Two rivals, `EFFECT` or `EFFECT@JOINT`.
    ///
    /// # Errors
    /// If there are not two, or one is not known.
    pub fn apart(pair: &str, dof: usize) -> Result<Self, AskError> {
        let [one, other] = words(pair).collect::<Vec<_>>()[..] else {
            return Err(AskError::Rivals(pair.into()));
        };
        Ok(Self::Apart([Term::parse(one, dof)?, Term::parse(other, dof)?]))
    }

    /// Everything that is asked for by name.
    pub(super) fn terms(&self) -> &[Term] {
        match self {
            Self::Learn { terms, .. } => terms,
            Self::Apart(rivals) => rivals,
        }
    }
}

impl Term {
    fn parse(text: &str, dof: usize) -> Result<Self, AskError> {
        let (name, joint) = text.split_once('@').map_or((text, None), |(n, j)| (n, Some(j)));
        let effect = effects::find(name)
            .ok_or_else(|| AskError::Unknown { name: name.into(), known: visible() })?;
        if effect.seen() != Seen::Columns {
            return Err(AskError::NotTorque { name: name.into(), known: visible() });
        }
        let whole_arm = effect.about().scope == Scope::Arm;
        let joints = match joint {
            None if whole_arm => vec![0],
            None => (0..dof).collect(),
            Some(_) if whole_arm => {
                return Err(AskError::WholeArm { text: text.into(), name: effect.about().name });
            }
            Some(number) => {
                let joint = number.parse::<usize>().ok().filter(|j| (1..=dof).contains(j));
                let wrong = || AskError::Joint { text: text.into(), joint: number.into(), dof };
                vec![joint.ok_or_else(wrong)? - 1]
            }
        };
        Ok(Self { effect, joints })
    }

    pub(super) fn name(&self) -> &'static str {
        self.effect.about().name
    }

    /// As the command line takes it.
    pub fn says(&self) -> String {
        let whole_arm = self.effect.about().scope == Scope::Arm;
        match self.joints[..] {
            [joint] if !whole_arm => format!("{}@{}", self.name(), joint + 1),
            _ => self.name().into(),
        }
    }
}

fn words(list: &str) -> impl Iterator<Item = &str> {
    list.split(',').map(str::trim).filter(|w| !w.is_empty())
}

/// Effects that torque shows.
fn visible() -> String {
    let shows = |e: &&&dyn Effect| e.seen() == Seen::Columns && e.of_drive() != DriveKind::Servo;
    let names = CATALOGUE.iter().filter(shows).map(|e| e.about().name);
    names.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_joints_and_groups() {
        let Ok(Ask::Learn { inertia, terms }) = Ask::learn("inertia, friction,payload", 6) else {
            panic!("all of them are known");
        };
        let names: Vec<_> = terms.iter().map(Term::says).collect();
        assert!(inertia);
        assert_eq!(names, ["coulomb", "viscous", "stribeck", "payload"]);
        assert_eq!((terms[0].joints.len(), &terms[3].joints[..]), (6, &[0][..]));
        let Ok(Ask::Apart([a, b])) = Ask::apart("payload,link_inertia@6", 6) else {
            panic!("both are known");
        };
        assert_eq!((a.says().as_str(), b.says().as_str()), ("payload", "link_inertia@6"));
        assert_eq!(b.joints, [5]);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let wrong = |text: &str| Ask::learn(text, 6).err().unwrap().to_string();
        assert!(wrong("columb").contains("`columb`") && wrong("columb").contains("coulomb"));
        assert!(wrong("time_delay").contains("does not show as joint torque"));
        assert!(wrong("coulomb@7").contains("7 is not a joint: count from 1 to 6"));
        assert!(wrong("coulomb@0").contains("0 is not a joint"));
        assert!(wrong("payload@2").contains("whole arm"));
        assert!(wrong(" , ").contains("nothing is asked for"));
        let rivals = Ask::apart("payload", 6).err().unwrap().to_string();
        assert!(rivals.contains("two rivals"), "{rivals}");
    }
}
