//! Small effects that try the joints on which others will be hung: one that iterates on the device until a condition holds and
//! keeps its result, one lit by a local beam, one on the CPU between two of the GPU, one that looks through a hemicube.

mod common;

use common::build::*;
use common::shafts::gpu;
use glam::DVec3;
use std::f64::consts::PI;
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Rendered};
use tyndall::beam::Beam;
use tyndall::conditions::{Conditions, Input};
use tyndall::effect::{
    ALL, Batch, Contribution, Decision, Effect, Extent, Field, Kept, Loop, Number, Over, Pass,
    Product, RasterView, Resource, Settings, When,
};
use tyndall::medium::{Phase, Scattering, Shape};
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::curtain::complement;
use tyndall::scene::{Camera, Scene};
use tyndall::studies::scenes::{cuboid, fog, quad};

/// The effects of the project with others before the last, which takes light through the air to the eye.
fn with(own: &[&'static Effect]) -> Vec<&'static Effect> {
    let (last, before) = ALL.split_last().expect("there are effects");
    [before, own, &[*last]].concat()
}

fn plan<'c>(conditions: &'c Conditions, own: &[&'static Effect], set: &[(&str, f64)]) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::Draft,
        set: set.iter().map(|(k, v)| (k.to_string(), *v)).collect(),
        ..Overrules::default()
    };
    Plan::with(conditions, &overrules, &with(own)).expect("the effects fit together")
}

fn on_gpu(plan: &Plan) -> Rendered {
    let rendered = gpu().render(plan, &Limits::default(), &|_| {});
    let rendered = rendered.expect("the device works");
    rendered.frame.check().expect("every value is sound");
    rendered
}

fn by_reference(plan: &Plan) -> Rendered {
    let rendered = Reference::new(plan).render(&Limits::default(), &|_| {});
    rendered.expect("it fits into memory")
}

fn runs(rendered: &Rendered, pass: &str) -> u32 {
    let step = rendered.steps.iter().find(|step| step.pass == pass);
    step.expect("the pass is there").runs
}

/// A floor and a roof over a part of it, with a place and a time.
fn shelter() -> Scene {
    let mut triangles = cuboid(DVec3::new(-4.0, -0.2, -4.0), DVec3::new(4.0, 0.0, 4.0));
    triangles.extend(cuboid(
        DVec3::new(-2.0, 2.0, -2.0),
        DVec3::new(0.0, 2.1, 2.0),
    ));
    let mut scene = scene(&triangles, 140.0, 50.0);
    scene.ground.enabled = false;
    scene
}

fn camera() -> Camera {
    Camera::look_at(
        DVec3::new(0.5, 1.2, 6.0),
        DVec3::new(0.0, 1.0, 0.0),
        60.0 * PI / 180.0,
    )
}

// Heat along a rod whose ends are held at 0 and 1: relaxed until nothing changes by more than the tolerance, it rises evenly.

const PLACES: u64 = 24;

const ROD: Product = Product {
    name: "rod",
    wgsl: "array<f32>",
    bytes: |_| 4 * PLACES,
    reads: &[Input::Geometry],
    zeroed: true,
};

const CHANGE: Product = Product {
    name: "change",
    wgsl: "array<atomic<u32>, 4>",
    bytes: |_| 16,
    reads: &[Input::Geometry],
    zeroed: true,
};

const SETTLED: Loop = Loop {
    condition: &CHANGE,
    holds: |found, settings| f64::from(f32::from_bits(found[0])) < settings.get("tolerance"),
    turns: 16,
    most: |_| 100_000,
};

const fn of_rod(entry: &'static str, when: When) -> Pass {
    Pass {
        shader: "
            @compute @workgroup_size(1)
            fn heat() {
                rod[23] = 1.0;
            }

            // Even and odd places in turns.
            @compute @workgroup_size(1)
            fn relax() {
                atomicStore(&change[0], 0u);
                for (var parity = 0u; parity < 2u; parity++) {
                    for (var i = 1u + parity; i < 23u; i += 2u) {
                        let next = 0.5 * (rod[i - 1u] + rod[i + 1u]);
                        atomicMax(&change[0], bitcast<u32>(abs(next - rod[i])));
                        rod[i] = next;
                    }
                }
            }

            @compute @workgroup_size(8, 8)
            fn show(@builtin(global_invocation_id) id: vec3u) {
                if inside_tile(id) {
                    let x = (tile.corner.x + id.x) % 24u;
                    lights[pixel_index(id)] += vec4f(vec3f(rod[x]), 0.0);
                }
            }",
        entry,
        over: Over::Groups(|_| [1, 1]),
        when,
        uses: &[Resource::Make(&ROD), Resource::Make(&CHANGE)],
    }
}

const RELAXED: Effect = Effect {
    name: "relaxed",
    summary: "heat along a rod",
    writes: &[Field::Lights],
    knobs: &[tyndall::effect::Knob {
        name: "tolerance",
        meaning: "change of a turn at which it is settled",
        values: [1e-6; 4],
        range: [1e-7, 1.0],
    }],
    decide: |_| Decision::run("a test", Contribution::Bound(1.0)),
    passes: &[
        of_rod("heat", When::Once),
        of_rod("relax", When::Until(&SETTLED)),
        Pass {
            over: Over::Pixels,
            uses: &[Resource::Make(&ROD), Resource::Update(Field::Lights)],
            ..of_rod("show", When::Tile)
        },
    ],
    ..Effect::NOTHING
};

#[test]
fn an_effect_iterates_until_it_is_done_and_keeps_what_it_found_over_tiles_and_moments() {
    if !common::gpu("an_effect_iterates_until_it_is_done") {
        return;
    }
    // A device of its own: what is kept must not go with other tests' scenes.
    let mut own = Gpu::open(Choice::Any).expect("there is an adapter");
    let mut on_gpu = |plan: &Plan| {
        let rendered = own.render(plan, &Limits::default(), &|_| {});
        rendered.expect("the device works")
    };
    // Two tiles of 512 pixels.
    let mut scene = shelter();
    scene.sun = None;
    scene.site = Some(tyndall::scene::SiteEntry {
        latitude_deg: 47.0,
        longitude_deg: 8.0,
        elevation: 400.0,
        timezone: Some("Europe/Zurich".into()),
    });
    scene.time = Some("2026-06-21T10:00:00+02:00".into());
    let first = conditions(scene, camera(), [600, 8]);
    let rendered = on_gpu(&plan(&first, &[&RELAXED], &[]));
    assert!(rendered.made.products.contains(&"rod"));
    let turns = runs(&rendered, "relax");
    assert!(turns > 200 && turns.is_multiple_of(16), "{turns}");
    assert_eq!(runs(&rendered, "heat"), 1);
    assert_eq!(runs(&rendered, "show"), 2);
    let even = |rendered: &Rendered, within: f64| {
        for (i, value) in layer(&rendered.frame, Field::Lights).iter().enumerate() {
            let exact = (i % 600 % 24) as f64 / 23.0;
            assert!((value.x - exact).abs() < within, "{i}: {value} {exact}");
        }
    };
    even(&rendered, 1e-3);

    // Another moment, another eye: what was made of geometry alone is still there.
    let later = first.at("2026-06-21T17:00:00+02:00").expect("a time");
    let mut view = later.view.clone();
    view.camera.eye.x += 0.3;
    let later = later.seen_from(view).expect("a view");
    let rendered = on_gpu(&plan(&later, &[&RELAXED], &[]));
    assert_eq!(runs(&rendered, "relax"), 0);
    assert!(!rendered.made.products.contains(&"rod"));
    even(&rendered, 1e-3);

    // A knob that it depends on, or another scene: made anew, from the beginning.
    let coarse = on_gpu(&plan(&later, &[&RELAXED], &[("relaxed.tolerance", 1e-2)]));
    assert!(runs(&coarse, "relax") < turns && runs(&coarse, "relax") > 0);
    let off = layer(&coarse.frame, Field::Lights)[12].x - 12.0 / 23.0;
    assert!(off.abs() > 0.05, "{off}");
    let mut other = shelter();
    other.mesh.positions[0].x -= 0.1;
    let other = conditions(other, camera(), [600, 8]);
    assert!(runs(&on_gpu(&plan(&other, &[&RELAXED], &[])), "relax") > 200);
}

// A lamp of finite extent under a slotted roof, in fog: local beams with their own shadow maps against the fan of exact shadows.

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
    passes: &[Pass {
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
                    let toward = beam_toward(p);
                    let apart = direction - toward;
                    var source = vec3f(0.0);
                    for (var m = 0u; m < tile.media; m++) {
                        let there = select(0.0, 1.0, inside(media[m], p));
                        source += there * source_of(media[m], 0.5 * dot(apart, apart), ALL_MEDIA);
                    }
                    let depth = optical_depth(origin, direction, t, ALL_MEDIA)
                        + optical_depth(p, toward, length(beam.position - p), ALL_MEDIA);
                    let length = aside * step / (cos(angle) * cos(angle));
                    sum += source * exp(-depth) * beam_illuminance(p) * length;
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
    }],
    ..Effect::NOTHING
};

fn lamp_reference<'a>(conditions: &'a Conditions, settings: &Settings<'_>, _: &Kept) -> Batch<'a> {
    let beams = cells(conditions, settings);
    let air = &conditions.air;
    Box::new(move |fields| {
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
    })
}

/// A slotted roof between the lamp and the floor, in fog.
fn lamp_scene() -> Scene {
    let mut triangles = cuboid(DVec3::new(-4.0, -0.2, -4.0), DVec3::new(4.0, 0.0, 4.0));
    for i in 0..6 {
        let x = -2.0 + 0.8 * f64::from(i);
        triangles.extend(cuboid(
            DVec3::new(x, 1.6, -1.5),
            DVec3::new(x + 0.4, 1.7, 1.5),
        ));
    }
    let mut scene = scene(&triangles, 140.0, 50.0);
    scene.ground.enabled = false;
    let shape = Shape::Box {
        min: DVec3::new(-4.0, 0.0, -4.0),
        max: DVec3::new(4.0, 4.0, 4.0),
    };
    scene.media = vec![fog(shape, 0.08, 0.02, Phase::HenyeyGreenstein { g: 0.4 })];
    scene
}

/// Relative RMSE over the second channel.
fn apart(found: &[DVec3], truth: &[DVec3]) -> f64 {
    let mean = truth.iter().map(|v| v.y).sum::<f64>() / truth.len() as f64;
    let square = found.iter().zip(truth).map(|(a, b)| (a.y - b.y).powi(2));
    (square.sum::<f64>() / truth.len() as f64).sqrt() / mean
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

// On the CPU, between two effects of the GPU: light of surfaces, doubled and dimmed by the air's transmittance, goes on.

const BEFORE: Effect = Effect {
    name: "before",
    summary: "surfaces glow by their distance",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Bound(1e3)),
    reference: |_, _, _| {
        Box::new(|fields| {
            fields.update(Field::Lights, |_, _, surface, present| {
                present
                    + DVec3::splat(if surface.is_met() {
                        surface.distance
                    } else {
                        0.0
                    })
            });
        })
    },
    passes: &[Pass {
        shader: "
            @compute @workgroup_size(8, 8)
            fn before(@builtin(global_invocation_id) id: vec3u) {
                if inside_tile(id) {
                    let i = pixel_index(id);
                    let met = select(0.0, surfaces[i].distance, surfaces[i].number != NOTHING);
                    lights[i] += vec4f(vec3f(met), 0.0);
                }
            }",
        entry: "before",
        over: Over::Pixels,
        when: When::Tile,
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::Lights),
        ],
    }],
    ..Effect::NOTHING
};

const BETWEEN: Effect = Effect {
    name: "between",
    summary: "doubles the light of surfaces and takes the air's share of it",
    reads: &[Field::Lights, Field::Transmittance],
    alters: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Bound(1e3)),
    reference: |_, _, _| {
        Box::new(|fields| {
            fields.update(Field::Lights, |_, _, _, present| 2.0 * present);
            fields.multiply(Field::Lights, Field::Transmittance);
        })
    },
    ..Effect::NOTHING
};

const BEHIND: Effect = Effect {
    name: "behind",
    summary: "what the CPU made of it, once more",
    reads: &[Field::Lights],
    writes: &[Field::InscatterLights],
    decide: |_| Decision::run("a test", Contribution::Bound(1e3)),
    reference: |_, _, _| {
        Box::new(|fields| {
            let lights = fields.get(Field::Lights).map(<[DVec3]>::to_vec);
            let mut lights = lights.into_iter().flatten();
            fields.update(Field::InscatterLights, |_, _, _, present| {
                present + 0.5 * lights.next().unwrap_or_default()
            });
        })
    },
    passes: &[Pass {
        shader: "
            @compute @workgroup_size(8, 8)
            fn behind(@builtin(global_invocation_id) id: vec3u) {
                if inside_tile(id) {
                    let i = pixel_index(id);
                    inscatter_lights[i] += 0.5 * lights[i];
                }
            }",
        entry: "behind",
        over: Over::Pixels,
        when: When::Tile,
        uses: &[
            Resource::Read(Field::Lights),
            Resource::Update(Field::InscatterLights),
        ],
    }],
    ..Effect::NOTHING
};

#[test]
fn the_cpu_works_between_effects_of_the_gpu_on_what_these_left() {
    if !common::gpu("the_cpu_works_between_effects_of_the_gpu") {
        return;
    }
    let seen = conditions(lamp_scene(), camera(), [64, 48]);
    // Each rasteriser rounds pixels at silhouettes its own way.
    let exact = [("visibility.silhouettes", 1.0)];
    let plan = plan(&seen, &[&BEFORE, &BETWEEN, &BEHIND], &exact);
    let truth = by_reference(&plan);
    let found = on_gpu(&plan);
    for field in [Field::Lights, Field::InscatterLights] {
        let (found, truth) = (layer(&found.frame, field), layer(&truth.frame, field));
        let off = apart(&found, &truth);
        eprintln!("{field:?}: {off:.1e}");
        assert!(off < 1e-5, "{field:?}: {off}");
    }
    // It is what was meant: 2 x tau / 2, seen through nothing more, where light of surfaces is once more dimmed.
    let transmittance = &truth.frame.transmittance;
    let air = layer(&truth.frame, Field::InscatterLights);
    for (i, value) in air.iter().enumerate().step_by(7) {
        let distance = f64::from(truth.frame.depth[i]);
        if distance < 1e9 {
            let exact = distance * f64::from(transmittance[i].y);
            assert!((value.y / exact - 1.0).abs() < 1e-5, "{i}: {value} {exact}");
        }
    }
    let step = found.steps.iter().find(|s| s.effect.name == "between");
    assert!(step.expect("it ran").on_cpu);
}

// The share of the sky that a square plate over a point hides, through a hemicube.

// Software drivers end loops at 65 535 turns: five faces of 96 squared are 46 080.
const SIDE: u32 = 96;

const SEEN: Product = Product {
    name: "seen",
    wgsl: "array<f32>",
    bytes: |_| 16,
    reads: &[Input::Geometry],
    zeroed: true,
};

const PLATE_SHADER: &str = "
    // From the origin upward: face 0 looks up, the others to the sides.
    fn turned(p: vec3f, face: u32) -> vec3f {
        switch face {
            case 0u: { return vec3f(p.x, p.z, p.y); }
            case 1u: { return vec3f(p.z, p.y, p.x); }
            case 2u: { return vec3f(p.z, p.y, -p.x); }
            case 3u: { return vec3f(p.x, p.y, p.z); }
            default: { return vec3f(p.x, p.y, -p.z); }
        }
    }

    struct Drawn {
        @builtin(position) position: vec4f,
        @location(0) @interpolate(flat) triangle: u32,
    }

    @vertex
    fn look_vertex(@location(0) corner: vec3f, @builtin(vertex_index) vertex: u32,
                   @builtin(instance_index) face: u32) -> Drawn {
        // The scene's own axes: the point lies at its origin.
        let at = turned(eye_relative(corner) + vec3f(knobs.x, knobs.y, knobs.z), face);
        return Drawn(vec4f(at.xy, at.z - 1e-3, at.z), vertex / 3u);
    }

    @fragment
    fn look_fragment(in: Drawn) -> @location(0) u32 {
        return in.triangle + 1u;
    }

    // Delta form factors (Cohen & Greenberg 1985): 1 / (pi (1 + x2 + y2)2) in front, z / (pi (1 + x2 + z2)2) at the sides.
    @compute @workgroup_size(1)
    fn sum() {
        let side = textureDimensions(faces).x;
        let cell = 4.0 / (f32(side) * f32(side)) / 3.14159265;
        var hidden = 0.0;
        var all = 0.0;
        for (var face = 0u; face < 5u; face++) {
            for (var y = 0u; y < side; y++) {
                for (var x = 0u; x < side; x++) {
                    let q = vec2f(2.0 * (f32(x) + 0.5) / f32(side) - 1.0, 1.0 - 2.0 * (f32(y) + 0.5) / f32(side));
                    let d = 1.0 + dot(q, q);
                    let factor = cell / (d * d) * select(max(q.y, 0.0), 1.0, face == 0u);
                    all += factor;
                    hidden += select(0.0, factor, textureLoad(faces, vec2u(x, y), face, 0).x != 0u);
                }
            }
        }
        seen[0] = hidden;
        seen[1] = all;
    }

    @compute @workgroup_size(8, 8)
    fn tell(@builtin(global_invocation_id) id: vec3u) {
        if inside_tile(id) {
            lights[pixel_index(id)] += vec4f(seen[0], seen[1], 0.0, 0.0);
        }
    }";

fn eye(conditions: &Conditions, _: &Settings<'_>) -> Vec<(&'static str, Number)> {
    let eye = conditions.view.camera.eye;
    let number = |value| Number::float(value);
    vec![
        ("x", number(eye.x)),
        ("y", number(eye.y)),
        ("z", number(eye.z)),
    ]
}

const PLATE: Effect = Effect {
    name: "plate",
    summary: "how much of the sky is hidden",
    writes: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Bound(1.0)),
    passes: &[
        Pass {
            shader: PLATE_SHADER,
            entry: "look",
            over: Over::Raster(RasterView::Hemicube(|_: &Extent<'_>| SIDE)),
            when: When::Once,
            uses: &[Resource::Knobs(eye)],
        },
        Pass {
            shader: PLATE_SHADER,
            entry: "sum",
            over: Over::Groups(|_| [1, 1]),
            when: When::Once,
            uses: &[Resource::Faces, Resource::Make(&SEEN)],
        },
        Pass {
            shader: PLATE_SHADER,
            entry: "tell",
            over: Over::Pixels,
            when: When::Tile,
            uses: &[Resource::Make(&SEEN), Resource::Update(Field::Lights)],
        },
    ],
    ..Effect::NOTHING
};

#[test]
fn a_hemicube_finds_the_form_factor_of_a_plate() {
    if !common::gpu("a_hemicube_finds_the_form_factor_of_a_plate") {
        return;
    }
    // A square of 2 x 2 m, 1 m over the point: four times that of a corner's rectangle with X = Y = 1,
    // (1 / 2 pi) (X / sqrt(1 + X2) atan(Y / sqrt(1 + X2)) + Y / sqrt(1 + Y2) atan(X / sqrt(1 + Y2))).
    let root = 2f64.sqrt();
    let corner = (2.0 / root * (1.0 / root).atan()) / (2.0 * PI);
    let exact = 4.0 * corner;
    let plate = quad(
        DVec3::new(-1.0, 1.0, -1.0),
        DVec3::new(2.0, 0.0, 0.0),
        DVec3::new(0.0, 0.0, 2.0),
    );
    let seen = conditions(scene(&plate, 140.0, 50.0), camera(), [8, 8]);
    let rendered = on_gpu(&plan(&seen, &[&PLATE], &[]));
    let found = layer(&rendered.frame, Field::Lights)[0];
    eprintln!(
        "hidden {:.5}, exact {exact:.5}; all {:.5}",
        found.x, found.y
    );
    assert!((found.x / exact - 1.0).abs() < 0.01, "{found} {exact}");
    assert!((found.y - 1.0).abs() < 1e-3, "{found}");
    assert_eq!(runs(&rendered, "look"), 1);
    // Beside the point it hides less.
    let moved: Vec<_> = plate
        .iter()
        .map(|corners| corners.map(|p| p + DVec3::X))
        .collect();
    let beside = conditions(scene(&moved, 140.0, 50.0), camera(), [8, 8]);
    let less = layer(&on_gpu(&plan(&beside, &[&PLATE], &[])).frame, Field::Lights)[0];
    assert!(less.x < 0.8 * found.x, "{less}");
}
