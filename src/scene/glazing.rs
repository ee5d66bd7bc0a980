//! What the triangles of panes let through, at a place and along a straight line.
//!
//! Pictures are read at their nearest texel, as base colours are. So the parts of a line that have one colour have exact ends: where it
//! passes from texel to texel. Within such a part the angle may change, of light from a lamp, and so may the vertices' colours: it is
//! divided until what is let through changes by less than 0.002.

use super::cut_out::texel;
use super::glass::Incidence;
use super::opacity::Opacities;
use super::pane::FINEST;
use super::shade::Run;
use super::{Mesh, Pane, Scene, Texture};
use crate::colour::{Space, srgb_decode, srgb_encode};
use glam::{DMat3, DVec2, DVec3};

/// What a part of a line lets through changes by no more than this [1].
const EVEN: f64 = 2e-3;

/// So often a part may be halved.
const HALVINGS: u32 = 8;

/// More borders of texels than this on a line are not told apart: far more than a picture shows.
const BORDERS: f64 = 65_536.0;

/// A picture of no more than [`FINEST`] texels each way: means of linear light, or of a channel that is linear.
fn no_finer(picture: &Texture, is_linear: bool) -> Texture {
    let size = [picture.width, picture.height];
    let [width, height] = size.map(|texels| texels.min(FINEST));
    if size == [width, height] {
        return picture.clone();
    }
    let decode = |code: u8| match is_linear {
        true => f64::from(code) / 255.0,
        false => srgb_decode(f64::from(code) / 255.0),
    };
    let encode = |value: f64| match is_linear {
        true => (255.0 * value).round() as u8,
        false => (255.0 * srgb_encode(value)).round() as u8,
    };
    let decoded: [f64; 256] = std::array::from_fn(|code| decode(code as u8));
    let range = |i: u32, of: u32, all: u32| {
        let [from, to] = [i, i + 1].map(|i| (u64::from(i) * u64::from(all) / u64::from(of)) as u32);
        from..to
    };
    let mean = |i: u32, j: u32| {
        let (mut sum, mut count) = (DVec3::ZERO, 0.0);
        for y in range(j, height, picture.height) {
            for x in range(i, width, picture.width) {
                let [r, g, b, _] = picture.pixels[y as usize * picture.width as usize + x as usize];
                sum += DVec3::from_array([r, g, b].map(|code| decoded[usize::from(code)]));
                count += 1.0;
            }
        }
        let [r, g, b] = (sum / count).to_array().map(encode);
        [r, g, b, 255]
    };
    let rows = (0..height).flat_map(|j| (0..width).map(move |i| (i, j)));
    Texture {
        name: picture.name.clone(),
        width,
        height,
        pixels: rows.map(|(i, j)| mean(i, j)).collect(),
        wrap: picture.wrap,
    }
}

/// What the triangles of a tree of panes let through.
pub(super) struct Glazing {
    /// One for each kept triangle.
    sheets: Vec<Sheet>,
    glasses: Vec<Glass>,
    pictures: Vec<Texture>,
    working_from_rec709: DMat3,
}

/// A triangle of glass.
struct Sheet {
    /// Which of the glasses.
    glass: u32,
    /// Unit normal.
    normal: DVec3,
    /// Unit vectors along the borders between the pictures' texels, where there are any.
    borders: [Option<DVec3>; 2],
    uvs: [DVec2; 3],
    /// The vertices' colours, where they count.
    colors: Option<[DVec3; 3]>,
}

/// A material of glass.
struct Glass {
    /// What multiplies the pictures, linear Rec. 709.
    factor: DVec3,
    /// Which of the pictures, and whether their red channel is read.
    pictures: Vec<(usize, bool)>,
    count: u32,
    /// The share of the pane that is there.
    cover: f64,
}

impl Glazing {
    /// Of the listed triangles of a scene.
    pub fn new(scene: &Scene, opacities: &Opacities, triangles: &[u32]) -> Self {
        let mut pictures: Vec<Texture> = Vec::new();
        let mut number = vec![None; scene.textures.len()];
        let mut glasses: Vec<Glass> = Vec::new();
        let mut glass_of = vec![None; scene.materials.len()];
        let mesh = &scene.mesh;
        let mut sheets = Vec::with_capacity(triangles.len());
        for triangle in triangles {
            let triangle = &mesh.triangles[*triangle as usize];
            let index = triangle.material as usize;
            let material = &scene.materials[index];
            let pane = material.pane.as_ref().unwrap_or(&Pane::CLEAR);
            let glass = *glass_of[index].get_or_insert_with(|| {
                let base = match pane.is_tinted {
                    true => material.base_color,
                    false => DVec3::ONE,
                };
                let shown = [
                    (material.texture.filter(|_| pane.is_tinted), false),
                    (pane.red, true),
                    (pane.image, false),
                ];
                let shown = shown.into_iter().filter_map(|(index, red)| {
                    let index: usize = index?;
                    let number = *number[index].get_or_insert_with(|| {
                        pictures.push(no_finer(&scene.textures[index], red));
                        pictures.len() - 1
                    });
                    Some((number, red))
                });
                glasses.push(Glass {
                    factor: pane.transmittance * base,
                    pictures: shown.collect(),
                    count: pane.count,
                    cover: opacities.of_panes[index].share,
                });
                glasses.len() as u32 - 1
            });
            let mut sheet = Sheet::new(mesh, triangle.vertices, glass, pane);
            let shown = &glasses[glass as usize].pictures;
            for (axis, border) in sheet.borders.iter_mut().enumerate() {
                let texels = |picture: &Texture| [picture.width, picture.height][axis];
                if !shown.iter().any(|(k, _)| texels(&pictures[*k]) > 1) {
                    *border = None;
                }
            }
            sheets.push(sheet);
        }
        Glazing {
            sheets,
            glasses,
            pictures,
            working_from_rec709: Space::Rec709.to_working(),
        }
    }

    /// Which material a pane has, by a number of its own.
    pub fn glass(&self, slot: usize) -> u32 {
        self.sheets[slot].glass
    }

    /// Unit normal of a pane.
    pub fn normal(&self, slot: usize) -> DVec3 {
        self.sheets[slot].normal
    }

    /// Unit vectors along the borders between colours of a pane.
    pub fn borders(&self, slot: usize) -> [Option<DVec3>; 2] {
        self.sheets[slot].borders
    }

    /// What a pane lets through at a place (weights of the second and third corner) of light whose way has this cosine to its
    /// normal.
    pub fn through(&self, slot: usize, at: DVec2, cosine: f64) -> DVec3 {
        let colour = self.sheets[slot].color(at) * self.shown(slot, at);
        self.at_angle(slot, colour, cosine)
    }

    /// The same of a pane that lets through a colour, linear Rec. 709, along its normal.
    fn at_angle(&self, slot: usize, colour: DVec3, cosine: f64) -> DVec3 {
        let glass = &self.glasses[self.sheets[slot].glass as usize];
        let incidence = Incidence::new(cosine);
        let normal = (self.working_from_rec709 * colour).clamp(DVec3::ZERO, DVec3::ONE);
        let one = |share: f64| incidence.transmittance(share, glass.count);
        let through = match normal.x == normal.y && normal.y == normal.z {
            true => DVec3::splat(one(normal.x)),
            false => DVec3::from_array(normal.to_array().map(one)),
        };
        1.0 - glass.cover + glass.cover * through
    }

    /// What a pane lets through along its normal, but for the vertices' colours: linear Rec. 709.
    fn shown(&self, slot: usize, at: DVec2) -> DVec3 {
        let sheet = &self.sheets[slot];
        let glass = &self.glasses[sheet.glass as usize];
        let uv = sheet.uv(at);
        let mut shown = glass.factor;
        for (picture, is_red) in &glass.pictures {
            let picture = &self.pictures[*picture];
            let x = texel(uv.x, picture.width, picture.wrap[0]);
            let y = texel(uv.y, picture.height, picture.wrap[1]);
            let [r, g, b, _] = picture.pixels[(y * picture.width + x) as usize];
            shown *= match is_red {
                true => DVec3::splat(f64::from(r) / 255.0),
                false => DVec3::from_array([r, g, b].map(|c| srgb_decode(f64::from(c) / 255.0))),
            };
        }
        shown
    }

    /// Calls `found` for the parts of a straight line over a pane between two fractions of it, as fractions, with what is let through
    /// there. The line's ends are weights of the second and third corner; `cosine` is that of the light's way to the normal.
    pub fn parts(
        &self,
        slot: usize,
        line: [DVec2; 2],
        within: Run,
        cosine: &impl Fn(f64) -> f64,
        found: &mut impl FnMut(f64, f64, DVec3),
    ) {
        let sheet = &self.sheets[slot];
        let place = |f: f64| line[0].lerp(line[1], f);
        let uv = |f: f64| sheet.uv(place(f));
        let mut ends = vec![within[0], within[1]];
        for (picture, _) in &self.glasses[sheet.glass as usize].pictures {
            let picture = &self.pictures[*picture];
            let size = DVec2::new(picture.width.into(), picture.height.into());
            let (from, to) = (uv(0.0) * size, uv(1.0) * size);
            borders(from.x, to.x, within, &mut ends);
            borders(from.y, to.y, within, &mut ends);
        }
        ends.sort_unstable_by(f64::total_cmp);
        let mut hand_over = |(run, shown): (Run, DVec3)| {
            let through = |f: f64| self.at_angle(slot, sheet.color(place(f)) * shown, cosine(f));
            let angles = [run[0], 0.5 * (run[0] + run[1]), run[1]].map(cosine);
            if sheet.colors.is_none() && angles[0] == angles[1] && angles[1] == angles[2] {
                found(run[0], run[1], through(run[0]));
            } else {
                even(run, run.map(through), &through, HALVINGS, found);
            }
        };
        let mut open: Option<(Run, DVec3)> = None;
        for pair in ends.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            if to <= from {
                continue;
            }
            let shown = self.shown(slot, place(0.5 * (from + to)));
            match &mut open {
                Some((run, same)) if *same == shown => run[1] = to,
                _ => {
                    if let Some(part) = open.replace(([from, to], shown)) {
                        hand_over(part);
                    }
                }
            }
        }
        if let Some(part) = open {
            hand_over(part);
        }
    }
}

impl Sheet {
    fn new(mesh: &Mesh, vertices: [u32; 3], glass: u32, pane: &Pane) -> Self {
        let [a, b, c] = vertices.map(|v| mesh.positions[v as usize]);
        let uvs = vertices.map(|v| mesh.uvs[v as usize]);
        let (e, f) = (uvs[1] - uvs[0], uvs[2] - uvs[0]);
        // Where one coordinate stays the same.
        let along = |e: f64, f: f64| (f * (b - a) - e * (c - a)).try_normalize();
        let is_coloured = pane.is_tinted && !mesh.colors.is_empty();
        Sheet {
            glass,
            normal: (b - a).cross(c - a).normalize_or_zero(),
            borders: [along(e.x, f.x), along(e.y, f.y)],
            uvs,
            colors: is_coloured.then(|| vertices.map(|v| mesh.colors[v as usize].truncate())),
        }
    }

    fn uv(&self, at: DVec2) -> DVec2 {
        let [a, b, c] = self.uvs;
        a * (1.0 - at.x - at.y) + b * at.x + c * at.y
    }

    fn color(&self, at: DVec2) -> DVec3 {
        self.colors.map_or(DVec3::ONE, |[a, b, c]| {
            a * (1.0 - at.x - at.y) + b * at.x + c * at.y
        })
    }
}

/// Adds the fractions of a line, between two of them, at which a coordinate [texels] passes from texel to texel.
fn borders(start: f64, end: f64, within: Run, all: &mut Vec<f64>) {
    let slope = end - start;
    let at = within.map(|f| start + f * slope);
    let (low, high) = (at[0].min(at[1]), at[0].max(at[1]));
    let (first, last) = (low.floor() + 1.0, high.ceil() - 1.0);
    if last < first || last - first > BORDERS {
        return;
    }
    let count = (last - first) as u32 + 1;
    let places = (0..count).map(|i| (first + f64::from(i) - start) / slope);
    all.extend(places.filter(|f| *f > within[0] && *f < within[1]));
}

/// Divides a part of a line, of which it is known what is let through at its ends, until that is even.
fn even(
    [from, to]: Run,
    ends: [DVec3; 2],
    through: &impl Fn(f64) -> DVec3,
    halvings: u32,
    found: &mut impl FnMut(f64, f64, DVec3),
) {
    let middle = 0.5 * (from + to);
    let at_middle = through(middle);
    let off = |end: DVec3| (end - at_middle).abs().max_element();
    if halvings == 0 || off(ends[0]).max(off(ends[1])) <= EVEN {
        // Simpson's rule.
        return found(from, to, (ends[0] + 4.0 * at_middle + ends[1]) / 6.0);
    }
    even(
        [from, middle],
        [ends[0], at_middle],
        through,
        halvings - 1,
        found,
    );
    even(
        [middle, to],
        [at_middle, ends[1]],
        through,
        halvings - 1,
        found,
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Wrap;

    #[test]
    fn fine_pictures_become_means_of_linear_light() {
        let stripes = |i: u32| if i.is_multiple_of(2) { 0 } else { 255 };
        let picture = Texture {
            name: "stripes".into(),
            width: 2 * FINEST,
            height: 3,
            pixels: (0..6 * FINEST).map(|i| [stripes(i); 4]).collect(),
            wrap: [Wrap::Repeat; 2],
        };
        let coarse = no_finer(&picture, false);
        assert_eq!([coarse.width, coarse.height], [FINEST, 3]);
        let half = (255.0 * srgb_encode(0.5)).round() as u8;
        assert!(coarse.pixels.iter().all(|p| *p == [half, half, half, 255]));
        assert!(no_finer(&picture, true).pixels.iter().all(|p| p[0] == 128));
        let small = Texture {
            width: 4,
            pixels: picture.pixels[..12].to_vec(),
            ..picture
        };
        assert_eq!(no_finer(&small, false).pixels, small.pixels);
    }
}
