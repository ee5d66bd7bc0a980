//! Which frames of a sequence a process renders: `--only` and `--shard`.

use crate::error::{Error, Result};
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Frames by their index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Only {
    /// Those of which a file is missing.
    Missing,
    /// These.
    Indices(Vec<RangeInclusive<u64>>),
}

impl Only {
    /// Those indices, in order, as [`Only::from_str`] reads them: `2,4,10-20`.
    pub fn text(indices: impl IntoIterator<Item = u64>) -> String {
        let mut ranges: Vec<[u64; 2]> = Vec::new();
        for index in indices {
            match ranges.last_mut() {
                Some([_, last]) if *last + 1 == index => *last = index,
                _ => ranges.push([index, index]),
            }
        }
        let text = ranges.iter().map(|[first, last]| match last - first {
            0 => first.to_string(),
            1 => format!("{first},{last}"),
            _ => format!("{first}-{last}"),
        });
        text.collect::<Vec<_>>().join(",")
    }

    /// Whether it names this index; of [`Only::Missing`] it is not known.
    pub fn names(&self, index: u64) -> bool {
        match self {
            Only::Missing => true,
            Only::Indices(ranges) => ranges.iter().any(|range| range.contains(&index)),
        }
    }
}

impl FromStr for Only {
    type Err = Error;

    /// `missing`, or indices and ranges of them, as in `2,4,10-20`.
    fn from_str(text: &str) -> Result<Self> {
        if text.trim() == "missing" {
            return Ok(Only::Missing);
        }
        let range = |part: &str| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            let [first, last] = [first, last].map(|number| number.trim().parse::<u64>().ok());
            let range = first?..=last?;
            (!range.is_empty()).then_some(range)
        };
        match text.split(',').map(range).collect() {
            Some(ranges) => Ok(Only::Indices(ranges)),
            None => Err(Error::input(
                format!("--only {text}"),
                "these are no indices of frames",
                "write missing, or indices and ranges: 2,4,10-20",
            )),
        }
    }
}

/// One of so many equal shares of a sequence: frames are dealt out by turns, so that each has some of all hours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Which it is, from 1.
    pub number: u64,
    /// How many there are.
    pub of: u64,
}

impl Shard {
    /// Whether a frame is in it, by its place in the sequence from 0.
    pub fn holds(&self, place: u64) -> bool {
        place % self.of == self.number - 1
    }
}

impl FromStr for Shard {
    type Err = Error;

    /// `I/N`, I from 1 to N.
    fn from_str(text: &str) -> Result<Self> {
        let parts = text.split_once('/');
        let parts = parts.map(|(number, of)| [number, of].map(|part| part.trim().parse().ok()));
        match parts {
            Some([Some(number), Some(of)]) if (1..=of).contains(&number) => {
                Ok(Shard { number, of })
            }
            _ => Err(Error::input(
                format!("--shard {text}"),
                "this is no share of a sequence",
                "write I/N with I from 1 to N: 2/16",
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_and_ranges() {
        let only: Only = "2, 4,10-20".parse().expect("it is one");
        let named: Vec<u64> = (0..30).filter(|index| only.names(*index)).collect();
        assert_eq!(named[..3], [2, 4, 10]);
        assert_eq!(named.len(), 13);
        assert_eq!(Only::text(named), "2,4,10-20");
        assert_eq!(Only::text([1, 2, 3, 7, 8]), "1-3,7,8");
        assert_eq!(Only::text([]), "");
        assert_eq!("missing".parse().ok(), Some(Only::Missing));
        for bad in ["", "1,", "3-1", "-3", "a", "1-2-3", "missing,2"] {
            assert!(bad.parse::<Only>().is_err_and(|e| e.is_input()), "{bad}");
        }
    }

    #[test]
    fn shards_hold_each_frame_once() {
        for of in [1, 3, 16] {
            for place in 0..100 {
                let shards = (1..=of).map(|number| Shard { number, of });
                assert_eq!(shards.filter(|shard| shard.holds(place)).count(), 1);
            }
        }
        assert_eq!("2/3".parse().ok(), Some(Shard { number: 2, of: 3 }));
        for bad in ["0/3", "4/3", "1", "1/0", "a/b", "-1/2", ""] {
            assert!(bad.parse::<Shard>().is_err_and(|e| e.is_input()), "{bad}");
        }
    }
}
