//! Pictures of MTL materials: the colour of one and the opacity of another become one texture.

use super::assembly::decode_image;
use super::mtl::{Channel, Entry, Map, Remarks};
use super::named::{self, Beside, MOST};
use super::text::{shortened, shown_path};
use super::{Texture, Wrap};
use crate::warning::Warning;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The textures made so far, by the files and the options that make them.
#[derive(Default)]
pub(super) struct Pictures {
    made: BTreeMap<Key, Made>,
    /// Where and why pictures cannot be read.
    missing: BTreeMap<PathBuf, String>,
}

type Key = (Option<PathBuf>, Option<PathBuf>, bool, Option<Channel>);

/// What a material's pictures give.
#[derive(Clone, Copy, Default)]
pub(super) struct Made {
    /// The texture, by its number.
    pub texture: Option<usize>,
    /// Whether it has the colour of `map_Kd`, and is not white with the opacity of `map_d`.
    pub colored: bool,
    /// Whether some of its texels are not opaque.
    pub pierced: bool,
}

impl Pictures {
    /// Makes the texture of a material of the file `library`.
    pub fn make(
        &mut self,
        entry: &Entry,
        library: &Path,
        beside: &mut Beside,
        textures: &mut Vec<Texture>,
        remarks: &mut Remarks,
    ) -> Made {
        let (color, opacity) = (&entry.look.diffuse_map, &entry.look.opacity_map);
        let mut fault = |problem| {
            remarks
                .faults
                .add(problem, entry.line, || shortened(&entry.name));
        };
        if let (Some(color), Some(opacity)) = (color, opacity)
            && (color.scale, color.offset, color.clamp)
                != (opacity.scale, opacity.offset, opacity.clamp)
        {
            fault("map_d has other -s, -o or -clamp than map_Kd, whose are taken for both");
        }
        let Some(first) = color.as_ref().or(opacity.as_ref()) else {
            return Made::default();
        };
        let mut find = |map: &Option<Map>| map.as_ref().map(|m| beside.find(library, &m.name));
        let channel = opacity.as_ref().and_then(|map| map.channel);
        let key = (find(color), find(opacity), first.clamp, channel);
        if let Some(&made) = self.made.get(&key) {
            return made;
        }

        let wrap = if first.clamp {
            [Wrap::Clamp; 2]
        } else {
            [Wrap::Repeat; 2]
        };
        let mut read = |path: &Option<PathBuf>, map: &Option<Map>| {
            let (path, map) = (path.as_ref()?, map.as_ref()?);
            let picture = named::read(path).and_then(|bytes| {
                decode_image(&map.name, &bytes, wrap).map_err(|problem| {
                    format!("{}: {problem}", shown_path(&path.display().to_string()))
                })
            });
            picture
                .map_err(|problem| self.missing.insert(path.clone(), problem))
                .ok()
        };
        let color = read(&key.0, color);
        // The same picture for both: its alpha is in the texture already.
        let is_same = key.0 == key.1 && channel.is_none();
        let opacity = if is_same { None } else { read(&key.1, opacity) };
        if is_same && color.as_ref().is_some_and(|picture| !is_pierced(picture)) {
            fault("map_d is map_Kd's picture, which has no alpha: opaque");
        }
        let colored = color.is_some();
        let texture = match opacity {
            Some(opacity) => {
                let (texture, exact) = with_opacity(color, opacity, channel);
                if !exact {
                    fault(
                        "map_d and map_Kd are of sizes that do not go into each other: nearest texels are taken",
                    );
                }
                Some(texture)
            }
            None => color,
        };
        let made = Made {
            colored,
            pierced: texture.as_ref().is_some_and(is_pierced),
            texture: texture.map(|texture| {
                textures.push(texture);
                textures.len() - 1
            }),
        };
        self.made.insert(key, made);
        made
    }

    /// What could not be read, as warnings of the scene `file`.
    pub fn into_warnings(self, file: &str) -> impl Iterator<Item = Warning> {
        let more = self.missing.len().saturating_sub(MOST);
        let problems = self.missing.into_values().take(MOST);
        let rest = (more > 0).then(|| format!("{more} more pictures cannot be read"));
        problems
            .chain(rest)
            .map(move |problem| Warning::MissingTexture {
                problem: format!("{file}: {problem}"),
                remedy: "put the picture where the MTL file names it, as PNG or JPEG".into(),
            })
    }
}

fn is_pierced(picture: &Texture) -> bool {
    picture.pixels.iter().any(|texel| texel[3] < 255)
}

/// A picture, or white, whose alpha is the value of another; and whether no texel of either is lost.
fn with_opacity(
    color: Option<Texture>,
    opacity: Texture,
    channel: Option<Channel>,
) -> (Texture, bool) {
    let channel = channel.unwrap_or(if is_pierced(&opacity) {
        Channel::Alpha
    } else {
        Channel::Luminance
    });
    let value = |[r, g, b, a]: [u8; 4]| match channel {
        Channel::Red => r,
        Channel::Green => g,
        Channel::Blue => b,
        Channel::Alpha => a,
        // Weights of Rec. 709; grey stays as it is.
        Channel::Luminance => {
            ((2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b) + 5000) / 10_000) as u8
        }
    };
    let color = color.unwrap_or_else(|| Texture {
        name: opacity.name.clone(),
        width: 1,
        height: 1,
        pixels: vec![[255; 4]],
        wrap: opacity.wrap,
    });
    let texels = |width: u32, height: u32| u64::from(width) * u64::from(height);
    let (own, other) = ((color.width, color.height), (opacity.width, opacity.height));
    let both = (own.0.max(other.0), own.1.max(other.1));
    // A wide and a tall picture would make one that is neither.
    let most = 4 * texels(own.0, own.1).max(texels(other.0, other.1));
    let (width, height) = if texels(both.0, both.1) <= most {
        both
    } else {
        own
    };
    let fits = |(w, h): (u32, u32)| width % w == 0 && height % h == 0;
    let texel = |picture: &Texture, x: u32, y: u32| {
        let nearest = |i: u32, from: u32, to: u32| {
            ((2 * u64::from(i) + 1) * u64::from(to) / (2 * u64::from(from))) as usize
        };
        let (x, y) = (
            nearest(x, width, picture.width),
            nearest(y, height, picture.height),
        );
        picture.pixels[y * picture.width as usize + x]
    };
    let pixels = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| {
            let [r, g, b, _] = texel(&color, x, y);
            [r, g, b, value(texel(&opacity, x, y))]
        })
        .collect();
    let exact = fits(own) && fits(other);
    let (name, wrap) = (color.name, color.wrap);
    let texture = Texture {
        name,
        width,
        height,
        pixels,
        wrap,
    };
    (texture, exact)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, pixels: &[[u8; 4]]) -> Texture {
        Texture {
            name: "p".into(),
            width,
            height,
            pixels: pixels.to_vec(),
            wrap: [Wrap::Repeat; 2],
        }
    }

    #[test]
    fn opacity_comes_from_the_picture_that_has_it() {
        let grey = |v| [v, v, v, 255];
        let color = picture(2, 1, &[[1, 2, 3, 255], [4, 5, 6, 255]]);
        let opacity = picture(1, 2, &[grey(9), grey(200)]);
        let (made, exact) = with_opacity(Some(color), opacity.clone(), None);
        assert!(exact);
        assert_eq!((made.width, made.height), (2, 2));
        assert_eq!(
            made.pixels,
            [[1, 2, 3, 9], [4, 5, 6, 9], [1, 2, 3, 200], [4, 5, 6, 200]]
        );
        let (white, _) = with_opacity(None, opacity, None);
        assert_eq!(white.pixels, [[255, 255, 255, 9], [255, 255, 255, 200]]);

        let colors = picture(1, 1, &[[10, 20, 30, 40]]);
        for (channel, value) in [
            (None, 40),
            (Some(Channel::Red), 10),
            (Some(Channel::Green), 20),
            (Some(Channel::Blue), 30),
            (Some(Channel::Alpha), 40),
            (Some(Channel::Luminance), 19),
        ] {
            let (made, _) = with_opacity(None, colors.clone(), channel);
            assert_eq!(made.pixels[0][3], value, "{channel:?}");
        }
        let (_, exact) = with_opacity(
            Some(picture(3, 1, &[[0; 4]; 3])),
            picture(2, 1, &[[0; 4]; 2]),
            None,
        );
        assert!(!exact);
    }
}
