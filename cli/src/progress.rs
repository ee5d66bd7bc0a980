//! How far a long task is: a bar on a terminal, elsewhere a line every so often.

use indicatif::{ProgressBar, ProgressStyle};
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use tyndall::task::Step;

/// The time between two lines.
const EVERY: Duration = Duration::from_secs(10);

/// When a line was written last, whichever task it was about: many short ones are as long as one.
static SPOKE: LazyLock<Spoke> = LazyLock::new(Spoke::default);

/// When something was said last.
#[derive(Clone)]
struct Spoke(Arc<Mutex<Instant>>);

impl Default for Spoke {
    fn default() -> Self {
        Spoke(Arc::new(Mutex::new(Instant::now())))
    }
}

impl Spoke {
    fn now(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }

    /// The time until the next line is due.
    fn due(&self, every: Duration) -> Duration {
        let spoke = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        every.saturating_sub(spoke.elapsed())
    }
}

/// A line is formatted on the stack of its thread [bytes].
const STACK: usize = 128 << 10;

/// Shows how far a task is, until it is dropped.
pub enum Bar {
    /// On a terminal.
    Drawn(ProgressBar),
    /// On a pipe or in a file.
    Lines(Lines),
    /// Nowhere.
    Silent,
}

impl Bar {
    /// A bar where standard error is a terminal, lines by `say` where it is not.
    pub fn new(say: fn(&str)) -> Self {
        let bar = ProgressBar::new(1000);
        if bar.is_hidden() {
            return Bar::Lines(Lines::new(EVERY, SPOKE.clone(), say));
        }
        let style = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}");
        Bar::Drawn(bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())))
    }

    /// Shows what is being done, and how much of it is; what is left of it is found by how long that took.
    pub fn step(&self, step: Step) {
        match step.turn {
            None => self.take(step.stage, step.share, true),
            Some([turn, of]) => {
                let words = format!("{}, {turn} of {of}", step.stage);
                self.take(&words, step.share, true);
            }
        }
    }

    /// Shows what is being done in words that say how long it will take, and how much of the whole is done, 0 to 1.
    pub fn show(&self, words: &str, share: f64) {
        self.take(words, share, false);
    }

    fn take(&self, words: &str, share: f64, is_timed: bool) {
        match self {
            Bar::Drawn(bar) => {
                bar.set_message(words.to_owned());
                bar.set_position((1000.0 * share) as u64);
            }
            Bar::Lines(lines) => lines.take(words, share, is_timed),
            Bar::Silent => {}
        }
    }

    /// The next line is due only after the whole time between two: something else was said just now.
    pub fn spoke(&self) {
        if let Bar::Lines(lines) = self {
            lines.spoke.now();
        }
    }

    /// Does what writes lines, while nothing is drawn over them.
    pub fn apart<T>(&self, work: impl FnOnce() -> T) -> T {
        match self {
            Bar::Drawn(bar) => bar.suspend(work),
            _ => work(),
        }
    }

    /// Whether what is done can be told by lines: it is not drawn over them.
    pub fn takes_lines(&self) -> bool {
        !matches!(self, Bar::Drawn(_))
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Bar::Drawn(bar) = self {
            bar.finish_and_clear();
        }
    }
}

/// Lines that a thread of their own writes, however seldom the task says how far it is.
pub struct Lines {
    shared: Arc<(Mutex<Told>, Condvar)>,
    spoke: Spoke,
    thread: Option<JoinHandle<()>>,
}

/// What a task has said last.
struct Told {
    words: String,
    share: f64,
    /// Where this stage was, and when, as it was told of first.
    begun: (f64, Instant),
    /// Whether words are a stage's, of which it is found how long it takes.
    is_timed: bool,
    is_over: bool,
}

impl Told {
    fn take(&mut self, words: &str, share: f64, is_timed: bool) {
        if self.words != words {
            words.clone_into(&mut self.words);
            self.begun = (share, Instant::now());
        }
        self.share = share;
        self.is_timed = is_timed;
    }

    /// The time until the next line of it is due, where that is `due` for any task: one that has not said what it does has its whole time.
    fn due(&self, every: Duration, due: Duration) -> Duration {
        match self.words.is_empty() {
            true => due.max(every.saturating_sub(self.begun.1.elapsed())),
            false => due,
        }
    }

    fn line(&self) -> String {
        let Told { words, share, .. } = self;
        let (from, since) = self.begun;
        let gone = since.elapsed().as_secs_f64();
        let done = (share - from) / (1.0 - from).max(f64::MIN_POSITIVE);
        let percent = 100.0 * share;
        match (self.is_timed, words.is_empty()) {
            (_, true) => format!("beginning, for {}", duration(gone)),
            (false, _) => format!("{words}, {percent:.0} %"),
            (true, _) if done > 0.01 => {
                let left = gone * (1.0 - done) / done;
                format!("{words}: {percent:.0} %, about {} left", duration(left))
            }
            (true, _) => format!("{words}: {percent:.0} %, for {}", duration(gone)),
        }
    }
}

impl Lines {
    fn new(every: Duration, spoke: Spoke, say: impl Fn(&str) + Send + 'static) -> Self {
        let now = Instant::now();
        let shared = Arc::new((
            Mutex::new(Told {
                words: String::new(),
                share: 0.0,
                begun: (0.0, now),
                is_timed: true,
                is_over: false,
            }),
            Condvar::new(),
        ));
        let (own, last) = (Arc::clone(&shared), spoke.clone());
        let work = move || {
            let (told, changed) = &*own;
            let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
            while !told.is_over {
                let due = told.due(every, last.due(every));
                if due.is_zero() {
                    say(&told.line());
                    last.now();
                    continue;
                }
                let woken = changed.wait_timeout(told, due);
                told = woken.unwrap_or_else(PoisonError::into_inner).0;
            }
        };
        // Where there is no thread to be had, the work matters more.
        let thread = thread::Builder::new().stack_size(STACK).spawn(work).ok();
        Lines {
            shared,
            spoke,
            thread,
        }
    }

    fn take(&self, words: &str, share: f64, is_timed: bool) {
        let mut told = self.told();
        let begins = told.words.is_empty();
        told.take(words, share, is_timed);
        if begins {
            // A line may be due at once.
            self.shared.1.notify_all();
        }
    }

    fn told(&self) -> MutexGuard<'_, Told> {
        self.shared.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        self.told().is_over = true;
        self.shared.1.notify_all();
        if let Some(thread) = self.thread.take() {
            // It has nothing left to do but to end.
            let _ = thread.join();
        }
    }
}

/// A time [s] as people say it.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5970.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_comes_every_so_often_until_the_end() {
        let said = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&said);
        let every = Duration::from_millis(20);
        let begun = Instant::now();
        let bar = Bar::Lines(Lines::new(every, Spoke::default(), move |line| {
            heard.lock().unwrap().push(line.to_owned());
        }));
        let step = |stage, share| {
            bar.step(Step {
                stage,
                share,
                turn: None,
            });
        };
        step("the picture", 0.0);
        step("the picture", 0.25);
        let count = || said.lock().unwrap().len();
        while count() < 3 && begun.elapsed() < Duration::from_secs(20) {
            thread::sleep(Duration::from_millis(5));
        }
        assert!(begun.elapsed() >= 2 * every, "not sooner");
        drop(bar);
        let lines = said.lock().unwrap().clone();
        assert!(lines.len() >= 3, "{lines:?}");
        let last = &lines[lines.len() - 1];
        assert!(last.starts_with("the picture: 25 %, about "), "{lines:?}");
        assert!(last.ends_with(" s left"), "{lines:?}");
        thread::sleep(3 * every);
        assert_eq!(count(), lines.len(), "it has ended");
    }

    #[test]
    fn many_short_tasks_are_told_of_as_one_long() {
        let (said, spoke) = (Arc::new(Mutex::new(0)), Spoke::default());
        let begun = Instant::now();
        let count = || *said.lock().unwrap();
        while count() < 2 && begun.elapsed() < Duration::from_secs(20) {
            let heard = Arc::clone(&said);
            let every = Duration::from_millis(200);
            let bar = Bar::Lines(Lines::new(every, spoke.clone(), move |line| {
                assert!(line.starts_with("a short one"), "{line}");
                *heard.lock().unwrap() += 1;
            }));
            bar.show("a short one", 0.5);
            thread::sleep(Duration::from_millis(10));
        }
        assert!(count() >= 2, "ten seconds began anew with each");
        assert!(begun.elapsed() >= Duration::from_millis(400), "not sooner");
    }

    #[test]
    fn what_is_left_goes_by_what_its_stage_took() {
        let now = Instant::now();
        let ago = |seconds| now.checked_sub(Duration::from_secs(seconds)).unwrap();
        let mut told = Told {
            words: "patches".into(),
            share: 0.75,
            begun: (0.5, ago(60)),
            is_timed: true,
            is_over: false,
        };
        assert_eq!(told.line(), "patches: 75 %, about 60 s left");
        let (every, none) = (Duration::from_secs(10), Duration::ZERO);
        let spoke = |time| Spoke(Arc::new(Mutex::new(time)));
        assert!(spoke(now).due(every) > Duration::from_secs(5));
        assert!(spoke(ago(11)).due(every).is_zero());
        assert!(told.due(every, none).is_zero());
        told.words.clear();
        told.begun.1 = now;
        assert!(told.due(every, none) > Duration::from_secs(5));
        told.words = "patches".into();
        told.begun = (0.75, ago(600));
        assert_eq!(told.line(), "patches: 75 %, for 10 min");
        told.is_timed = false;
        told.words = "frame 3, 2 h left".into();
        assert_eq!(told.line(), "frame 3, 2 h left, 75 %");
    }
}
