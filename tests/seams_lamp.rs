//! Light of a lamp, the seam on which lamps will be hung: local beams with their own shadow maps against the fan of exact shadows.

mod common;

use common::build::*;
use common::own_effects::*;
use glam::DVec3;
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::backend::{Limits, Rendered};
use tyndall::beam::Beam;
use tyndall::conditions::Conditions;
use tyndall::effect::{
    Batch, Contribution, Decision, Effect, Field, Keeper, Number, Over, Pass, Resource, Settings,
    When,
};
use tyndall::medium::Scattering;
use tyndall::plan::{Overrules, Plan};
use tyndall::scene::shade::complement;

const LAMP: DVec3 = DVec3::new(0.3, 2.6, 0.2);

/// Cells of a square face of 0.2 m that looks down, each a quarter of the light.
fn cells(_: &Conditions, _: &Settings<'_>) -> Vec<Beam> {
    [(-0.05, -0.05), (0.05, -0.05), (-0.05, 0.05), (0.05, 0.05)]
        .map(|(x, z)| Beam::Local {
            position: LAMP + DVec3::new(x, 0.0, z),
            intensity: DVec3::new(100.0, 80.0, 60.0),
            radius: 0.056,
        })
        .to_vec()
}

const LAMP_GLOW: Effect = Effect {
    name: "lamp_glow",
    summary: "light of a lamp scattered by the air",
    reads: &[Field::Surface],
    writes: &[Field::InscatterLights],
    knobs: &[tyndall::effect::Knob {
        name: "steps",
        meaning: "steps along each ray",
        values: [1024.0; 4],
        range: [1.0, 65536.0],
    }],
    decide: |_| Decision::run("a test", Contribution::Bound(1e6)),
    reference: lamp_reference,
    passes: &[LAMP_PASS],
    ..Effect::NOTHING
};

const LAMP_PASS: Pass = Pass {
    shader: "
            @compute @workgroup_size(8, 8)
            fn glow(@builtin(global_invocation_id) id: vec3u) {
                if !inside_tile(id) {
                    return;
                }
                let i = pixel_index(id);
                let origin = ray_origin(id);
                let direction = ray_direction(id);
                let air = air_span(origin, direction);
                let end = min(ray_end(surfaces[i], origin, direction), air.y);
                // Even steps of the angle that the lamp sees: there is no peak in it.
                let foot = dot(beam.position - origin, direction);
                let aside = max(length(beam.position - origin - foot * direction), beam.extent);
                let first = atan2(air.x - foot, aside);
                let step = (atan2(end - foot, aside) - first) / f32(knobs.steps);
                var sum = vec3f(0.0);
                for (var k = 0u; k < knobs.steps && end > air.x; k++) {
                    let angle = first + (f32(k) + 0.5) * step;
                    let t = foot + aside * tan(angle);
                    let p = origin + t * direction;
                    if !beam_reaches(p) {
                        continue;
                    }
                    let length = aside * step / (cos(angle) * cos(angle));
                    sum += beam_scattered(origin, direction, t, ALL_MEDIA) * length;
                }
                inscatter_lights[i] += vec4f(sum, 0.0);
            }",
    entry: "glow",
    over: Over::Pixels,
    when: When::EachBeam(cells),
    uses: &[
        Resource::Read(Field::Surface),
        Resource::Update(Field::InscatterLights),
        Resource::Knobs(|_, settings| vec![("steps", Number::count(settings.get("steps")))]),
    ],
};

fn lamp_reference<'a>(
    conditions: &'a Conditions,
    settings: &Settings<'_>,
    _: &Keeper<'_>,
) -> tyndall::Result<Batch<'a>> {
    let beams = cells(conditions, settings);
    let air = &conditions.air;
    Ok(Box::new(move |fields| {
        let mut dark = Vec::new();
        fields.update(Field::InscatterLights, |ray, _, surface, present| {
            let end = surface.distance.min(air.end(ray.origin, ray.direction));
            conditions.geometry.dark_runs(ray, end, &beams, &mut dark);
            let mut sum = DVec3::ZERO;
            for (beam, dark) in beams.iter().zip(&dark) {
                let scattering = Scattering::new(air, ray.origin, ray.direction, end, beam);
                for [from, to] in complement(dark, end) {
                    sum += beam.strength() * scattering.integrate(from, to);
                }
            }
            present + sum
        });
    }))
}

#[test]
fn a_lamp_of_finite_extent_has_its_own_shadow_maps() {
    if !common::gpu("a_lamp_of_finite_extent_has_its_own_shadow_maps") {
        return;
    }
    let seen = conditions(lamp_scene(), camera(), [96, 64]);
    let set = [("shadow.resolution", 8192.0)];
    let both = plan(&seen, &[&LAMP_GLOW], &set);
    let of = |rendered: &Rendered| layer(&rendered.frame, Field::InscatterLights);
    let truth = of(&by_reference(&both));
    let rendered = on_gpu(&both);
    // Those of the sun, and six faces for each of four cells.
    assert!(rendered.made.maps > 24, "{}", rendered.made.maps);
    let found = of(&rendered);
    let off = apart(&found, &truth);
    eprintln!("lamp: {off:.4}");
    assert!(off < 0.01, "{off}");
    // The sun's own light is as it is without the lamp.
    let alone = on_gpu(&plan(&seen, &[], &set));
    assert_eq!(
        layer(&alone.frame, Field::InscatterSun),
        layer(&rendered.frame, Field::InscatterSun)
    );
    // Without the roof there is more light: that shadows are left out is noticed.
    let mut open = lamp_scene();
    open.mesh.triangles.truncate(12);
    let open = conditions(open, camera(), [96, 64]);
    let open = of(&on_gpu(&plan(&open, &[&LAMP_GLOW], &set)));
    assert!(apart(&open, &truth) > 0.2);
}

#[test]
fn a_lamp_has_shadows_at_night() {
    if !common::gpu("a_lamp_has_shadows_at_night") {
        return;
    }
    let mut night = lamp_scene();
    night.sun.as_mut().expect("it has a sun").elevation_deg = -20.0;
    let night = conditions(night, camera(), [48, 32]);
    let plan = plan(&night, &[&LAMP_GLOW], &[("shadow.resolution", 4096.0)]);
    assert!(plan.running().any(|step| step.effect.draws_maps()));
    let of = |rendered: &Rendered| layer(&rendered.frame, Field::InscatterLights);
    let off = apart(&of(&on_gpu(&plan)), &of(&by_reference(&plan)));
    assert!(off < 0.02, "{off}");
    // Without anybody who asks there are no maps.
    let alone = Plan::new(&night, &Overrules::default()).expect("it is sound");
    assert!(!alone.running().any(|step| step.effect.draws_maps()));
}

#[test]
fn maps_of_a_lamp_that_goes_with_the_eye_are_drawn_again() {
    if !common::gpu("maps_of_a_lamp_that_goes_with_the_eye_are_drawn_again") {
        return;
    }
    const CARRIED: Effect = Effect {
        name: "carried",
        passes: &[Pass {
            when: When::EachBeam(|conditions, _| {
                let eye = conditions.view.camera.eye;
                vec![Beam::local(eye + 0.5 * DVec3::Y, DVec3::splat(100.0))]
            }),
            ..LAMP_PASS
        }],
        ..LAMP_GLOW
    };
    let first = conditions(lamp_scene(), camera(), [48, 32]);
    let mut view = first.view.clone();
    view.camera.eye += DVec3::new(-0.7, -0.3, -1.5);
    let moved = first.seen_from(view).expect("a view");
    let set = [("shadow.resolution", 4096.0)];
    let plans = [&first, &moved].map(|seen| plan(seen, &[&CARRIED], &set));
    let of = |rendered: &Rendered| layer(&rendered.frame, Field::InscatterLights);
    let render = |gpu: &mut Gpu, plan: &Plan| {
        let rendered = gpu.render(plan, &Limits::default(), &|_| {});
        of(&rendered.expect("the device works"))
    };
    let mut lasting = Gpu::open(Choice::Any).expect("there is an adapter");
    render(&mut lasting, &plans[0]);
    let kept = render(&mut lasting, &plans[1]);
    let mut fresh = Gpu::open(Choice::Any).expect("there is an adapter");
    let truth = render(&mut fresh, &plans[1]);
    assert!(apart(&kept, &truth) < 1e-4, "{}", apart(&kept, &truth));
}

#[test]
fn the_fan_of_a_lamp_agrees_with_shadow_rays() {
    let seen = conditions(lamp_scene(), camera(), [24, 16]);
    let geometry = &seen.geometry;
    let mut checked = 0;
    let mut dark = Vec::new();
    for (k, lamp) in [LAMP, DVec3::new(-1.0, 0.8, 0.0), DVec3::new(0.0, 9.0, 1.0)]
        .into_iter()
        .enumerate()
    {
        let beams = [Beam::local(lamp, DVec3::ONE)];
        for y in 0..16 {
            for x in 0..24 {
                let at = glam::DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let ray = seen.view.ray(at);
                let far = 14.0;
                geometry.dark_runs(&ray, far, &beams, &mut dark);
                for i in 0..200 {
                    let t = far * (f64::from(i) + 0.5) / 200.0;
                    let point = ray.at(t);
                    let shadow = tyndall::scene::Ray {
                        origin: point,
                        direction: (lamp - point).normalize(),
                    };
                    let border = dark[0]
                        .iter()
                        .flatten()
                        .any(|border| (border - t).abs() < 1e-6);
                    if border {
                        continue;
                    }
                    let runs = dark[0].iter();
                    let is_dark = runs.clone().any(|[from, to]| (*from..*to).contains(&t));
                    let hidden = geometry.occluded(&shadow, 1e-9, point.distance(lamp));
                    assert_eq!(is_dark, hidden, "lamp {k}, ray {x} {y}, t {t}: {dark:?}");
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 200_000, "{checked}");
    // The lamp on the ray itself: dark behind the first thing on either side of it.
    let ray = tyndall::scene::Ray {
        origin: DVec3::new(0.2, 5.0, 0.0),
        direction: DVec3::NEG_Y,
    };
    let on_ray = [Beam::local(DVec3::new(0.2, 3.0, 0.0), DVec3::ONE)];
    geometry.dark_runs(&ray, 8.0, &on_ray, &mut dark);
    let [run] = dark[0][..] else {
        panic!("one dark run: {dark:?}");
    };
    let hit = geometry
        .closest(&ray, 0.0, 8.0)
        .expect("there is something below");
    assert!(
        (run[0] - hit.distance).abs() < 1e-9 && run[1] == 8.0,
        "{run:?}"
    );
}
