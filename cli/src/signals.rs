//! Being asked to end: Ctrl-C and SIGTERM set a flag, which long work looks at, instead of ending the program at once.

use std::sync::atomic::AtomicBool;

/// What `sysexits.h` calls EX_TEMPFAIL: try again later, something is left to be done.
pub const TRY_AGAIN: u8 = tyndall::timelapse::cluster::AGAIN;

#[cfg(unix)]
mod caught {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::flag;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::sync::{Arc, LazyLock};
    use tyndall::timelapse::cluster::AGAIN;

    /// 128 and the number of SIGINT, as shells have it.
    const INTERRUPTED: u8 = 130;

    struct Caught {
        asked: Arc<AtomicBool>,
        signal: Arc<AtomicUsize>,
    }

    static CAUGHT: LazyLock<Caught> = LazyLock::new(|| {
        let caught = Caught {
            asked: Arc::default(),
            signal: Arc::default(),
        };
        for (signal, code) in [(SIGINT, INTERRUPTED), (SIGTERM, AGAIN)] {
            let Caught {
                asked,
                signal: which,
            } = &caught;
            // Where they cannot be caught they end the program, as they do without. Whoever asks twice does not want to wait: the first of
            // these acts when the flag is set already.
            let _ = flag::register_conditional_shutdown(signal, code.into(), asked.clone());
            let _ = flag::register_usize(signal, which.clone(), signal as usize);
            let _ = flag::register(signal, asked.clone());
        }
        caught
    });

    pub fn asked() -> &'static AtomicBool {
        &CAUGHT.asked
    }

    pub fn exit_status() -> Option<u8> {
        match CAUGHT.signal.load(Ordering::Relaxed) as i32 {
            SIGINT => Some(INTERRUPTED),
            SIGTERM => Some(AGAIN),
            _ => None,
        }
    }
}

#[cfg(not(unix))]
mod caught {
    use std::sync::atomic::AtomicBool;

    static NEVER: AtomicBool = AtomicBool::new(false);

    pub fn asked() -> &'static AtomicBool {
        &NEVER
    }

    pub fn exit_status() -> Option<u8> {
        None
    }
}

/// Set when somebody asks the program to end. From the first call on the program does not end by itself then.
pub fn asked_to_end() -> &'static AtomicBool {
    caught::asked()
}

/// The exit status of work that was ended: 75 after SIGTERM, 130 after Ctrl-C; nothing where nobody asked.
pub fn exit_status() -> Option<u8> {
    caught::exit_status()
}
