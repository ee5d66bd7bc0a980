//! Pixels that lines and polygons are drawn on.

/// A colour, sRGB.
pub type Color = [u8; 3];

/// A picture of 8-bit colours that lines and polygons are drawn on, with soft edges.
#[derive(Debug, Clone)]
pub struct Canvas {
    width: usize,
    height: usize,
    /// Codes of sRGB, in which coverage is linear.
    pixels: Vec<[f32; 3]>,
}

impl Canvas {
    /// White paper of so many pixels.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[255.0; 3]; width * height],
        }
    }

    /// A picture that is there already: three bytes a pixel from the top left. What `rgb` lacks is white, what is too much is left out.
    pub fn over(width: usize, height: usize, rgb: &[u8]) -> Self {
        let mut canvas = Self::new(width, height);
        for (pixel, codes) in canvas.pixels.iter_mut().zip(rgb.chunks_exact(3)) {
            *pixel = [codes[0], codes[1], codes[2]].map(f32::from);
        }
        canvas
    }

    /// Width [pixels].
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height [pixels].
    pub fn height(&self) -> usize {
        self.height
    }

    /// Draws strokes of one width [pixels], x to the right and y down from the upper left corner; where they meet they do not darken each other.
    pub fn stroke(&mut self, strokes: &[Vec<[f64; 2]>], width: f64, color: Color) {
        let reach = 0.5 * width + 1.0;
        let clip = |low: f64, high: f64, size: usize| {
            (
                (low - reach).floor().max(0.0) as usize,
                ((high + reach).ceil().max(0.0) as usize).min(size),
            )
        };
        let points = || strokes.iter().flatten();
        let bound = |axis: usize| {
            points().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                (low.min(p[axis]), high.max(p[axis]))
            })
        };
        let ((x_low, x_high), (y_low, y_high)) = (bound(0), bound(1));
        let ((x0, x1), (y0, y1)) = (
            clip(x_low, x_high, self.width),
            clip(y_low, y_high, self.height),
        );
        if x0 >= x1 || y0 >= y1 {
            return;
        }
        let mut coverage = vec![0.0_f32; (x1 - x0) * (y1 - y0)];
        for pair in strokes.iter().flat_map(|stroke| stroke.windows(2)) {
            let [a, b] = [pair[0], pair[1]];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let squared = dx * dx + dy * dy;
            let (sx0, sx1) = clip(a[0].min(b[0]), a[0].max(b[0]), self.width);
            let (sy0, sy1) = clip(a[1].min(b[1]), a[1].max(b[1]), self.height);
            for y in sy0..sy1 {
                for x in sx0..sx1 {
                    let (px, py) = (x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]);
                    let t = if squared > 0.0 {
                        ((px * dx + py * dy) / squared).clamp(0.0, 1.0)
                    } else {
                        0.0
                    };
                    let distance = (px - t * dx).hypot(py - t * dy);
                    let here = (0.5 * width + 0.5 - distance).clamp(0.0, width.min(1.0)) as f32;
                    let cell = &mut coverage[(y - y0) * (x1 - x0) + x - x0];
                    *cell = cell.max(here);
                }
            }
        }
        for y in y0..y1 {
            for x in x0..x1 {
                let alpha = coverage[(y - y0) * (x1 - x0) + x - x0];
                for (channel, &c) in self.pixels[y * self.width + x].iter_mut().zip(&color) {
                    *channel += alpha * (f32::from(c) - *channel);
                }
            }
        }
    }

    /// Fills a polygon; where it crosses itself, what is inside twice is outside.
    pub fn fill(&mut self, points: &[[f64; 2]], color: Color) {
        let bound = |axis: usize, size: usize| {
            let of = |f: fn(f64, f64) -> f64, from| points.iter().map(|p| p[axis]).fold(from, f);
            let (low, high) = (of(f64::min, f64::INFINITY), of(f64::max, 0.0));
            (low - 1.0).max(0.0) as usize..((high + 2.0) as usize).min(size)
        };
        let edges = || points.iter().zip(points.iter().cycle().skip(1));
        for y in bound(1, self.height) {
            for x in bound(0, self.width) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let (mut inside, mut distance) = (false, f64::INFINITY);
                for (a, b) in edges() {
                    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
                    inside ^= (a[1] > py) != (b[1] > py) && px < a[0] + dx * (py - a[1]) / dy;
                    let along = (px - a[0]) * dx + (py - a[1]) * dy;
                    let t = (along / (dx * dx + dy * dy).max(1e-12)).clamp(0.0, 1.0);
                    distance = distance.min((px - a[0] - t * dx).hypot(py - a[1] - t * dy));
                }
                let signed = if inside { distance } else { -distance };
                let alpha = (0.5 + signed).clamp(0.0, 1.0) as f32;
                for (channel, &c) in self.pixels[y * self.width + x].iter_mut().zip(&color) {
                    *channel += alpha * (f32::from(c) - *channel);
                }
            }
        }
    }

    /// Copies a picture of a width [pixels], three bytes a pixel, with its upper left corner at the nearest pixel; what does not fit is cut.
    pub fn picture(&mut self, at: [f64; 2], width: usize, rgb: &[u8]) {
        let [left, top] = at.map(|c| c.round().max(0.0) as usize);
        for (i, codes) in rgb.chunks_exact(3).enumerate() {
            let (x, y) = (left + i % width.max(1), top + i / width.max(1));
            if x < self.width && y < self.height {
                self.pixels[y * self.width + x] = [codes[0], codes[1], codes[2]].map(f32::from);
            }
        }
    }

    /// Three bytes a pixel from the top left, sRGB.
    pub fn bytes(&self) -> Vec<u8> {
        self.pixels
            .iter()
            .flatten()
            .map(|c| c.round() as u8)
            .collect()
    }
}
