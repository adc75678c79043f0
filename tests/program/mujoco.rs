//! What MuJoCo is asked: a second simulator, in Python. Without it these tests say that they are
//! skipped.

use std::path::Path;
use std::process::{Command, Output};

/// A Python with MuJoCo: $ARMTWIN_PYTHON, or the one on the path.
fn python() -> Option<String> {
    let python = std::env::var("ARMTWIN_PYTHON").unwrap_or("python3".into());
    let found = Command::new(&python).args(["-c", "import mujoco, numpy"]).output();
    let found = found.is_ok_and(|o| o.status.success());
    if !found {
        eprintln!("skipped: {python} has no mujoco (pip install mujoco, or set ARMTWIN_PYTHON)");
    }
    found.then_some(python)
}

/// Runs a script of `tests/mujoco` to its end, where there is MuJoCo.
pub fn script(name: &str, arguments: &[&str]) -> Option<Output> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mujoco").join(name);
    let armtwin = env!("CARGO_BIN_EXE_armtwin");
    let mut command = Command::new(python()?);
    let run = command.arg(script).args(arguments).env("ARMTWIN", armtwin).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    Some(run)
}
