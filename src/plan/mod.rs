//! The plan: which effects a scene calls for, why not the others, and with which settings.
//!
//! A plan also checks its flow: an effect whose fields nobody writes is left out, one that no effect before it could serve is
//! refused, and so is one whose passes do not name what it says that it reads and writes.

mod flow;

use crate::conditions::Conditions;
use crate::effect::air_lamps::INTEGRATOR;
use crate::effect::{
    ALL, Contribution, Decision, Effect, Field, Method, Pass, Resource, Settings, When,
    lamps_on_device,
};
use crate::error::{Error, Result, nearest};
use crate::frame::Part;
use crate::medium::Medium;

/// How much accuracy is paid for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quality {
    /// To place camera and sun.
    Draft,
    /// Good enough to look at.
    #[default]
    Preview,
    /// Good enough to sign for.
    High,
    /// The finest setting of the backend.
    Reference,
}

impl Quality {
    /// All of them, the cheapest first.
    pub const ALL: [Quality; 4] = [
        Quality::Draft,
        Quality::Preview,
        Quality::High,
        Quality::Reference,
    ];

    /// Its name in flags and reports.
    pub fn name(self) -> &'static str {
        match self {
            Quality::Draft => "draft",
            Quality::Preview => "preview",
            Quality::High => "high",
            Quality::Reference => "reference",
        }
    }
}

/// What the user wants otherwise than the plan would have it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overrules {
    /// Where all knobs start.
    pub quality: Quality,
    /// How a GPU integrates sunlight in the air; absent: [`Method::Rectified`].
    pub method: Option<Method>,
    /// Effects that surely contribute less than this share of the picture's mean luminance are left out; absent: 1e-4.
    pub tolerance: Option<f64>,
    /// `EFFECT.KNOB` and value.
    pub set: Vec<(String, f64)>,
    /// Effects to run even if they contribute too little.
    pub force: Vec<String>,
    /// Effects to leave out.
    pub without: Vec<String>,
}

impl Overrules {
    /// Those of the effects to leave out that give light.
    pub fn lights_left_out(&self) -> Vec<&str> {
        let is_light = |field: Field| !matches!(field.part(), Part::Surface | Part::Share);
        let gives = |name: &str| {
            let mut called = ALL.iter().filter(|effect| effect.is_called(name));
            called.any(|effect| effect.writes.iter().any(|field| is_light(*field)))
        };
        let names = self.without.iter().map(String::as_str);
        names.filter(|name| gives(name)).collect()
    }

    /// The same at the finest quality and without knobs of the user's: what pictures are measured by.
    pub fn finest(&self) -> Self {
        Overrules {
            quality: Quality::Reference,
            set: Vec::new(),
            ..self.clone()
        }
    }
}

/// One effect of the plan.
#[derive(Clone)]
pub struct Step {
    /// The effect.
    pub effect: &'static Effect,
    /// Whether it runs, and why.
    pub decision: Decision,
    /// Its knobs.
    pub settings: Vec<(&'static str, f64)>,
}

impl Step {
    /// Whether the reference does it on every backend: it has no passes, the scene holds what they are no match for, or another
    /// integrator than theirs is asked for.
    pub fn is_by_reference(&self, conditions: &Conditions) -> bool {
        let other = |(knob, value): &(&str, f64)| *knob == INTEGRATOR.name && *value != 0.0;
        self.effect.passes.is_empty()
            || left_to_reference(self.effect, conditions).is_some()
            || self.settings.iter().any(other)
    }
}

/// The most media whose light shaders integrate. Each bends the light of all others, so that work grows with the square; some drivers
/// end a shader's loops after 65 535 turns, and light is missing then.
const MOST_MEDIA: usize = 16;

/// Why an effect that has passes is left to its reference, if it is.
fn left_to_reference(effect: &Effect, conditions: &Conditions) -> Option<&'static str> {
    if asks_media(effect) && conditions.air.media.iter().any(Medium::is_curved) {
        return Some("the borders of a layer or an ellipsoid are curved");
    }
    let has_panes = conditions.geometry.panes().is_some();
    if has_panes && effect.writes.contains(&Field::Transmittance) {
        return Some("panes colour the light");
    }
    let has_lamps = |resource: &Resource| matches!(resource, Resource::Lamps(_));
    if effect
        .passes
        .iter()
        .any(|pass| pass.uses.iter().any(has_lamps))
    {
        let in_air = effect.writes.contains(&Field::InscatterLights);
        return lamps_on_device::fits_device(conditions, in_air).err();
    }
    let for_beams = |pass: &Pass| matches!(pass.when, When::EachBeam(_));
    if !effect.passes.iter().any(for_beams) {
        return None;
    }
    // Shadow maps hold one depth.
    if has_panes {
        return Some("panes colour the light");
    }
    if conditions.geometry.has_veils() {
        return Some("surfaces let a part of the light through");
    }
    let in_air =
        effect.writes.contains(&Field::InscatterSun) || effect.alters.contains(&Field::Background);
    let many = conditions.air.media.len() > MOST_MEDIA;
    (in_air && many).then_some("there are more than 16 media")
}

/// Whether an effect's passes ask what fills the air: on rays from the eye, or on the sun's way to surfaces and to the sky.
fn asks_media(effect: &Effect) -> bool {
    let of_air =
        |field: &Field| matches!(field.part(), Part::Air | Part::Share) || *field == Field::Sun;
    !effect.passes.is_empty()
        && (effect.writes.iter().any(of_air) || effect.alters.contains(&Field::Background))
}

/// Which effects are run, in their order.
pub struct Plan<'c> {
    /// What they are run on.
    pub conditions: &'c Conditions,
    /// Share of the mean luminance below which effects were left out.
    pub tolerance: f64,
    /// How a GPU integrates sunlight in the air, where there is any.
    pub method: Method,
    /// All effects, run or not.
    pub steps: Vec<Step>,
}

impl<'c> Plan<'c> {
    /// Asks every effect whether the scene calls for it.
    ///
    /// # Errors
    /// [`Error::Input`] for an effect or knob that does not exist (with the nearest one that does), for one that is both
    /// forced and left out, and for forcing one that the scene gives nothing to do; [`Error::Domain`] for a knob's value
    /// outside its range.
    pub fn new(conditions: &'c Conditions, overrules: &Overrules) -> Result<Self> {
        Self::with(conditions, overrules, ALL)
    }

    /// The same with other effects than [`ALL`], in the order in which they run: for who brings effects of their own.
    ///
    /// # Errors
    /// Those of [`Plan::new`]; [`Error::Failed`] for effects that do not fit together: one that reads what no effect before it
    /// writes, or whose passes do not name what it reads and writes.
    pub fn with(
        conditions: &'c Conditions,
        overrules: &Overrules,
        effects: &[&'static Effect],
    ) -> Result<Self> {
        for (place, effect) in effects.iter().enumerate() {
            flow::check(effect, &effects[..place])?;
        }
        let find = |name: &str| find(effects, name);
        for name in overrules.force.iter().chain(&overrules.without) {
            find(name)?;
        }
        if let Some(name) = overrules
            .force
            .iter()
            .find(|name| overrules.without.contains(name))
        {
            return Err(Error::input(
                format!("--force {name}"),
                "the effect is forced and left out",
                "use --force or --without, not both",
            ));
        }
        let tolerance = overrules.tolerance.unwrap_or(1e-4);
        let level = Quality::ALL
            .iter()
            .position(|q| *q == overrules.quality)
            .expect("all qualities are listed");
        let method = overrules.method.unwrap_or(Method::Rectified);
        let mut steps: Vec<Step> = Vec::with_capacity(effects.len());
        for &effect in effects {
            let mut decision = decide(effect, conditions);
            if let Contribution::Bound(bound) = decision.contribution
                && decision.run
                && bound < tolerance * conditions.least_luminance()
            {
                decision = Decision::skip(
                    format!("{}, too little to be seen", decision.reason),
                    decision.contribution,
                );
            }
            if let Some(own) = effect.method
                && own != method
            {
                decision = Decision::nothing(format!("the method is {}", method.name()));
            } else if overrules.without.iter().any(|n| effect.is_called(n)) {
                if matches!(decision.contribution, Contribution::Everything) {
                    return Err(Error::input(
                        format!("--without {}", effect.name),
                        "without it there is no picture",
                        "leave it in",
                    ));
                }
                decision.reason = format!("left out by --without; {}", decision.reason);
                decision.run = false;
            } else if overrules.force.iter().any(|n| effect.is_called(n)) && !decision.run {
                if !decision.possible {
                    return Err(Error::input(
                        format!("--force {}", effect.name),
                        format!("it has nothing to do: {}", decision.reason),
                        "leave the flag out",
                    ));
                }
                decision.reason = format!("forced by --force; {}", decision.reason);
                decision.run = true;
            }
            if let Some(why) = left_to_reference(effect, conditions)
                && decision.run
            {
                decision.reason += &format!("; by the reference on every backend, as {why}");
            }
            if let Some(reason) = unserved(effect, &steps)
                && decision.run
            {
                decision = Decision::nothing(reason);
            }
            let settings = effect
                .knobs
                .iter()
                .map(|knob| (knob.name, knob.values[level]))
                .collect();
            steps.push(Step {
                effect,
                decision,
                settings,
            });
        }
        let mut plan = Plan {
            conditions,
            tolerance,
            method,
            steps,
        };
        for (target, value) in &overrules.set {
            plan.set(target, *value)?;
        }
        plan.draw_maps(&overrules.without);
        Ok(plan)
    }

    /// Lets shadow maps be drawn if an effect that runs has beams and nobody draws their maps: at night a lamp has shadows too.
    fn draw_maps(&mut self, without: &[String]) {
        let asks = self.running().any(|step| {
            let settings = Settings {
                effect: step.effect.name,
                values: &step.settings,
            };
            step.effect.passes.iter().any(|pass| match pass.when {
                When::EachBeam(beams) => !beams(self.conditions, &settings).is_empty(),
                _ => false,
            })
        });
        if !asks || self.running().any(|step| step.effect.draws_maps()) {
            return;
        }
        let mut steps = self.steps.iter_mut();
        let drawing = steps.find(|step| {
            step.effect.draws_maps() && !without.iter().any(|name| step.effect.is_called(name))
        });
        if let Some(step) = drawing {
            step.decision = Decision::run(
                "an effect asks for the shadow maps of its beams",
                Contribution::Everything,
            );
        }
    }

    fn set(&mut self, target: &str, value: f64) -> Result<()> {
        let place = format!("--set {target}");
        let (name, knob) = target.split_once('.').ok_or_else(|| {
            Error::input(
                &place,
                "EFFECT.KNOB=VALUE was expected",
                "for example --set shafts.suns=16",
            )
        })?;
        let effects: Vec<&'static Effect> = self.steps.iter().map(|step| step.effect).collect();
        find(&effects, name)?;
        let called = || effects.iter().filter(|effect| effect.is_called(name));
        let known = called()
            .flat_map(|effect| effect.knobs)
            .find(|k| k.name == knob)
            .ok_or_else(|| {
                let mut names = Vec::new();
                for known in called().flat_map(|effect| effect.knobs) {
                    if !names.contains(&known.name) {
                        names.push(known.name);
                    }
                }
                let remedy = match (nearest(knob, names.iter().copied()), &names[..]) {
                    (_, []) => "it has none".to_owned(),
                    (Some(near), _) => format!("did you mean `{near}`?"),
                    (None, names) => format!("it has {}", names.join(", ")),
                };
                Error::input(&place, format!("`{name}` has no knob `{knob}`"), remedy)
            })?;
        let [low, high] = known.range;
        if !(low..=high).contains(&value) {
            return Err(Error::domain(
                target,
                value,
                format!("{low} to {high}"),
                format!("it counts {}", known.meaning),
            ));
        }
        for step in &mut self.steps {
            if step.effect.is_called(name) {
                for setting in &mut step.settings {
                    if setting.0 == knob {
                        setting.1 = value;
                    }
                }
            }
        }
        Ok(())
    }

    /// The effects that run.
    pub fn running(&self) -> impl Iterator<Item = &Step> {
        self.steps.iter().filter(|step| step.decision.run)
    }

    /// The effects whose knobs count in pictures of the scene, whatever the hour: without the methods that are not chosen, and without what
    /// only writes fields that stay empty.
    pub fn counted(&self) -> impl Iterator<Item = &Step> {
        let is_chosen = |step: &&Step| step.effect.method.is_none_or(|own| own == self.method);
        let is_empty = |field: &Field| !self.conditions.may_hold(*field);
        self.steps.iter().filter(is_chosen).filter(move |step| {
            let writes = step.effect.writes;
            writes.is_empty() || !writes.iter().all(is_empty)
        })
    }

    /// The fields that some effect of the plan writes.
    pub fn written(&self) -> Vec<Field> {
        let mut written = Vec::new();
        for field in self.running().flat_map(|step| step.effect.writes) {
            if !written.contains(field) {
                written.push(*field);
            }
        }
        written
    }
}

fn find(effects: &[&'static Effect], name: &str) -> Result<&'static Effect> {
    effects
        .iter()
        .copied()
        .find(|effect| effect.is_called(name))
        .ok_or_else(|| {
            let names = effects.iter().map(|e| e.name).chain(["shafts"]);
            let remedy = match nearest(name, names) {
                Some(near) => format!("did you mean `{near}`? (`tyndall plan` lists them)"),
                None => "`tyndall plan` lists them".into(),
            };
            Error::input(
                format!("effect `{name}`"),
                "there is no such effect",
                remedy,
            )
        })
}

/// What an effect decides; of points that receive light, only what lights surfaces has anything to do.
fn decide(effect: &Effect, conditions: &Conditions) -> Decision {
    let seen = |field: &Field| matches!(field.part(), Part::Behind | Part::Air | Part::Share);
    let made = effect.writes.iter().chain(effect.alters);
    if conditions.view.points().is_some() && made.clone().any(seen) {
        return Decision::nothing("points receive light, and see nothing");
    }
    (effect.decide)(conditions)
}

/// Why an effect cannot run after those steps: a field that it reads is not made.
fn unserved(effect: &Effect, before: &[Step]) -> Option<String> {
    let missing = effect.reads.iter().find(|field| {
        let mut running = before.iter().filter(|step| step.decision.run);
        !running.any(|step| step.effect.writes.contains(field))
    })?;
    Some(format!("nothing makes `{}`", missing.name()))
}
