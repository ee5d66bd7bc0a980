//! Lamps as physics has them: where they are, what they shine with, and what stands before them.

use super::GroundPlane;
use super::evenly::{GOLDEN_ANGLE, evenly};
use super::faces::Faces;
use crate::beam::Beam;
use crate::colour::{Space, luminance};
use crate::error::{Error, Result, nearest};
use crate::photometry::{Distribution, Pose};
use crate::scene::{Geometry, LampForm, PunctualKind, Ray, Scene};
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

pub use super::spot::Spot;

/// No place is nearer to a point of light than a micrometre [m2].
const NEAREST: f64 = 1e-12;

/// Where so much of the daylight in the open arrives it is as bright as there to the eye [1].
const AS_OPEN: f64 = 0.05;

/// A lamp nearly all of whose light meets something nearer than this is shut in [m].
const SHUT_IN: f64 = 0.25;

/// A lamp.
#[derive(Clone)]
pub struct Lamp {
    /// Its name in the file.
    pub name: String,
    /// Where it is [m]: one end of a line, one corner of a rectangle, the middle of a sphere.
    pub position: DVec3,
    /// Its axis and where azimuth begins.
    pub pose: Pose,
    /// Of the whole lamp along its axis [cd], RGB in the working space; of a table a factor [1].
    pub intensity: DVec3,
    /// How intensity goes by direction.
    pub distribution: Distribution,
    /// What its light comes from.
    pub form: LampForm,
    /// What stands in the way of its light, where that is not all that stands in the way of light.
    housed: Option<Housed>,
    /// The faces of one that is a surface of the scene.
    pub(super) faces: Option<Arc<Faces>>,
}

/// What a lamp's housing leaves of the casters.
#[derive(Clone)]
struct Housed {
    /// The material of the housing.
    material: String,
    /// All casters of other materials.
    without: Arc<Geometry>,
}

impl Lamp {
    /// All lamps of a scene: those of its file, then points and spots of its mesh.
    pub(super) fn all(scene: &Scene) -> Result<Vec<Lamp>> {
        let working = Space::Rec709.to_working();
        let mut housed: Vec<(&str, Arc<Geometry>)> = Vec::new();
        let mut lamps = Vec::with_capacity(scene.lamps.len() + scene.lights.len());
        for entry in &scene.lamps {
            let named = |what: &str| format!("light `{}`: {what}", entry.name);
            let wrong = |what: &str, error: Error| {
                Error::input(named(what), error.problem(), error.remedy())
            };
            entry
                .distribution
                .check()
                .map_err(|e| wrong("distribution", e))?;
            let pose =
                Pose::new(entry.toward, entry.around).map_err(|e| wrong("toward, around", e))?;
            check(&entry.name, entry.position, entry.intensity)?;
            check_form(&entry.name, entry.form)?;
            let without = match &entry.ignore {
                None => None,
                Some(material) => Some(Housed {
                    material: material.clone(),
                    without: geometry_without(scene, material, || named("ignore"), &mut housed)?,
                }),
            };
            lamps.push(Lamp {
                name: entry.name.clone(),
                position: entry.position,
                pose,
                intensity: (working * entry.intensity).max(DVec3::ZERO),
                distribution: entry.distribution.clone(),
                form: entry.form,
                housed: without,
                faces: None,
            });
        }
        for light in &scene.lights {
            let distribution = match light.kind {
                PunctualKind::Directional => continue,
                PunctualKind::Point => Distribution::Isotropic,
                PunctualKind::Spot { inner, outer } => Distribution::Cone { inner, outer },
            };
            let wrong =
                |e: Error| Error::input(format!("lamp `{}`", light.name), e.problem(), e.remedy());
            distribution.check().map_err(wrong)?;
            check(&light.name, light.position, light.color)?;
            lamps.push(Lamp {
                name: light.name.clone(),
                position: light.position,
                pose: Pose::new(light.direction, None).map_err(wrong)?,
                intensity: (working * light.color).max(DVec3::ZERO),
                distribution,
                form: LampForm::Point,
                housed: None,
                faces: None,
            });
        }
        Ok(lamps)
    }

    /// The surfaces of a scene that shine: a lamp for each material, and one for its backs.
    pub(super) fn glowing(
        scene: &Scene,
        geometry: &Geometry,
        ground: Option<GroundPlane>,
    ) -> Result<Vec<Lamp>> {
        let mut lamps = Vec::new();
        for (&material, emission) in &scene.emissions {
            let name = &scene.materials[material as usize].name;
            for back in [false, true] {
                if back && !emission.both_sides {
                    continue;
                }
                let Some(faces) = Faces::new(scene, geometry, ground, material, back) else {
                    continue;
                };
                let (position, radius) = faces.ball();
                let intensity = DVec3::splat(faces.candela);
                check(name, position, intensity)?;
                lamps.push(Lamp {
                    name: name.clone(),
                    position,
                    pose: Pose::new(DVec3::NEG_Y, None)?,
                    intensity,
                    distribution: Distribution::Isotropic,
                    form: LampForm::Faces { radius },
                    housed: None,
                    faces: Some(Arc::new(faces)),
                });
            }
        }
        Ok(lamps)
    }

    /// The material of its faces, by its number in the scene, if it is a surface that shines.
    pub fn material(&self) -> Option<u32> {
        self.faces.as_ref().map(|faces| faces.material)
    }

    /// The greatest luminance of its faces [cd/m2], if it is a surface that shines: no surface gets more of its light than one would
    /// that such a luminance surrounds.
    pub fn glow(&self) -> Option<f64> {
        self.faces.as_ref().map(|faces| faces.brightest)
    }

    /// The luminance beside which it is seen, where open ground has `typical` [cd/m2]: the same as long as a twentieth of the light in the
    /// open meets it, which is day for the eye, and down to none in a room without windows. Nothing for lamps that are no surfaces.
    pub(super) fn seen_beside(&self, typical: f64) -> Option<f64> {
        let faces = self.faces.as_ref()?;
        Some((faces.openness / AS_OPEN).min(1.0) * typical)
    }

    /// Whether it gives any light at all.
    pub(super) fn shines(&self) -> bool {
        luminance(self.intensity) > 0.0 && self.distribution.peak() > 0.0
    }

    /// Why little or nothing of its light reaches the scene, if it does not.
    pub(super) fn is_dark(&self, all: &Geometry, ground: Option<f64>) -> Option<&'static str> {
        if !self.shines() {
            return Some("its intensity is 0");
        }
        if ground.is_some_and(|height| self.middle().y < height) {
            return Some("it lies under the ground");
        }
        const RAYS: u32 = 64;
        let spot = self.spots(1)[0];
        let geometry = self.geometry(all);
        let near = SHUT_IN.min(0.02 * geometry.extent());
        let cone = self.distribution.cone();
        let (mut whole, mut out) = (0.0, 0.0);
        for k in 0..RAYS {
            // Over the cone, each for as much of its solid angle.
            let down = 2.0 * (0.5 * cone).sin().powi(2) * (f64::from(k) + 0.5) / f64::from(RAYS);
            let theta = 2.0 * (0.5 * down).sqrt().min(1.0).asin();
            let direction = self.pose.direction(theta, GOLDEN_ANGLE * f64::from(k));
            let shape = self.shape(&spot, direction);
            let ray = Ray {
                origin: spot.position,
                direction,
            };
            whole += shape;
            if geometry.transmittance(&ray, 1e-9 * geometry.extent(), near) != DVec3::ZERO {
                out += shape;
            }
        }
        (out <= 0.01 * whole).then_some("nearly all of its light meets a surface right beside it")
    }

    /// What stands in the way of its light, of all that does.
    pub fn geometry<'a>(&'a self, all: &'a Geometry) -> &'a Geometry {
        self.housed.as_ref().map_or(all, |housed| &housed.without)
    }

    /// The material that does not shade it, if there is one.
    pub fn ignored(&self) -> Option<&str> {
        self.housed.as_ref().map(|housed| housed.material.as_str())
    }

    /// Luminous intensity of a spot of it along a direction away from it, of any length [cd, RGB].
    pub fn intensity(&self, spot: &Spot, direction: DVec3) -> DVec3 {
        self.shape(spot, direction) * self.intensity * spot.tint
    }

    /// The same for a lamp of 1 cd.
    pub fn shape(&self, spot: &Spot, direction: DVec3) -> f64 {
        let before = match spot.side {
            None => 1.0,
            Some((side, counts)) => match side.dot(direction) {
                cosine if cosine <= 0.0 => return 0.0,
                cosine if counts => cosine / direction.length(),
                _ => 1.0,
            },
        };
        spot.share * before * self.distribution.intensity(&self.pose, direction)
    }

    /// The most that it sends in any direction [cd, luminance].
    pub fn greatest_intensity(&self) -> f64 {
        luminance(self.intensity) * self.distribution.peak()
    }

    /// Luminous flux [lm, luminance]: of a rectangle of even intensity that of the side on which it shines; of another all that its
    /// distribution says; of faces pi times the intensity along their normals.
    pub fn flux(&self) -> f64 {
        let part = match (self.form, &self.distribution) {
            (LampForm::Rectangle { .. }, Distribution::Isotropic) => 0.5,
            (LampForm::Faces { .. }, _) => 0.25,
            _ => 1.0,
        };
        part * luminance(self.intensity) * self.distribution.flux()
    }

    /// The middle of it [m].
    pub fn middle(&self) -> DVec3 {
        match self.form {
            LampForm::Point | LampForm::Sphere { .. } | LampForm::Faces { .. } => self.position,
            LampForm::Line { to } => 0.5 * (self.position + to),
            LampForm::Rectangle { edges } => self.position + 0.5 * (edges[0] + edges[1]),
        }
    }

    /// How far it reaches from its middle [m]; 0 of a point.
    pub fn extent(&self) -> f64 {
        match self.form {
            LampForm::Point => 0.0,
            LampForm::Sphere { radius } | LampForm::Faces { radius } => radius,
            LampForm::Line { to } => 0.5 * self.position.distance(to),
            LampForm::Rectangle { edges: [a, b] } => 0.5 * (a + b).length().max((a - b).length()),
        }
    }

    /// In how many directions it extends: 0 of a point, 1 of a line, 2 of a rectangle or a sphere.
    pub fn dimensions(&self) -> u32 {
        match self.form {
            LampForm::Point => 0,
            LampForm::Line { .. } => 1,
            LampForm::Rectangle { .. } | LampForm::Sphere { .. } | LampForm::Faces { .. } => 2,
        }
    }

    /// The spot of a part of the lamp, which is laid out on the unit square: where it is there, and its size, each way, as seen from a
    /// place. Of a line the second coordinate counts for nothing, of a point neither.
    ///
    /// A sphere is as bright all over (Lambert 1760): it is divided into parts of equal solid angle of what the place sees of it.
    pub fn spot(&self, at: [f64; 2], size: f64, from: DVec3) -> Spot {
        let share = match self.dimensions() {
            0 => 1.0,
            1 => size,
            _ => size * size,
        };
        match self.form {
            // Faces have parts of their own: see `faces`.
            LampForm::Point | LampForm::Faces { .. } => Spot {
                position: self.position,
                side: None,
                share,
                radius: self.extent(),
                tint: DVec3::ONE,
            },
            LampForm::Line { to } => Spot {
                position: self.position.lerp(to, at[0]),
                side: None,
                share,
                radius: 0.5 * size * self.position.distance(to),
                tint: DVec3::ONE,
            },
            LampForm::Rectangle { edges: [a, b] } => {
                let normal = a.cross(b).normalize_or_zero();
                let side = normal * normal.dot(self.pose.toward).signum();
                Spot {
                    position: self.position + at[0] * a + at[1] * b,
                    side: Some((side, false)),
                    share,
                    radius: 0.5 * size * a.cross(b).length().sqrt(),
                    tint: DVec3::ONE,
                }
            }
            LampForm::Sphere { radius } => {
                let way = from - self.position;
                let distance = way.length();
                let Some(axis) = way.try_normalize().filter(|_| distance > radius) else {
                    return Spot {
                        position: self.position,
                        side: None,
                        share,
                        radius,
                        tint: DVec3::ONE,
                    };
                };
                // The cone of directions from the place to the sphere, and the point of the sphere that each meets first.
                let sin = radius / distance;
                let one_minus_cos = sin * sin / (1.0 + (1.0 - sin * sin).sqrt());
                let down = at[0] * one_minus_cos;
                let across = (down * (2.0 - down)).max(0.0).sqrt();
                let (y, x) = (TAU * at[1]).sin_cos();
                let (u, v) = axis.any_orthonormal_pair();
                let toward = (down - 1.0) * axis + across * (x * u + y * v);
                let along = -way.dot(toward);
                let inside = (radius * radius - (way + along * toward).length_squared()).max(0.0);
                let position = from + (along - inside.sqrt()) * toward;
                let square = position.distance_squared(from);
                // L dw = I / (pi r^2) dw, as an intensity over the square of the distance.
                let solid = TAU * one_minus_cos * share;
                Spot {
                    position,
                    side: None,
                    share: square * solid / (PI * radius * radius),
                    radius: 0.0,
                    tint: DVec3::ONE,
                }
            }
        }
    }

    /// Places that stand for the whole lamp wherever it is seen from, `count` each way: a beam each.
    pub fn spots(&self, count: u32) -> Vec<Spot> {
        if let Some(faces) = &self.faces {
            return faces.beams(count);
        }
        if let LampForm::Sphere { radius } = self.form {
            // On the sphere itself, each as bright as the cosine has it: 4 cos(theta) of a part of the sphere adds up to 1 on each side.
            let count = 2 * count * count;
            let spot = |k: u32| {
                let side = evenly(k, count);
                Spot {
                    position: self.position + radius * side,
                    side: Some((side, true)),
                    share: 4.0 / f64::from(count),
                    radius: 2.0 * radius / f64::from(count).sqrt(),
                    tint: DVec3::ONE,
                }
            };
            return match count {
                2 => vec![self.spot([0.5; 2], 1.0, self.position)],
                _ => (0..count).map(spot).collect(),
            };
        }
        let size = 1.0 / f64::from(count);
        let (across, down) = match self.dimensions() {
            0 => return vec![self.spot([0.5; 2], 1.0, self.position)],
            1 => (count, 1),
            _ => (count, count),
        };
        let cells = (0..down).flat_map(|j| (0..across).map(move |i| [i, j]));
        cells
            .map(|cell| {
                self.spot(
                    cell.map(|at| size * (f64::from(at) + 0.5)),
                    size,
                    self.position,
                )
            })
            .collect()
    }

    /// Places that stand for the lamp on a ray from its origin to a distance [m], if it is a surface that shines.
    pub fn faces_along(&self, ray: &Ray, end: f64, count: u32, found: impl FnMut(Spot)) {
        if let Some(faces) = &self.faces {
            faces.along(ray, end, count, found);
        }
    }

    /// Illuminance of a spot on a plane that faces it, if nothing stands in the way [lx, RGB].
    pub fn illuminance(&self, spot: &Spot, point: DVec3) -> DVec3 {
        let way = point - spot.position;
        let square = way.length_squared().max(spot.radius * spot.radius);
        self.intensity(spot, way) / square.max(NEAREST)
    }

    /// A spot as a beam of 1 cd all around.
    pub fn beam(spot: &Spot) -> Beam {
        Beam::Local {
            position: spot.position,
            intensity: DVec3::ONE,
            radius: spot.radius,
        }
    }

    /// Places of a ray [m], in order, where it may enter or leave what a spot shines on, or its light bends: cones, and its side.
    pub fn bends(&self, spot: &Spot, ray: &Ray) -> Vec<f64> {
        let Pose {
            toward,
            around,
            third,
        } = self.pose;
        let axes = DMat3::from_cols(around, third, toward);
        let of_cones = self.cone_weights().map(|weights| Some((axes, weights?)));
        let of_side = spot.side.map(|(side, _)| {
            let (u, v) = side.any_orthonormal_pair();
            (DMat3::from_cols(u, v, side), weights(FLAT, FLAT))
        });
        let mut bends: Vec<f64> = of_cones
            .into_iter()
            .chain([of_side])
            .flatten()
            .flat_map(|(axes, weights)| cone(spot.position, axes, weights, ray))
            .flatten()
            .collect();
        bends.sort_unstable_by(f64::total_cmp);
        bends
    }

    /// The quadratic forms, in the lamp's axes (around, third, toward), that are 0 on the cones where its light ends or bends.
    pub fn cone_weights(&self) -> [Option<DVec3>; 2] {
        let square = |half: f64| half.tan().powi(2).min(FLAT);
        let round = |half: f64| (half < PI).then(|| weights(square(half), square(half)));
        match self.distribution {
            Distribution::Elliptical { spread: [a, b], .. } => {
                [Some(weights(square(a), square(b))), None]
            }
            Distribution::Cone { inner, outer } => [round(outer), round(inner)],
            _ => [round(self.distribution.cone()), None],
        }
    }

    /// Whether a spot shines toward a place at all, for all that its cone and its side say.
    pub fn faces(&self, spot: &Spot, point: DVec3) -> bool {
        let way = point - spot.position;
        let before = spot.side.is_none_or(|(side, _)| side.dot(way) > 0.0);
        before && self.pose.angles(way).0 <= self.distribution.cone()
    }
}

/// The square of a tangent from which on a cone is a plane.
const FLAT: f64 = 1e24;

/// The quadratic form of the cone x^2 / a + y^2 / b = z^2; a and b are squares of tangents of half angles.
fn weights(a: f64, b: f64) -> DVec3 {
    // Scaled so that no term is beyond all bounds: a cone of no width is its axis, one of a right angle a plane.
    let scale = 1.0 + a.min(b);
    DVec3::new(-b, -a, a * b) / (scale * a.max(b).max(1.0))
}

/// Where a ray crosses the cone of a quadratic form in some axes around an apex, or its other half [m].
fn cone(apex: DVec3, axes: DMat3, weights: DVec3, ray: &Ray) -> [Option<f64>; 2] {
    // From the ray's point nearest to the apex: there the linear terms are small.
    let foot = (apex - ray.origin).dot(ray.direction);
    let into = axes.transpose();
    let (base, along) = (into * (ray.at(foot) - apex), into * ray.direction);
    let form = |p: DVec3, q: DVec3| (weights * p).dot(q);
    let (square, linear, constant) = (form(along, along), form(along, base), form(base, base));
    // linear^2 - square constant, without taking nearly equal numbers from each other (Lagrange's identity).
    let minor = |i: usize, j: usize| {
        let across = along[i] * base[j] - along[j] * base[i];
        weights[i] * weights[j] * across * across
    };
    let under = -(minor(0, 1) + minor(1, 2) + minor(2, 0));
    if under < 0.0 {
        return [None; 2];
    }
    let q = -(linear + linear.signum() * under.sqrt());
    let root = |top: f64, under: f64| Some(foot + top / under).filter(|t| t.is_finite());
    [root(q, square), root(constant, q)]
}

/// The casters of a scene but those of a material, made once for all lamps that ignore it.
fn geometry_without<'a>(
    scene: &Scene,
    material: &'a str,
    place: impl FnOnce() -> String,
    made: &mut Vec<(&'a str, Arc<Geometry>)>,
) -> Result<Arc<Geometry>> {
    if let Some((_, geometry)) = made.iter().find(|(name, _)| *name == material) {
        return Ok(geometry.clone());
    }
    let names = scene.materials.iter().map(|m| m.name.as_str());
    if !names.clone().any(|name| name == material) {
        let remedy = match nearest(material, names) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "the scene has no materials".to_owned(),
        };
        return Err(Error::input(
            place(),
            format!("the scene has no material `{material}`"),
            remedy,
        ));
    }
    let geometry = Arc::new(without(scene, material));
    made.push((material, geometry.clone()));
    Ok(geometry)
}

/// The casters of a scene but those of a material.
fn without(scene: &Scene, material: &str) -> Geometry {
    let mut rest = Scene {
        mesh: scene.mesh.clone(),
        materials: scene.materials.clone(),
        textures: scene.textures.clone(),
        ..Scene::default()
    };
    let is_kept = |index: u32| scene.materials[index as usize].name != material;
    rest.mesh.triangles.retain(|t| is_kept(t.material));
    Geometry::new(&rest)
}

fn check(name: &str, position: DVec3, intensity: DVec3) -> Result<()> {
    if !super::checks::near(position) {
        return Err(Error::domain(
            format!("light `{name}`: position"),
            format!("{position} m"),
            "-1e9 to 1e9 m in each coordinate",
            "give metres in the scene's axes",
        ));
    }
    if !(intensity.min_element() >= 0.0 && intensity.max_element() <= 1e15) {
        return Err(Error::domain(
            format!("light `{name}`: intensity"),
            format!("{intensity} cd"),
            "0 to 1e15 cd",
            "give candela; for a table, a factor",
        ));
    }
    Ok(())
}

fn check_form(name: &str, form: LampForm) -> Result<()> {
    let is_good = match form {
        LampForm::Point => true,
        LampForm::Line { to } => super::checks::near(to),
        LampForm::Rectangle { edges } => edges.into_iter().all(super::checks::near),
        LampForm::Sphere { radius } | LampForm::Faces { radius } => radius > 0.0 && radius <= 1e6,
    };
    match is_good {
        true => Ok(()),
        false => Err(Error::domain(
            format!("light `{name}`: its extent"),
            format!("{form:?}"),
            "up to 1e9 m, and a radius above 0 up to 1e6 m",
            "give metres in the scene's axes",
        )),
    }
}
