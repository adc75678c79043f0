//! A recording rendered by the viewer without a window, where it and a Vulkan driver are installed.

use std::collections::BTreeSet;
use std::io::Read;
use std::path::Path;
use std::process::Command;

use flate2::read::ZlibDecoder;
use tempfile::TempDir;

/// Red, green, blue of every pixel.
pub struct Picture {
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Pixels near a colour.
    pub fn count(&self, colour: [u8; 3], tolerance: u8) -> usize {
        let near = |p: &&[u8; 3]| p.iter().zip(colour).all(|(a, b)| a.abs_diff(b) <= tolerance);
        self.pixels.iter().filter(near).count()
    }

    pub fn colours(&self) -> usize {
        self.pixels.iter().collect::<BTreeSet<_>>().len()
    }
}

/// `None`, and a word about it, where nothing can be rendered.
pub fn render(rrd: &Path) -> Option<Picture> {
    let viewer = std::env::var("ARMTWIN_RERUN").unwrap_or_else(|_| "rerun".into());
    if Command::new(&viewer).arg("--version").output().is_err() {
        eprintln!("skipped: no rerun viewer on PATH or under ARMTWIN_RERUN");
        return None;
    }
    let folder = TempDir::new().unwrap();
    let png = folder.path().join("shot.png");
    let out = Command::new(&viewer)
        .args(["--headless", "--bind", "127.0.0.1", "--port", "auto", "--renderer", "vulkan"])
        .args(["--hide-welcome-screen", "--window-size", "1000x700", "--screenshot-to"])
        .args([png.as_path(), rrd])
        .env("RUST_LOG", "off")
        .env("XDG_RUNTIME_DIR", folder.path())
        .output()
        .unwrap();
    let Ok(bytes) = std::fs::read(&png) else {
        let said = String::from_utf8_lossy(&out.stderr);
        let last = said.lines().last().unwrap_or("no word");
        eprintln!("skipped: the viewer renders nothing here (a Vulkan driver is needed): {last}");
        return None;
    };
    Some(decoded(&bytes))
}

/// Eight bits per channel, not interlaced: what the viewer writes.
fn decoded(png: &[u8]) -> Picture {
    assert_eq!(&png[1..4], b"PNG");
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()) as usize;
    let (width, channels) = (number(16), if png[25] == 6 { 4 } else { 3 });
    let (mut packed, mut at) = (Vec::new(), 8);
    while at < png.len() {
        let length = number(at);
        if &png[at + 4..at + 8] == b"IDAT" {
            packed.extend_from_slice(&png[at + 8..at + 8 + length]);
        }
        at += 12 + length;
    }
    let mut raw = Vec::new();
    ZlibDecoder::new(&packed[..]).read_to_end(&mut raw).unwrap();
    let mut above = vec![0u8; width * channels];
    let mut pixels = Vec::new();
    for line in raw.chunks(1 + width * channels) {
        let mut row = line[1..].to_vec();
        for i in 0..row.len() {
            let left = if i >= channels { row[i - channels] } else { 0 };
            let corner = if i >= channels { above[i - channels] } else { 0 };
            row[i] = row[i].wrapping_add(predicted(line[0], left, above[i], corner));
        }
        pixels.extend(row.chunks(channels).map(|p| [p[0], p[1], p[2]]));
        above = row;
    }
    Picture { pixels }
}

/// The filters of PNG.
fn predicted(filter: u8, left: u8, above: u8, corner: u8) -> u8 {
    let [a, b, c] = [left, above, corner].map(i32::from);
    match filter {
        1 => left,
        2 => above,
        3 => ((a + b) / 2) as u8,
        4 => {
            let [pa, pb, pc] = [(b - c).abs(), (a - c).abs(), (a + b - 2 * c).abs()];
            if pa <= pb && pa <= pc {
                left
            } else if pb <= pc {
                above
            } else {
                corner
            }
        }
        _ => 0,
    }
}
