//! Where on a patch light comes from.
//!
//! A patch sends the same light from everywhere but for that of sun and lamps, which falls unevenly. How closely it is told where a ray has
//! met a patch goes by how much the ray stands for: from afar a patch is one whole, from near by it has tiles.

use glam::DVec2;

/// One of 4^level equal parts of the rectangle around a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tile(u16);

/// The greatest level of tiles.
pub(super) const FINEST: u32 = 7;

impl Tile {
    /// All of it.
    pub const WHOLE: Tile = Tile(0);

    /// The tile of a level, 0 to 7, at a place in the rectangle, 0 to 1 each way.
    pub(super) fn at(level: u32, place: DVec2) -> Self {
        let side = 1u32 << level;
        let [i, j] = (place * f64::from(side))
            .to_array()
            .map(|at| (at as u32).min(side - 1));
        Tile::numbered(first(level) + (j * side + i) as usize)
    }

    /// That of a number: they count level by level, row by row.
    pub(super) fn numbered(number: usize) -> Self {
        Tile(number as u16)
    }

    /// Its number.
    pub(super) fn number(self) -> usize {
        usize::from(self.0)
    }

    /// Its level.
    pub(super) fn level(self) -> u32 {
        (0..=FINEST)
            .rfind(|level| first(*level) <= self.number())
            .unwrap_or(0)
    }

    /// The tile that this one is a quarter of.
    pub(super) fn whole(self) -> Option<Self> {
        let number = self.number();
        let level = Some(self.level()).filter(|level| *level > 0)?;
        let (at, side) = (number - first(level), 1 << level);
        let (i, j) = (at % side / 2, at / side / 2);
        Some(Tile((first(level - 1) + j * side / 2 + i) as u16))
    }
}

/// The number of the first tile of a level: how many there are of all coarser ones.
pub(super) fn first(level: u32) -> usize {
    ((1 << (2 * level)) - 1) / 3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_numbered_level_by_level() {
        assert_eq!(Tile::at(0, DVec2::splat(0.7)), Tile::WHOLE);
        let mut next = 0;
        for level in 0..=FINEST {
            assert_eq!(first(level), next);
            let side = 1u32 << level;
            for j in 0..side {
                for i in 0..side {
                    let place = (DVec2::new(i.into(), j.into()) + 0.5) / f64::from(side);
                    let tile = Tile::at(level, place);
                    assert_eq!(tile, Tile::numbered(next));
                    let whole = level.checked_sub(1).map(|above| Tile::at(above, place));
                    assert_eq!(tile.whole(), whole);
                    next += 1;
                }
            }
            // The border belongs to the last one.
            assert_eq!(Tile::at(level, DVec2::ONE), Tile::numbered(next - 1));
        }
    }
}
