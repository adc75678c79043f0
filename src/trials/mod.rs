//! Blind trials: cases with sealed labels, answers given without them, and what they are worth.
//!
//! [`draw()`] makes cases in rapier, [`draw_on()`] grafts effects onto somebody's own recordings,
//! [`import()`] takes cases made elsewhere. A case folder
//! holds what the answerer may see: two recordings, the nominal twin, settings, and the arm where none is built
//! in. What is hidden lies
//! in `sealed/` beside the case folders, and `seals.json` publishes the hash of every file there:
//! [`score()`] refuses a truth that does not match. [`answer()`] is given a case folder and nothing
//! else. [`CriteriaTrial`] answers with each criterion moved: how much does it matter?
//!
//! What draws does not share its mathematics with what answers: rapier's implicit steps and its
//! constraint friction at reversals against inverse dynamics and sliding laws.

mod answer;
mod arm;
mod asked;
mod baselines;
mod case;
mod criteria;
mod draw;
mod drawn;
mod error;
mod foreign;
mod hide;
mod import;
mod nuisance;
mod on_recordings;
mod plan;
mod score;
mod seal;
mod servos;
mod shapes;
mod strength;
mod third;
mod truth;

pub use crate::files::sha256;
pub use answer::{Answer, answer};
pub use asked::{Draw, Family};
pub use baselines::{BaselineAnswer, Method};
pub use case::{Case, case_folders};
pub use criteria::{CriteriaTrial, Moved, Row, Work, criteria_page};
pub use draw::draw;
pub use error::TrialError;
pub use import::{Names, import};
pub use on_recordings::{DrawOn, Sources, draw_on};
pub use score::{
    Chapter, Figure, Goal, Judged, Printed, Share, figures, goals, judge, page, score,
};
pub use seal::{Seals, write_json};
pub use truth::{Hidden, Kind, Strength, TrueValue, Truth};
