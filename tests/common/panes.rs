//! Panes for tests, and what they let through as found otherwise: by summing what goes to and fro within them, and by intersecting
//! rays with rectangles.

use super::build::{material, quad};
use glam::{DVec2, DVec3};
use tyndall::colour::Space;
use tyndall::scene::{Material, Pane, Ray, Scene, Texture, Triangle, Wrap};

/// What a surface of glass (n = 1.52) reflects of light across and along the plane of incidence: Fresnel's formulae by the angles.
fn reflected(angle: f64) -> [f64; 2] {
    if angle == 0.0 {
        return [(0.52f64 / 2.52).powi(2); 2];
    }
    let inside = (angle.sin() / 1.52).asin();
    let across = (angle - inside).sin() / (angle + inside).sin();
    let along = (angle - inside).tan() / (angle + inside).tan();
    [across * across, along * along]
}

/// What `count` panes do to light at an angle [rad], of an inner transmittance `a` along the normal, all that goes to and fro between
/// surfaces and panes added up term by term.
fn pile(angle: f64, a: f64, count: u32) -> f64 {
    let way = a.powf(1.0 / (angle.sin() / 1.52).asin().cos());
    let of = |r: f64| {
        let (mut through, mut back) = (0.0, r);
        let mut inside = 1.0 - r;
        for _ in 0..200_000 {
            inside *= way;
            through += inside * (1.0 - r);
            inside *= r * way;
            back += inside * (1.0 - r);
            inside *= r;
            if inside < 1e-18 {
                break;
            }
        }
        let (one, one_back) = (through, back);
        for _ in 1..count {
            let (mut further, mut more) = (0.0, 0.0);
            let mut between = through;
            for _ in 0..200_000 {
                further += between * one;
                between *= one_back;
                more += between * through;
                between *= back;
                if between < 1e-18 {
                    break;
                }
            }
            (through, back) = (further, back + more);
        }
        through
    };
    let [across, along] = reflected(angle);
    0.5 * (of(across) + of(along))
}

/// What `count` panes let through at an angle [rad] that let `normal` through along the normal.
pub fn glass(normal: f64, angle: f64, count: u32) -> f64 {
    if normal >= pile(0.0, 1.0, count) {
        return normal * pile(angle, 1.0, count) / pile(0.0, 1.0, count);
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match pile(0.0, middle, count) < normal {
            true => low = middle,
            false => high = middle,
        }
    }
    pile(angle, 0.5 * (low + high), count)
}

/// The same of a colour, linear Rec. 709, in the working space.
pub fn coloured(normal: DVec3, angle: f64, count: u32) -> DVec3 {
    let working = Space::Rec709.to_working() * normal;
    DVec3::from_array(
        working
            .to_array()
            .map(|share| glass(share.clamp(0.0, 1.0), angle, count)),
    )
}

/// A rectangle of glass: colours in columns, from its corner along its first edge.
#[derive(Clone)]
pub struct Window {
    pub corner: DVec3,
    pub edges: [DVec3; 2],
    pub factor: f64,
    /// sRGB.
    pub columns: Vec<[u8; 3]>,
    pub count: u32,
}

impl Window {
    /// Of one grey.
    pub fn plain(corner: DVec3, edges: [DVec3; 2], factor: f64) -> Self {
        Window {
            corner,
            edges,
            factor,
            columns: vec![[255; 3]],
            count: 1,
        }
    }

    /// Puts it into a scene.
    pub fn put_into(&self, scene: &mut Scene) {
        scene.textures.push(Texture {
            name: "tiles".into(),
            width: self.columns.len() as u32,
            height: 1,
            pixels: self
                .columns
                .iter()
                .map(|[r, g, b]| [*r, *g, *b, 255])
                .collect(),
            wrap: [Wrap::Repeat; 2],
        });
        scene.materials.push(Material {
            name: format!("glass {}", scene.materials.len()),
            pane: Some(Pane {
                transmittance: DVec3::splat(self.factor),
                image: Some(scene.textures.len() - 1),
                count: self.count,
                ..Pane::CLEAR
            }),
            ..material(0.5)
        });
        let [a, b] = self.edges;
        let uvs = [
            [0.0, 0.0],
            [1.0, 0.0],
            [0.0, 1.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
        ];
        let mesh = &mut scene.mesh;
        for corners in quad(self.corner, a, b) {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            mesh.normals.extend([DVec3::ZERO; 3]);
            mesh.triangles.push(Triangle {
                vertices: [first, first + 1, first + 2],
                material: scene.materials.len() as u32 - 1,
            });
        }
        mesh.uvs.extend(uvs.map(DVec2::from_array));
    }

    /// Where a ray crosses it [m], in which column, and at which angle to its normal.
    pub fn crossed(&self, ray: &Ray) -> Option<(f64, usize, f64)> {
        let [a, b] = self.edges;
        let normal = a.cross(b).normalize();
        let cosine = normal.dot(ray.direction);
        let distance = (self.corner - ray.origin).dot(normal) / cosine;
        let at = ray.at(distance) - self.corner;
        let u = at.dot(a) / a.length_squared();
        let v = at.dot(b) / b.length_squared();
        let is_met = distance > 0.0 && (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v);
        let column = (u * self.columns.len() as f64) as usize;
        is_met.then_some((distance, column, cosine.abs().min(1.0).acos()))
    }

    /// The colour of a column, linear Rec. 709.
    pub fn colour(&self, column: usize) -> DVec3 {
        let linear = |c: u8| match f64::from(c) / 255.0 {
            low if low <= 0.04045 => low / 12.92,
            c => ((c + 0.055) / 1.055).powf(2.4),
        };
        self.factor * DVec3::from_array(self.columns[column].map(linear))
    }

    /// What is left of light along a ray up to a distance [m].
    pub fn leaves(&self, ray: &Ray, far: f64) -> DVec3 {
        match self.crossed(ray).filter(|(distance, ..)| *distance < far) {
            Some((_, column, angle)) => coloured(self.colour(column), angle, self.count),
            None => DVec3::ONE,
        }
    }
}
