//! Time-lapse: frames over a range of times, planned as a whole, resumed by what is in them, and a film of them.
