//! Whether effects fit together, and their passes fit them.

use crate::effect::{Effect, Field, Life, Over, Pass, RasterView, Resource, When};
use crate::error::{Error, Result};

/// Whether an effect fits behind others, and its passes fit it.
pub(super) fn check(effect: &Effect, before: &[&'static Effect]) -> Result<()> {
    let defect = |problem: String| {
        Err(Error::failed(
            format!("the effect `{}` {problem}", effect.name),
            "mend the effect, or the order of the effects: the documentation of the module `effect` says how they fit together",
        ))
    };
    if before.iter().any(|other| other.name == effect.name) {
        return defect("stands twice among the effects, or another has its name".into());
    }
    for (place, knob) in effect.knobs.iter().enumerate() {
        let [low, high] = knob.range;
        if knob
            .values
            .iter()
            .any(|value| !(low..=high).contains(value))
        {
            return defect(format!(
                "has values of its knob `{}` outside {low} to {high}",
                knob.name
            ));
        }
        if effect.knobs[..place].iter().any(|k| k.name == knob.name) {
            return defect(format!("has two knobs `{}`", knob.name));
        }
    }
    let finds_surfaces = |other: &&Effect| other.writes.contains(&Field::Surface);
    if effect.alters.contains(&Field::Surface)
        || effect.writes.contains(&Field::Surface) && before.iter().any(|o| finds_surfaces(&&**o))
    {
        return defect("changes `surface`, which one effect finds and the others only read".into());
    }
    for field in effect.reads {
        if !before.iter().any(|other| other.writes.contains(field)) {
            return defect(format!(
                "reads `{}`, which no effect before it writes",
                field.name()
            ));
        }
    }
    let lit = |pass: &&Pass| matches!(pass.when, When::EachBeam(_));
    if effect.passes.iter().any(|pass| lit(&pass))
        && !effect.draws_maps()
        && !before.iter().any(|other| other.draws_maps())
    {
        return defect(
            "has passes for each beam, but no effect up to it draws the maps of beams".into(),
        );
    }
    if effect.passes.is_empty() {
        return Ok(());
    }
    let in_parts = |pass: &Pass| matches!(pass.when, When::Parts(_));
    if effect.passes.iter().any(in_parts) && (effect.passes.len(), effect.writes.len()) != (1, 1) {
        return defect(
            "has a pass in parts, and another pass or more than one field that it writes".into(),
        );
    }
    let (mut read, mut updated) = (Vec::new(), Vec::new());
    let mut made: Vec<&str> = Vec::new();
    for pass in effect.passes {
        if let Over::Fields(fields) = pass.over {
            updated.extend(fields);
        }
        if let Some(problem) = misfit(effect, pass) {
            return defect(problem);
        }
        for resource in pass.uses {
            match resource {
                Resource::Read(field) => read.push(*field),
                Resource::Update(field) => updated.push(*field),
                Resource::Use(product) => {
                    let made = effect.passes.iter().flat_map(|pass| pass.uses).any(
                        |other| matches!(other, Resource::Make(made) if made.name == product.name),
                    );
                    if !made {
                        return defect(format!(
                            "uses `{}`, which none of its passes makes",
                            product.name
                        ));
                    }
                }
                _ => {}
            }
        }
        // In a loop what a turn uses may be what the one before has made.
        let in_loop = matches!(pass.when, When::Until(_));
        let uses = pass.uses.iter();
        for product in uses.clone().filter_map(Resource::product) {
            let makes = |r: &Resource| matches!(r, Resource::Make(p) if p.name == product.name);
            if uses.clone().any(makes) {
                made.push(product.name);
            } else if !in_loop && !made.contains(&product.name) {
                return defect(format!(
                    "uses `{}` in its pass `{}` before one makes it",
                    product.name, pass.entry
                ));
            }
        }
    }
    let changed = |field: &Field| effect.writes.contains(field) || effect.alters.contains(field);
    if let Some(field) = read
        .iter()
        .find(|field| !effect.reads.contains(field) && !changed(field))
    {
        return defect(format!(
            "does not say that it reads `{}`, as one of its passes does",
            field.name()
        ));
    }
    if let Some(field) = updated.iter().find(|field| !changed(field)) {
        return defect(format!(
            "does not say that it writes or alters `{}`, as one of its passes does",
            field.name()
        ));
    }
    if let Some(field) = effect
        .reads
        .iter()
        .find(|field| !read.contains(field) && !updated.contains(field))
    {
        return defect(format!(
            "says that it reads `{}`, and none of its passes does",
            field.name()
        ));
    }
    if let Some(field) = effect
        .writes
        .iter()
        .chain(effect.alters)
        .find(|field| !updated.contains(field))
    {
        return defect(format!(
            "says that it writes or alters `{}`, and none of its passes does",
            field.name()
        ));
    }
    Ok(())
}

/// What is wrong with when a pass runs, what it covers and what it leaves.
fn misfit(effect: &Effect, pass: &Pass) -> Option<String> {
    let entry = pass.entry;
    let mut names: Vec<&str> = Vec::new();
    for resource in pass.uses {
        let name = match resource {
            Resource::Read(field) | Resource::Update(field) => field.name(),
            Resource::Use(product) | Resource::Make(product) => product.name,
            _ => continue,
        };
        if names.contains(&name) {
            return Some(format!("names `{name}` twice in its pass `{entry}`"));
        }
        names.push(name);
    }
    let kept = matches!(pass.when, When::Once | When::Until(_));
    for resource in pass.uses {
        let of_tile = match resource {
            Resource::Read(field) | Resource::Update(field) => Some(field.name()),
            Resource::Use(product) | Resource::Make(product) => {
                (product.life() != Life::Kept).then_some(product.name)
            }
            Resource::Numbers => Some("numbers"),
            _ => None,
        };
        if let (true, Some(name)) = (kept, of_tile) {
            return Some(format!(
                "fills what is kept from a field of a tile, `{name}`, in its pass `{entry}`: there is no tile yet"
            ));
        }
        let Resource::Make(product) = resource else {
            continue;
        };
        let longer = match pass.when {
            When::Tile | When::Parts(_) => product.life() != Life::Tile,
            When::EachBeam(_) => product.life() == Life::Kept,
            When::Once | When::Until(_) => false,
        };
        if longer {
            return Some(format!(
                "makes `{}` in its pass `{entry}`, which does not run for as long as that lives: it lacks the input `Tile` or `Beam`, \
                 or has one too many, or is only used there",
                product.name
            ));
        }
    }
    let makes_kept = |pass: &Pass| {
        let made = |resource: &Resource| match resource {
            Resource::Make(product) => product.life() == Life::Kept,
            _ => false,
        };
        pass.uses.iter().any(made)
    };
    match (pass.when, pass.over) {
        (When::Once | When::Until(_), Over::Pixels | Over::Fields(_)) => Some(format!(
            "runs its pass `{entry}` over pixels before there are any: cover groups"
        )),
        (When::Until(until), _)
            if !effect.passes.iter().any(|other| {
                let of_loop = matches!(other.when, When::Until(own) if std::ptr::eq(own, until));
                let made = |resource: &Resource| {
                    matches!(resource, Resource::Make(p) if p.name == until.condition.name)
                };
                of_loop && other.uses.iter().any(made)
            }) =>
        {
            Some(format!(
                "loops until `{}`, which no pass of the loop makes",
                until.condition.name
            ))
        }
        (When::Tile, Over::Raster(RasterView::Camera(_) | RasterView::Beam(_))) => None,
        (When::Once | When::Until(_), Over::Raster(RasterView::Hemicube(_))) => {
            (!effect.passes.iter().any(makes_kept)).then(|| {
                format!("draws a hemicube in its pass `{entry}` for nothing that is kept")
            })
        }
        (_, Over::Raster(_)) => Some(format!(
            "draws its pass `{entry}` at the wrong time: camera and beams for tiles, hemicubes once or in a loop"
        )),
        _ => None,
    }
}
