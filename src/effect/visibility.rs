//! The first surface on each ray: distance, normals, reflectance.
//!
//! Triangles come first; rays that miss them all and point below the horizon meet the endless ground plane. A texture is read
//! at its nearest texel, in linear light. Both sides of a triangle reflect; normals face the eye. The interpolated normal is
//! used for shading where it agrees with the triangle about which side the eye is on.
//!
//! Of a surface that lets 1 - a of the light through, a share a of a pixel's samples meets it, and the others what is behind it
//! ([`crate::scene::opacity::choice`]): the mean over a pixel is a L1 + (1 - a) L2, and one sample shows one or the other.

use super::{
    Contribution, Decision, Effect, Field, Knob, Over, Pass, RasterView, Resource, Source, Surface,
    When,
};
use crate::colour::Space;
use crate::conditions::{Conditions, Receivers, View};
use crate::scene::{Hit, Ray, opacity::choice};
use glam::{DMat3, DVec3, UVec2};

/// The first surface on each ray.
pub const VISIBILITY: Effect = Effect {
    name: "visibility",
    summary: "the first surface on each ray",
    writes: &[Field::Surface],
    knobs: &[Knob {
        name: "silhouettes",
        meaning: "1: rays at silhouettes are traced (GPU); 0: those pixels are as the rasteriser rounds",
        values: [0.0, 1.0, 1.0, 1.0],
        range: [0.0, 1.0],
    }],
    decide: |conditions| {
        Decision::run(
            format!(
                "{} triangles{}",
                conditions.geometry.triangle_count(),
                if conditions.ground.is_some() {
                    " and a ground"
                } else {
                    ""
                }
            ),
            Contribution::Everything,
        )
    },
    reference: |conditions, _, _| {
        let working_from_rec709 = Space::Rec709.to_working();
        Ok(Box::new(move |fields| {
            let places = fields.rays.iter().zip(&fields.pixels).zip(&fields.samples);
            for (((ray, pixel), sample), surface) in places.zip(&mut fields.surfaces) {
                *surface = match conditions.view.receivers {
                    Receivers::Pixels => {
                        let choice = choice(pixel.to_array(), *sample);
                        first_surface(conditions, ray, choice, working_from_rec709)
                    }
                    Receivers::Points(_) => receiver_surface(&conditions.view, *pixel),
                };
            }
        }))
    },
    passes: &[
        Pass {
            shader: SHADER,
            entry: "picture",
            over: Over::Raster(RasterView::Camera(|settings| {
                settings.get("silhouettes") > 0.5
            })),
            when: When::Tile,
            uses: &[
                Resource::Attributes,
                Resource::Facets,
                Resource::Materials,
                Resource::Texels,
            ],
        },
        Pass {
            shader: SHADER,
            entry: "resolve",
            over: Over::Pixels,
            when: When::Tile,
            uses: &[
                Resource::Attributes,
                Resource::Facets,
                Resource::Materials,
                Resource::Texels,
                Resource::Corners,
                Resource::Numbers,
                Resource::Update(Field::Surface),
            ],
        },
    ],
    ..Effect::NOTHING
};

const SHADER: &str = include_str!("../../shaders/visibility.wgsl");

/// The point whose illuminance a pixel holds, as a surface; nothing where the picture has more pixels than points.
pub fn receiver_surface(view: &View, pixel: UVec2) -> Surface {
    view.point(pixel).map_or(Surface::NOTHING, |point| {
        Surface::receiver(point, point.position.distance(view.camera.eye))
    })
}

/// What a ray shows first; of surfaces that let light through, what `choice` falls to ([`choice`]).
pub fn first_surface(
    conditions: &Conditions,
    ray: &Ray,
    choice: f64,
    working_from_rec709: DMat3,
) -> Surface {
    if let Some(hit) = conditions.geometry.seen(ray, choice) {
        return triangle_surface(conditions, ray, &hit, working_from_rec709);
    }
    ground_surface(conditions, ray)
}

/// What a ray meets that meets no triangle: the ground, or nothing.
pub fn ground_surface(conditions: &Conditions, ray: &Ray) -> Surface {
    match &conditions.ground {
        Some(ground) if ray.direction.y < 0.0 && ray.origin.y > ground.height => {
            let distance = (ray.origin.y - ground.height) / -ray.direction.y;
            let mut position = ray.at(distance);
            position.y = ground.height;
            Surface {
                source: Source::Ground,
                distance,
                position,
                normal: DVec3::Y,
                facet: DVec3::Y,
                albedo: ground.albedo,
            }
        }
        _ => Surface::NOTHING,
    }
}

/// The place of a triangle of the scene that a ray meets, when it is known to meet that one first; the nearest place of the
/// triangle if it passes by a hair.
pub fn known_surface(
    conditions: &Conditions,
    ray: &Ray,
    triangle: u32,
    working_from_rec709: DMat3,
) -> Surface {
    let mesh = &conditions.scene.mesh;
    let [a, b, c] = mesh.triangles[triangle as usize]
        .vertices
        .map(|i| mesh.positions[i as usize] - ray.origin);
    let (e, f) = (b - a, c - a);
    let edge = e.cross(f);
    let across = edge.dot(ray.direction);
    let distance = if across == 0.0 {
        a.dot(ray.direction)
    } else {
        edge.dot(a) / across
    };
    let p = distance * ray.direction - a;
    let square = edge.length_squared();
    let v = (p.cross(f).dot(edge) / square).clamp(0.0, 1.0);
    let w = (e.cross(p).dot(edge) / square).clamp(0.0, 1.0 - v);
    let hit = Hit {
        distance: (a + v * e + w * f).dot(ray.direction).max(0.0),
        triangle,
        barycentric: [v, w],
    };
    triangle_surface(conditions, ray, &hit, working_from_rec709)
}

fn triangle_surface(
    conditions: &Conditions,
    ray: &Ray,
    hit: &Hit,
    working_from_rec709: DMat3,
) -> Surface {
    let mesh = &conditions.scene.mesh;
    let triangle = &mesh.triangles[hit.triangle as usize];
    let [v, w] = hit.barycentric;
    let weights = [1.0 - v - w, v, w];
    let corners = triangle.vertices.map(|i| mesh.positions[i as usize]);
    let mix = |values: [DVec3; 3]| {
        values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
    };
    let edge = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let facet = edge.normalize_or_zero();
    let facet = if facet.dot(ray.direction) > 0.0 {
        -facet
    } else {
        facet
    };
    let smooth = mix(triangle.vertices.map(|i| mesh.normals[i as usize]));
    let normal = match smooth.try_normalize() {
        Some(n) if n.dot(edge) * facet.dot(edge) < 0.0 => -n,
        Some(n) => n,
        None => facet,
    };
    let color = conditions.scene.base_color(hit.triangle, hit.barycentric);
    Surface {
        source: Source::Triangle(hit.triangle, hit.barycentric),
        distance: hit.distance,
        position: ray.at(hit.distance),
        normal,
        facet,
        albedo: (working_from_rec709 * color).max(DVec3::ZERO),
    }
}
