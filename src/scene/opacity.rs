//! How much of a surface is there: the one place that reads alpha.
//!
//! Alpha is the product of the material's factor, the texture's alpha and the vertices' (interpolated over the triangle).
//!
//! | mode | where there is a surface | what share of the light it stops there |
//! |---|---|---|
//! | [`AlphaMode::Opaque`] | everywhere | all |
//! | [`AlphaMode::Mask`] | where alpha reaches the cutoff | all |
//! | [`AlphaMode::Blend`] | where texture times vertices reach half of their greatest | the greatest alpha |
//!
//! A material that is glass ([`super::Pane`]) stops light by the laws of glass instead, where and as far as the table has it there
//! ([`super::panes`]).
//!
//! So a blended surface of alpha 1 is an opaque one, a textured leaf is cut out, and a pane of alpha a lets 1 - a of the light
//! through, uncoloured and straight on. What is less than half there is left out, and what is more is there as a whole: a
//! gradient becomes an edge, which a warning says.

use super::pane::FINEST;
use super::text::shortened;
use super::{AlphaMode, Material, Scene, Texture};
use crate::warning::Warning;

/// How much of a material is there, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opacity {
    /// The share of light that a solid part stops, 0 to 1; 0: nothing is there.
    pub share: f64,
    /// The least product of the texture's and the vertices' alpha, 0 to 1, that is solid; absent: all of it is.
    pub least: Option<f64>,
}

impl Opacity {
    /// All of it is there.
    pub const WHOLE: Opacity = Opacity {
        share: 1.0,
        least: None,
    };

    /// None of it is there.
    pub const NOTHING: Opacity = Opacity {
        share: 0.0,
        least: None,
    };

    /// Whether it lets a part of the light through.
    pub fn is_veil(&self) -> bool {
        0.0 < self.share && self.share < 1.0
    }

    /// That of a material, whose texture times vertices have alphas within `range`.
    fn of(material: &Material, [low, high]: [f64; 2]) -> Opacity {
        let (share, least) = match material.alpha_mode {
            AlphaMode::Opaque => return Opacity::WHOLE,
            AlphaMode::Mask { cutoff } if material.alpha * high < cutoff => {
                return Opacity::NOTHING;
            }
            AlphaMode::Mask { cutoff } => (1.0, cutoff / material.alpha.max(f64::MIN_POSITIVE)),
            AlphaMode::Blend => (material.alpha * high, 0.5 * high),
        };
        Opacity {
            share: share.clamp(0.0, 1.0),
            least: (low < least).then_some(least),
        }
    }
}

/// What a scene's materials have been found to be, and what must be said about them.
pub struct Opacities {
    /// One a material; nothing is there of one that is glass.
    pub of_material: Vec<Opacity>,
    /// How much of each is there as glass, and where.
    pub of_panes: Vec<Opacity>,
    /// What is not there, or not as the file has it.
    pub warnings: Vec<Warning>,
}

impl Opacities {
    /// Reads the alpha of a scene.
    pub fn new(scene: &Scene) -> Self {
        let users = users(scene);
        let mut textures: Vec<Option<Alphas>> = vec![None; scene.textures.len()];
        let mut opacities = Opacities {
            of_material: Vec::with_capacity(scene.materials.len()),
            of_panes: Vec::with_capacity(scene.materials.len()),
            warnings: Vec::new(),
        };
        let (mut absent, mut sharpened, mut partly) = (Vec::new(), Vec::new(), Vec::new());
        let mut panes = Vec::new();
        for (material, (triangles, vertices)) in scene.materials.iter().zip(&users) {
            let reads_alpha = material.alpha_mode != AlphaMode::Opaque;
            let texture = material.texture.filter(|_| reads_alpha).map(|index| {
                *textures[index].get_or_insert_with(|| Alphas::of(&scene.textures[index]))
            });
            let [low, high] = texture.map_or([1.0, 1.0], |t| t.range);
            let opacity = Opacity::of(material, [low * vertices[0], high * vertices[1]]);
            let (as_surface, as_pane) = match material.pane {
                None => (opacity, Opacity::NOTHING),
                Some(_) => (Opacity::NOTHING, opacity),
            };
            opacities.of_material.push(as_surface);
            opacities.of_panes.push(as_pane);
            if *triangles > 0 && as_pane.share > 0.0 {
                panes.push(material.name.clone());
                let shown = material.pane.iter().flat_map(|pane| {
                    [
                        material.texture.filter(|_| pane.is_tinted),
                        pane.red,
                        pane.image,
                    ]
                });
                for picture in shown.flatten().map(|index| &scene.textures[index]) {
                    let Texture {
                        name,
                        width,
                        height,
                        ..
                    } = picture;
                    if *width.max(height) > FINEST {
                        opacities.warnings.push(Warning::Mended {
                            problem: format!(
                                "the picture `{}` of the glass `{}` has {width} x {height} texels",
                                shortened(name),
                                material.name
                            ),
                            instead: format!("means of {} each way at most", FINEST),
                        });
                    }
                }
            }
            if *triangles == 0 || !reads_alpha {
                continue;
            }
            if as_surface.is_veil() {
                partly.push(material.name.clone());
            }
            if opacity.share == 0.0 {
                absent.push((material.name.clone(), *triangles));
            } else if material.alpha_mode == AlphaMode::Blend {
                let between = texture.map_or(0.0, |t| t.between);
                let fades = vertices[0] < 0.95 * vertices[1];
                if between > NOTICEABLE || fades {
                    sharpened.push(material.name.clone());
                }
            }
        }
        if !absent.is_empty() {
            let warning = Warning::WhollySeeThrough { materials: absent };
            opacities.warnings.push(warning);
        }
        if !partly.is_empty() {
            let warning = Warning::PartlySeeThrough { materials: partly };
            opacities.warnings.push(warning);
        }
        if !panes.is_empty() {
            let warning = Warning::Panes { materials: panes };
            opacities.warnings.push(warning);
        }
        if !sharpened.is_empty() {
            let warning = Warning::GradualAlpha {
                materials: sharpened,
            };
            opacities.warnings.push(warning);
        }
        opacities
    }
}

/// A share of texels between there and not there that is more than the soft edge of an outline.
const NOTICEABLE: f64 = 0.2;

/// For each material, how many triangles have it, and the least and greatest alpha of their vertices.
fn users(scene: &Scene) -> Vec<(usize, [f64; 2])> {
    let mesh = &scene.mesh;
    let mut users = vec![(0, [f64::INFINITY, f64::NEG_INFINITY]); scene.materials.len()];
    for triangle in &mesh.triangles {
        let (count, [low, high]) = &mut users[triangle.material as usize];
        *count += 1;
        if mesh.colors.is_empty() {
            continue;
        }
        for vertex in triangle.vertices {
            let alpha = mesh.colors[vertex as usize].w;
            *low = low.min(alpha);
            *high = high.max(alpha);
        }
    }
    let bare = |(count, _): &&mut (usize, [f64; 2])| mesh.colors.is_empty() || *count == 0;
    users
        .iter_mut()
        .filter(bare)
        .for_each(|(_, range)| *range = [1.0, 1.0]);
    users
}

/// The alphas of a texture.
#[derive(Clone, Copy)]
struct Alphas {
    /// The least and the greatest, 0 to 1.
    range: [f64; 2],
    /// The share of texels between 5 and 95 % of the greatest, among those that are not empty.
    between: f64,
}

impl Alphas {
    fn of(texture: &Texture) -> Self {
        let mut counts = [0usize; 256];
        for [.., alpha] in &texture.pixels {
            counts[usize::from(*alpha)] += 1;
        }
        let low = counts.iter().position(|n| *n > 0).unwrap_or(255);
        let high = counts.iter().rposition(|n| *n > 0).unwrap_or(255);
        let high_alpha = high as f64;
        let number = |from: f64, to: f64| -> usize {
            let within = |alpha: &usize| (from..to).contains(&(*alpha as f64));
            (0..256).filter(within).map(|alpha| counts[alpha]).sum()
        };
        let between = number(0.05 * high_alpha, 0.95 * high_alpha);
        let there = number(0.05 * high_alpha, 256.0).max(1);
        Alphas {
            range: [low as f64 / 255.0, high as f64 / 255.0],
            between: between as f64 / there as f64,
        }
    }
}

/// The odd number next to 2^32 (sqrt(2) - 1), whose multiples are spread as evenly as can be (and not as the golden ratio's
/// are, by which places in a pixel go).
const STEP: u32 = 1_779_033_703;

/// Which of several surfaces, each of which lets part of the light through, a sample of a pixel shows: a number of 0 to 1, below
/// 1.
///
/// A ray shows the first surface of opacity a where the number is below a, the next one where it is below a + (1 - a) b, and so
/// on. The numbers of a pixel's samples are a Kronecker sequence, turned from pixel to pixel by a hash: means over n samples
/// converge like 1 / n for any number of surfaces, and every backend chooses alike.
pub fn choice(pixel: [u32; 2], sample: u32) -> f64 {
    // Two rounds of the finalizer lowbias32 (Wellons 2018).
    let mix = |mut x: u32| {
        x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
        x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        x ^ (x >> 16)
    };
    let turn = mix(mix(pixel[0]).wrapping_add(pixel[1]));
    f64::from(turn.wrapping_add(sample.wrapping_mul(STEP))) / 4_294_967_296.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_choices_of_a_pixel_are_spread_like_one_over_n() {
        for n in [1u32, 4, 16, 64, 256, 1024] {
            let mut worst = 0.0f64;
            for pixel in 0..64 {
                for share in [0.1, 0.5, 0.75, 0.99] {
                    let hits = (0..n).filter(|i| choice([pixel, 3 * pixel], *i) < share);
                    worst = worst.max((hits.count() as f64 / f64::from(n) - share).abs());
                }
            }
            assert!(worst < 3.0 / f64::from(n), "{n}: {worst}");
        }
    }
}
