//! What trades accuracy for time in an effect.

/// A number that can be set: most trade accuracy for time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knob {
    /// Its name.
    pub name: &'static str,
    /// What it counts, with its unit.
    pub meaning: &'static str,
    /// Its value at each quality: draft, preview, high, reference.
    pub values: [f64; 4],
    /// Its least and greatest value.
    pub range: [f64; 2],
}

/// The knobs of one effect as a plan has set them.
#[derive(Debug, Clone, Copy)]
pub struct Settings<'a> {
    /// The effect's name.
    pub effect: &'static str,
    /// The knobs' names and values.
    pub values: &'a [(&'static str, f64)],
}

impl Settings<'_> {
    /// The value of a knob that the effect declares.
    pub fn get(&self, knob: &str) -> f64 {
        self.values
            .iter()
            .find(|(name, _)| *name == knob)
            .map(|(_, value)| *value)
            .unwrap_or_else(|| {
                let known: Vec<&str> = self.values.iter().map(|(name, _)| *name).collect();
                let known = known.join(", ");
                panic!(
                    "the effect `{}` asks for its knob `{knob}`, which it does not declare; it has {known}",
                    self.effect
                )
            })
    }
}
