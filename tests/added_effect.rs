//! An effect as the documentation of the module `effect` says that one is added: its shader is the text that stands there.

mod common;

use common::build::*;
use common::shafts::gpu;
use common::views::*;
use glam::DVec3;
use std::sync::OnceLock;
use tyndall::Error;
use tyndall::backend::reference::Reference;
use tyndall::backend::{Limits, Rendered};
use tyndall::conditions::{Conditions, Input};
use tyndall::effect::{
    ALL, Contribution, Decision, Effect, Field, Knob, Loop, Number, Over, Pass, Product,
    RasterView, Resource, When,
};
use tyndall::plan::{Overrules, Plan, Quality};

/// The shader of the documentation, the only raw string there.
fn shader() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| {
        let documentation = include_str!("../src/effect/mod.rs");
        let lines = documentation
            .lines()
            .map_while(|line| line.strip_prefix("//!"));
        lines
            .skip_while(|line| !line.ends_with("r#\""))
            .skip(1)
            .take_while(|line| !line.trim().starts_with("\"#"))
            .map(|line| format!("{}\n", line.strip_prefix(' ').unwrap_or(line)))
            .collect()
    })
}

/// Each surface glows by its albedo.
const GLOW: Effect = Effect {
    name: "glow",
    summary: "surfaces glow",
    reads: &[Field::Surface],
    writes: &[Field::Lights],
    knobs: &[Knob {
        name: "strength",
        meaning: "luminance of white [cd/m2]",
        values: [100.0; 4],
        range: [0.0, 1e6],
    }],
    decide: |_| Decision::run("a test", Contribution::Bound(100.0)),
    reference: |_, settings, _| {
        let strength = settings.get("strength");
        Ok(Box::new(move |fields| {
            fields.update(Field::Lights, |_, _, surface, present| {
                present + strength * surface.albedo
            });
        }))
    },
    ..Effect::NOTHING
};

/// The same with its pass, once the text is at hand.
fn on_gpu() -> &'static Effect {
    static EFFECT: OnceLock<Effect> = OnceLock::new();
    static PASSES: OnceLock<[Pass; 1]> = OnceLock::new();
    let passes = PASSES.get_or_init(|| {
        [Pass {
            shader: shader(),
            entry: "glow",
            over: Over::Pixels,
            when: When::Tile,
            uses: &[
                Resource::Read(Field::Surface),
                Resource::Update(Field::Lights),
                Resource::Knobs(|_, settings| {
                    vec![("strength", Number::float(settings.get("strength")))]
                }),
            ],
        }]
    });
    EFFECT.get_or_init(|| Effect { passes, ..GLOW })
}

fn with(own: &'static Effect) -> Vec<&'static Effect> {
    let compose = ALL.iter().position(|effect| effect.name == "compose");
    let (before, after) = ALL.split_at(compose.expect("there is compose"));
    [before, &[own], after].concat()
}

fn plan<'c>(conditions: &'c Conditions, own: &'static Effect, strength: f64) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::Draft,
        set: vec![("glow.strength".into(), strength)],
        ..Overrules::default()
    };
    Plan::with(conditions, &overrules, &with(own)).expect("it fits")
}

fn lights(rendered: &Rendered) -> Vec<DVec3> {
    layer(&rendered.frame, Field::Lights)
}

#[test]
fn an_added_effect_is_planned_rendered_compared_and_reported() {
    if !common::gpu("an_added_effect_is_planned_rendered_compared_and_reported") {
        return;
    }
    let conditions = at_size(&slats(1.0));
    let truth = Reference::new(&plan(&conditions, &GLOW, 100.0))
        .expect("it can be prepared")
        .render(&Limits::default(), &|_| {});
    let truth = lights(&truth.expect("it fits into memory"));
    assert!(truth.iter().any(|v| v.x > 1.0));
    // With passes, and without: then the CPU does it there too, and reads what the GPU wrote.
    for (effect, on_cpu) in [(on_gpu(), false), (&GLOW, true)] {
        let plan = plan(&conditions, effect, 100.0);
        assert!(plan.running().any(|step| step.effect.name == "glow"));
        let found = gpu().render(&plan, &Limits::default(), &|_| {});
        let found = found.expect("the device works");
        let step = found.steps.iter().find(|step| step.effect.name == "glow");
        assert_eq!(step.map(|step| step.on_cpu), Some(on_cpu));
        let off = relative_rmse(&lights(&found), &truth);
        assert!(off < 1e-3, "{on_cpu}: {off}");
    }
    // One that does not do what its reference does is noticed.
    let other = gpu().render(
        &plan(&conditions, on_gpu(), 50.0),
        &Limits::default(),
        &|_| {},
    );
    assert!(relative_rmse(&lights(&other.expect("it works")), &truth) > 0.3);
}

/// The error of effects that do not fit together; it names what is wrong.
fn refused(own: &'static Effect) -> String {
    let conditions = at_size(&slats(1.0));
    // Without who makes it, there is a field that nobody writes.
    let mut effects = with(own);
    effects.retain(|effect| effect.name != "air_lamps");
    match Plan::with(&conditions, &Overrules::default(), &effects) {
        Ok(_) => panic!("{} fits", own.name),
        Err(error @ Error::Failed { .. }) => error.problem(),
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    const fn pass(uses: &'static [Resource]) -> Pass {
        Pass {
            shader: "",
            entry: "x",
            over: Over::Pixels,
            when: When::Tile,
            uses,
        }
    }
    const KEPT: Product = Product {
        name: "kept",
        wgsl: "array<f32>",
        bytes: |_| 4,
        reads: &[Input::Geometry],
        zeroed: true,
    };
    const fn effect(passes: &'static [Pass]) -> Effect {
        Effect {
            name: "bad",
            reads: &[Field::Surface],
            writes: &[Field::Lights],
            passes,
            ..Effect::NOTHING
        }
    }
    const SOUND: &[Resource] = &[
        Resource::Read(Field::Surface),
        Resource::Update(Field::Lights),
    ];
    // Reads what nobody has written.
    const UNWRITTEN: Effect = Effect {
        reads: &[Field::InscatterLights],
        writes: &[],
        ..effect(&[])
    };
    const UNREAD: Effect = effect(&[pass(&[Resource::Update(Field::Lights)])]);
    const UNWRITING: Effect = effect(&[pass(&[Resource::Read(Field::Surface)])]);
    const HIDDEN_READ: Effect =
        effect(&[pass(SOUND), pass(&[Resource::Read(Field::Transmittance)])]);
    const HIDDEN_WRITE: Effect = effect(&[pass(SOUND), pass(&[Resource::Update(Field::Sun)])]);
    const UNMADE: Effect = effect(&[pass(SOUND), pass(&[Resource::Use(&KEPT)])]);
    const ONCE: Effect = effect(&[
        pass(SOUND),
        Pass {
            when: When::Once,
            ..pass(SOUND)
        },
    ]);
    // Lives longer than the pass that makes it runs.
    const LONG: Effect = effect(&[pass(SOUND), pass(&[Resource::Make(&KEPT)])]);
    const TWICE: Effect = effect(&[pass(&[
        Resource::Read(Field::Surface),
        Resource::Update(Field::Lights),
        Resource::Update(Field::Lights),
    ])]);
    const BEFORE_PIXELS: Effect = effect(&[
        pass(SOUND),
        Pass {
            when: When::Once,
            ..pass(&[Resource::Make(&KEPT)])
        },
    ]);
    const FINDS: Effect = Effect {
        writes: &[Field::Surface],
        ..effect(&[])
    };
    const WITHOUT_END: Loop = Loop {
        condition: &KEPT,
        holds: |_, _| true,
        turns: 1,
        most: |_| 1,
    };
    const ENDLESS: Effect = effect(&[
        pass(SOUND),
        Pass {
            over: Over::Groups(|_| [1, 1]),
            when: When::Until(&WITHOUT_END),
            ..pass(&[])
        },
    ]);
    const DRAWN_LATE: Effect = effect(&[
        pass(SOUND),
        Pass {
            over: Over::Raster(RasterView::Hemicube(|_| 8)),
            ..pass(&[])
        },
    ]);
    for (effect, names) in [
        (
            &UNWRITTEN,
            "reads `inscatter_lights`, which no effect before",
        ),
        (&UNREAD, "says that it reads `surface`"),
        (&UNWRITING, "says that it writes or alters `lights`"),
        (&HIDDEN_READ, "does not say that it reads `transmittance`"),
        (&HIDDEN_WRITE, "does not say that it writes or alters `sun`"),
        (&UNMADE, "uses `kept`, which none of its passes makes"),
        (&ONCE, "fills what is kept from a field of a tile"),
        (&LONG, "does not run for as long as that lives"),
        (&TWICE, "names `lights` twice"),
        (&BEFORE_PIXELS, "over pixels before there are any"),
        (&FINDS, "changes `surface`"),
        (
            &ENDLESS,
            "loops until `kept`, which no pass of the loop makes",
        ),
        (&DRAWN_LATE, "draws its pass `x` at the wrong time"),
    ] {
        let problem = refused(effect);
        assert!(problem.contains(names), "{problem}");
    }
    // What draws no maps before passes for each beam.
    let lit: Vec<&'static Effect> = ALL.iter().copied().filter(|e| !e.draws_maps()).collect();
    let conditions = at_size(&slats(1.0));
    let error = Plan::with(&conditions, &Overrules::default(), &lit).map(|_| ());
    let error = error.expect_err("nobody draws maps").problem();
    assert!(error.contains("draws the maps of beams"), "{error}");
}

#[test]
fn what_nobody_makes_in_this_scene_leaves_out_who_reads_it() {
    let mut view = slats(1.0);
    view.scene.media.clear();
    let conditions = at_size(&view);
    let plan = Plan::new(&conditions, &Overrules::default()).expect("it is sound");
    let compose = plan.steps.iter().find(|s| s.effect.name == "compose");
    let compose = compose.expect("it is listed");
    assert!(!compose.decision.run);
    assert!(compose.decision.reason.contains("transmittance"));
    let with_fog = at_size(&slats(1.0));
    let plan = Plan::new(&with_fog, &Overrules::default()).expect("it is sound");
    assert!(plan.running().any(|step| step.effect.name == "compose"));
}
