//! Steps from what a search located to where all parameters together settle.

use super::arm::identify;
use super::arm_problem::{ArmProblem, BoundsByName, at_joint};
use super::assemble::assemble_around;
use super::error::IdentificationError;
use super::located::{Located, with_located};
use super::settings::{Method, Settings};
use super::terms::Terms;
use super::{Found, separable};
use crate::effects::{Role, Scope, Size};
use crate::signals::Samples;
use crate::twin::Twin;

/// A step of Gauss-Newton is cut to this factor.
const FARTHEST: f64 = 1.5;
/// Relative steps that count as none.
const SETTLED: f64 = 1e-3;
const ROUNDS: usize = 6;

/// Gauss-Newton steps from what was located, by least squares on all parameters together, until
/// they settle: (twin with the nonlinear values, what was located there).
///
/// # Errors
/// As [`super::assemble`].
pub fn settle(
    samples: &Samples,
    twin: &Twin,
    terms: &Terms,
    mut located: Vec<Located>,
    nlse: &separable::Settings,
) -> Result<(Twin, Vec<Located>), IdentificationError> {
    let settings = Settings { methods: vec![Method::Nlse], nlse: *nlse, ..Settings::default() };
    let size = Size::of(&twin.robot);
    for _ in 0..ROUNDS {
        let known = with_located(twin, &located);
        let arm = assemble_around(samples, &known, terms, &BoundsByName::new(), &located)?;
        let found = identify(&arm, None, &settings)?.swap_remove(0).found;
        let steps: Vec<f64> = located.iter_mut().map(|l| step(l, &size, &arm, &found)).collect();
        if steps.iter().all(|s| *s < SETTLED) {
            break;
        }
    }
    Ok((with_located(twin, &located), located))
}

/// Takes over what was found; the largest relative change of a nonlinear parameter.
fn step(located: &mut Located, size: &Size, arm: &ArmProblem, found: &Found) -> f64 {
    let value = |name: &str| match located.effect.about().scope {
        Scope::Joint => {
            let k = arm.joints[located.joint].index(name)?;
            found.joints[located.joint].get(k).copied()
        }
        scope => {
            let own = at_joint(name, located.joint);
            let name = if scope == Scope::Link { own.as_str() } else { name };
            let k = arm.shared.iter().position(|p| p.name == name)?;
            found.shared.get(k).copied()
        }
    };
    let linear: Vec<Option<f64>> = located.of_role(Role::Linear).map(|p| value(p.name)).collect();
    let nonlinear: Vec<_> = located.of_role(Role::Nonlinear).map(|p| (p, value(p.name))).collect();
    // What follows a reference is no more linear than the rest.
    let follows = located.follows();
    for (own, new) in located.linear.iter_mut().zip(linear) {
        let Some(new) = new else { continue };
        *own = if follows { cut(*own, new) } else { new };
    }
    let mut largest = 0.0f64;
    for (own, (p, new)) in located.nonlinear.iter_mut().zip(nonlinear) {
        let Some(new) = new else { continue };
        let new = p.on(size).clamp(cut(*own, new));
        largest = largest.max((new / *own - 1.0).abs());
        *own = new;
    }
    let linear = located.linear.clone();
    located.effect.settle(&linear, &mut located.nonlinear);
    largest
}

/// No further than by the factor a step may take.
pub(super) fn cut(from: f64, to: f64) -> f64 {
    let (a, b) = (from / FARTHEST, from * FARTHEST);
    to.clamp(a.min(b), a.max(b))
}
