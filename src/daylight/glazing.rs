//! Other glass in the same windows: what variants of a model differ in beside weather and orientation.

use crate::error::{Error, Result};
use crate::scene::{Pane, Scene};
use glam::DVec3;

/// Transmittances of some panes, in the place of those that a scene says.
#[derive(Debug, Clone, PartialEq)]
pub struct Glazing {
    /// Materials by name, and what all panes of each together let through at normal incidence [1].
    pub panes: Vec<(String, f64)>,
}

impl Glazing {
    /// Reads `MATERIAL=TRANSMITTANCE` pairs with commas between them.
    ///
    /// # Errors
    /// [`Error::Input`] for what is no such pair and for a material that stands twice, [`Error::Domain`] for a transmittance outside 0 to 1.
    pub fn parse(text: &str) -> Result<Self> {
        let wrong = |problem: String| {
            let remedy = "write it like --glazing south=0.6,roof=0.4";
            Error::input(format!("--glazing {text}"), problem, remedy)
        };
        let mut panes: Vec<(String, f64)> = Vec::new();
        for pair in text.split(',') {
            let (name, value) = (pair.rsplit_once('='))
                .ok_or_else(|| wrong(format!("`{pair}` is no material with a transmittance")))?;
            let name = name.trim().to_owned();
            let share: f64 =
                (value.trim().parse()).map_err(|_| wrong(format!("`{value}` is no number")))?;
            if !(0.0..=1.0).contains(&share) {
                return Err(Error::domain(
                    format!("the transmittance of `{name}`"),
                    share,
                    "0 to 1",
                    "give a share of the light, as 0.72",
                ));
            }
            if panes.iter().any(|(other, _)| *other == name) {
                return Err(wrong(format!("`{name}` stands twice")));
            }
            panes.push((name, share));
        }
        Ok(Glazing { panes })
    }

    /// Puts it into a scene: clear grey glass of as many panes as were there, without tints and pictures.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that no glass has.
    pub fn put(&self, scene: &mut Scene) -> Result<()> {
        for (name, share) in &self.panes {
            let mut is_there = false;
            let own = (scene.materials.iter_mut()).filter(|material| material.name == *name);
            for pane in own.filter_map(|material| material.pane.as_mut()) {
                *pane = Pane {
                    transmittance: DVec3::splat(*share),
                    count: pane.count,
                    ..Pane::CLEAR
                };
                is_there = true;
            }
            if !is_there {
                let glass = scene.materials.iter().filter(|m| m.pane.is_some());
                let names: Vec<&str> = glass.map(|m| m.name.as_str()).collect();
                return Err(Error::input(
                    "--glazing",
                    format!("the scene has no glass `{name}`"),
                    match names.is_empty() {
                        true => "it has none: say in a [[pane]] table which material is".to_owned(),
                        false => format!("its glass is {}", names.join(", ")),
                    },
                ));
            }
        }
        Ok(())
    }

    /// A word for names of files: `south0.6-roof0.4`.
    pub fn tag(&self) -> String {
        let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_');
        let word = |(name, share): &(String, f64)| {
            let name: String = name
                .chars()
                .map(|c| if is_plain(c) { c } else { '_' })
                .collect();
            format!("{name}{share}")
        };
        self.panes.iter().map(word).collect::<Vec<_>>().join("-")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;

    #[test]
    fn pairs_are_read_and_put_into_panes_alone() {
        let glazing = Glazing::parse("a b=0.6, roof=0.25").expect("it is sound");
        assert_eq!(glazing.tag(), "a_b0.6-roof0.25");
        for (text, word) in [
            ("roof", "no material"),
            ("roof=x", "no number"),
            ("roof=1.5", "0 to 1"),
            ("roof=nan", "0 to 1"),
            ("roof=0.1,roof=0.2", "twice"),
        ] {
            let error = Glazing::parse(text).expect_err(text).to_string();
            assert!(error.contains(word), "{error}");
        }
        let glass = |name: &str| Material {
            pane: Some(Pane {
                count: 2,
                is_tinted: true,
                ..Pane::CLEAR
            }),
            ..Material::of(name, DVec3::X)
        };
        let mut scene = Scene {
            materials: vec![glass("a b"), Material::of("roof", DVec3::ONE), glass("c")],
            ..Scene::default()
        };
        let error = glazing
            .put(&mut scene)
            .expect_err("roof is no glass")
            .to_string();
        assert!(
            error.contains("roof") && error.contains("a b, c"),
            "{error}"
        );
        let pane = scene.materials[0].pane.clone().expect("it is glass");
        assert_eq!(pane.transmittance, DVec3::splat(0.6));
        assert!(pane.count == 2 && !pane.is_tinted);
        assert_eq!(scene.materials[2], glass("c"));
    }
}
