//! Where the z-partitions' shadow maps look: fitted across the light, as dense as the picture asks, snapped to whole texels.

use super::shared::{self, PARTITIONS, PartitionMap};
use crate::beam::Beam;
use crate::conditions::Conditions;
use crate::effect::MapSettings;
use crate::scene::Projection;
use glam::{DVec2, DVec3, UVec2, Vec2, Vec4};

/// The farthest over the nearest depth that is split: what is nearer shares the first partition.
const DEPTHS: f64 = 200.0;

/// Angle by which maps are turned around the light from the horizontal [rad]. Edges of buildings are level or upright; along
/// texels they would be off by the same part of a texel all along, and all light that they let through with them.
const TURN: f64 = 0.4;

/// Maps have about so many texels on a side, however few pixels there are, unless their resolution is less.
const LEAST: f64 = 256.0;

/// A rectangle across the light [m].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Window {
    min: DVec2,
    max: DVec2,
}

impl Window {
    const EMPTY: Window = Window {
        min: DVec2::INFINITY,
        max: DVec2::NEG_INFINITY,
    };

    fn with(self, at: DVec2) -> Window {
        Window {
            min: self.min.min(at),
            max: self.max.max(at),
        }
    }

    fn within(self, other: &Window) -> Window {
        Window {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    fn encloses(&self, other: &Window) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }
}

/// What a partition covers across the light, and the depth in its middle [m].
struct Covered {
    window: Window,
    depth: f64,
}

/// Width of a pixel in the middle of the picture at a depth [m].
fn pixel_width(conditions: &Conditions, depth: f64) -> f64 {
    if conditions.view.points().is_some() {
        // Points have no pixels: maps are as fine as they may be.
        return 0.0;
    }
    let middle = 0.5 * UVec2::from(conditions.view.size).as_dvec2();
    let at = |x: f64, y: f64| {
        let ray = conditions
            .view
            .camera
            .ray(middle + DVec2::new(x, y), conditions.view.size);
        ray.origin + depth * ray.direction
    };
    let middle = at(0.0, 0.0);
    (at(1.0, 0.0) - middle)
        .length()
        .min((at(0.0, 1.0) - middle).length())
}

/// The corners of the camera's view: where each corner's rays begin and what they do for a metre of depth.
fn corner_rays(conditions: &Conditions) -> Vec<(DVec3, DVec3)> {
    let [w, h] = conditions.view.size.map(f64::from);
    let [_, _, forward] = conditions.view.camera.axes();
    [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)]
        .map(|(x, y)| {
            let ray = conditions
                .view
                .camera
                .ray(DVec2::new(x, y), conditions.view.size);
            (ray.origin, ray.direction / ray.direction.dot(forward))
        })
        .to_vec()
}

/// Depths at which the camera's view is split, from 0 on: the last is that of the farthest caster.
fn splits(nearest: f64, farthest: f64, settings: &MapSettings) -> Vec<f64> {
    let near = nearest.max(farthest / DEPTHS);
    (0..=settings.partitions)
        .map(|i| {
            let f = i as f64 / settings.partitions as f64;
            let logarithmic = near * (farthest / near).powf(f);
            let even = near + (farthest - near) * f;
            match i {
                0 => 0.0,
                _ => settings.logarithmic * logarithmic + (1.0 - settings.logarithmic) * even,
            }
        })
        .collect()
}

/// Texels on a side of each of the six faces around a local beam, of what a map may have at most.
const FACE: u32 = 4;

/// A local beam: six maps, the faces of a cube around it.
fn local(conditions: &Conditions, position: DVec3, radius: f64, most: u32) -> shared::Beam {
    let extent = conditions.geometry.extent();
    shared::Beam {
        kind: shared::LOCAL,
        partitions: 6,
        side: (most / FACE).max(16) as f32,
        position: (position - conditions.view.camera.eye).as_vec3(),
        extent: radius as f32,
        // Inside of the lamp nothing stands in its way.
        near: radius.max(1e-4 * extent).max(f64::from(f32::MIN_POSITIVE)) as f32,
        ..shared::Beam::default()
    }
}

/// A beam and its maps' windows, the finest map first. Its `side` is that of the largest map; its strength is left at zero.
///
/// A map is as dense as the settings ask in the middle of its partition, so that a partition has as many texels as the picture
/// has use for: near ones the most that a side may have, those in the distance or under a low sun fewer.
pub fn fit(
    conditions: &Conditions,
    casters: &[DVec3],
    beam: &Beam,
    settings: &MapSettings,
) -> shared::Beam {
    let (toward, angular_radius) = match *beam {
        Beam::Parallel {
            toward,
            angular_radius,
            ..
        } => (toward, angular_radius),
        Beam::Local {
            position, radius, ..
        } => return local(conditions, position, radius, settings.most),
    };
    let eye = conditions.view.camera.eye;
    let geometry = &conditions.geometry;
    let (low, high) = geometry.bounds();
    let origin = 0.5 * (low + high);
    let height = toward;
    let level = DVec3::Y.cross(height).try_normalize().unwrap_or(DVec3::X);
    let across = TURN.cos() * level + TURN.sin() * height.cross(level);
    let along = height.cross(across);
    let place = |p: DVec3| DVec2::new(across.dot(p - origin), along.dot(p - origin));

    let mut all = Window::EMPTY;
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for p in casters {
        all = all.with(place(*p));
        let h = height.dot(*p - origin);
        (lowest, highest) = (lowest.min(h), highest.max(h));
    }
    if casters.is_empty() {
        (all.min, all.max, lowest, highest) = (DVec2::ZERO, DVec2::ZERO, 0.0, 0.0);
    }
    // Flat things need room too; nothing may be clipped by rounding.
    let slack = 1e-6 * geometry.extent().max(f64::MIN_POSITIVE);
    all = Window {
        min: all.min - slack,
        max: all.max + slack,
    };
    (lowest, highest) = (lowest - slack, highest + slack);

    let mut parts = views(conditions, place, (low, high), settings);
    parts
        .iter_mut()
        .for_each(|part| part.window = part.window.within(&all));
    parts.retain(|part| !part.window.is_empty());
    let mut fitted: Vec<(Window, PartitionMap)> = Vec::with_capacity(parts.len());
    for part in &mut parts {
        part.window.min -= slack;
        part.window.max += slack;
        let texel = pixel_width(conditions, part.depth) / settings.density;
        let map = snapped(&part.window, texel, settings.most, geometry.extent());
        fitted.push((part.window, map));
    }
    let area = |map: &PartitionMap| map.texel.x * map.texel.y;
    fitted.sort_by(|(_, a), (_, b)| area(a).total_cmp(&area(b)));
    // What a finer map covers is never read from a coarser one.
    let mut maps: Vec<(Window, PartitionMap)> = Vec::with_capacity(fitted.len());
    for (window, map) in fitted {
        if maps.len() < PARTITIONS as usize
            && !maps.iter().any(|(finer, _)| finer.encloses(&window))
        {
            maps.push((window, map));
        }
    }
    let side = maps.iter().map(|(_, map)| map.size.max_element());
    let side = side.fold(1.0, f32::max);

    let plane = |axis: DVec3| {
        let offset = axis.dot(eye - origin);
        Vec4::from((axis.as_vec3(), offset as f32))
    };
    let mut light = shared::Beam {
        kind: shared::PARALLEL,
        extent: angular_radius as f32,
        toward: toward.as_vec3(),
        partitions: maps.len() as u32,
        side,
        across: plane(across),
        along: plane(along),
        height: plane(height),
        casters: Vec4::new(
            all.min.x as f32,
            all.min.y as f32,
            all.max.x as f32,
            all.max.y as f32,
        ),
        heights: Vec4::new(lowest as f32, highest as f32, 0.0, 0.0),
        ..shared::Beam::default()
    };
    for (place, (_, map)) in light.maps.iter_mut().zip(&maps) {
        *place = *map;
    }
    light
}

/// What each part of the view covers across the light; the last part has no far end.
fn views(
    conditions: &Conditions,
    place: impl Fn(DVec3) -> DVec2,
    (low, high): (DVec3, DVec3),
    settings: &MapSettings,
) -> Vec<Covered> {
    let eye = conditions.view.camera.eye;
    let corners = (0..8).map(|i| {
        let pick = |bit: usize, a: f64, b: f64| if i & bit == 0 { a } else { b };
        DVec3::new(
            pick(1, low.x, high.x),
            pick(2, low.y, high.y),
            pick(4, low.z, high.z),
        )
    });
    if conditions.view.camera.projection == Projection::Panorama {
        // Nested squares around the eye.
        let farthest = corners.map(|c| c.distance(eye)).fold(0.0, f64::max);
        let depths = splits(0.0, farthest, settings);
        return depths
            .windows(2)
            .zip(1..)
            .map(|(pair, i)| {
                let reach = if i == settings.partitions {
                    f64::INFINITY
                } else {
                    pair[1]
                };
                Covered {
                    window: Window {
                        min: place(eye) - reach,
                        max: place(eye) + reach,
                    },
                    depth: 0.5 * (pair[0] + pair[1]),
                }
            })
            .collect();
    }
    let [_, _, forward] = conditions.view.camera.axes();
    let depths: Vec<f64> = corners.map(|c| (c - eye).dot(forward)).collect();
    let farthest = depths.iter().copied().fold(0.0, f64::max);
    let nearest = depths.iter().copied().fold(f64::INFINITY, f64::min);
    let rays = corner_rays(conditions);
    let cone = rays.iter().fold(Window::EMPTY, |window, (from, step)| {
        let start = place(*from);
        let move_ = place(*from + *step) - start;
        let end = |m: f64, s: f64| match m {
            m if m > 0.0 => f64::INFINITY,
            m if m < 0.0 => f64::NEG_INFINITY,
            _ => s,
        };
        let far = DVec2::new(end(move_.x, start.x), end(move_.y, start.y));
        window.with(start).with(far)
    });
    if farthest <= 0.0 {
        // All is behind the eye; what shades the view comes from there.
        return vec![Covered {
            window: cone,
            depth: 0.5 * nearest.abs(),
        }];
    }
    let splits = splits(nearest, farthest, settings);
    let slice = |from: f64, to: f64| {
        rays.iter().fold(Window::EMPTY, |window, (origin, step)| {
            window
                .with(place(*origin + from * *step))
                .with(place(*origin + to * *step))
        })
    };
    splits
        .windows(2)
        .zip(1..)
        .map(|(pair, i)| Covered {
            window: if i == settings.partitions {
                cone
            } else {
                slice(pair[0], pair[1])
            },
            depth: 0.5 * (pair[0] + pair[1]),
        })
        .collect()
}

/// The map that covers a window with two texels to spare, texels being about `texel` [m] wide, less where that makes fewer than
/// [`LEAST`], more where it makes more than `most`: their sizes come in steps
/// of 2^(1/8) of the scene's diagonal, and windows begin at whole texels, so that a small change of the view moves the map by
/// whole texels or not at all.
fn snapped(window: &Window, texel: f64, most: u32, extent: f64) -> PartitionMap {
    let size = window.max - window.min;
    // A few large pixels see less of a map than light has detail: their own means need it.
    let wanted = (size / LEAST).min(DVec2::splat(texel));
    let size = (size / (f64::from(most) - 4.0)).max(wanted);
    let step = |x: f64| extent * (0.125 * (8.0 * (x / extent).log2()).ceil()).exp2();
    let texel = DVec2::new(step(size.x), step(size.y)).as_vec2();
    let least = (window.min / texel.as_dvec2()).floor() - 1.0;
    let size = (window.max / texel.as_dvec2()).ceil() + 1.0 - least;
    PartitionMap {
        least: (least * texel.as_dvec2()).as_vec2(),
        texel,
        size: size.as_vec2().min(Vec2::splat(most as f32)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_grow_from_nothing_to_the_farthest() {
        let depths = splits(
            0.1,
            100.0,
            &MapSettings {
                partitions: 4,
                logarithmic: 0.7,
                most: 512,
                density: 1.0,
            },
        );
        assert_eq!(depths.len(), 5);
        assert_eq!(depths[0], 0.0);
        assert!((depths[4] - 100.0).abs() < 1e-9);
        assert!(depths.windows(2).all(|d| d[1] > d[0]));
    }

    #[test]
    fn a_snapped_map_covers_its_window_and_moves_by_whole_texels() {
        let window = |shift: f64| Window {
            min: DVec2::new(-3.7 + shift, 11.0),
            max: DVec2::new(20.1 + shift, 12.5),
        };
        let still = snapped(&window(0.0), 0.0, 512, 30.0);
        for shift in [0.0, 0.003, 0.5, 123.456] {
            let w = window(shift);
            let map = snapped(&w, 0.0, 512, 30.0);
            let least = map.least.as_dvec2();
            let most = least + map.size.as_dvec2() * map.texel.as_dvec2();
            assert!(map.size.max_element() <= 512.0, "{}", map.size);
            assert!(
                least.cmple(w.min).all() && most.cmpge(w.max).all(),
                "{shift}"
            );
            assert_eq!(map.texel, still.texel);
            let texels = (map.least - still.least) / map.texel;
            assert!(
                (texels - texels.round()).abs().max_element() < 1e-2,
                "{texels}"
            );
        }
    }
}
