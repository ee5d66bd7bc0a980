//! Time-lapse: frames over a range of times, planned as a whole, resumed by what is in them, and a film of them.
//!
//! | module | what |
//! |---|---|
//! | [`template`] | names of files with the frame's index in them |
//! | [`plan`] | the plan file: a header, and a line for each frame |
//! | [`film`] | finished frames as a film; `h264` and `mp4` are what encodes it without ffmpeg |
//! | [`cluster`] | jobs for Slurm and Kubernetes that make the frames in shards |

pub mod cluster;
pub mod film;
mod h264;
mod mp4;
pub mod plan;
pub mod template;
