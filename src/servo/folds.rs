//! Twins that were fitted to one half of two recordings and are held against the other (cross-validation).
//!
//! Many values always follow the stretches better that they are fitted to: that tells nothing. What is there brings a twin nearer
//! to the stretches between, along both motions with the same values. Whether it is there, and what it is called, is asked of
//! both recordings: values that the one motion hardly tells may well be told by the other.

use super::refit::Refits;
use super::sizes::Sizes;
use super::yardstick::Yardstick;
use super::{ServoError, Settings, Track};
use crate::follow::Watch;
use crate::twin::Twin;

/// Both recordings, whole and in halves.
pub struct Halved {
    whole: [Track; 2],
    /// Of each recording every other stretch, and those between.
    halves: [[Track; 2]; 2],
}

impl Halved {
    pub fn new(whole: [Track; 2]) -> Self {
        let halves = whole.each_ref().map(|track| track.halves(Settings::default().horizon_s));
        Self { whole, halves }
    }
}

/// Fits to the same half of both recordings.
pub struct Fold<'a> {
    pub refits: Refits<'a>,
    /// The half that is fitted to, led along the whole motion: fits go by stretches of it.
    own: [Yardstick<'a>; 2],
    /// The other half.
    against: [Yardstick<'a>; 2],
}

impl Fold<'_> {
    /// The twin, fitted from `start`, or `start` where stretches that begin in measured states led the fit away from what the
    /// whole motion shows: an arm that stands is held there by friction, whatever it carries.
    ///
    /// # Errors
    /// If a twin cannot be simulated.
    pub fn nearer(&self, start: &Twin, fitted: Twin) -> Result<Twin, ServoError> {
        let left = |twin: &Twin| -> Result<f64, ServoError> {
            self.own.iter().map(|own| Ok(own.left_as_is(twin)?.ln())).sum()
        };
        Ok(if left(start)? < left(&fitted)? { start.clone() } else { fitted })
    }
}

/// Twins, each fitted to one half.
pub type Twins = [Twin; 2];

/// Both folds.
pub struct Folds<'a> {
    folds: [Fold<'a>; 2],
    /// Who follows the fits.
    pub watch: &'a dyn Watch,
}

impl<'a> Folds<'a> {
    /// # Errors
    /// As [`super::identify`].
    pub fn new(twin: &'a Twin, both: &'a Halved, watch: &'a dyn Watch) -> Result<Self, ServoError> {
        let fold = |fitted: usize| -> Result<Fold<'a>, ServoError> {
            let tracks = both.halves.iter().map(|halves| &halves[fitted]).collect();
            let refits = Refits::new(twin, tracks, watch)?;
            let of = |half: usize| {
                [0, 1].map(|i| Yardstick {
                    track: &both.whole[i],
                    part: &both.halves[i][half],
                    open: refits.open(),
                })
            };
            let (own, against) = (of(fitted), of(1 - fitted));
            Ok(Fold { refits, own, against })
        };
        Ok(Self { folds: [fold(0)?, fold(1)?], watch })
    }

    /// The twin as given, what it leaves open fitted to one half and to the other.
    pub fn before(&self) -> Twins {
        self.folds.each_ref().map(|fold| fold.refits.before.clone())
    }

    /// What twins leave of the half that each was not fitted to, what they leave open as that half has it.
    ///
    /// # Errors
    /// If a twin cannot be simulated.
    pub fn left(&self, twins: &Twins) -> Result<Sizes, ServoError> {
        self.measured(twins, |against, twin| against.left(twin))
    }

    /// What twins leave of the half that each was not fitted to, with all values that they have.
    ///
    /// # Errors
    /// If a twin cannot be simulated.
    pub fn left_as_is(&self, twins: &Twins) -> Result<Sizes, ServoError> {
        self.measured(twins, |against, twin| against.left_as_is(twin))
    }

    fn measured(
        &self,
        twins: &Twins,
        by: impl Fn(&Yardstick<'_>, &Twin) -> Result<Sizes, ServoError> + Sync,
    ) -> Result<Sizes, ServoError> {
        let of = |k: usize, i: usize| by(&self.folds[k].against[i], &twins[k]);
        let of_recording = |i: usize| -> Result<Sizes, ServoError> {
            let (first, second) = rayon::join(|| of(0, i), || of(1, i));
            Ok(first?.and(second?))
        };
        let (first, second) = rayon::join(|| of_recording(0), || of_recording(1));
        Ok(first?.beside(second?))
    }

    /// The one of two twins that leaves less of both recordings, whole: where one half hardly tells a value the other may.
    ///
    /// # Errors
    /// If a twin cannot be simulated.
    pub fn nearer<'t>(&self, twins: &'t Twins) -> Result<&'t Twin, ServoError> {
        let left = |k: usize| -> Result<f64, ServoError> {
            let Fold { own, against, .. } = &self.folds[k];
            own.iter().chain(against).map(|part| Ok(part.left_as_is(&twins[k])?.ln())).sum()
        };
        Ok(if left(1)? < left(0)? { &twins[1] } else { &twins[0] })
    }

    /// Of each fold and its twin.
    ///
    /// # Errors
    /// As `of`.
    pub fn each<T: Send, R: Send>(
        &self,
        all: [T; 2],
        of: impl Fn(&Fold<'a>, T) -> Result<R, ServoError> + Sync,
    ) -> Result<[R; 2], ServoError> {
        let [a, b] = all;
        let (a, b) = rayon::join(|| of(&self.folds[0], a), || of(&self.folds[1], b));
        Ok([a?, b?])
    }
}
