//! One colour per role, the same in 3D, in the plots and in the summary.

use rerun::Color;

/// What was recorded, commanded or measured against.
pub const RECORDED: Rgb = Rgb(86, 170, 240);
/// What the twin says.
pub const SIMULATED: Rgb = Rgb(255, 160, 40);
pub const TARGET: Rgb = Rgb(160, 160, 160);
/// The twin as given, and mended: as in the report.
pub const BEFORE: Rgb = Rgb(251, 146, 60);
pub const AFTER: Rgb = Rgb(45, 212, 191);
/// Moments after a reversal, and contacts.
pub const REVERSAL: Rgb = Rgb(120, 134, 160);
pub const CONTACT: Rgb = Rgb(230, 90, 140);
/// Recorded minus twin.
pub const DIFFERENCE: Rgb = Rgb(230, 90, 140);
/// Links of the recorded arm; its joints take [`RECORDED`].
pub const LINK: Rgb = Rgb(205, 210, 216);

/// Behind the arm.
pub const BACKGROUND: Rgb = Rgb(24, 27, 33);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

impl From<Rgb> for Color {
    fn from(Rgb(r, g, b): Rgb) -> Self {
        Color::from_rgb(r, g, b)
    }
}

impl Rgb {
    pub fn translucent(self, alpha: u8) -> Color {
        Color::from_unmultiplied_rgba(self.0, self.1, self.2, alpha)
    }
}
