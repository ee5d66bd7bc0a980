//! Triangles with holes: where the alpha of a texture times that of the vertices does not reach a threshold, nothing is there.
//!
//! A straight line over a texture is solid on some parts and not on others. Each texel knows how far it is to the nearest one that
//! is otherwise, so that a line goes from there at once to the end of the square of texels that are alike (as sphere tracing
//! does, Hart 1996, in the maximum norm): only where leaves end does it go by single texels. The parts are those of a walk from
//! texel to texel.

use super::shade::Run;
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
}

/// The alpha channel of a texture, and which of its texels are solid.
pub(super) struct AlphaMap {
    size: [u32; 2],
    wrap: [Wrap; 2],
    /// Alpha of the texel times that of the vertices must reach this, in 0 to 255.
    least: f64,
    alpha: Vec<u8>,
    /// Where the vertices' alpha is 1: [`SOLID`] or 0, and in the other bits how many texels it is to the nearest one that is
    /// otherwise, at most [`FAR`].
    squares: Vec<u8>,
}

const SOLID: u8 = 0x80;
const FAR: u8 = 0x7f;

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
    /// That of a texture, or of a material without one, of which an alpha of `least`, 0 to 255, is solid.
    pub fn new(texture: Option<&Texture>, least: f64) -> Self {
        match texture {
            Some(texture) => {
                let alpha = texture.pixels.iter().map(|p| p[3]).collect();
                Self::of([texture.width, texture.height], texture.wrap, alpha, least)
            }
            None => Self::of([1, 1], [Wrap::Clamp; 2], vec![255], least),
        }
    }

    fn of(size: [u32; 2], wrap: [Wrap; 2], alpha: Vec<u8>, least: f64) -> Self {
        // Vertices' alpha is interpolated, also where it is the same at all three: 1 may come out a digit less.
        let least = least - 1e-9;
        AlphaMap {
            size,
            wrap,
            least,
            squares: squares(size, &alpha, least),
            alpha,
        }
    }

    /// The least alpha that is solid, 0 to 255.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// Whether a place is solid.
    pub fn is_solid(&self, spot: Spot) -> bool {
        let x = texel(spot.uv.x, self.size[0], self.wrap[0]);
        let y = texel(spot.uv.y, self.size[1], self.wrap[1]);
        let alpha = self.alpha[(y * self.size[0] + x) as usize];
        f64::from(alpha) * spot.alpha >= self.least
    }

    /// The parts of a straight line on which it is solid, as fractions of the line between two of them, in order and apart from
    /// each other.
    pub fn solid_parts(&self, line: [Spot; 2], within: Run, mut found: impl FnMut(f64, f64)) {
        let [from, to] = line;
        let size = self.size.map(f64::from);
        let start = [from.uv.x * size[0], from.uv.y * size[1]];
        let slope = [
            (to.uv.x - from.uv.x) * size[0],
            (to.uv.y - from.uv.y) * size[1],
        ];
        let alpha = [from.alpha, to.alpha - from.alpha];
        // A solid part that may go on.
        let mut open: Option<Run> = None;
        let mut solid = |from: f64, to: f64| match &mut open {
            Some([_, end]) if *end == from => *end = to,
            _ => {
                if let Some([from, to]) = open.replace([from, to]) {
                    found(from, to);
                }
            }
        };
        let mut piece = |ways: [[f64; 2]; 2], run: Run| {
            if alpha == [1.0, 0.0] {
                self.walk(ways, run, &mut solid);
            } else {
                self.walk_fading(ways, alpha, run, &mut solid);
            }
        };
        // Most lines stay within one copy.
        let inside = |axis: usize| {
            let (a, b) = (start[axis], start[axis] + slope[axis]);
            a.min(b) >= 0.0 && (a.max(b) < size[axis] || a.max(b) == size[axis] && a != b)
        };
        let one = inside(0) && inside(1);
        let mut borders = Vec::new();
        if !one {
            for axis in 0..2 {
                self.borders(axis, start[axis], slope[axis], within, &mut borders);
            }
            borders.sort_unstable_by(f64::total_cmp);
        }
        let mut at = within[0];
        for border in borders.into_iter().chain([within[1]]) {
            if border > at {
                let middle = 0.5 * (at + border);
                let way = |axis: usize| match one {
                    true => [start[axis], slope[axis]],
                    false => self.unwrapped(axis, start[axis], slope[axis], middle),
                };
                piece([way(0), way(1)], [at, border]);
                at = border;
            }
        }
        if let Some([from, to]) = open {
            found(from, to);
        }
    }

    /// Where a line passes from one copy of the texture to the next, between two fractions.
    fn borders(&self, axis: usize, start: f64, slope: f64, within: Run, borders: &mut Vec<f64>) {
        let size = f64::from(self.size[axis]);
        let at = |f: f64| (start + f * slope) / size;
        let (mut low, mut high) = (
            at(within[0]).min(at(within[1])),
            at(within[0]).max(at(within[1])),
        );
        if self.wrap[axis] == Wrap::Clamp {
            (low, high) = (low.max(-0.5), high.min(1.5));
        }
        let count = high.ceil() - low.floor() - 1.0;
        if count > 0.0 && count <= COPIES {
            let first = low.floor() + 1.0;
            let all = (0..count as u32).map(|i| ((first + f64::from(i)) * size - start) / slope);
            borders.extend(all.filter(|f| *f > within[0] && *f < within[1]));
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

    /// The solid parts of a line, its start and slope on each axis [texels], square by square.
    fn walk(&self, ways: [[f64; 2]; 2], run: Run, solid: &mut impl FnMut(f64, f64)) {
        let around = |texel: usize| i32::from(self.squares[texel] & FAR) - 1;
        self.visit(ways, run, around, |texel, from, to| {
            if self.squares[texel] & SOLID != 0 {
                solid(from, to);
            }
        });
    }

    /// The same where the vertices' alpha is another one, its start and slope, texel by texel.
    fn walk_fading(
        &self,
        ways: [[f64; 2]; 2],
        alpha: [f64; 2],
        run: Run,
        solid: &mut impl FnMut(f64, f64),
    ) {
        self.visit(
            ways,
            run,
            |_| 0,
            |texel, from, to| {
                let own = f64::from(self.alpha[texel]);
                let is_solid = |f: f64| own * (alpha[0] + f * alpha[1]) >= self.least;
                let enough = (self.least / own - alpha[0]) / alpha[1];
                let (a, b) = match (is_solid(from), is_solid(to)) {
                    (true, true) => (from, to),
                    (true, false) => (from, enough.clamp(from, to)),
                    (false, true) => (enough.clamp(from, to), to),
                    (false, false) => (from, from),
                };
                if b > a {
                    solid(a, b);
                }
            },
        );
    }

    /// Visits the texels on a line within one copy of the texture, its start and slope on each axis [texels]: those that lie
    /// `around` one of them, as many on each side, count as one with it. Each with the part of the line, which is not empty.
    fn visit(
        &self,
        [[px, dx], [py, dy]]: [[f64; 2]; 2],
        [from, to]: Run,
        around: impl Fn(usize) -> i32,
        mut found: impl FnMut(usize, f64, f64),
    ) {
        let [width, height] = self.size.map(|n| n as i32);
        let (ix, iy) = (1.0 / dx, 1.0 / dy);
        // Whole parts by `as`: places on a texture are not negative but for rounding.
        let mut x = ((px + from * dx) as i32).clamp(0, width - 1);
        let mut y = ((py + from * dy) as i32).clamp(0, height - 1);
        let mut at = from;
        while at < to {
            let texel = (y * width + x) as usize;
            let r = around(texel);
            // The borders ahead, and the texels behind them.
            let (bx, beyond_x) = if dx > 0.0 {
                (x + r + 1, x + r + 1)
            } else {
                (x - r, x - r - 1)
            };
            let (by, beyond_y) = if dy > 0.0 {
                (y + r + 1, y + r + 1)
            } else {
                (y - r, y - r - 1)
            };
            let tx = if dx == 0.0 {
                f64::INFINITY
            } else {
                (f64::from(bx) - px) * ix
            };
            let ty = if dy == 0.0 {
                f64::INFINITY
            } else {
                (f64::from(by) - py) * iy
            };
            let mut end = tx.min(ty).max(at);
            let beside_x = ((px + end * dx) as i32).clamp(x - r, x + r);
            let beside_y = ((py + end * dy) as i32).clamp(y - r, y + r);
            let next = if tx <= ty {
                (beyond_x, beside_y)
            } else {
                (beside_x, beyond_y)
            };
            // But for rounding the copy of the texture ends only where the line does.
            let inside = (0..width).contains(&next.0) && (0..height).contains(&next.1);
            if end >= to || !inside {
                end = to;
            }
            if end > at {
                found(texel, at, end);
            }
            (x, y) = next;
            at = end;
        }
    }
}

/// A line over more copies of a texture than this is as solid as the copy in its middle: far more than a picture shows.
const COPIES: f64 = 65_536.0;

/// For each texel whether it is solid, and how far it is to the nearest one that is otherwise: the maximum norm in two sweeps
/// (Rosenfeld & Pfaltz 1966).
fn squares([width, height]: [u32; 2], alpha: &[u8], least: f64) -> Vec<u8> {
    let (w, h) = (width as usize, height as usize);
    let solid = |i: usize| f64::from(alpha[i]) >= least;
    let mut far = vec![FAR; w * h];
    // From a texel to one beside it, of the same kind or otherwise.
    let nearer = |far: &[u8], i: usize, j: usize| match solid(i) == solid(j) {
        true => far[j].saturating_add(1),
        false => 1,
    };
    for backward in [false, true] {
        for k in 0..w * h {
            let i = if backward { w * h - 1 - k } else { k };
            let (x, y) = (i % w, i / w);
            let row = if backward {
                (y + 1 < h).then(|| i + w)
            } else {
                y.checked_sub(1).map(|_| i - w)
            };
            let mut best = far[i];
            if let Some(above) = row {
                let left = if x > 0 { above - 1 } else { above };
                let right = if x + 1 < w { above + 1 } else { above };
                for j in left..=right {
                    best = best.min(nearer(&far, i, j));
                }
            }
            let side = if backward {
                (x + 1 < w).then_some(i + 1)
            } else {
                (x > 0).then(|| i - 1)
            };
            if let Some(j) = side {
                best = best.min(nearer(&far, i, j));
            }
            far[i] = best;
        }
    }
    (0..w * h)
        .map(|i| if solid(i) { far[i] | SOLID } else { far[i] })
        .collect()
}

/// The nearest texel of a coordinate (0 to 1 spans the texture) on one axis.
pub fn texel(coordinate: f64, size: u32, wrap: Wrap) -> u32 {
    let position = (coordinate * f64::from(size)).floor();
    let n = f64::from(size);
    if (0.0..n).contains(&position) {
        return position as u32;
    }
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
    fn walk(map: &AlphaMap, line: [Spot; 2]) -> Vec<[f64; 2]> {
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
            if map.is_solid(line[0].lerp(line[1], middle)) {
                match parts.last_mut() {
                    Some(last) if last[1] == pair[0] => last[1] = pair[1],
                    _ => parts.push([pair[0], pair[1]]),
                }
            }
        }
        parts
    }

    fn texture(size: [u32; 2], wrap: [Wrap; 2], alpha: impl FnMut(usize) -> u8) -> AlphaMap {
        let alpha = (0..(size[0] * size[1]) as usize).map(alpha).collect();
        AlphaMap::of(size, wrap, alpha, 127.5)
    }

    #[test]
    fn squares_find_the_parts_of_a_walk_from_texel_to_texel() {
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
                    let truth = walk(&map, line);
                    let mut parts = Vec::new();
                    map.solid_parts(line, [0.0, 1.0], |from, to| parts.push([from, to]));
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
            // What is met by a billionth is met.
            let near = |x: f64| (1e8 * x).round() / 1e8;
            map.solid_parts(line, [0.0, 1.0], |from, to| {
                if near(from) < near(to) {
                    parts.push([near(from), near(to)]);
                }
            });
            parts
        };
        let plain = AlphaMap::new(None, 127.5);
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
        assert!((found[0][0] - 5.0 / 6.0).abs() < 1e-8, "{found:?}");
    }

    #[test]
    fn absurd_texture_coordinates_end() {
        let map = texture([4, 4], [Wrap::Repeat, Wrap::Clamp], |i| 255 * (i as u8 % 2));
        for far in [1e9, 1e20, 1e300] {
            let line = [-far, far].map(|x| Spot {
                uv: DVec2::splat(x),
                alpha: 1.0,
            });
            map.solid_parts(line, [0.0, 1.0], |_, _| {});
        }
    }
}
