//! A drawing of lines and words, written as SVG or as PNG.

use std::io::Write;
use std::path::Path;

use tyndall::output::atomic;
use tyndall::{Error, Result};

/// A colour, sRGB.
pub type Color = [u8; 3];

/// Where a text's anchor lies in it.
#[derive(Clone, Copy, PartialEq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

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
        picture: image::RgbImage,
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

    /// A picture with its upper left corner there, [`PIXELS`] of it to a unit; what does not fit on the paper is cut.
    pub fn picture(&mut self, at: [f64; 2], picture: image::RgbImage) {
        self.items.push(Item::Picture { at, picture });
    }

    /// Writes the drawing as its name's end says, .svg or .png.
    ///
    /// # Errors
    /// [`Error::Input`] for another ending; [`Error::File`] if it cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let write = |path: &Path, bytes: &[u8]| atomic::write(path, |file| file.write_all(bytes));
        match path
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase)
            .as_deref()
        {
            Some("svg") => write(path, self.svg().as_bytes()),
            Some("png") => write(path, &self.png()?),
            _ => Err(Error::input(
                path.display().to_string(),
                "the name ends in neither .svg nor .png",
                "choose one of the two",
            )),
        }
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
                    picture,
                } => {
                    let [width, height] =
                        [picture.width(), picture.height()].map(|side| f64::from(side) / PIXELS);
                    // Nothing but memory can fail, and there is no picture without it either.
                    let link = encoded(picture)
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

    /// The drawing as PNG.
    ///
    /// # Errors
    /// [`Error::Failed`] when it cannot be encoded.
    pub fn png(&self) -> Result<Vec<u8>> {
        let mut canvas = Canvas::new(
            (self.width * PIXELS) as usize,
            (self.height * PIXELS) as usize,
        );
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
                    let strokes = letters(text, at.map(|c| c * PIXELS), size * PIXELS, *anchor);
                    canvas.stroke(&strokes, 0.42 * size * PIXELS, [255; 3]);
                    canvas.stroke(&strokes, 0.095 * size * PIXELS, *color);
                }
                Item::Picture { at, picture } => canvas.picture(at.map(|c| c * PIXELS), picture),
            }
        }
        let [width, height] = [canvas.width, canvas.height].map(|side| side as u32);
        image::RgbImage::from_raw(width, height, canvas.bytes())
            .ok_or_else(|| unencoded(&"its size is not its own"))
            .and_then(|picture| encoded(&picture))
    }
}

/// A picture as PNG.
fn encoded(picture: &image::RgbImage) -> Result<Vec<u8>> {
    let mut png = std::io::Cursor::new(Vec::new());
    let written = picture.write_to(&mut png, image::ImageFormat::Png);
    written.map_err(|error| unencoded(&error))?;
    Ok(png.into_inner())
}

fn unencoded(error: &dyn std::fmt::Display) -> Error {
    Error::failed(
        format!("the PNG could not be encoded: {error}"),
        "write an .svg instead",
    )
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

/// Pixels, linear in coverage, white at first.
struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            pixels: vec![[255.0; 3]; width * height],
        }
    }

    /// Draws strokes of one width; where they meet they do not darken each other.
    fn stroke(&mut self, strokes: &[Vec<[f64; 2]>], width: f64, color: Color) {
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
    fn fill(&mut self, points: &[[f64; 2]], color: Color) {
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

    /// Copies a picture, with its corner at the nearest pixel.
    fn picture(&mut self, at: [f64; 2], picture: &image::RgbImage) {
        let [left, top] = at.map(|c| c.round().max(0.0) as usize);
        for (x, y, pixel) in picture.enumerate_pixels() {
            let (x, y) = (left + x as usize, top + y as usize);
            if x < self.width && y < self.height {
                self.pixels[y * self.width + x] = pixel.0.map(f32::from);
            }
        }
    }

    fn bytes(&self) -> Vec<u8> {
        self.pixels
            .iter()
            .flatten()
            .map(|c| c.round() as u8)
            .collect()
    }
}

/// The width of a text of a size.
pub fn text_width(text: &str, size: f64) -> f64 {
    let units = |g: &str| f64::from(g.as_bytes()[1]) - f64::from(g.as_bytes()[0]);
    text.chars().map(|c| units(glyph(c))).sum::<f64>() * 0.72 * size / 21.0
}

/// The strokes of a text in Hershey's letters.
fn letters(text: &str, at: [f64; 2], size: f64, anchor: Anchor) -> Vec<Vec<[f64; 2]>> {
    // Capitals are 21 units high, from -12 to 9, and 0.72 of the size.
    let scale = 0.72 * size / 21.0;
    let glyphs: Vec<&str> = text.chars().map(glyph).collect();
    let side = |byte: u8| f64::from(byte) - 82.0;
    let width = text_width(text, size);
    let mut x = at[0]
        - match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
    let mut strokes = Vec::new();
    for glyph in glyphs {
        let bytes = glyph.as_bytes();
        let left = side(bytes[0]);
        let mut stroke = Vec::new();
        for pair in bytes[2..].chunks_exact(2) {
            if pair == b" R" {
                strokes.push(std::mem::take(&mut stroke));
            } else {
                stroke.push([
                    x + (side(pair[0]) - left) * scale,
                    at[1] + (side(pair[1]) + 1.5) * scale,
                ]);
            }
        }
        strokes.push(stroke);
        x += (side(bytes[1]) - left) * scale;
    }
    strokes.retain(|stroke| stroke.len() > 1);
    strokes
}

/// A letter's strokes: the left and right side, then points, each two letters of which R is zero; " R" lifts the pen.
fn glyph(c: char) -> &'static str {
    match c {
        '°' => "KXQFOGNINKOMQNSNUMVKVIUGSFQF",
        '\u{2212}' => GLYPHS[usize::from(b'-' - b' ')],
        _ => u32::from(c)
            .checked_sub(32)
            .and_then(|i| GLYPHS.get(i as usize))
            .copied()
            .unwrap_or(GLYPHS[usize::from(b'?' - b' ')]),
    }
}

/// The letters from space to tilde: the simplex Roman of A. V. Hershey (US National Bureau of Standards, 1967).
#[rustfmt::skip]
const GLYPHS: [&str; 95] = [
    "JZ", "MWRFRT RRYQZR[SZRY", "JZNFNM RVFVM", "H]SBLb RYBRb RLOZO RKUYU",
    "H\\PBP_ RTBT_ RYIWGTFPFMGKIKKLMMNOOUQWRXSYUYXWZT[P[MZKX",
    "F^[FI[ RNFPHPJOLMMKMIKIIJGLFNFPGSHVHYG[F RWTUUTWTYV[X[ZZ[X[VYTWT",
    "E_\\O\\N[MZMYNXPVUTXRZP[L[JZIYHWHUISJRQNRMSKSIRGPFNGMIMKNNPQUXWZY[[[\\Z\\Y", "MWRHQGRFSGSIRKQL",
    "KYVBTDRGPKOPOTPYR]T`Vb", "KYNBPDRGTKUPUTTYR]P`Nb", "JZRLRX RMOWU RWOMU", "E_RIR[ RIR[R", "NVSWRXQWRVSWSYQ[",
    "E_IR[R", "NVRVQWRXSWRV", "G][BIb", "H\\QFNGLJKOKRLWNZQ[S[VZXWYRYOXJVGSFQF", "H\\NJPISFS[",
    "H\\LKLJMHNGPFTFVGWHXJXLWNUQK[Y[", "H\\MFXFRNUNWOXPYSYUXXVZS[P[MZLYKW", "H\\UFKTZT RUFU[",
    "H\\WFMFLOMNPMSMVNXPYSYUXXVZS[P[MZLYKW", "H\\XIWGTFRFOGMJLOLTMXOZR[S[VZXXYUYTXQVOSNRNOOMQLT", "H\\YFO[ RKFYF",
    "H\\PFMGLILKMMONSOVPXRYTYWXYWZT[P[MZLYKWKTLRNPQOUNWMXKXIWGTFPF",
    "H\\XMWPURRSQSNRLPKMKLLINGQFRFUGWIXMXRWWUZR[P[MZLX", "NVROQPRQSPRO RRVQWRXSWRV", "NVROQPRQSPRO RSWRXQWRVSWSYQ[",
    "F^ZIJRZ[", "E_IO[O RIU[U", "F^JIZRJ[", "I[LKLJMHNGPFTFVGWHXJXLWNVORQRT RRYQZR[SZRY",
    "E`WNVLTKQKOLNMMPMSNUPVSVUUVS RQKOMNPNSOUPV RWKVSVUXVZV\\T]Q]O\\L[JYHWGTFQFNGLHJJILHOHRIUJWLYNZQ[T[WZYYZX RXKWSWUXV",
    "I[RFJ[ RRFZ[ RMTWT", "G\\KFK[ RKFTFWGXHYJYLXNWOTP RKPTPWQXRYTYWXYWZT[K[",
    "H]ZKYIWGUFQFOGMILKKNKSLVMXOZQ[U[WZYXZV", "G\\KFK[ RKFRFUGWIXKYNYSXVWXUZR[K[", "H[LFL[ RLFYF RLPTP RL[Y[",
    "HZLFL[ RLFYF RLPTP", "H]ZKYIWGUFQFOGMILKKNKSLVMXOZQ[U[WZYXZVZS RUSZS", "G]KFK[ RYFY[ RKPYP", "NVRFR[",
    "JZVFVVUYTZR[P[NZMYLVLT", "G\\KFK[ RYFKT RPOY[", "HYLFL[ RL[X[", "F^JFJ[ RJFR[ RZFR[ RZFZ[",
    "G]KFK[ RKFY[ RYFY[", "G]PFNGLIKKJNJSKVLXNZP[T[VZXXYVZSZNYKXIVGTFPF", "G\\KFK[ RKFTFWGXHYJYMXOWPTQKQ",
    "G]PFNGLIKKJNJSKVLXNZP[T[VZXXYVZSZNYKXIVGTFPF RSWY]", "G\\KFK[ RKFTFWGXHYJYLXNWOTPKP RRPY[",
    "H\\YIWGTFPFMGKIKKLMMNOOUQWRXSYUYXWZT[P[MZKX", "JZRFR[ RKFYF", "G]KFKULXNZQ[S[VZXXYUYF", "I[JFR[ RZFR[",
    "F^HFM[ RRFM[ RRFW[ R\\FW[", "H\\KFY[ RYFK[", "I[JFRPR[ RZFRP", "H\\YFK[ RKFYF RK[Y[",
    "KYOBOb RPBPb ROBVB RObVb", "KYKFY^", "KYTBTb RUBUb RNBUB RNbUb", "JZRDJR RRDZR", "I[Ib[b", "NVSKQMQORPSORNQO",
    "I\\XMX[ RXPVNTMQMONMPLSLUMXOZQ[T[VZXX", "H[LFL[ RLPNNPMSMUNWPXSXUWXUZS[P[NZLX",
    "I[XPVNTMQMONMPLSLUMXOZQ[T[VZXX", "I\\XFX[ RXPVNTMQMONMPLSLUMXOZQ[T[VZXX",
    "I[LSXSXQWOVNTMQMONMPLSLUMXOZQ[T[VZXX", "MYWFUFSGRJR[ ROMVM", "I\\XMX]W`VaTbQbOa RXPVNTMQMONMPLSLUMXOZQ[T[VZXX",
    "I\\MFM[ RMQPNRMUMWNXQX[", "NVQFRGSFREQF RRMR[", "MWRFSGTFSERF RSMS^RaPbNb", "IZMFM[ RWMMW RQSX[", "NVRFR[",
    "CaGMG[ RGQJNLMOMQNRQR[ RRQUNWMZM\\N]Q][", "I\\MMM[ RMQPNRMUMWNXQX[", "I\\QMONMPLSLUMXOZQ[T[VZXXYUYSXPVNTMQM",
    "H[LMLb RLPNNPMSMUNWPXSXUWXUZS[P[NZLX", "I\\XMXb RXPVNTMQMONMPLSLUMXOZQ[T[VZXX", "KXOMO[ ROSPPRNTMWM",
    "J[XPWNTMQMNNMPNRPSUTWUXWXXWZT[Q[NZMX", "MYRFRWSZU[W[ ROMVM", "I\\MMMWNZP[S[UZXW RXMX[", "JZLMR[ RXMR[",
    "G]JMN[ RRMN[ RRMV[ RZMV[", "J[MMX[ RXMM[", "JZLMR[ RXMR[P_NaLbKb", "J[XMM[ RMMXM RM[X[",
    "KYTBRCQDPFPHQJRKSMSOQQ RRCQEQGRISJTLTNSPORSTTVTXSZR[Q]Q_Ra RQSSUSWRYQZP\\P^Q`RaTb", "NVRBRb",
    "KYPBRCSDTFTHSJRKQMQOSQ RRCSESGRIQJPLPNQPURQTPVPXQZR[S]S_Ra RSSQUQWRYSZT\\T^S`RaPb",
    "F^IUISJPLONOPPTSVTXTZS[Q RISJQLPNPPQTTVUXUZT[Q[O",
];
