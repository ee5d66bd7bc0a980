//! Lines in, text out, piece by piece in their order: whatever has come in is worked on and printed while more is awaited.
//!
//! One thread reads, as many as there are cores work, the caller writes. Each hand-over holds a few pieces, so that memory
//! does not grow with the input, and a slow reader of the results slows the reading.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;

use tyndall::{Error, Result};

/// The longest line that is read [bytes]: no row is longer, and what has no lines (`/dev/zero`) is found out soon.
pub const LONGEST: usize = 1 << 20;

/// How much is asked for at a time [bytes].
const READ: usize = 1 << 17;

/// Whole lines of a file.
pub struct Piece {
    /// The number of the first, from 1.
    pub first: usize,
    /// The lines with their ends; the file's last may have none.
    pub bytes: Vec<u8>,
}

/// A file, a pipe or standard input, taken as it comes.
pub struct Input {
    path: PathBuf,
    /// What errors call it.
    pub name: String,
    source: Box<dyn Read + Send>,
    buffer: Vec<u8>,
    /// The beginning of a line whose end has not come.
    begun: Vec<u8>,
    next_line: usize,
}

impl Input {
    /// `-` is standard input.
    pub fn open(path: &Path) -> Result<Self> {
        let (path, source): (PathBuf, Box<dyn Read + Send>) = if path == Path::new("-") {
            ("standard input".into(), Box::new(std::io::stdin()))
        } else {
            let file = File::open(path).map_err(|error| Error::reading(path, error))?;
            (path.to_owned(), Box::new(file))
        };
        Ok(Input {
            name: path.display().to_string(),
            path,
            source,
            buffer: vec![0; READ],
            begun: Vec::new(),
            next_line: 1,
        })
    }

    /// Waits for the end of a line and takes all whole lines that are there; `None` at the end.
    pub fn next(&mut self) -> Result<Option<Piece>> {
        loop {
            let length = match self.source.read(&mut self.buffer) {
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(Error::reading(&self.path, error)),
                Ok(0) if self.begun.is_empty() => return Ok(None),
                Ok(0) => return Ok(Some(self.take(Vec::new()))),
                Ok(length) => length,
            };
            let came = &self.buffer[..length];
            let is_end = |byte: &u8| *byte == b'\n';
            let first = came.iter().position(is_end);
            if self.begun.len() + first.unwrap_or(length) > LONGEST {
                return Err(Error::input(
                    format!("{}:{}", self.name, self.next_line),
                    format!("the line is longer than {LONGEST} bytes"),
                    "give a CSV: lines of cells, with commas between them",
                ));
            }
            match came.iter().rposition(is_end) {
                Some(last) => {
                    let rest = came[last + 1..].to_vec();
                    self.begun.extend_from_slice(&self.buffer[..=last]);
                    return Ok(Some(self.take(rest)));
                }
                None => self.begun.extend_from_slice(came),
            }
        }
    }

    /// What has come, leaving the beginning of another line.
    fn take(&mut self, rest: Vec<u8>) -> Piece {
        let bytes = std::mem::replace(&mut self.begun, rest);
        let first = self.next_line;
        self.next_line += bytes.iter().filter(|byte| **byte == b'\n').count();
        Piece { first, bytes }
    }
}

/// Does `work` on `first` and on all further pieces of an input, each worker with its own copy, and gives the results to
/// `sink` in order, which is told before it waits.
///
/// It ends with the input, or early once the sink wants no more, and then leaves the input alone.
pub fn run<T: Send + 'static>(
    first: Piece,
    mut input: Input,
    work: impl FnMut(&Piece) -> T + Clone + Send + 'static,
    sink: &mut impl Sink<T>,
) -> Result<()> {
    let workers = thread::available_parallelism().map_or(1, |n| n.get());
    let (jobs, waiting) = sync_channel::<(Piece, SyncSender<T>)>(workers);
    let (order, results) = sync_channel::<Result<Receiver<T>>>(2 * workers);
    let waiting = Arc::new(Mutex::new(waiting));
    for _ in 0..workers {
        let (waiting, mut work) = (Arc::clone(&waiting), work.clone());
        start(move || {
            loop {
                let job = match waiting.lock() {
                    Ok(waiting) => waiting.recv(),
                    Err(_) => return,
                };
                let Ok((piece, done)) = job else { return };
                // Nobody takes it where nothing more is wanted.
                let _ = done.send(work(&piece));
            }
        })?;
    }
    start(move || {
        let mut next = Ok(Some(first));
        while let Some(piece) = next.transpose() {
            let sent = match piece {
                Ok(piece) => {
                    let (done, result) = sync_channel(1);
                    order.send(Ok(result)).is_ok() && jobs.send((piece, done)).is_ok()
                }
                Err(error) => {
                    let _ = order.send(Err(error));
                    false
                }
            };
            if !sent {
                return;
            }
            next = input.next();
        }
    })?;
    while let Some(result) = awaited(&results, sink)? {
        match awaited(&result?, sink)? {
            Some(result) => sink.take(result)?,
            None if sink.wants_more() => {
                return Err(Error::failed(
                    "a thread ended before its work was done",
                    "please report this defect with the command",
                ));
            }
            None => {}
        }
    }
    Ok(())
}

/// What takes the results.
pub trait Sink<T> {
    /// Takes one.
    fn take(&mut self, result: T) -> Result<()>;
    /// Nothing has come yet: what was taken may go out.
    fn idle(&mut self) -> Result<()>;
    /// Whether more are wanted.
    fn wants_more(&self) -> bool;
}

/// What a channel gives, or `None` when all has come or no more is wanted.
fn awaited<T, U>(channel: &Receiver<U>, sink: &mut impl Sink<T>) -> Result<Option<U>> {
    match channel.try_recv() {
        Ok(value) => Ok(Some(value).filter(|_| sink.wants_more())),
        Err(TryRecvError::Disconnected) => Ok(None),
        Err(TryRecvError::Empty) => {
            sink.idle()?;
            Ok(match sink.wants_more() {
                true => channel.recv().ok(),
                false => None,
            })
        }
    }
}

fn start(run: impl FnOnce() + Send + 'static) -> Result<()> {
    thread::Builder::new()
        .spawn(run)
        .map(drop)
        .map_err(|error| {
            Error::failed(
                format!("a thread could not be started: {error}"),
                "allow more memory or more threads",
            )
        })
}
