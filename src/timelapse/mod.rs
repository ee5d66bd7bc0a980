//! Time-lapse: frames over a range of times, planned as a whole, resumed by what is in them, and a film of them.
//!
//! | module | what |
//! |---|---|
//! | [`template`] | names of files with the frame's index in them |
//! | [`plan`] | the plan file: a header, and a line for each frame |

pub mod plan;
pub mod template;
