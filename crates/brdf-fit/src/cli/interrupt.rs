//! What becomes of unfinished outputs when a signal ends the program.

/// Prepares the program for signals: one that ends it leaves no temporary file behind, and a limit on
/// the size of files (`ulimit -f`) is an error of the output that exceeds it.
///
/// The exit status remains that of a program which the signal ends.
#[cfg(unix)]
pub(super) fn prepare() {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXCPU, SIGXFSZ};
    use signal_hook::flag;
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    // With a handler, whatever it does, the system returns the error to the writer.
    let _ = flag::register(SIGXFSZ, Arc::new(AtomicBool::new(false)));
    let mut ending = vec![SIGHUP, SIGINT, SIGTERM, SIGXCPU];
    ending.retain(|signal| !is_ignored(*signal));
    let Ok(mut signals) = Signals::new(&ending) else {
        return;
    };
    let wait = move || {
        if let Some(signal) = signals.forever().next() {
            crate::output::abandon();
            let _ = emulate_default_handler(signal);
        }
    };
    let waiting = thread::Builder::new()
        .name("signals".to_owned())
        .spawn(wait);
    if waiting.is_err() {
        // Without a thread, a signal ends the program as usual, and the next run removes what it leaves.
        for signal in ending {
            let _ = flag::register_conditional_default(signal, Arc::new(AtomicBool::new(true)));
        }
    }
}

#[cfg(not(unix))]
pub(super) fn prepare() {}

/// Whether the program that started this one wants a signal to be ignored, as `nohup` does and a shell
/// for commands in the background. Only Linux tells; elsewhere, that holds for SIGHUP.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").ok();
    let ignored = status.as_deref().and_then(ignored_signals);
    match ignored {
        Some(mask) => mask >> (signal - 1) & 1 == 1,
        None => signal == signal_hook::consts::SIGHUP,
    }
}

/// The mask of ignored signals in `/proc/self/status`, with bit `n - 1` for signal n.
#[cfg(unix)]
fn ignored_signals(status: &str) -> Option<u64> {
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(line.trim(), 16).ok()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn the_ignored_signals_are_a_mask() {
        let status = "Name:\tfit\nSigBlk:\t0000000000000000\nSigIgn:\t0000000000001001\n";
        assert_eq!(ignored_signals(status), Some(0x1001));
        assert_eq!(ignored_signals("Name:\tfit\n"), None);
    }
}
