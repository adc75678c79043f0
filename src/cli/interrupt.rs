//! Ctrl-C and SIGTERM: work that listens ends between two files; all other work ends at once, and
//! leaves no half of one.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

#[cfg(unix)]
use nix::sys::signal::{SigSet, Signal};

use crate::files;

static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Raised by the first interruption, if somebody holds it then.
pub fn flag() -> Arc<AtomicBool> {
    Arc::clone(FLAG.get_or_init(Arc::default))
}

/// Whether somebody listens who was not told before.
fn is_told() -> bool {
    let listened = FLAG.get().filter(|flag| Arc::strong_count(flag) > 1);
    listened.is_some_and(|flag| !flag.swap(true, Ordering::Relaxed))
}

/// From now on an interrupted program leaves nothing behind, and a limit on the size of files is an
/// error like a full disk. Called before there are other threads, which inherit what is blocked.
///
/// # Errors
/// If the system takes no handler.
#[cfg(unix)]
pub fn listen() -> anyhow::Result<()> {
    use nix::sys::signal::raise;

    let ends = SigSet::from_iter([Signal::SIGINT, Signal::SIGTERM]);
    blocked().thread_block()?;
    std::thread::spawn(move || {
        while let Ok(signal) = ends.wait() {
            if !is_told() {
                files::abandon();
                // So that whoever waits for the program sees what ended it.
                let _ = ends.thread_unblock().and_then(|()| raise(signal));
                std::process::exit(128 + signal as i32);
            }
        }
    });
    Ok(())
}

#[cfg(unix)]
fn blocked() -> SigSet {
    SigSet::from_iter([Signal::SIGINT, Signal::SIGTERM, Signal::SIGXFSZ])
}

/// Starts another program, which inherits what is blocked where it is started.
pub fn starting<T>(start: impl FnOnce() -> T) -> T {
    #[cfg(unix)]
    let open = blocked().thread_unblock();
    let started = start();
    #[cfg(unix)]
    let _ = open.and_then(|()| blocked().thread_block());
    started
}

/// # Errors
/// If the system takes no handler.
#[cfg(not(unix))]
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        if !is_told() {
            files::abandon();
            std::process::exit(130);
        }
    })?;
    Ok(())
}
