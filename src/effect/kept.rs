//! What effects keep on the CPU: solutions that are found once and serve until what they were made of changes.

use super::settings::Settings;
use crate::conditions::{Conditions, Input, Snapshot};
use crate::error::Result;
use crate::radiosity::Drawer;
use crate::task::Task;
use std::any::Any;
use std::sync::{Arc, Mutex, PoisonError};

/// A result that the reference of an effect keeps.
pub struct Keep {
    /// What it is: a name of its own among what the effect keeps.
    pub name: &'static str,
    /// What it is made of, beside the effect's knobs. [`Input::Tile`] and [`Input::Beam`] mean nothing here.
    pub reads: &'static [Input],
}

struct Entry {
    effect: &'static str,
    name: &'static str,
    settings: Vec<(&'static str, f64)>,
    made_of: Snapshot,
    parents: Vec<Shared>,
    value: Shared,
}

/// A kept result of any type.
pub type Shared = Arc<dyn Any + Send + Sync>;

impl Entry {
    fn is_of(&self, parents: &[Shared]) -> bool {
        let same = |(a, b): (&Shared, &Shared)| Arc::ptr_eq(a, b);
        self.parents.len() == parents.len() && self.parents.iter().zip(parents).all(same)
    }
}

/// Results kept from frame to frame, one of each name and effect. Whoever renders many frames holds on to one of these.
#[derive(Default)]
pub struct Kept {
    entries: Mutex<Vec<Entry>>,
    made: Mutex<Vec<&'static str>>,
    notes: Mutex<Vec<String>>,
    /// What draws hemicubes for them.
    drawer: Option<Arc<dyn Drawer>>,
}

/// What is kept, as the effects of a plan get to it while they are prepared.
pub struct Keeper<'k> {
    kept: &'k Kept,
    task: Task<'k>,
}

impl Keeper<'_> {
    /// What draws hemicubes faster than the CPU casts rays, if there is such a thing.
    pub fn drawer(&self) -> Option<&dyn Drawer> {
        self.kept.drawer.as_deref()
    }

    /// The kept result, if nothing that it was made of has changed; else `make` makes it anew, and it takes the old one's place. The
    /// work of making it is a stage of its own, named like the result.
    ///
    /// # Errors
    /// Those of `make`; then nothing is kept.
    pub fn get<T: Any + Send + Sync>(
        &self,
        keep: &Keep,
        conditions: &Conditions,
        settings: &Settings<'_>,
        make: impl FnOnce(Task<'_>) -> Result<T>,
    ) -> Result<Arc<T>> {
        self.get_from(keep, conditions, settings, &[], make)
    }

    /// The same of a result that is made of other kept results too, `parents`: it ends when one of these is another one.
    ///
    /// # Errors
    /// Those of `make`; then nothing is kept.
    pub fn get_from<T: Any + Send + Sync>(
        &self,
        keep: &Keep,
        conditions: &Conditions,
        settings: &Settings<'_>,
        parents: &[Shared],
        make: impl FnOnce(Task<'_>) -> Result<T>,
    ) -> Result<Arc<T>> {
        let kept = self.kept;
        let lock = || kept.entries.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().iter().find_map(|entry| {
            let same = entry.effect == settings.effect
                && entry.name == keep.name
                && entry.settings == settings.values
                && entry.is_of(parents)
                && entry.made_of.still_holds(conditions, keep.reads);
            same.then(|| entry.value.clone())
        });
        if let Some(value) = known.and_then(|value| value.downcast::<T>().ok()) {
            return Ok(value);
        }
        // Not locked, so that what takes long does not keep others waiting.
        let value = Arc::new(make(self.task.stage(keep.name))?);
        let mut entries = lock();
        // What is of another scene would only keep that alive.
        entries.retain(|entry| {
            let same = entry.effect == settings.effect && entry.name == keep.name;
            !same && entry.made_of.is_of_scene(conditions)
        });
        entries.push(Entry {
            effect: settings.effect,
            name: keep.name,
            settings: settings.values.to_vec(),
            made_of: conditions.snapshot(keep.reads),
            parents: parents.to_vec(),
            value: value.clone(),
        });
        drop(entries);
        kept.made
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(keep.name);
        Ok(value)
    }

    /// What another effect keeps, if nothing that it was made of has changed; the effect of a plan that comes before has made it for
    /// this plan.
    pub fn of_other<T: Any + Send + Sync>(
        &self,
        effect: &str,
        keep: &Keep,
        conditions: &Conditions,
    ) -> Option<Arc<T>> {
        let entries = &self.kept.entries;
        let entries = entries.lock().unwrap_or_else(PoisonError::into_inner);
        let entry = entries.iter().find(|entry| {
            entry.effect == effect
                && entry.name == keep.name
                && entry.made_of.still_holds(conditions, keep.reads)
        });
        entry.and_then(|entry| entry.value.clone().downcast::<T>().ok())
    }

    /// Says something about the picture at hand that a user may want to know.
    pub fn note(&self, text: String) {
        let notes = &self.kept.notes;
        let mut notes = notes.lock().unwrap_or_else(PoisonError::into_inner);
        if !notes.contains(&text) {
            notes.push(text);
        }
    }
}

impl Kept {
    /// Nothing yet, and something that draws hemicubes.
    pub fn with_drawer(drawer: Arc<dyn Drawer>) -> Self {
        Kept {
            drawer: Some(drawer),
            ..Kept::default()
        }
    }

    /// Lends it to the effects of a plan, which are prepared as this task.
    pub fn keeper<'k>(&'k self, task: Task<'k>) -> Keeper<'k> {
        Keeper { kept: self, task }
    }

    /// What was made since the last call, by name.
    pub fn take_made(&self) -> Vec<&'static str> {
        std::mem::take(&mut self.made.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// What was said since the last call.
    pub fn take_notes(&self) -> Vec<String> {
        std::mem::take(&mut self.notes.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Drops everything.
    pub fn forget(&self) {
        self.entries
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clear();
    }
}
