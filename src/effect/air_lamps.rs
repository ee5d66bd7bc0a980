//! Light of lamps scattered once by the air toward the eye: cones, glows.
//!
//! L = sum over lamps of integral over the ray of sum_i sigma_s,i p_i(mu) I(direction) e^-(tau_eye + tau_lamp) V / d^2 dt. The part of
//! the ray that a lamp's cone and side leave is found first: a ray that meets none costs nothing more. On it the fan between lamp and
//! ray gives the exact lit runs ([`crate::scene::curtain`]), and each is integrated in the angle that the lamp sees
//! ([`crate::medium::LocalScattering`]), in which nothing peaks however near the lamp is. A lamp with an extent is as many points as `points`
//! says; a surface that shines is parts no larger than 1 / `points` of how far they are from the ray.
//!
//! Lamps are gone through by the most that they could add ([`crate::conditions::volumes`]): a ray that misses all that they may shine on pays
//! nothing, and the last, which together could add less than a share of what the others do, or of many lamps a fiftieth of that share of
//! what half of the picture's rays get, are left out. Light that is scattered more than once is neglected.
//!
//! On a GPU the fan goes through the tree of casters in f32, and each lit run is integrated by seven points on parts that are halved.
//!
//! That is the reference and what a picture is made with. Other ways of integrating, for comparison, are the values of the knob
//! `integrator` ([`Integrator`]).

mod integrator;
mod met;
mod most;
mod planes;
mod rows;

pub use integrator::Integrator;

use super::surface_lamps::{LEFT_OUT, NO_LAMPS, counted};
use super::visibility::first_surface;
use super::{
    Contribution, Decision, Effect, Field, Knob, Number, Over, Paid, Pass, Resource, Settings,
    When, lamps_on_device,
};
use crate::colour::luminance;
use crate::conditions::lamps::{Lamp, Spot};
use crate::conditions::volumes::{Bounds, Queue, Volume, Volumes};
use crate::conditions::{Conditions, spread};
use crate::error::Result;
use crate::medium::gauss_nodes;
use crate::scene::Ray;
use crate::scene::shade::Shade;
use glam::{DMat3, DVec3};
use integrator::{Care, integrate};
use met::Met;
use most::{Most, lit_world};
use planes::Planes;
use rows::Rows;

/// Light of lamps in the air.
pub const AIR_LAMPS: Effect = Effect {
    name: "air_lamps",
    summary: "light of lamps that the air scatters to the eye",
    reads: &[Field::Surface],
    writes: &[Field::InscatterLights],
    knobs: &[
        Knob {
            name: "points",
            meaning: "points, each way, that stand for a lamp with an extent",
            values: [1.0, 2.0, 4.0, 8.0],
            range: [1.0, 64.0],
        },
        Knob {
            name: "error",
            meaning: "relative error of the integral over a lit run",
            values: [1e-2, 1e-3, 3e-4, 1e-6],
            range: [1e-9, 0.1],
        },
        LEFT_OUT,
        INTEGRATOR,
        Knob {
            name: "nodes",
            meaning: "nodes on each lit run (equiangular)",
            values: [4.0, 8.0, 16.0, 64.0],
            range: [1.0, 1024.0],
        },
        Knob {
            name: "planes",
            meaning: "virtual planes through the air that the picture shows (planes)",
            values: [15.0, 75.0, 150.0, 600.0],
            range: [1.0, 4096.0],
        },
        Knob {
            name: "lattice",
            meaning: "lattice points along each side of a plane (planes)",
            values: [10.0, 20.0, 40.0, 80.0],
            range: [2.0, 512.0],
        },
        Knob {
            name: "map",
            meaning: "texels along each side of a lamp's light map (planes)",
            values: [64.0, 64.0, 128.0, 256.0],
            range: [4.0, 4096.0],
        },
        Knob {
            name: "rows",
            meaning: "half-planes around the line from the eye to a lamp (rows)",
            values: [256.0, 512.0, 1024.0, 4096.0],
            range: [1.0, 65536.0],
        },
    ],
    decide,
    reference: |conditions, settings, _| {
        let points = settings.get("points") as u32;
        let spots: Vec<(&Lamp, Spot)> = conditions
            .lamps
            .iter()
            .filter(|lamp| lamp.glow().is_none())
            .flat_map(|lamp| lamp.spots(points).into_iter().map(move |spot| (lamp, spot)))
            .collect();
        let lamps = AirLamps::new(conditions, spots, settings)?;
        Ok(Box::new(move |fields| {
            let mut at_hand = AtHand::default();
            let mut paid = Paid::default();
            fields.update(Field::InscatterLights, |ray, _, surface, present| {
                let (light, pairs) = lamps.on(ray, surface.distance, &mut at_hand);
                paid.add(pairs);
                present + light
            });
            fields.pay(paid);
        }))
    },
    passes: &[Pass {
        shader: include_str!("../../shaders/air_lamps.wgsl"),
        entry: "scatter",
        over: Over::Pixels,
        when: When::Parts(lamps_on_device::parts),
        uses: &[
            Resource::Read(Field::Surface),
            Resource::Update(Field::InscatterLights),
            Resource::Knobs(|conditions, settings| {
                let mut knobs = lamps_on_device::knobs(conditions, settings);
                // f32 does not tell less.
                knobs.push(("error", Number::float(settings.get("error").max(3e-5))));
                let strongest = lamps_on_device::strongest(conditions);
                knobs.push(("strongest", Number::float(strongest)));
                knobs
            }),
            Resource::Part,
            Resource::Lamps(lamps_on_device::texels),
            Resource::CasterTree,
            Resource::CasterCorners,
            Resource::Facets,
            Resource::Materials,
        ],
    }],
    ..Effect::NOTHING
};

/// Which [`Integrator`] is at work.
pub const INTEGRATOR: Knob = Knob {
    name: "integrator",
    meaning: "0: exact; to compare with it 1: glow, 2: airlight, 3: equiangular, 4: planes, 5: rows",
    values: [0.0; 4],
    range: [0.0, 5.0],
};

fn decide(conditions: &Conditions) -> Decision {
    if conditions.lamps.is_empty() {
        return Decision::nothing(NO_LAMPS);
    }
    let media = &conditions.air.media;
    if media.is_empty() {
        return Decision::nothing("the scene has no medium: nothing scatters light");
    }
    if media.iter().all(|m| m.scattering.max_element() == 0.0) {
        return Decision::nothing("no medium scatters light");
    }
    let strongest = media.iter().map(|m| m.phase.peak()).fold(0.0, f64::max);
    let lit = -(-conditions.greatest_optical_depth()).exp_m1();
    let contribution = match conditions.greatest_lamp_luminance() {
        bound if bound.is_finite() => Contribution::Bound(lit * bound),
        _ => Contribution::Estimate(strongest * lit * conditions.typical_lamp_light()),
    };
    Decision::run(
        format!(
            "{} in {}",
            counted(conditions.lamps.len()),
            conditions.media_phrase()
        ),
        contribution,
    )
}

/// With no more lamps than this none are left out for what others give elsewhere.
const FEW: usize = 8;

/// What is left out for that, of the share that is left out of a ray's own light [1]: dark rays beside bright ones keep theirs.
const DARK: f64 = 0.02;

/// So many rays tell what those of the picture get.
const PROBES: usize = 32;

/// The lamps of a scene as the air sees them.
struct AirLamps<'c> {
    conditions: &'c Conditions,
    spots: Vec<(&'c Lamp, Spot)>,
    volumes: Volumes,
    /// Lamps that are surfaces of the scene, of which a ray has as many `points` each way as they are wide from there.
    shining: Vec<&'c Lamp>,
    points: u32,
    care: Care,
    /// What virtual planes hold, where they integrate.
    planes: Option<Planes<'c>>,
    /// Rows in the planes of eye and lamps, where they tell the lit runs.
    rows: Option<Rows<'c>>,
    left_out: f64,
    /// What adds up to no more does not matter on any ray [cd/m2, luminance].
    negligible: f64,
}

/// What is kept from ray to ray for its memory.
#[derive(Default)]
struct AtHand<'c> {
    queue: Queue<Met<'c>>,
    shades: Vec<Shade>,
}

impl<'c> AirLamps<'c> {
    fn new(
        conditions: &'c Conditions,
        spots: Vec<(&'c Lamp, Spot)>,
        settings: &Settings<'_>,
    ) -> Result<Self> {
        let world: Bounds = lit_world(conditions);
        let of = |(lamp, spot): &(&Lamp, Spot)| {
            Volume::new(lamp, spot.position, 0.0, spot.share, &world)
        };
        let volumes: Vec<Volume> = spots.iter().map(of).collect();
        let integrator = Integrator::ALL[settings.get("integrator") as usize];
        let planes = match integrator {
            Integrator::Planes => {
                let fine = ["planes", "lattice", "map"].map(|knob| settings.get(knob) as usize);
                Some(Planes::new(conditions, &spots, fine)?)
            }
            _ => None,
        };
        let rows = (integrator == Integrator::Rows)
            .then(|| Rows::new(conditions, spots.len(), settings.get("rows") as usize))
            .transpose()?;
        let mut lamps = AirLamps {
            conditions,
            rows,
            spots,
            volumes: Volumes::new(&volumes),
            shining: conditions
                .lamps
                .iter()
                .filter(|lamp| lamp.glow().is_some())
                .collect(),
            points: settings.get("points") as u32,
            planes,
            care: Care {
                integrator,
                error: settings.get("error"),
                nodes: gauss_nodes(settings.get("nodes") as u32),
            },
            left_out: settings.get("left_out"),
            negligible: 0.0,
        };
        if conditions.lamps.len() > FEW {
            lamps.negligible = DARK * lamps.left_out * lamps.typical();
        }
        Ok(lamps)
    }

    /// What half of the picture's rays get at least, as a few tell [cd/m2, luminance].
    fn typical(&self) -> f64 {
        let view = &self.conditions.view;
        let mut at_hand = AtHand::default();
        let light = |pixel: glam::UVec2| {
            let ray = view.ray(pixel.as_dvec2() + 0.5);
            let surface = first_surface(self.conditions, &ray, 0.5, DMat3::IDENTITY);
            luminance(self.on(&ray, surface.distance, &mut at_hand).0)
        };
        let mut lights: Vec<f64> = spread(view.size, PROBES).into_iter().map(light).collect();
        lights.sort_unstable_by(f64::total_cmp);
        lights.get(lights.len() / 2).copied().unwrap_or(0.0)
    }

    /// What all lamps add to a ray up to a distance [cd/m2, RGB], and of how many spots the light was found.
    fn on(&self, ray: &Ray, distance: f64, at_hand: &mut AtHand<'c>) -> (DVec3, u64) {
        let conditions = self.conditions;
        let end = conditions.air.end(ray.origin, ray.direction).min(distance);
        let (mut sum, mut pairs) = (DVec3::ZERO, 0);
        if end <= 0.0 {
            return (sum, pairs);
        }
        let most = Most::new(conditions, ray, end);
        let AtHand { queue, shades } = at_hand;
        self.volumes.strongest_first(
            queue,
            self.negligible,
            |group| most.of_group(group),
            |number| {
                let (lamp, spot) = self.spots[number];
                let met = Met::of(conditions, (number, lamp, spot), ray, end)?;
                Some((most.of_spot(lamp, &spot, met.span), met))
            },
            |met| {
                pairs += 1;
                sum += met.light() * self.share(&met, ray, shades);
                (self.left_out * luminance(sum)).max(self.negligible)
            },
        );
        // Of surfaces that shine each ray has spots of its own.
        let mut parts = Vec::new();
        for lamp in &self.shining {
            lamp.faces_along(ray, end, self.points, |spot| {
                if let Some(met) = Met::of(conditions, (usize::MAX, lamp, spot), ray, end) {
                    parts.push((most.of_spot(lamp, &spot, met.span), met));
                }
            });
        }
        parts.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let rests = rests(parts.iter().map(|(most, _)| *most));
        for ((_, met), rest) in parts.iter().zip(rests) {
            if rest <= (self.left_out * luminance(sum)).max(self.negligible) {
                break;
            }
            pairs += 1;
            sum += met.light() * self.share(met, ray, shades);
        }
        (sum, pairs)
    }
}

/// What each of some bounds and all behind it add up to, from the weakest on: so small ones keep their digits beside large ones.
fn rests(bounds: impl DoubleEndedIterator<Item = f64>) -> Vec<f64> {
    let add = |sum: &mut f64, bound: f64| {
        *sum += bound;
        Some(*sum)
    };
    let mut rests: Vec<f64> = bounds.rev().scan(0.0, add).collect();
    rests.reverse();
    rests
}

impl AirLamps<'_> {
    /// What a spot adds for each candela of its lamp [1/(m2 sr)].
    fn share(&self, met: &Met<'_>, ray: &Ray, shades: &mut Vec<Shade>) -> DVec3 {
        // Surfaces that shine have neither planes nor rows, and neither knows panes.
        let is_plain = met.number < self.spots.len() && self.conditions.geometry.panes().is_none();
        if let Some(planes) = self.planes.as_ref().filter(|_| is_plain) {
            return planes.light(met.number, &met.spot, ray, met.span);
        }
        let of_row = self.rows.as_ref().filter(|_| is_plain).and_then(|rows| {
            shades.resize_with(1, Shade::default);
            rows.lit_runs(met, ray, &mut shades[0])
        });
        let runs = of_row.unwrap_or_else(|| met.lit_runs(self.conditions, ray, shades));
        match runs.is_empty() {
            true => DVec3::ZERO,
            false => integrate(self.conditions, met, ray, &runs, &self.care),
        }
    }
}
