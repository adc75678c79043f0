//! Values that the drive holds, and that an effect among the twin's may give in their place.

use super::Twin;
use crate::effects::{Effect, of_drive};
use crate::robot::Drive;

impl Twin {
    /// The drive as the twin reckons with it: values of an effect stand in place of the drive's.
    pub fn whole_drive(&self) -> Drive {
        let mut drive = self.drive.clone();
        for (_, part, parameter) in of_drive() {
            if let Some(given) = self.values.get(parameter) {
                drive.part_mut(part).clone_from(given);
            }
        }
        drive
    }

    /// The drive without what effects give in its place.
    pub fn bare_drive(&self) -> Drive {
        let mut drive = self.drive.clone();
        for (_, part, _) in of_drive().filter(|(.., name)| self.values.contains_key(*name)) {
            drive.part_mut(part).fill(0.0);
        }
        drive
    }

    /// Where the drive holds a parameter, one value per joint.
    pub fn held_by_drive(&mut self, parameter: &str) -> Option<&mut Vec<f64>> {
        let (_, part, _) = of_drive().find(|(.., name)| *name == parameter)?;
        Some(self.drive.part_mut(part))
    }

    /// Values of effects that the drive has a place for go there, and those effects are the drive's alone.
    pub fn settle_drive(&mut self) {
        self.drive = self.whole_drive();
        for (effect, _, parameter) in of_drive() {
            self.values.remove(parameter);
            self.effects.retain(|name| name != effect.about().name);
        }
    }

    /// Forgets the values of an effect, those in the drive as well.
    pub fn forget(&mut self, effect: &dyn Effect) {
        effect.about().parameters.iter().for_each(|p| drop(self.values.remove(p.name)));
        if let Some(part) = effect.stands_for() {
            self.drive.part_mut(part).fill(0.0);
        }
    }
}
