//! The order of a tile's work. Effects run in the order of the plan, but for two things: passes for each beam run together, so that
//! the maps of a beam are drawn once for all, and what the CPU does is done as early as may be, so that the device is seldom
//! waited for. Neither may change what anybody reads.

use crate::effect::{Effect, Field, Over, Pass, RasterView, Resource};

/// What a stage reads and what it changes.
#[derive(Debug, Clone, Default)]
pub struct Touched {
    reads: Vec<Thing>,
    changes: Vec<Thing>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Thing {
    Field(Field),
    /// A product of an effect.
    Product(&'static str, &'static str),
    /// The triangles in pixels, and those in a hemicube's.
    Numbers,
    Faces(&'static str),
}

impl Touched {
    /// By an effect that the CPU does.
    pub fn by_host(effect: &'static Effect) -> Self {
        let things = |fields: &[Field]| fields.iter().map(|f| Thing::Field(*f)).collect::<Vec<_>>();
        Touched {
            reads: [
                things(effect.reads),
                // What is altered is read.
                things(effect.alters),
                vec![Thing::Field(Field::Surface)],
            ]
            .concat(),
            changes: [things(effect.writes), things(effect.alters)].concat(),
        }
    }

    /// By a pass, over one of its fields if it is one over fields.
    pub fn by_pass(effect: &'static Effect, pass: &Pass, each: Option<Field>) -> Self {
        let mut touched = Touched::default();
        for resource in pass.uses {
            match resource {
                Resource::Read(field) => touched.reads.push(Thing::Field(*field)),
                Resource::Update(field) => touched.change(effect, *field),
                Resource::Each => each.iter().for_each(|field| touched.change(effect, *field)),
                Resource::Use(product) => {
                    touched
                        .reads
                        .push(Thing::Product(effect.name, product.name));
                }
                Resource::Make(product) => {
                    touched
                        .changes
                        .push(Thing::Product(effect.name, product.name));
                }
                Resource::Numbers => touched.reads.push(Thing::Numbers),
                Resource::Faces => touched.reads.push(Thing::Faces(effect.name)),
                _ => {}
            }
        }
        if let Over::Raster(view) = pass.over {
            touched.changes.push(match view {
                RasterView::Hemicube(_) => Thing::Faces(effect.name),
                _ => Thing::Numbers,
            });
        }
        touched
    }

    /// A field that is written or added to, or altered, which reads it.
    fn change(&mut self, effect: &Effect, field: Field) {
        self.changes.push(Thing::Field(field));
        if effect.alters.contains(&field) {
            self.reads.push(Thing::Field(field));
        }
    }

    /// Whether the order of two stages matters.
    fn depends_on(&self, other: &Touched) -> bool {
        meets(&self.reads, &other.changes)
            || meets(&self.changes, &other.changes)
            || meets(&self.changes, &other.reads)
    }
}

fn meets(some: &[Thing], others: &[Thing]) -> bool {
    some.iter().any(|thing| others.contains(thing))
}

/// One entry of the order.
pub enum Action {
    /// A stage, once.
    Stage(usize),
    /// Stages, in turns for each beam.
    Beams(Vec<usize>),
}

/// The order, and what is touched by each entry, by which effect.
#[derive(Default)]
pub struct Schedule {
    pub actions: Vec<Action>,
    touched: Vec<Vec<(&'static str, Touched)>>,
}

impl Schedule {
    /// A stage behind all others.
    pub fn tile(&mut self, stage: usize, touched: Touched) {
        self.actions.push(Action::Stage(stage));
        self.touched.push(vec![("", touched)]);
    }

    /// A stage for each beam: together with the last ones, unless something between depends on the order, or it reads what others
    /// of them only have when all beams are through.
    pub fn each_beam(&mut self, stage: usize, effect: &'static str, touched: Touched) {
        let last = self
            .actions
            .iter()
            .rposition(|action| matches!(action, Action::Beams(_)));
        if let Some(last) = last {
            let behind = self.touched[last + 1..].iter().flatten();
            let between = behind.clone().any(|(_, other)| touched.depends_on(other));
            let among = self.touched[last].iter().any(|(owner, other)| {
                let after = meets(&touched.reads, &other.changes);
                let before = meets(&touched.changes, &other.reads);
                *owner != effect && (after || before)
            });
            if !between && !among {
                if let Action::Beams(stages) = &mut self.actions[last] {
                    stages.push(stage);
                }
                self.touched[last].push((effect, touched));
                return;
            }
        }
        self.actions.push(Action::Beams(vec![stage]));
        self.touched.push(vec![(effect, touched)]);
    }

    /// A stage of the CPU, as early as may be. Returns the fields that are changed before it.
    pub fn host(&mut self, stage: usize, touched: &Touched) -> Vec<Field> {
        let depends = |others: &Vec<(&str, Touched)>| {
            let mut others = others.iter();
            others.any(|(_, other)| touched.depends_on(other))
        };
        let at = self.touched.iter().rposition(depends).map_or(0, |i| i + 1);
        self.actions.insert(at, Action::Stage(stage));
        self.touched.insert(at, vec![("", touched.clone())]);
        let before = self.touched[..at].iter().flatten();
        before
            .flat_map(|(_, other)| &other.changes)
            .filter_map(|thing| match thing {
                Thing::Field(field) => Some(*field),
                _ => None,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touched(reads: &[Field], changes: &[Field]) -> Touched {
        let things = |fields: &[Field]| fields.iter().map(|f| Thing::Field(*f)).collect();
        Touched {
            reads: things(reads),
            changes: things(changes),
        }
    }

    fn order(schedule: &Schedule) -> Vec<Vec<usize>> {
        let stages = |action: &Action| match action {
            Action::Stage(stage) => vec![*stage],
            Action::Beams(stages) => stages.clone(),
        };
        schedule.actions.iter().map(stages).collect()
    }

    #[test]
    fn beams_go_together_unless_something_between_depends_on_them() {
        use Field::{Background, InscatterSun, Sky, Sun, Surface, Transmittance};
        let mut schedule = Schedule::default();
        schedule.tile(0, touched(&[], &[Surface]));
        schedule.each_beam(1, "surface", touched(&[Surface], &[Sun]));
        schedule.tile(2, touched(&[Surface], &[Background]));
        // Joins the first: nobody between has to do with it.
        schedule.each_beam(3, "air", touched(&[Surface], &[InscatterSun]));
        assert_eq!(order(&schedule), [vec![0], vec![1, 3], vec![2]]);
        // Reads what was written between.
        schedule.each_beam(4, "shadow", touched(&[Background], &[Transmittance]));
        // Reads what another one's passes only have behind all beams.
        schedule.each_beam(5, "glow", touched(&[Transmittance], &[Sky]));
        // Its own passes may go on from beam to beam.
        schedule.each_beam(6, "glow", touched(&[Sky], &[Sky]));
        // Changes what another one reads for each beam, which must not see it early.
        schedule.each_beam(7, "late", touched(&[], &[Transmittance]));
        assert_eq!(
            order(&schedule),
            [vec![0], vec![1, 3], vec![2], vec![4], vec![5, 6], vec![7]]
        );
    }

    #[test]
    fn the_cpu_works_as_early_as_may_be_and_knows_what_is_there() {
        use Field::{Background, Sky, Sun, Surface};
        let mut schedule = Schedule::default();
        schedule.tile(0, touched(&[], &[Surface]));
        schedule.each_beam(1, "surface", touched(&[Surface], &[Sun]));
        schedule.tile(2, touched(&[Surface], &[Background]));
        let before = schedule.host(3, &touched(&[Surface], &[Sky]));
        assert_eq!(before, [Surface]);
        let before = schedule.host(4, &touched(&[Surface], &[Background]));
        assert!(before.contains(&Background) && before.contains(&Sun));
        assert_eq!(
            order(&schedule),
            [vec![0], vec![3], vec![1], vec![2], vec![4]]
        );
        // What it changes was read by nobody before; what reads it comes behind.
        schedule.tile(5, touched(&[Sky, Sun], &[Background]));
        let before = schedule.host(6, &touched(&[], &[Sun]));
        assert!(before.contains(&Sun));
        assert_eq!(order(&schedule).last(), Some(&vec![6]));
    }
}
