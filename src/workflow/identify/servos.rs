//! Values by which an arm of position servos, simulated along its command, goes where the recorded one did.

use super::Identify;
use crate::diagnosis::{By, TimeOffset};
use crate::follow::Watch;
use crate::recording::{Provenance, refuse_same};
use crate::servo::{
    self, AsSent, Fitted, Following, Free, PositionGap, ServoError, Settings, Track,
    free_parameters, replay,
};
use crate::signals::Conditioning;
use crate::twin::Twin;
use crate::workflow::{Arm, Prepared, WorkflowError, by, conditioned};

/// What is fitted where nobody says what: a servo's own values and the simplest friction.
const USUAL: [&str; 6] =
    ["servo_gain", "servo_offset", "servo_delay", "coulomb", "viscous", "rotor_inertia"];

/// A recording and what servos saw of it.
pub struct Told {
    pub provenance: Provenance,
    pub track: Track,
    /// Against the first recording that is fitted; its track has the command so much later.
    pub time_offset: Option<TimeOffset>,
}

/// An identification by simulation and all that led to it.
pub struct IdentifiedServos {
    /// As given.
    pub twin: Twin,
    pub terms: Vec<String>,
    pub settings: Settings,
    pub conditioning: Conditioning,
    pub fit: Vec<Told>,
    pub check: Vec<Told>,
    pub fitted: Fitted,
    /// Position errors on each check recording before and after, led through from its begin.
    pub checked: Vec<[PositionGap; 2]>,
    /// Wall-clock, s.
    pub seconds: f64,
}

impl Identify {
    /// By which method these recordings are to be explained; the twin is made such that only that can be meant.
    ///
    /// # Errors
    /// If simulation is asked for and the twin has no servos.
    pub fn method(
        &self,
        twin: &mut Twin,
        recordings: &[&Prepared<'_>],
    ) -> Result<By, WorkflowError> {
        by::choose(self.by, twin, recordings)
    }

    /// Fits position servos to all recordings of `fit` at once, and holds what was found against those of
    /// `check`.
    ///
    /// # Errors
    /// If the twin has no servos or cannot be simulated, something is asked for that only torque can tell, or
    /// recordings are the same or too short.
    pub fn servos(
        &self,
        arm: &Arm,
        fit: Vec<Prepared<'_>>,
        check: Vec<Prepared<'_>>,
        watch: &dyn Watch,
    ) -> Result<IdentifiedServos, WorkflowError> {
        self.refuse_torque()?;
        for check in &check {
            fit.iter().try_for_each(|fit| refuse_same(fit, check))?;
        }
        let clock = std::time::Instant::now();
        let how = self.reading.signals.over(Conditioning::default());
        let all = |recordings: Vec<Prepared<'_>>| -> Result<Vec<Told>, WorkflowError> {
            recordings.into_iter().map(|r| told(r, &arm.twin, &how)).collect()
        };
        let (mut fit, mut check) = (all(fit)?, all(check)?);
        watch.tell("fitting by simulation", 0, 0);
        as_sent(&arm.twin, fit.iter_mut().chain(&mut check), watch)?;
        let terms = self.servo_terms(&arm.twin);
        let mut free = free_parameters(&arm.twin, &terms)?;
        self.bound(&mut free);
        let tracks: Vec<&Track> = fit.iter().map(|t| &t.track).collect();
        let settings = Settings::default();
        let fitted = servo::identify(&arm.twin, &tracks, &free, &settings, watch)?;
        let checked = check.iter().map(|t| before_and_after(&arm.twin, &fitted.twin, &t.track));
        let checked = checked.collect::<Result<_, ServoError>>()?;
        let seconds = clock.elapsed().as_secs_f64();
        let twin = arm.twin.clone();
        Ok(IdentifiedServos {
            twin,
            terms,
            settings,
            conditioning: how,
            fit,
            check,
            fitted,
            checked,
            seconds,
        })
    }

    /// What a twin lists without values, or the usual; `terms` replaces, `with` adds.
    fn servo_terms(&self, twin: &Twin) -> Vec<String> {
        let open: Vec<String> = twin.open().map(|e| e.about().name.to_string()).collect();
        let mut terms = match (self.terms.is_empty(), open.is_empty()) {
            (false, _) => self.terms.clone(),
            (true, false) => open,
            (true, true) => USUAL.map(String::from).to_vec(),
        };
        let more: Vec<String> = self.with.iter().filter(|w| !terms.contains(w)).cloned().collect();
        terms.extend(more);
        terms
    }

    fn refuse_torque(&self) -> Result<(), WorkflowError> {
        let asked = [("reduce", self.reduce), ("inertia", self.asks_for_inertia())];
        match asked.iter().find(|(_, given)| *given) {
            Some((what, _)) => Err(WorkflowError::Asked(format!(
                "{what} needs recorded torque: leave it out where an arm is identified by simulation"
            ))),
            None => Ok(()),
        }
    }

    fn bound(&self, free: &mut [Free]) {
        for (name, [low, high]) in &self.bounds {
            for f in free.iter_mut().filter(|f| f.parameter.name == name) {
                (f.min, f.max, f.start) = (*low, *high, f.start.clamp(*low, *high));
            }
        }
    }
}

fn told(recording: Prepared<'_>, twin: &Twin, how: &Conditioning) -> Result<Told, WorkflowError> {
    let recording = by::kept(By::Simulation, recording);
    let samples = conditioned(&recording, twin, how)?;
    let at = |error: ServoError| WorkflowError::from(error).at(&recording.provenance.source);
    let track = Track::new(&samples, twin).map_err(at)?;
    Ok(Told { provenance: recording.provenance.clone(), track, time_offset: None })
}

/// Commands as they were sent, where loggers noted them otherwise than in the first recording. Where the twin runs away along that,
/// nothing is known of it.
fn as_sent<'a>(
    twin: &Twin,
    mut all: impl Iterator<Item = &'a mut Told>,
    watch: &dyn Watch,
) -> Result<(), ServoError> {
    let (Some(first), mut others) = (all.next(), all.peekable()) else { return Ok(()) };
    if others.peek().is_none() {
        return Ok(());
    }
    let following = match Following::new(twin, &first.track, watch) {
        Err(ServoError::Diverged { .. }) => return Ok(()),
        following => following?,
    };
    for told in others {
        let AsSent { track, time_offset } =
            following.as_sent([&first.track, &told.track], watch)?;
        (told.track, told.time_offset) = (track, time_offset);
    }
    Ok(())
}

fn before_and_after(
    before: &Twin,
    after: &Twin,
    track: &Track,
) -> Result<[PositionGap; 2], ServoError> {
    let stretches = track.stretches(f64::INFINITY);
    let gap = |twin: &Twin| {
        replay(twin, track, &stretches).map(|simulated| PositionGap::new(track, &simulated))
    };
    Ok([gap(before)?, gap(after)?])
}
