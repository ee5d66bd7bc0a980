//! Form factors by hemicubes (Cohen & Greenberg 1985), the method of the ReLiShaft paper, beside rays.
//!
//! Half a cube stands on a patch. Each texel of its five faces is a pyramid of directions whose form factor is known in closed form
//! ([`Hemicube`]); all of it goes to what the ray through the texel's middle meets. Of the sky, of ground and of surfaces that let
//! light through a texel sees what any ray sees, and the air takes its part on the way.
//!
//! Which triangle stands in each texel is found by the tree of triangles, or by a [`Drawer`]: a graphics device that draws them all.
//! A rasteriser rounds corners to parts of a texel. So where triangles meet it is asked in f64 which of them a texel's ray meets, and
//! at silhouettes the ray is cast: both ways give the same rows, and walls that meet have no gaps.

use super::arrival::{Row, Source, spread};
use super::planes::Home;
use super::transport::{Transport, WHOLE};
use crate::error::{Error, Result};
use crate::scene::geometry::intersect;
use crate::scene::opacity::Opacity;
use crate::scene::{Hit, Ray};
use crate::split_mix::SplitMix;
use crate::task::Task;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Right, up and forward of each face, where the third axis is the surface's normal. Of the four at the sides the upper half is there.
pub const FACES: [[DVec3; 3]; 5] = [
    [DVec3::X, DVec3::Y, DVec3::Z],
    [DVec3::Y, DVec3::Z, DVec3::X],
    [DVec3::NEG_X, DVec3::Z, DVec3::Y],
    [DVec3::NEG_Y, DVec3::Z, DVec3::NEG_X],
    [DVec3::X, DVec3::Z, DVec3::NEG_Y],
];

/// Something that draws hemicubes: it finds which triangle stands in each texel.
pub trait Drawer: Send + Sync {
    /// Draws `triangles` as each of `eyes` sees them, on faces of `side` texels. `each` is given the texels of some of the eyes, of one
    /// after the other in their order: for each of [`Hemicube::texels`] the number of a triangle, from 1, or 0 for none.
    ///
    /// # Errors
    /// [`Error::Failed`] when the device fails; those of `each`.
    fn draw(
        &self,
        triangles: &[Target],
        eyes: &[Eye],
        side: usize,
        each: &mut dyn FnMut(&[u32]) -> Result<()>,
    ) -> Result<()>;
}

/// A triangle that is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Corners [m], scene axes.
    pub corners: [DVec3; 3],
    /// What is not seen from itself: the plane that it is a part of, or itself.
    pub home: u32,
}

/// Where a hemicube stands.
#[derive(Debug, Clone, Copy)]
pub struct Eye {
    /// Its middle [m], scene axes.
    pub place: DVec3,
    /// Unit vectors; the third is the surface's normal.
    pub axes: [DVec3; 3],
    /// What is nearer than this is not drawn [m]: a millionth of the patch.
    pub near: f64,
    /// The home that is not seen from there.
    pub home: u32,
}

/// The home of no triangle.
const NOWHERE: u32 = u32::MAX;

/// What is nearer to the middle of a patch than this share of its size is not drawn [1]: above the rounding of f32.
const NEAR: f64 = 1e-6;

/// The most entries of rows of all patches together: each takes up to 72 bytes while what patches exchange is made.
const MOST: usize = 20_000_000;

/// The directions of a hemicube and their form factors.
///
/// Texels count row by row from the top of the face in front, then from the top of each of the half faces around it: `side` columns,
/// 3 `side` rows.
pub struct Hemicube {
    side: usize,
    /// Unit vectors, and form factors, which sum to 1.
    texels: Vec<(DVec3, f64)>,
}

impl Hemicube {
    /// One of an even number of texels on a side; an odd one is the next.
    pub fn new(side: usize) -> Self {
        let side = side.next_multiple_of(2).max(2);
        let half = side / 2;
        let at = |i: usize| 2.0 * i as f64 / side as f64 - 1.0;
        let mut texels = Vec::with_capacity(3 * side * side);
        for ([right, up, forward], rows) in FACES.into_iter().zip([side, half, half, half, half]) {
            for row in 0..rows {
                let (top, low) = (-at(row), -at(row + 1));
                for column in 0..side {
                    let (left, end) = (at(column), at(column + 1));
                    let factor = match rows == side {
                        true => over([left, end], [low, top], in_front),
                        false => over([left, end], [low, top], at_side),
                    };
                    let toward = 0.5 * (left + end) * right + 0.5 * (low + top) * up + forward;
                    texels.push((toward.normalize(), factor));
                }
            }
        }
        let whole: f64 = texels.iter().map(|(_, factor)| factor).sum();
        texels.iter_mut().for_each(|(_, factor)| *factor /= whole);
        Hemicube { side, texels }
    }

    /// Unit vectors, the third axis being the normal, and form factors [1], which sum to 1.
    pub fn texels(&self) -> &[(DVec3, f64)] {
        &self.texels
    }

    /// A texel and those around it on its face.
    fn around(&self, texel: usize) -> impl Iterator<Item = usize> {
        let (side, half) = (self.side, self.side / 2);
        let (row, column) = (texel / side, texel % side);
        let (first, rows) = match row < side {
            true => (0, side),
            false => (row - row % half, half),
        };
        let rows = row.max(first + 1) - 1..(row + 2).min(first + rows);
        let columns = column.max(1) - 1..(column + 2).min(side);
        rows.flat_map(move |row| columns.clone().map(move |column| row * side + column))
    }
}

/// What a function that grows from 0 along both axes has between two places on each.
fn over([left, right]: [f64; 2], [low, high]: [f64; 2], from_zero: fn(f64, f64) -> f64) -> f64 {
    from_zero(right, high) - from_zero(left, high) - from_zero(right, low) + from_zero(left, low)
}

/// The form factor of a rectangle at a distance of 1 that faces the surface, from the foot of the normal to a corner.
fn in_front(x: f64, y: f64) -> f64 {
    let (across, along) = (x.hypot(1.0), y.hypot(1.0));
    (x / across * (y / across).atan() + y / along * (x / along).atan()) / (2.0 * PI)
}

/// The form factor of a rectangle that stands upright on the surface's plane at a distance of 1, from the foot to a corner.
fn at_side(x: f64, z: f64) -> f64 {
    let slant = z.hypot(1.0);
    (x.atan() - (x / slant).atan() / slant) / (2.0 * PI)
}

/// The triangles of a scene as hemicubes see them.
struct Cast {
    targets: Vec<Target>,
    /// Of each the number in the scene.
    numbers: Vec<u32>,
    /// Of each whether light goes through it, or through its holes.
    open: Vec<bool>,
}

/// Planes that a ray meets no farther apart than this share of the way are a crease, which hides nothing [1].
const CREASE: f64 = 0.01;

impl Cast {
    /// What the ray through a texel's middle meets, if that can be told from the triangles drawn there and beside it: from one, or
    /// from some that meet there. Behind a silhouette, or through a hole, anything may stand.
    fn met(&self, hemicube: &Hemicube, drawn: &[u32], texel: usize, ray: &Ray) -> Met {
        let own = drawn[texel];
        if hemicube.around(texel).all(|beside| drawn[beside] == own) && own == 0 {
            return Met::Known(None);
        }
        let (mut asked, mut count) = ([0; 9], 0);
        let [mut near, mut far] = [f64::INFINITY, 0.0f64];
        let mut first: Option<Hit> = None;
        for number in hemicube.around(texel).map(|beside| drawn[beside]) {
            if asked[..count].contains(&number) {
                continue;
            }
            asked[count] = number;
            count += 1;
            let at = (number as usize).wrapping_sub(1);
            let Some(Target { corners, .. }) = self.targets.get(at) else {
                return Met::Unknown;
            };
            let [a, b, c] = corners.map(|p| p - ray.origin);
            let normal = (b - a).cross(c - a);
            let distance = normal.dot(a) / normal.dot(ray.direction);
            (near, far) = (near.min(distance), far.max(distance));
            if self.open[at] || distance.is_nan() || near <= 0.0 || far - near > CREASE * near {
                return Met::Unknown;
            }
            let hit = intersect(corners, ray.origin, ray.direction).map(|hit| Hit {
                triangle: self.numbers[at],
                ..hit
            });
            first = match (first, hit) {
                (Some(one), Some(other)) if other.is_before(&one) => hit,
                (None, _) => hit,
                _ => first,
            };
        }
        first.map_or(Met::Unknown, |hit| Met::Known(Some(hit)))
    }
}

/// What is known of what a ray meets.
enum Met {
    /// The first triangle, if there is one.
    Known(Option<Hit>),
    Unknown,
}

/// What a hemicube sees: by source, its share and what is let through of that.
type Sum = Vec<(Source, f64, DVec3)>;

fn add(sum: &mut Sum, source: Source, share: f64, through: Vec3) {
    let through = share * through.as_dvec3();
    match sum.last_mut() {
        Some(last) if last.0 == source => {
            last.1 += share;
            last.2 += through;
        }
        _ => sum.push((source, share, through)),
    }
}

/// The mean of some of them, each source once.
fn mean(sums: &[Sum]) -> Row {
    let mut all: Sum = sums.concat();
    all.sort_by_key(|(source, ..)| *source);
    all.dedup_by(|next, sum| {
        let same = next.0 == sum.0;
        if same {
            sum.1 += next.1;
            sum.2 += next.2;
        }
        same
    });
    let part = 1.0 / sums.len().max(1) as f64;
    let rounded = |(source, share, through): (Source, f64, DVec3)| {
        (source, (part * share) as f32, (part * through).as_vec3())
    };
    all.into_iter().map(rounded).collect()
}

impl Transport {
    /// What the wanted patches see through hemicubes, and what is to be said about these.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the work was stopped.
    pub(super) fn hemicube_rows(
        &self,
        wanted: &[bool],
        drawer: Option<&dyn Drawer>,
        task: Task<'_>,
    ) -> Result<(Vec<Row>, Vec<String>)> {
        let all = &self.patches.all;
        let stands = |patch: &usize| wanted[*patch] && all[*patch].area > 0.0;
        let patches: Vec<usize> = (0..all.len()).filter(stands).collect();
        let (wish, spots) = (self.detail.hemicube, self.detail.hemicube_spots.max(1));
        let hemicube = Hemicube::new(self.side_for(patches.len(), wish, spots));
        let mut notes = Vec::new();
        if hemicube.side < wish {
            notes.push(format!(
                "hemicubes have {} texels on a side, not {wish}: those of {} patches would take too much memory",
                hemicube.side,
                patches.len()
            ));
        }
        let eyes: Vec<Eye> = patches
            .iter()
            .flat_map(|&patch| (0..spots).map(move |spot| self.eye(patch, spot, spots)))
            .collect();
        let traced = || {
            let pieces = task.pieces(eyes.len());
            let traced = |eye: &Eye| {
                pieces.begin()?;
                Ok(self.sum(&hemicube, eye, |_, _| Met::Unknown))
            };
            eyes.par_iter().map(traced).collect::<Result<Vec<Sum>>>()
        };
        // More triangles than texels: most of what would be drawn fills none.
        let triangles = self.conditions.geometry.triangle_count();
        let is_fine = triangles > hemicube.texels.len();
        if is_fine && drawer.is_some() {
            notes.push(format!(
                "hemicubes were not drawn, the CPU has cast a ray for each texel: {triangles} triangles are more than {} texels",
                hemicube.texels.len()
            ));
        }
        let drawer = drawer.filter(|_| !is_fine);
        let found = match drawer.map(|drawer| self.drawn(&hemicube, &eyes, drawer, task)) {
            Some(Ok(found)) => found,
            Some(Err(Error::Stopped)) => return Err(Error::Stopped),
            Some(Err(error)) => {
                let why = error.problem();
                notes.push(format!(
                    "hemicubes were not drawn, the CPU has cast a ray for each texel: {why}"
                ));
                traced()?
            }
            None => traced()?,
        };
        let mut rows = vec![Row::new(); all.len()];
        for (patch, sums) in patches.iter().zip(found.chunks(spots)) {
            rows[*patch] = mean(sums);
        }
        Ok((rows, notes))
    }

    /// Texels on a side of as many hemicubes, `wish` or fewer: of what a patch sees no row has more entries than it has texels.
    fn side_for(&self, patches: usize, wish: usize, spots: usize) -> usize {
        let entries = MOST / patches.max(1);
        match patches + self.dome.len() <= entries {
            true => wish,
            false => wish.min((entries as f64 / (3 * spots) as f64).sqrt() as usize / 2 * 2),
        }
    }

    /// Where one of the hemicubes of a patch stands: in its middle, or on one of some points that are spread over it. Each is turned
    /// its own way about the normal, since walls along its texels would all be off by the same part of one.
    fn eye(&self, patch: usize, number: usize, spots: usize) -> Eye {
        let own = &self.patches.all[patch];
        let spot = match spots {
            1 => own.middle(),
            _ => own.spot(&spread(number, patch as u64)),
        };
        let (tangent, bitangent) = spot.normal.any_orthonormal_pair();
        let seed = (patch as u64) << 32 | number as u64;
        let (sin, cos) = (2.0 * PI * SplitMix(seed).unit()).sin_cos();
        Eye {
            place: spot.lifted(self.near(spot.point)),
            axes: [
                cos * tangent + sin * bitangent,
                cos * bitangent - sin * tangent,
                spot.normal,
            ],
            near: NEAR * own.area.sqrt(),
            home: self.home(spot.triangle),
        }
    }

    /// What is not seen from a triangle: its plane, or itself.
    fn home(&self, triangle: u32) -> u32 {
        match self.patches.homes.get(triangle as usize) {
            Some(Home::Plane(plane, _)) => *plane,
            Some(_) => self.patches.faces.len() as u32 + triangle,
            None => NOWHERE,
        }
    }

    /// What each hemicube sees, where the triangles are drawn.
    fn drawn(
        &self,
        hemicube: &Hemicube,
        eyes: &[Eye],
        drawer: &dyn Drawer,
        task: Task<'_>,
    ) -> Result<Vec<Sum>> {
        let (numbers, opacities): (Vec<_>, Vec<_>) = self.conditions.geometry.casters().unzip();
        let target = |triangle: &u32| Target {
            corners: self.conditions.scene.mesh.corners(*triangle),
            home: self.home(*triangle),
        };
        let cast = Cast {
            targets: numbers.iter().map(target).collect(),
            open: opacities.iter().map(|o| *o != Opacity::WHOLE).collect(),
            numbers,
        };
        let count = hemicube.texels.len();
        let pieces = task.pieces(eyes.len());
        let mut found = Vec::with_capacity(eyes.len());
        drawer.draw(&cast.targets, eyes, hemicube.side, &mut |texels| {
            let next = &eyes[found.len()..];
            let next = texels.par_chunks_exact(count).zip(next);
            let sums = next.map(|(drawn, eye)| {
                pieces.begin()?;
                Ok(self.sum(hemicube, eye, |texel, ray| {
                    cast.met(hemicube, drawn, texel, ray)
                }))
            });
            found.extend(sums.collect::<Result<Vec<Sum>>>()?);
            Ok(())
        })?;
        Ok(found)
    }

    /// What one hemicube sees, where `met` tells what rays meet.
    fn sum(&self, hemicube: &Hemicube, eye: &Eye, met: impl Fn(usize, &Ray) -> Met) -> Sum {
        let mut sum = Sum::new();
        let [u, v, w] = eye.axes;
        for (texel, (d, factor)) in hemicube.texels.iter().enumerate() {
            let ray = Ray {
                origin: eye.place,
                direction: d.x * u + d.y * v + d.z * w,
            };
            let (solid, share, veils) = match met(texel, &ray) {
                Met::Known(hit) => (self.look_at(&ray, hit, WHOLE), 1.0, Vec::new()),
                Met::Unknown => self.look_through(&ray, WHOLE),
            };
            for (look, share) in veils.into_iter().chain([(solid, share)]) {
                add(&mut sum, look.source, share * factor, look.through);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn form_factors_sum_to_one_and_are_those_of_the_published_formulae() {
        for side in [2, 4, 6, 16, 50, 128, 512, 1024] {
            let hemicube = Hemicube::new(side);
            assert_eq!(hemicube.texels().len(), 3 * side * side);
            let whole: f64 = hemicube.texels().iter().map(|(_, factor)| factor).sum();
            assert!((whole - 1.0).abs() < 1e-11, "{side}: {whole}");
            // Cohen & Greenberg 1985: cos(theta) dw / pi at the texel's middle, exact as texels become small. Of a texel on a cube one
            // away dw is its area times the cube of the cosine of its angle to the face.
            let area = (2.0 / side as f64).powi(2);
            let mut worst = 0.0f64;
            for (toward, factor) in hemicube.texels() {
                let cosine = toward.abs().max_element();
                let published = toward.z * area * cosine.powi(3) / PI;
                worst = worst.max((factor / published - 1.0).abs());
                assert!(*factor > 0.0 && toward.z > 0.0);
            }
            // Where 10^-10 of a whole are left of sums near to it, these have lost digits.
            let allowed = 3.0 / (side * side) as f64 + 1e-5;
            assert!(worst < allowed, "{side}: {worst} {allowed}");
        }
        assert_eq!(Hemicube::new(0).side, 2);
        assert_eq!(Hemicube::new(5).side, 6);
    }

    #[test]
    fn texels_of_a_face_have_their_neighbours_there() {
        let hemicube = Hemicube::new(4);
        let around = |texel| hemicube.around(texel).collect::<Vec<_>>();
        assert_eq!(around(0), [0, 1, 4, 5]);
        assert_eq!(around(5), [0, 1, 2, 4, 5, 6, 8, 9, 10]);
        // The last row of the face in front, and the first of the half face after it.
        assert_eq!(around(15), [10, 11, 14, 15]);
        assert_eq!(around(16), [16, 17, 20, 21]);
        assert_eq!(around(23), [18, 19, 22, 23]);
        assert_eq!(around(47), [42, 43, 46, 47]);
    }
}
