//! A drawing of lines and words, written as SVG or as PNG.

use super::canvas::{Canvas, Color};
use super::lettering::{Anchor, draw_text};
use super::{atomic, png};
use crate::error::{Error, Result};
use std::io::Write;
use std::path::Path;

enum Item {
    Line {
        points: Vec<[f64; 2]>,
        width: f64,
        color: Color,
        dash: Option<[f64; 2]>,
    },
    Shape {
        points: Vec<[f64; 2]>,
        fill: Color,
        width: f64,
        color: Color,
        tip: String,
    },
    Text {
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        color: Color,
        text: String,
    },
    Picture {
        at: [f64; 2],
        size: [u32; 2],
        rgb: Vec<u8>,
    },
}

/// A drawing on white paper, x to the right and y downward.
pub struct Drawing {
    width: f64,
    height: f64,
    items: Vec<Item>,
}

/// Pixels of a PNG for a unit of the drawing.
pub const PIXELS: f64 = 2.0;

impl Drawing {
    /// Paper of a width and a height.
    pub fn new(width: f64, height: f64) -> Self {
        Self {
            width,
            height,
            items: Vec::new(),
        }
    }

    /// A line through points.
    pub fn line(
        &mut self,
        points: Vec<[f64; 2]>,
        width: f64,
        color: Color,
        dash: Option<[f64; 2]>,
    ) {
        if points.len() > 1 {
            self.items.push(Item::Line {
                points,
                width,
                color,
                dash,
            });
        }
    }

    /// A filled polygon with an outline; `tip` is what a reader of the SVG is told who points at it.
    pub fn shape(
        &mut self,
        points: Vec<[f64; 2]>,
        fill: Color,
        width: f64,
        color: Color,
        tip: impl Into<String>,
    ) {
        self.items.push(Item::Shape {
            points,
            fill,
            width,
            color,
            tip: tip.into(),
        });
    }

    /// A circle.
    pub fn circle(&mut self, centre: [f64; 2], radius: f64, width: f64, color: Color) {
        let points = (0..=180)
            .map(|i| {
                let (sin, cos) = (f64::from(i) * 2.0_f64).to_radians().sin_cos();
                [centre[0] + radius * sin, centre[1] - radius * cos]
            })
            .collect();
        self.line(points, width, color, None);
    }

    /// A text, centred in height on its anchor, on a white halo.
    pub fn text(
        &mut self,
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        color: Color,
        text: impl Into<String>,
    ) {
        self.items.push(Item::Text {
            at,
            size,
            anchor,
            color,
            text: text.into(),
        });
    }

    /// A picture of a width and a height [pixels], three bytes a pixel, with its upper left corner there, [`PIXELS`] of it to a unit;
    /// what does not fit on the paper is cut.
    pub fn picture(&mut self, at: [f64; 2], size: [u32; 2], rgb: Vec<u8>) {
        self.items.push(Item::Picture { at, size, rgb });
    }

    /// Writes the drawing as its name's end says, .svg or .png.
    ///
    /// # Errors
    /// [`Error::Input`] for another ending; [`Error::File`] if it cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        match path
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase)
            .as_deref()
        {
            Some("svg") => atomic::write(path, |file| file.write_all(self.svg().as_bytes())),
            Some("png") => {
                let png = self.png()?;
                atomic::write(path, |file| file.write_all(&png))
            }
            _ => Err(Error::input(
                path.display().to_string(),
                "the name ends in neither .svg nor .png",
                "choose one of the two",
            )),
        }
    }

    /// The drawing as the bytes of a PNG.
    ///
    /// # Errors
    /// [`Error::Failed`] when it cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>> {
        let canvas = self.canvas();
        let size = [canvas.width(), canvas.height()].map(|side| side as u32);
        encoded(size, &canvas.bytes())
    }

    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        let (w, h) = (self.width, self.height);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"Helvetica, Arial, sans-serif\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        );
        for item in &self.items {
            match item {
                Item::Line {
                    points,
                    width,
                    color,
                    dash,
                } => {
                    let dash = dash
                        .map(|[on, off]| format!(" stroke-dasharray=\"{on} {off}\""))
                        .unwrap_or_default();
                    svg += &format!(
                        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>\n",
                        coordinates(points),
                        hex(*color)
                    );
                }
                Item::Shape {
                    points,
                    fill,
                    width,
                    color,
                    tip,
                } => {
                    svg += &format!(
                        "<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"><title>{}</title></polygon>\n",
                        coordinates(points),
                        hex(*fill),
                        hex(*color),
                        escaped(tip)
                    );
                }
                Item::Text {
                    at: [x, y],
                    size,
                    anchor,
                    color,
                    text,
                } => {
                    let anchor = match anchor {
                        Anchor::Start => "start",
                        Anchor::Middle => "middle",
                        Anchor::End => "end",
                    };
                    let text = escaped(text);
                    svg += &format!(
                        "<text x=\"{x:.2}\" y=\"{:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{}\" stroke=\"white\" \
                         stroke-width=\"{:.2}\" paint-order=\"stroke\">{text}</text>\n",
                        y + 0.36 * size,
                        hex(*color),
                        0.3 * size
                    );
                }
                Item::Picture {
                    at: [x, y],
                    size,
                    rgb,
                } => {
                    let [width, height] = size.map(|side| f64::from(side) / PIXELS);
                    // Its size is its own: nothing but memory can fail, and there is no picture without it either.
                    let link = encoded(*size, rgb)
                        .map(|png| data_link(&png))
                        .unwrap_or_default();
                    svg += &format!(
                        "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width}\" height=\"{height}\" href=\"{link}\"/>\n"
                    );
                }
            }
        }
        svg + "</svg>\n"
    }

    /// The drawing as pixels, two for a unit of it each way.
    pub fn canvas(&self) -> Canvas {
        let [width, height] = [self.width, self.height].map(|side| (side * PIXELS) as usize);
        let mut canvas = Canvas::new(width, height);
        for item in &self.items {
            match item {
                Item::Line {
                    points,
                    width,
                    color,
                    dash,
                } => {
                    let scaled: Vec<[f64; 2]> =
                        points.iter().map(|p| p.map(|c| c * PIXELS)).collect();
                    let strokes = match dash {
                        Some(dash) => dashes(&scaled, dash.map(|d| d * PIXELS)),
                        None => vec![scaled],
                    };
                    canvas.stroke(&strokes, width * PIXELS, *color);
                }
                Item::Shape {
                    points,
                    fill,
                    width,
                    color,
                    ..
                } => {
                    let mut scaled: Vec<[f64; 2]> =
                        points.iter().map(|p| p.map(|c| c * PIXELS)).collect();
                    canvas.fill(&scaled, *fill);
                    scaled.extend(scaled.first().copied());
                    canvas.stroke(&[scaled], width * PIXELS, *color);
                }
                Item::Text {
                    at,
                    size,
                    anchor,
                    color,
                    text,
                } => {
                    let at = at.map(|c| c * PIXELS);
                    let halo = Some([255; 3]);
                    draw_text(&mut canvas, at, text, size * PIXELS, *anchor, *color, halo);
                }
                Item::Picture { at, size, rgb } => {
                    canvas.picture(at.map(|c| c * PIXELS), size[0] as usize, rgb);
                }
            }
        }
        canvas
    }
}

/// A picture as the bytes of a PNG.
fn encoded([width, height]: [u32; 2], rgb: &[u8]) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    png::write_to(&mut bytes, width, height, rgb, &[]).map_err(|error| {
        Error::failed(
            format!("the PNG could not be encoded: {error}"),
            "write an .svg instead",
        )
    })?;
    Ok(bytes)
}

/// A PNG as the address of itself.
pub fn data_link(png: &[u8]) -> String {
    use base64::Engine;
    let text = base64::engine::general_purpose::STANDARD.encode(png);
    format!("data:image/png;base64,{text}")
}

fn coordinates(points: &[[f64; 2]]) -> String {
    let points = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}"));
    points.collect::<Vec<_>>().join(" ")
}

/// A text as SVG and HTML hold it.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A line cut into dashes.
fn dashes(points: &[[f64; 2]], [on, off]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut strokes = Vec::new();
    let (mut drawing, mut left) = (true, on);
    let mut stroke = vec![points[0]];
    for pair in points.windows(2) {
        let [mut a, b] = [pair[0], pair[1]];
        loop {
            let length = (b[0] - a[0]).hypot(b[1] - a[1]);
            if length <= left {
                left -= length;
                if drawing {
                    stroke.push(b);
                }
                break;
            }
            let t = left / length;
            a = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
            if drawing {
                stroke.push(a);
                strokes.push(std::mem::take(&mut stroke));
            } else {
                stroke = vec![a];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
    }
    strokes.push(stroke);
    strokes.retain(|stroke| stroke.len() > 1);
    strokes
}
