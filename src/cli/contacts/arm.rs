//! A twin with its open values fitted, and contacts of recordings held against it.

use std::path::PathBuf;

use anyhow::Context;

use crate::diagnosis;
use crate::external_wrench::{Contact, Criteria, Heard, Left, Noise, Residual, contacts, left};
use crate::follow::Watch;
use crate::identification::{
    BoundsByName, Method, Settings, Terms, assemble_around, fitted_twin, identify_watched, settle,
};
use crate::recording::Recording;
use crate::signals::{Conditioning, Samples, condition};
use crate::twin::Twin;

/// A recording and where it is from.
pub struct Source {
    path: PathBuf,
    recording: Recording,
}

impl Source {
    pub fn of(path: PathBuf, recording: Recording) -> Self {
        Self { path, recording }
    }

    fn samples(&self, twin: &Twin, how: &Conditioning) -> anyhow::Result<Samples> {
        condition(&self.recording, &twin.drive, twin.robot.dof(), how)
            .with_context(|| self.path.display().to_string())
    }

    fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }
}

/// As for identification: forces are followed as far as torque is.
pub fn conditioning() -> Conditioning {
    Conditioning::default()
}

pub struct Arm {
    pub twin: Twin,
    how: Conditioning,
}

impl Arm {
    /// `twin` with what it leaves open, and what is asked for `with` it, fitted by least squares.
    pub fn fitted(
        twin: &Twin,
        fit: &Source,
        with: &[String],
        how: &Conditioning,
        watch: &dyn Watch,
    ) -> anyhow::Result<Self> {
        let terms = Terms::of_twin(twin, with);
        let how = how.clone();
        if with.is_empty() && twin.open().next().is_none() {
            return Ok(Self { twin: twin.clone(), how });
        }
        let (terms, samples) = (terms?, fit.samples(twin, &how)?);
        let settings = Settings { methods: vec![Method::Nlse], ..Settings::default() };
        watch.tell("fitting the twin", 0, 0);
        let located = diagnosis::locate(&samples, twin, &terms, watch)?;
        let (around, located) = match located.is_empty() {
            true => (twin.clone(), located),
            false => settle(&samples, twin, &terms, located, &settings.nlse)?,
        };
        let problem =
            assemble_around(&samples, &around, &terms, &BoundsByName::default(), &located)?;
        let results = identify_watched(&problem, None, &settings, watch)?;
        let result = results.first().context("nothing was fitted")?;
        Ok(Self { twin: fitted_twin(&around, &terms, &problem, result)?, how })
    }

    /// Contacts of a recording; what the twin leaves besides is learned from it and from those that
    /// are `free` of contacts. `watch` is told how far the search is.
    pub fn contacts(
        &self,
        recording: &Source,
        free: &[Source],
        criteria: &Criteria,
        watch: &dyn Watch,
    ) -> anyhow::Result<Vec<Contact>> {
        let (samples, left) = self.left(recording)?;
        let others: Vec<(Samples, Left)> =
            free.iter().map(|source| self.left(source)).collect::<anyhow::Result<_>>()?;
        let heard = |samples: &Samples, left| Heard {
            left,
            every: samples.decimation(),
            dt: samples.decimation() as f64 * samples.dt,
        };
        let free: Vec<Heard<'_>> = others.iter().map(|(s, left)| heard(s, left)).collect();
        let noise = Noise::learn(heard(&samples, &left), &free);
        let residual = Residual {
            recording: &recording.name(),
            robot: &self.twin.robot,
            start: samples.start,
            dt: samples.dt,
            q: &samples.q,
            left: &left,
            usable: &samples.usable,
            every: samples.decimation(),
            noise: &noise,
        };
        Ok(contacts(&residual, criteria, watch))
    }

    /// The conditioned recording and what the twin leaves of it.
    pub fn left(&self, source: &Source) -> anyhow::Result<(Samples, Left)> {
        let samples = self.twin.correct(&source.samples(&self.twin, &self.how)?);
        let left = left(&self.twin, &samples)?;
        Ok((samples, left))
    }
}
