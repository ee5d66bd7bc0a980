//! Time-lapse: frames over a range of times, planned as a whole, resumed by what is in them, and a film of them.
//!
//! | module | what |
//! |---|---|
//! | [`when`] | the instants: ends, which may be what the sun does, and a step or a number of frames |
//! | [`template`] | names of files with the frame's index in them |
//! | [`plan`] | the plan file: a header, and a line for each frame |
//! | [`key`] | what makes a picture what it is, as hashes |
//! | [`exposure`] | one exposure curve for all frames |
//! | [`select`] | which frames a process renders |
//! | [`resume`] | which of them are there already |
//! | [`sequence`] | all of it: planning and rendering |
//! | [`frames`] | finished frames in their order, and how fast they are shown |
//! | [`film`] | a film of them; `h264` and `mp4` encode it where there is no ffmpeg |
//! | [`cluster`] | jobs for Slurm and Kubernetes that make the frames in shards |

pub mod cluster;
pub mod exposure;
pub mod film;
pub mod frames;
mod h264;
pub mod key;
mod mp4;
pub mod plan;
pub mod resume;
pub mod select;
pub mod sequence;
pub mod template;
pub mod when;

pub use sequence::{Asked, Planned, Sequence};
