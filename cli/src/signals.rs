//! Being asked to end, by Ctrl-C or SIGTERM. The program ends at once, with the status that says so; work that keeps what it has done,
//! or that says what it leaves, is asked by a flag instead.

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
        /// Whether the program ends at once.
        at_once: Arc<AtomicBool>,
        asked: Arc<AtomicBool>,
        signal: Arc<AtomicUsize>,
    }

    static CAUGHT: LazyLock<Caught> = LazyLock::new(|| {
        let caught = Caught {
            at_once: Arc::new(AtomicBool::new(true)),
            asked: Arc::default(),
            signal: Arc::default(),
        };
        for (signal, code) in [(SIGINT, INTERRUPTED), (SIGTERM, AGAIN)] {
            let Caught {
                at_once,
                asked,
                signal: which,
            } = &caught;
            // Where they cannot be caught they end the program, as they do without. Whoever asks twice does not want to wait: the second of
            // these acts when the flag is set already.
            let _ = flag::register_conditional_shutdown(signal, code.into(), at_once.clone());
            let _ = flag::register_conditional_shutdown(signal, code.into(), asked.clone());
            let _ = flag::register_usize(signal, which.clone(), signal as usize);
            let _ = flag::register(signal, asked.clone());
        }
        caught
    });

    pub fn prepare() {
        LazyLock::force(&CAUGHT);
    }

    pub fn asked() -> &'static AtomicBool {
        CAUGHT.at_once.store(false, Ordering::Relaxed);
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

    pub fn prepare() {}

    pub fn asked() -> &'static AtomicBool {
        &NEVER
    }

    pub fn exit_status() -> Option<u8> {
        None
    }
}

/// From here on the program ends with the status that says it was asked to.
pub fn prepare() {
    caught::prepare();
}

/// Set when somebody asks the program to end. From the first call on the program does not end by itself then.
pub fn asked_to_end() -> &'static AtomicBool {
    caught::asked()
}

/// The exit status of work that was ended: 75 after SIGTERM, 130 after Ctrl-C; nothing where nobody asked.
pub fn exit_status() -> Option<u8> {
    caught::exit_status()
}
