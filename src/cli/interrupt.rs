//! Ctrl-C, so that work ends between two files and not within one.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

/// Raised by Ctrl-C from the first call on; the same one every time.
///
/// # Errors
/// If the system takes no handler.
pub fn flag() -> anyhow::Result<Arc<AtomicBool>> {
    static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    if let Some(flag) = FLAG.get() {
        return Ok(Arc::clone(flag));
    }
    let flag = Arc::new(AtomicBool::new(false));
    let raise = Arc::clone(&flag);
    ctrlc::set_handler(move || raise.store(true, Ordering::Relaxed))?;
    Ok(Arc::clone(FLAG.get_or_init(|| flag)))
}
