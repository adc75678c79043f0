//! Values that an arm can have together: a load's inertia is that of a body.

use super::Twin;
use crate::effects::Effect;

/// Numbers printed with two digits are off by that much.
const PRINTED: f64 = 0.01;

impl Twin {
    /// Moves values to the nearest that an arm can have together ([`Effect::keep_physical`]).
    pub fn keep_possible(&mut self) {
        for (effect, joint, values) in self.together() {
            let mut possible = values;
            effect.keep_physical(&mut possible);
            for (p, value) in effect.about().parameters.iter().zip(possible) {
                let kept = self.values.get_mut(p.name).and_then(|all| all.get_mut(joint));
                kept.into_iter().for_each(|v| *v = value);
            }
        }
    }

    /// # Errors
    /// The key of a value that an arm cannot have beside the others, and what is wrong with it.
    pub(super) fn refuse_impossible(&self) -> Result<(), (String, String)> {
        for (effect, _, values) in self.together() {
            let mut possible = values.clone();
            effect.keep_physical(&mut possible);
            let each = effect.about().parameters.iter().zip(values.iter().zip(&possible));
            let mut far = each.filter(|(_, (v, p))| (*p - *v).abs() > PRINTED * v.abs());
            if let Some((parameter, (value, nearest))) = far.next() {
                let problem = format!(
                    "is {value}: no body has such moments of inertia together; the nearest is {nearest:.3} (no \
                     principal moment is negative, or larger than the two others together)"
                );
                return Err((format!("twin.values.{}", parameter.name), problem));
            }
        }
        Ok(())
    }

    /// Every known effect at every joint with its values.
    fn together(&self) -> Vec<(&'static dyn Effect, usize, Vec<f64>)> {
        let dof = self.robot.dof();
        let places = self.known().flat_map(|effect| (0..dof).map(move |joint| (effect, joint)));
        places.filter_map(|(e, j)| Some((e, j, self.values_at(e, j)?))).collect()
    }
}
