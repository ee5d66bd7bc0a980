//! Which layers an EXR holds.
//!
//! Unless they are named, those that pictures of the scene can hold something in: the same at every hour, so that no layer comes and
//! goes in a sequence.

use crate::conditions::Conditions;
use crate::effect::ALL;
use crate::error::{Error, Result};
use crate::frame::Field;
use crate::plan::Overrules;

/// The name under which all layers are asked for.
pub const EVERY: &str = "all";

/// The layers of an EXR, in its own names: those of [`Field::layers`], then `transmittance` and `normal`.
///
/// The picture (R, G, B) and Z are always written.
pub fn layer_names() -> impl Iterator<Item = &'static str> {
    Field::layers()
        .map(Field::name)
        .chain([Field::Transmittance.name(), "normal"])
}

/// The layers that pictures of these conditions can hold something in, whatever the hour: without air there is none that scatters, without
/// lamps none of theirs, and none is made by effects that are all left out.
pub fn layers_of(conditions: &Conditions, overrules: &Overrules) -> Vec<&'static str> {
    let is_left_out = |field: Field| {
        let mut writing = ALL.iter().filter(|effect| effect.writes.contains(&field));
        writing.all(|effect| overrules.without.iter().any(|name| effect.is_called(name)))
    };
    let is_there = |name: &&str| {
        let field = Field::named(name);
        field.is_none_or(|field| conditions.may_hold(field) && !is_left_out(field))
    };
    layer_names().filter(is_there).collect()
}

/// The layers of those names (`--layers`); all of them for no names, and for [`EVERY`].
///
/// # Errors
/// [`Error::Input`] with the nearest name for one that is unknown.
pub fn select_layers<S: AsRef<str>>(names: &[S]) -> Result<Vec<&'static str>> {
    if names.iter().all(|name| name.as_ref() == EVERY) {
        return Ok(layer_names().collect());
    }
    let mut selected = Vec::new();
    for name in names {
        let name = name.as_ref();
        let Some(known) = layer_names().find(|known| *known == name) else {
            let nearest = layer_names()
                .max_by(|a, b| {
                    strsim::jaro_winkler(a, name).total_cmp(&strsim::jaro_winkler(b, name))
                })
                .unwrap_or_default();
            let all = layer_names().collect::<Vec<_>>().join(", ");
            return Err(Error::input(
                "--layers",
                format!("there is no layer `{name}`"),
                format!("did you mean `{nearest}`? There are {all}; {EVERY} is each of them"),
            ));
        };
        if !selected.contains(&known) {
            selected.push(known);
        }
    }
    Ok(selected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_by_name() {
        let all = select_layers::<&str>(&[]).expect("no names are all names");
        assert_eq!(all.len(), 10);
        assert_eq!(all[..3], ["sun", "sky", "indirect"]);
        assert_eq!(select_layers(&["all"]).expect("it is known"), all);
        let two = select_layers(&["normal", "sun", "normal"]).expect("both are known");
        assert_eq!(two, ["normal", "sun"]);
        // All and one more are the one too many.
        assert!(select_layers(&["all", "sun"]).is_err_and(|e| e.is_input()));
        let error = select_layers(&["inscater_sun"]).expect_err("it is misspelt");
        assert!(error.is_input());
        assert!(error.remedy().contains("`inscatter_sun`?"), "{error}");
    }
}
