//! Where the z-partitions' shadow maps look: fitted across the light to what is seen, as dense as the picture asks, snapped to
//! whole texels; their heights fitted to what stands over or under each window.

use super::seen::{Seen, Sight, pixel_width};
use super::shared::{self, PARTITIONS, PartitionMap};
use super::window::{Window, heights, placed};
use crate::beam::Beam;
use crate::conditions::Conditions;
use crate::effect::MapSettings;
use crate::scene::Projection;
use glam::{DVec2, DVec3, Vec2, Vec4};
use rayon::prelude::*;

/// Angle by which maps are turned around the light from the horizontal [rad]. Edges of buildings are level or upright; along
/// texels they would be off by the same part of a texel all along, and all light that they let through with them.
const TURN: f64 = 0.4;

/// Maps have about so many texels on a side, however few pixels there are, unless their resolution is less.
const LEAST: f64 = 1024.0;

/// The most by which the far end of a partition is beyond its near end where there are more partitions than asked for: with that,
/// a map of the greatest resolution still has a texel for each pixel at its near end.
const RATIO: f64 = 4.0;

/// The share of rays that end so near that they do not decide how far maps are split.
const NEAR_SHARE: f64 = 0.05;

/// What a partition covers across the light, and a distance in its middle [m].
#[derive(Debug, Clone, Copy)]
struct Covered {
    window: Window,
    distance: f64,
}

/// Distances at which what is seen is split, from 0 to the farthest. Where the wanted number would make partitions whose ends are
/// too far apart, there are more, evenly in the logarithm.
fn splits(near: f64, far: f64, settings: &MapSettings) -> Vec<f64> {
    let near = near.clamp(1e-9 * far, far);
    // One map is left for the whole view.
    let parts = settings.partitions.clamp(1, PARTITIONS as usize - 1);
    let needed = 1.0 + ((far / near).ln() / RATIO.ln()).max(0.0);
    let count = parts.max((needed.ceil() as usize).min(PARTITIONS as usize - 1));
    let share = if count > parts {
        1.0
    } else {
        settings.logarithmic
    };
    (0..=count)
        .map(|i| {
            // The first split is at `near` where all are logarithmic.
            let f = match count > parts {
                true => (i as f64 - 1.0) / (count as f64 - 1.0).max(1.0),
                false => i as f64 / count as f64,
            };
            let logarithmic = near * (far / near).powf(f);
            let even = near + (far - near) * f;
            match i {
                0 => 0.0,
                _ => share * logarithmic + (1.0 - share) * even,
            }
        })
        .collect()
}

/// Texels on a side of each of the six faces around a local beam, of what a map may have at most.
const FACE: u32 = 4;

/// A beam without maps.
pub fn unmapped(conditions: &Conditions, beam: &Beam) -> shared::Beam {
    let none = shared::Beam {
        side: 1.0,
        ..shared::Beam::default()
    };
    match *beam {
        Beam::Parallel {
            toward,
            angular_radius,
            ..
        } => shared::Beam {
            kind: shared::PARALLEL,
            extent: angular_radius as f32,
            toward: toward.as_vec3(),
            ..none
        },
        Beam::Local {
            position, radius, ..
        } => shared::Beam {
            kind: shared::LOCAL,
            position: (position - conditions.view.camera.eye).as_vec3(),
            extent: radius as f32,
            ..none
        },
    }
}

/// A beam and its maps, the finest first. Its `side` is that of the largest map; its strength is left at zero.
///
/// A map is as dense as the settings ask in the middle of its partition, so that a partition has as many texels as the picture
/// has use for: near ones the most that a side may have, those in the distance or under a low sun fewer. All coordinates are
/// relative to the anchor: near it they keep their digits however far the scene reaches.
pub fn fit(
    conditions: &Conditions,
    seen: &Seen,
    casters: &[DVec3],
    anchor: DVec3,
    beam: &Beam,
    settings: &MapSettings,
) -> shared::Beam {
    let fitted = unmapped(conditions, beam);
    let toward = match *beam {
        Beam::Parallel { toward, .. } => toward,
        Beam::Local { radius, .. } => {
            // A lamp's maps see all around it, from inside of it on: nothing stands in its way there.
            let near = radius.max(1e-6 * conditions.geometry.extent().min(1.0));
            return shared::Beam {
                partitions: 6,
                side: (settings.most / FACE).max(16) as f32,
                near: near.max(f64::from(f32::MIN_POSITIVE)) as f32,
                ..fitted
            };
        }
    };
    let eye = conditions.view.camera.eye;
    let level = DVec3::Y.cross(toward).try_normalize().unwrap_or(DVec3::X);
    let across = TURN.cos() * level + TURN.sin() * toward.cross(level);
    let along = toward.cross(across);
    let place = |p: DVec3| {
        let p = p - anchor;
        DVec3::new(across.dot(p), along.dot(p), toward.dot(p))
    };
    let triangles = placed(casters, place);
    let corners = triangles.as_flattened().par_iter();
    let (low, high) = corners
        .fold(
            || (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |(low, high), p| (low.min(*p), high.max(*p)),
        )
        .reduce(
            || (DVec3::INFINITY, DVec3::NEG_INFINITY),
            |a, b| (a.0.min(b.0), a.1.max(b.1)),
        );
    let (low, high) = match triangles.is_empty() {
        true => (DVec3::ZERO, DVec3::ZERO),
        false => (low, high),
    };
    // Flat things need room too; nothing may be clipped by rounding to f32.
    let slack = 1e-6 * (high - low).length() + 4e-7 * low.abs().max(high.abs()).max_element();
    let slack = slack.max(f64::from(f32::MIN_POSITIVE));
    let all = Window {
        min: low.truncate() - slack,
        max: high.truncate() + slack,
    };

    let mut parts = views(conditions, seen, |p| place(p).truncate(), settings);
    parts
        .iter_mut()
        .for_each(|part| part.window = part.window.within(&all));
    parts.retain(|part| !part.window.is_empty());
    // Texels lie as if counted from the scene's middle, whatever the anchor is.
    let (least, greatest) = conditions.geometry.bounds();
    let grid = Grid {
        origin: place(0.5 * (least + greatest)).truncate(),
        unit: conditions.geometry.extent().max(f64::MIN_POSITIVE),
    };
    // As many texels as the wanted number of maps has, however many there are.
    let budget =
        (settings.partitions.max(1) as f64 * 4.0 / 3.0 / parts.len().max(1) as f64).min(1.0);
    let most = ((f64::from(settings.most) * budget.sqrt()) as u32).max(16);
    let mut fitted_maps: Vec<(Window, PartitionMap)> = Vec::with_capacity(parts.len());
    for part in &mut parts {
        let size = part.window.max - part.window.min;
        part.window = part.window.grown(1e-6 * size + 1e-3 * slack);
        let texel = pixel_width(conditions, part.distance) / settings.density;
        fitted_maps.push((part.window, snapped(&part.window, texel, most, &grid)));
    }
    let texel_area = |map: &PartitionMap| map.texel.x * map.texel.y;
    fitted_maps.sort_by(|(_, a), (_, b)| texel_area(a).total_cmp(&texel_area(b)));
    // What a finer map covers is never read from a coarser one.
    let mut maps: Vec<PartitionMap> = Vec::with_capacity(fitted_maps.len());
    let mut covered: Vec<Window> = Vec::new();
    for (window, map) in fitted_maps {
        if maps.len() < PARTITIONS as usize && !covered.iter().any(|finer| finer.encloses(&window))
        {
            covered.push(window);
            maps.push(map);
        }
    }
    // A snapped map is a little wider than its window, and is read up to its border.
    let drawn: Vec<Window> = maps
        .iter()
        .map(|map| Window {
            min: map.least.as_dvec2(),
            max: (map.least + map.size * map.texel).as_dvec2(),
        })
        .collect();
    for (map, heights) in maps.iter_mut().zip(heights(&triangles, &drawn)) {
        // Corners far away are rounded, and with them what lies between.
        let slack = 1e-3 * (heights.1 - heights.0) + 1e-6 * low.abs().max(high.abs()).max_element();
        let slack = slack.max(f64::from(f32::MIN_POSITIVE));
        map.heights = DVec2::new(heights.0 - slack, heights.1 + slack).as_vec2();
    }
    let side = maps.iter().map(|map| map.size.max_element());
    let side = side.fold(1.0, f32::max);
    let plane = |axis: DVec3| Vec4::from((axis.as_vec3(), axis.dot(eye - anchor) as f32));
    let mut light = shared::Beam {
        partitions: maps.len() as u32,
        side,
        across: plane(across),
        along: plane(along),
        height: plane(toward),
        casters: Vec4::new(
            all.min.x as f32,
            all.min.y as f32,
            all.max.x as f32,
            all.max.y as f32,
        ),
        highest: (high.z + slack) as f32,
        ..fitted
    };
    for (place, map) in light.maps.iter_mut().zip(&maps) {
        *place = *map;
    }
    light
}

/// What each part of the view covers across the light, the nearest first.
///
/// Maps are fitted to the rays of `seen`. What other rays see beyond them is covered by a last one, that of the whole view.
fn views(
    conditions: &Conditions,
    seen: &Seen,
    place: impl Fn(DVec3) -> DVec2,
    settings: &MapSettings,
) -> Vec<Covered> {
    let whole = Covered {
        window: cone(conditions, &place),
        distance: 0.5 * seen.farthest(),
    };
    if seen.sights.is_empty() {
        return vec![whole];
    }
    let splits = splits(0.5 * seen.quantile(NEAR_SHARE), seen.farthest(), settings);
    let mut parts: Vec<Covered> = splits
        .windows(2)
        .filter_map(|ends| {
            let of = |sight: &Sight| {
                let (from, to) = (sight.near.max(ends[0]), sight.far.min(ends[1]));
                (from <= to).then(|| {
                    let window = Window::EMPTY.with(place(sight.ray.at(from)));
                    window.with(place(sight.ray.at(to)))
                })
            };
            let window = seen.sights.iter().filter_map(of);
            let window = window.reduce(|a, b| a.and(&b))?;
            // Rays between those that were traced see a little more.
            let size = window.max - window.min;
            Some(Covered {
                window: window.grown(0.02 * size),
                distance: match ends[0] {
                    0.0 => 0.5 * ends[1],
                    from => (from * ends[1]).sqrt(),
                },
            })
        })
        .collect();
    parts.push(whole);
    parts
}

/// The whole view, seen along the light.
fn cone(conditions: &Conditions, place: &impl Fn(DVec3) -> DVec2) -> Window {
    let camera = &conditions.view.camera;
    if camera.projection == Projection::Panorama {
        return Window {
            min: DVec2::NEG_INFINITY,
            max: DVec2::INFINITY,
        };
    }
    let [w, h] = conditions.view.size.map(f64::from);
    let corners = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)];
    corners.into_iter().fold(Window::EMPTY, |window, (x, y)| {
        let ray = camera.ray(DVec2::new(x, y), conditions.view.size);
        let start = place(ray.origin);
        let goes = place(ray.at(1.0)) - start;
        let end = |goes: f64, start: f64| match goes {
            m if m > 0.0 => f64::INFINITY,
            m if m < 0.0 => f64::NEG_INFINITY,
            _ => start,
        };
        let far = DVec2::new(end(goes.x, start.x), end(goes.y, start.y));
        window.with(start).with(far)
    })
}

/// Where texels lie: their sizes come in steps of 2^(1/8) of a unit, their borders at whole ones from an origin [m].
struct Grid {
    origin: DVec2,
    unit: f64,
}

/// The map that covers a window with two texels to spare, texels being about `texel` [m] wide, less where that makes fewer than
/// [`LEAST`], more where it makes more than `most`. Sizes and borders are those of a grid, so that a small change of the view moves
/// the map by whole texels or not at all.
fn snapped(window: &Window, texel: f64, most: u32, grid: &Grid) -> PartitionMap {
    let size = window.max - window.min;
    // A few large pixels see less of a map than light has detail: their own means need it.
    let wanted = (size / LEAST).min(DVec2::splat(texel));
    let size = (size / (f64::from(most) - 4.0)).max(wanted);
    let step =
        |x: f64| grid.unit * (0.125 * (8.0 * (x / grid.unit).max(1e-30).log2()).ceil()).exp2();
    let texel = DVec2::new(step(size.x), step(size.y)).as_vec2();
    let wide = texel.as_dvec2();
    let least = ((window.min - grid.origin) / wide).floor() - 1.0;
    let size = ((window.max - grid.origin) / wide).ceil() + 1.0 - least;
    PartitionMap {
        least: (grid.origin + least * wide).as_vec2(),
        texel,
        size: size.as_vec2().min(Vec2::splat(most as f32)),
        heights: Vec2::ZERO,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(partitions: usize) -> MapSettings {
        MapSettings {
            partitions,
            logarithmic: 0.7,
            most: 512,
            density: 1.0,
        }
    }

    #[test]
    fn splits_grow_from_nothing_to_the_farthest() {
        for (partitions, near, far) in [
            (4, 0.1, 2.0),
            (3, 0.1, 40_000.0),
            (16, 0.1, 40_000.0),
            (1, 5.0, 5.0),
            (3, 0.0, 1e7),
        ] {
            let distances = splits(near, far, &settings(partitions));
            assert_eq!(distances[0], 0.0);
            let last = distances[distances.len() - 1];
            assert!((last / far - 1.0).abs() < 1e-9, "{distances:?}");
            assert!(distances.windows(2).all(|d| d[1] >= d[0]), "{distances:?}");
            assert!(distances.len() <= PARTITIONS as usize);
        }
        // A scene that reaches 40 km keeps its near partitions.
        let far = splits(1.0, 40_000.0, &settings(3));
        assert!(far[1] <= 1.0 + 1e-9 && far.len() > 6, "{far:?}");
    }

    #[test]
    fn a_snapped_map_covers_its_window_and_moves_by_whole_texels() {
        let window = |shift: f64| Window {
            min: DVec2::new(-3.7 + shift, 11.0),
            max: DVec2::new(20.1 + shift, 12.5),
        };
        let grid = Grid {
            origin: DVec2::new(17.3, -4.1),
            unit: 30.0,
        };
        let still = snapped(&window(0.0), 0.0, 512, &grid);
        for shift in [0.0, 0.003, 0.5, 123.456] {
            let w = window(shift);
            let map = snapped(&w, 0.0, 512, &grid);
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
