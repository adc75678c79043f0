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
    /// The half that is fitted to, of each recording.
    own: [&'a Track; 2],
    /// The other half, along the whole of each recording.
    against: [Yardstick<'a>; 2],
}

impl Fold<'_> {
    /// The twin, fitted from `start`, or `start` where stretches that begin in measured states led the fit away from what the
    /// whole motion shows, of which `start` leaves so much ([`LeftAsIs::own`]): an arm that stands is held there by friction,
    /// whatever it carries.
    ///
    /// # Errors
    /// If the twin cannot be simulated.
    pub fn nearer(
        &self,
        (start, left_by_start): (&Twin, f64),
        fitted: Twin,
    ) -> Result<Twin, ServoError> {
        let (own, _) = self.left_as_is(&fitted)?;
        Ok(if left_by_start < own { start.clone() } else { fitted })
    }

    /// What a twin leaves of the half that is fitted to ([`Sizes::ln`]), and of the other half of each recording.
    fn left_as_is(&self, twin: &Twin) -> Result<(f64, [Sizes; 2]), ServoError> {
        let of = |i: usize| self.against[i].left_as_is(self.own[i], twin);
        let (first, second) = rayon::join(|| of(0), || of(1));
        let ([first, own], [second, own_second]) = (first?, second?);
        Ok((own.ln() + own_second.ln(), [first, second]))
    }
}

/// Twins, each fitted to one half.
pub type Twins = [Twin; 2];

/// What twins leave with all values that they have, led along both motions.
pub struct LeftAsIs {
    /// Of the half that each was fitted to ([`Sizes::ln`]).
    pub own: [f64; 2],
    /// Of the half that each was not fitted to.
    pub other: Sizes,
}

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
            let of = |half: usize| both.halves.each_ref().map(|halves| &halves[half]);
            let (own, others) = (of(fitted), of(1 - fitted));
            let against = [0, 1].map(|i| Yardstick {
                track: &both.whole[i],
                part: others[i],
                open: refits.open(),
            });
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
        let left = self.each(twins.each_ref(), |fold, twin| {
            let [first, second] = &fold.against;
            let (first, second) = rayon::join(|| first.left(twin), || second.left(twin));
            Ok([first?, second?])
        })?;
        Ok(together(left))
    }

    /// What twins leave with all values that they have.
    ///
    /// # Errors
    /// If a twin cannot be simulated.
    pub fn left_as_is(&self, twins: &Twins) -> Result<LeftAsIs, ServoError> {
        let left = self.each(twins.each_ref(), |fold, twin| fold.left_as_is(twin))?;
        let [(first, other), (second, other_second)] = left;
        Ok(LeftAsIs { own: [first, second], other: together([other, other_second]) })
    }

    /// The one of two twins that leaves less of both recordings, whole: where one half hardly tells a value the other may.
    ///
    /// # Errors
    /// If a twin cannot be simulated.
    pub fn nearer<'t>(&self, twins: &'t Twins) -> Result<&'t Twin, ServoError> {
        let [first, second] = self.each(twins.each_ref(), |fold, twin| {
            let (own, other) = fold.left_as_is(twin)?;
            Ok(own + other.iter().map(Sizes::ln).sum::<f64>())
        })?;
        Ok(if second < first { &twins[1] } else { &twins[0] })
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

/// Errors of both halves of each of two recordings, as each fold has them.
fn together([[a, b], [c, d]]: [[Sizes; 2]; 2]) -> Sizes {
    a.and(c).beside(b.and(d))
}
