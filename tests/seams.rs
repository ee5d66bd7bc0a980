//! Small effects that try the joints on which others will be hung: one that iterates on the device until a condition holds and
//! keeps its result, one on the CPU between two of the GPU, one that looks through a hemicube. Lamps: `seams_lamp`.

mod common;

use common::build::*;
use common::own_effects::*;
use glam::DVec3;
use std::f64::consts::PI;
use tyndall::backend::gpu::{Choice, Gpu};
use tyndall::backend::{Limits, Rendered};
use tyndall::conditions::{Conditions, Input};
use tyndall::effect::{
    Contribution, Decision, Effect, Extent, Field, Loop, Number, Over, Pass, Product, RasterView,
    Resource, Settings, When,
};
use tyndall::plan::Plan;
use tyndall::studies::scenes::quad;

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
            uses: &[Resource::Use(&ROD), Resource::Update(Field::Lights)],
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

// Two results of different inputs: what depends on the sun is made again at another moment, what does not is not.

const FORM: Product = Product {
    name: "form",
    wgsl: "array<f32>",
    bytes: |_| 4,
    reads: &[Input::Geometry],
    zeroed: true,
};

const SOLUTION: Product = Product {
    name: "solution",
    wgsl: "array<f32>",
    bytes: |_| 4,
    reads: &[Input::Geometry, Input::Sun],
    zeroed: true,
};

const fn of_solved(entry: &'static str, over: Over, when: When, uses: &'static [Resource]) -> Pass {
    Pass {
        shader: "
            @compute @workgroup_size(1)
            fn shape() {
                form[0] += 1.0;
            }

            @compute @workgroup_size(1)
            fn solve() {
                solution[0] += 10.0 * form[0];
            }

            @compute @workgroup_size(8, 8)
            fn tell_both(@builtin(global_invocation_id) id: vec3u) {
                if inside_tile(id) {
                    lights[pixel_index(id)] += vec4f(form[0], solution[0], 0.0, 0.0);
                }
            }",
        entry,
        over,
        when,
        uses,
    }
}

const ONE: Over = Over::Groups(|_| [1, 1]);

const SOLVED: Effect = Effect {
    name: "solved",
    summary: "counts how often things are made",
    writes: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Bound(1.0)),
    passes: &[
        of_solved("shape", ONE, When::Once, &[Resource::Make(&FORM)]),
        of_solved(
            "solve",
            ONE,
            When::Once,
            &[Resource::Use(&FORM), Resource::Make(&SOLUTION)],
        ),
        of_solved(
            "tell_both",
            Over::Pixels,
            When::Tile,
            &[
                Resource::Use(&FORM),
                Resource::Use(&SOLUTION),
                Resource::Update(Field::Lights),
            ],
        ),
    ],
    ..Effect::NOTHING
};

#[test]
fn each_result_is_made_again_for_its_own_inputs_alone() {
    if !common::gpu("each_result_is_made_again_for_its_own_inputs_alone") {
        return;
    }
    let mut own = Gpu::open(Choice::Any).expect("there is an adapter");
    let mut render = |conditions: &Conditions, effects: &[&'static Effect]| {
        let plan = plan(conditions, effects, &[]);
        let rendered = own.render(&plan, &Limits::default(), &|_| {});
        rendered.expect("the device works")
    };
    let noon = conditions(shelter(), camera(), [16, 8]);
    // The same geometry under another sun.
    let mut later = noon.clone();
    later.sun.toward = DVec3::new(0.6, 0.64, 0.48);
    let told = |rendered: &Rendered| layer(&rendered.frame, Field::Lights)[0].truncate();
    let first = render(&noon, &[&SOLVED]);
    // Beside what other effects keep.
    let own_products = |rendered: &Rendered| -> Vec<&'static str> {
        let all = rendered.made.products.iter().copied();
        all.filter(|name| ["form", "solution"].contains(name))
            .collect()
    };
    assert_eq!(own_products(&first), ["form", "solution"]);
    let second = render(&later, &[&SOLVED]);
    assert_eq!(own_products(&second), ["solution"]);
    assert_eq!((runs(&second, "shape"), runs(&second, "solve")), (0, 1));
    // Each began from zeros: neither was added to what was there.
    for rendered in [&first, &second] {
        assert_eq!(told(rendered).to_array(), [1.0, 10.0]);
    }
    // Plans without the effect between do not end what still holds.
    render(&later, &[]);
    let third = render(&later, &[&SOLVED]);
    assert!(own_products(&third).is_empty(), "{:?}", third.made);
    assert_eq!(told(&third).to_array(), [1.0, 10.0]);
    // Another scene does.
    let other = conditions(lamp_scene(), camera(), [16, 8]);
    render(&other, &[]);
    let fourth = render(&later, &[&SOLVED]);
    assert_eq!(own_products(&fourth), ["form", "solution"]);
}

// On the CPU, between two effects of the GPU: light of surfaces, doubled and dimmed by the air's transmittance, goes on.

const BEFORE: Effect = Effect {
    name: "before",
    summary: "surfaces glow by their distance",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    decide: |_| Decision::run("a test", Contribution::Bound(1e3)),
    reference: |_, _, _| {
        Ok(Box::new(|fields| {
            fields.update(Field::Lights, |_, _, surface, present| {
                present
                    + DVec3::splat(if surface.is_met() {
                        surface.distance
                    } else {
                        0.0
                    })
            });
        }))
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
        Ok(Box::new(|fields| {
            fields.update(Field::Lights, |_, _, _, present| 2.0 * present);
            fields.multiply(Field::Lights, Field::Transmittance);
        }))
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
        Ok(Box::new(|fields| {
            let (own, lights) = (Field::InscatterLights, Field::Lights);
            fields.update_by(own, lights, |_, _, _, present, lights| {
                present + 0.5 * lights
            });
        }))
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
            uses: &[Resource::Use(&SEEN), Resource::Update(Field::Lights)],
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
