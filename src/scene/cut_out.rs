//! Triangles with holes: where the alpha of a texture times that of the vertices does not reach a threshold, nothing is there.
//!
//! A straight line over a texture is solid on some parts and not on others. Which ones is found on a pyramid of the least and
//! the greatest alpha of blocks of texels, each level of half the size: a block that is solid or empty as a whole is passed in
//! one step, and only where leaves end are single texels looked at. The parts are those of a walk from texel to texel.

use super::{Texture, Wrap};
use glam::DVec2;

/// A triangle with holes.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutOut {
    /// Which of the alpha maps.
    pub map: usize,
    pub uvs: [DVec2; 3],
    /// Alpha of the vertices.
    pub alphas: [f64; 3],
    /// Alpha of the texel times that of the place must reach this, in 0 to 255.
    pub least: f64,
}

/// The alpha channel of a texture, and its pyramid.
pub(super) struct AlphaMap {
    size: [u32; 2],
    wrap: [Wrap; 2],
    /// From single texels to the whole.
    levels: Vec<Level>,
}

/// Blocks of texels, row by row.
struct Level {
    width: u32,
    /// Least and greatest alpha of each block.
    ranges: Vec<[u8; 2]>,
}

/// A place on a cut-out: the texture coordinate and the vertices' alpha there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    pub uv: DVec2,
    pub alpha: f64,
}

impl Spot {
    pub fn lerp(self, other: Spot, f: f64) -> Spot {
        Spot {
            uv: self.uv.lerp(other.uv, f),
            alpha: self.alpha + f * (other.alpha - self.alpha),
        }
    }
}

impl CutOut {
    pub fn corner(&self, index: usize) -> Spot {
        Spot {
            uv: self.uvs[index],
            alpha: self.alphas[index],
        }
    }

    /// The place of the weights of the second and third vertex.
    pub fn spot(&self, [v, w]: [f64; 2]) -> Spot {
        let u = 1.0 - v - w;
        Spot {
            uv: self.uvs[0] * u + self.uvs[1] * v + self.uvs[2] * w,
            alpha: self.alphas[0] * u + self.alphas[1] * v + self.alphas[2] * w,
        }
    }
}

impl AlphaMap {
    pub fn new(texture: &Texture) -> Self {
        let ranges = texture.pixels.iter().map(|p| [p[3]; 2]).collect();
        Self::of([texture.width, texture.height], texture.wrap, ranges)
    }

    /// One of a material without a texture.
    pub fn plain() -> Self {
        Self::of([1, 1], [Wrap::Clamp; 2], vec![[255; 2]])
    }

    fn of(size: [u32; 2], wrap: [Wrap; 2], ranges: Vec<[u8; 2]>) -> Self {
        let mut levels = vec![Level {
            width: size[0],
            ranges,
        }];
        let [mut width, mut height] = size;
        while width > 1 || height > 1 {
            let below = &levels[levels.len() - 1];
            let blocks = [width.div_ceil(2), height.div_ceil(2)];
            let range = |i: u32| {
                let (x, y) = (2 * (i % blocks[0]), 2 * (i / blocks[0]));
                let columns = x..(x + 2).min(width);
                let texels =
                    (y..(y + 2).min(height)).flat_map(|v| columns.clone().map(move |u| (u, v)));
                texels
                    .map(|(u, v)| below.ranges[(v * width + u) as usize])
                    .fold([255, 0], |[low, high], [l, h]| [low.min(l), high.max(h)])
            };
            let ranges = (0..blocks[0] * blocks[1]).map(range).collect();
            [width, height] = blocks;
            levels.push(Level { width, ranges });
        }
        AlphaMap { size, wrap, levels }
    }

    /// Whether a place is solid.
    pub fn is_solid(&self, cut: &CutOut, spot: Spot) -> bool {
        let x = texel(spot.uv.x, self.size[0], self.wrap[0]);
        let y = texel(spot.uv.y, self.size[1], self.wrap[1]);
        let [alpha, _] = self.levels[0].ranges[(y * self.size[0] + x) as usize];
        f64::from(alpha) * spot.alpha >= cut.least
    }

    /// The parts of a straight line on which it is solid, as fractions of the line, in order and apart from each other; parts that
    /// are `hidden` may be left out.
    pub fn solid_parts(
        &self,
        least: f64,
        [from, to]: [Spot; 2],
        hidden: impl Fn(f64, f64) -> bool,
        found: impl FnMut(f64, f64),
    ) {
        let size = self.size.map(f64::from);
        let start = [from.uv.x * size[0], from.uv.y * size[1]];
        let slope = [
            (to.uv.x - from.uv.x) * size[0],
            (to.uv.y - from.uv.y) * size[1],
        ];
        let mut walk = Walk {
            map: self,
            least,
            alpha: [from.alpha, to.alpha - from.alpha],
            start: [0.0; 2],
            slope: [0.0; 2],
            hidden,
            found,
            open: None,
        };
        let top = self.levels.len() - 1;
        if walk.whole(top, 0, [0.0, 1.0]) != Some(false) {
            let mut borders = vec![0.0, 1.0];
            for axis in 0..2 {
                self.borders(axis, start[axis], slope[axis], &mut borders);
            }
            borders.sort_unstable_by(f64::total_cmp);
            for pair in borders.windows(2) {
                let [a, b] = [pair[0], pair[1]];
                if b <= a {
                    continue;
                }
                let middle = 0.5 * (a + b);
                for axis in 0..2 {
                    [walk.start[axis], walk.slope[axis]] =
                        self.unwrapped(axis, start[axis], slope[axis], middle);
                }
                walk.descend(top, [0, 0], [a, b]);
            }
        }
        walk.close();
    }

    /// Where a line passes from one copy of the texture to the next.
    fn borders(&self, axis: usize, start: f64, slope: f64, borders: &mut Vec<f64>) {
        let size = f64::from(self.size[axis]);
        let (a, b) = (start / size, (start + slope) / size);
        let (mut low, mut high) = (a.min(b), a.max(b));
        if self.wrap[axis] == Wrap::Clamp {
            (low, high) = (low.max(-0.5), high.min(1.5));
        }
        let count = high.ceil() - low.floor() - 1.0;
        if count <= COPIES {
            let first = low.floor() + 1.0;
            let all = (0..count.max(0.0) as u32).map(|i| first + f64::from(i));
            borders.extend(all.map(|border| (border - a) / (b - a)));
        }
    }

    /// Start and slope on one axis within the texture itself, of the copy of it that a line passes at the fraction `at`.
    fn unwrapped(&self, axis: usize, start: f64, slope: f64, at: f64) -> [f64; 2] {
        let size = f64::from(self.size[axis]);
        let copy = ((start + at * slope) / size).floor();
        match self.wrap[axis] {
            Wrap::Mirror if copy.rem_euclid(2.0) == 1.0 => [(copy + 1.0) * size - start, -slope],
            Wrap::Clamp if copy < 0.0 => [0.5, 0.0],
            Wrap::Clamp if copy > 0.0 => [size - 0.5, 0.0],
            Wrap::Clamp => [start, slope],
            _ => [start - copy * size, slope],
        }
    }
}

/// A line over more copies of a texture than this is as solid as the copy in its middle: far more than a picture shows.
const COPIES: f64 = 65_536.0;

/// A line on its way over a texture.
struct Walk<'m, H, F> {
    map: &'m AlphaMap,
    least: f64,
    /// The vertices' alpha where the line starts, and its change over the line.
    alpha: [f64; 2],
    /// Where the line would start in this copy of the texture [texels], and its change over the line.
    start: [f64; 2],
    slope: [f64; 2],
    hidden: H,
    found: F,
    /// A solid part that may go on.
    open: Option<[f64; 2]>,
}

impl<H: Fn(f64, f64) -> bool, F: FnMut(f64, f64)> Walk<'_, H, F> {
    /// Whether a block is solid (true) or empty (false) as a whole on a part of the line; `None` where it is neither.
    fn whole(&self, level: usize, block: usize, [from, to]: [f64; 2]) -> Option<bool> {
        let [low, high] = self.map.levels[level].ranges[block].map(f64::from);
        let a = self.alpha[0] + from * self.alpha[1];
        let b = self.alpha[0] + to * self.alpha[1];
        if low * a.min(b) >= self.least {
            return Some(true);
        }
        (high * a.max(b) < self.least).then_some(false)
    }

    /// Finds the solid parts of the line between two fractions, where it passes a block.
    fn descend(&mut self, level: usize, [x, y]: [u32; 2], [from, to]: [f64; 2]) {
        let block = (y * self.map.levels[level].width + x) as usize;
        match self.whole(level, block, [from, to]) {
            Some(true) => return self.solid(from, to),
            Some(false) => return,
            None => {}
        }
        if level == 0 {
            return self.fading(block, [from, to]);
        }
        if level > 2 && (self.hidden)(from, to) {
            return;
        }
        let half = f64::from(1u32 << (level - 1));
        let middle = [f64::from(2 * x + 1) * half, f64::from(2 * y + 1) * half];
        let crossing = |axis: usize| {
            let at = (middle[axis] - self.start[axis]) / self.slope[axis];
            // Also what is not a number lies outside.
            if at > from && at < to { at } else { to }
        };
        let (u, v) = (crossing(0), crossing(1));
        let below = &self.map.levels[level - 1];
        let (columns, rows) = (below.width, below.ranges.len() as u32 / below.width);
        let mut a = from;
        for b in [u.min(v), u.max(v), to] {
            if b > a {
                let at = 0.5 * (a + b);
                let beyond = |axis: usize| self.start[axis] + at * self.slope[axis] >= middle[axis];
                let child = [
                    (2 * x + u32::from(beyond(0))).min(columns - 1),
                    (2 * y + u32::from(beyond(1))).min(rows - 1),
                ];
                self.descend(level - 1, child, [a, b]);
                a = b;
            }
        }
    }

    /// The part of a texel on which the vertices' alpha is enough.
    fn fading(&mut self, texel: usize, [from, to]: [f64; 2]) {
        let [alpha, _] = self.map.levels[0].ranges[texel].map(f64::from);
        let enough = (self.least / alpha - self.alpha[0]) / self.alpha[1];
        if self.alpha[1] > 0.0 {
            self.solid(enough.max(from), to);
        } else {
            self.solid(from, enough.min(to));
        }
    }

    fn solid(&mut self, from: f64, to: f64) {
        match &mut self.open {
            Some([_, end]) if *end == from => *end = to,
            _ if to > from => {
                self.close();
                self.open = Some([from, to]);
            }
            _ => {}
        }
    }

    fn close(&mut self) {
        if let Some([from, to]) = self.open.take() {
            (self.found)(from, to);
        }
    }
}

/// The nearest texel of a coordinate (0 to 1 spans the texture) on one axis.
pub fn texel(coordinate: f64, size: u32, wrap: Wrap) -> u32 {
    let position = (coordinate * f64::from(size)).floor();
    let n = f64::from(size);
    let inside = match wrap {
        Wrap::Repeat => position.rem_euclid(n),
        Wrap::Mirror => {
            let p = position.rem_euclid(2.0 * n);
            if p < n { p } else { 2.0 * n - 1.0 - p }
        }
        Wrap::Clamp => position,
    };
    inside.clamp(0.0, n - 1.0) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// The solid parts of a line by a walk from texel to texel, each asked at its middle.
    fn walk(map: &AlphaMap, cut: &CutOut, line: [Spot; 2]) -> Vec<[f64; 2]> {
        let mut borders = vec![0.0, 1.0];
        for axis in 0..2 {
            let at = |spot: Spot| spot.uv[axis] * f64::from(map.size[axis]);
            let (a, b) = (at(line[0]), at(line[1]));
            let mut border = a.min(b).floor() + 1.0;
            while border < a.max(b) {
                borders.push((border - a) / (b - a));
                border += 1.0;
            }
        }
        borders.sort_unstable_by(f64::total_cmp);
        let mut parts: Vec<[f64; 2]> = Vec::new();
        for pair in borders.windows(2).filter(|pair| pair[1] > pair[0]) {
            let middle = 0.5 * (pair[0] + pair[1]);
            if map.is_solid(cut, line[0].lerp(line[1], middle)) {
                match parts.last_mut() {
                    Some(last) if last[1] == pair[0] => last[1] = pair[1],
                    _ => parts.push([pair[0], pair[1]]),
                }
            }
        }
        parts
    }

    fn texture(size: [u32; 2], wrap: [Wrap; 2], alpha: impl FnMut(usize) -> u8) -> AlphaMap {
        let alphas = (0..(size[0] * size[1]) as usize).map(alpha);
        AlphaMap::of(size, wrap, alphas.map(|a| [a; 2]).collect())
    }

    #[test]
    fn the_pyramid_finds_the_parts_of_a_walk_from_texel_to_texel() {
        let mut random = Random(0x1234_5678_9abc);
        let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
        let mut found_parts = 0;
        for (number, size) in [[64, 32], [17, 9], [1, 5], [33, 1], [256, 100]]
            .iter()
            .enumerate()
        {
            for wrap in wraps.iter().flat_map(|a| wraps.map(|b| [*a, b])) {
                // Blobs, and noise.
                let map = texture(*size, wrap, |i| {
                    let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
                    let blob = (f64::from(x) * 0.7).sin() + (f64::from(y) * 0.5).cos() > 0.3;
                    match number % 2 {
                        0 => 255 * u8::from(blob),
                        _ => (255.0 * random.unit()) as u8,
                    }
                });
                for i in 0..200 {
                    let mut place =
                        || DVec2::new(4.0 * random.unit() - 2.0, 4.0 * random.unit() - 2.0);
                    let (a, mut b) = (place(), place());
                    match i % 8 {
                        0 => b.x = a.x,
                        1 => b.y = a.y,
                        _ => {}
                    }
                    let line = [a, b].map(|uv| Spot { uv, alpha: 1.0 });
                    let cut = CutOut {
                        map: 0,
                        uvs: [DVec2::ZERO; 3],
                        alphas: [1.0; 3],
                        least: 127.5,
                    };
                    let truth = walk(&map, &cut, line);
                    let mut parts = Vec::new();
                    map.solid_parts(127.5, line, |_, _| false, |from, to| parts.push([from, to]));
                    let length = |parts: &[[f64; 2]]| parts.iter().map(|[a, b]| b - a).sum::<f64>();
                    assert!(
                        (length(&parts) - length(&truth)).abs() < 1e-12,
                        "{size:?} {wrap:?} {line:?}"
                    );
                    // Parts that are longer than rounding are the same ones.
                    let long = |parts: &[[f64; 2]]| -> Vec<[f64; 2]> {
                        parts
                            .iter()
                            .copied()
                            .filter(|[a, b]| b - a > 1e-12)
                            .collect()
                    };
                    for (ours, theirs) in long(&parts).iter().zip(&long(&truth)) {
                        found_parts += 1;
                        for end in 0..2 {
                            assert!(
                                (ours[end] - theirs[end]).abs() < 1e-12,
                                "{ours:?} {theirs:?}"
                            );
                        }
                    }
                }
            }
        }
        assert!(found_parts > 50_000, "{found_parts}");
    }

    #[test]
    fn the_alpha_of_vertices_fades_within_a_texel() {
        let spot = |x: f64, alpha: f64| Spot {
            uv: DVec2::new(x, 0.5),
            alpha,
        };
        let parts = |map: &AlphaMap, line: [Spot; 2]| {
            let mut parts = Vec::new();
            map.solid_parts(127.5, line, |_, _| false, |from, to| parts.push([from, to]));
            parts
        };
        let plain = AlphaMap::plain();
        assert_eq!(
            parts(&plain, [spot(0.0, 0.0), spot(1.0, 1.0)]),
            [[0.5, 1.0]]
        );
        assert_eq!(
            parts(&plain, [spot(0.0, 1.0), spot(1.0, 0.0)]),
            [[0.0, 0.5]]
        );
        assert_eq!(
            parts(&plain, [spot(0.0, 0.0), spot(1.0, 0.4)]),
            [[0.0; 2]; 0]
        );
        // Texels of alpha 1 and 0.6: the second is solid from a vertex alpha of 5/6 on.
        let two = texture([2, 1], [Wrap::Clamp; 2], |i| [255, 153][i]);
        let found = parts(&two, [spot(0.0, 0.0), spot(1.0, 1.0)]);
        assert_eq!(found.len(), 1);
        assert!((found[0][0] - 5.0 / 6.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn absurd_texture_coordinates_end() {
        let map = texture([4, 4], [Wrap::Repeat, Wrap::Clamp], |i| 255 * (i as u8 % 2));
        for far in [1e9, 1e20, 1e300] {
            let line = [-far, far].map(|x| Spot {
                uv: DVec2::splat(x),
                alpha: 1.0,
            });
            map.solid_parts(127.5, line, |_, _| false, |_, _| {});
        }
    }
}
