//! A batch of rays and what effects have found on them.

use crate::conditions::Receiver;
use crate::frame::Field;
use crate::scene::Ray;
use glam::{DVec3, UVec2};

/// What a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surface {
    /// What it belongs to.
    pub source: Source,
    /// Distance along the ray [m]; infinite where nothing is met.
    pub distance: f64,
    /// Position [m].
    pub position: DVec3,
    /// Unit normal that shading uses, on the eye's side.
    pub normal: DVec3,
    /// Unit normal of the triangle itself, on the eye's side.
    pub facet: DVec3,
    /// Reflectance in the working space, 0 to 1.
    pub albedo: DVec3,
}

/// What a surface belongs to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Nothing is met.
    Nothing,
    /// The endless ground plane.
    Ground,
    /// A triangle of the scene, with the weights of its second and third vertex.
    Triangle(u32, [f64; 2]),
    /// A point whose illuminance is wanted.
    Receiver,
}

impl Surface {
    /// What a ray that meets nothing has.
    pub const NOTHING: Surface = Surface {
        source: Source::Nothing,
        distance: f64::INFINITY,
        position: DVec3::ZERO,
        normal: DVec3::ZERO,
        facet: DVec3::ZERO,
        albedo: DVec3::ZERO,
    };

    /// A point that receives light, at a distance from the middle of all of them [m]: it sends on what it receives, so that its
    /// luminance [cd/m2] is its illuminance [lx].
    pub fn receiver(receiver: &Receiver, distance: f64) -> Surface {
        Surface {
            source: Source::Receiver,
            distance,
            position: receiver.position,
            normal: receiver.normal,
            facet: receiver.normal,
            albedo: DVec3::splat(std::f64::consts::PI),
        }
    }

    /// Whether something is met.
    pub fn is_met(&self) -> bool {
        self.source != Source::Nothing
    }
}

/// How many rays came to an effect with lamps, and how many paid: a ray that misses all volumes that lamps may light costs nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Paid {
    /// Rays that could have met one.
    pub rays: u64,
    /// Those that met one.
    pub met: u64,
    /// Lamps (or the points that stand for one) whose light was found, ray by ray.
    pub pairs: u64,
}

impl Paid {
    /// One ray more, on which the light of so many lamps was found.
    pub fn add(&mut self, lamps: u64) {
        self.rays += 1;
        self.met += u64::from(lamps > 0);
        self.pairs += lamps;
    }

    /// This and what others counted.
    pub fn and(self, other: Paid) -> Paid {
        Paid {
            rays: self.rays + other.rays,
            met: self.met + other.met,
            pairs: self.pairs + other.pairs,
        }
    }
}

/// A batch of rays and what the effects have found on them.
pub struct Fields {
    /// The rays.
    pub rays: Vec<Ray>,
    /// The pixel that each ray belongs to.
    pub pixels: Vec<UVec2>,
    /// Which of its pixel's samples each ray is.
    pub samples: Vec<u32>,
    /// [`Field::Surface`].
    pub surfaces: Vec<Surface>,
    values: [Option<Vec<DVec3>>; Field::COUNT],
    /// What the effect that is at work reads, and what it writes and alters: more it does not get.
    named: Option<(&'static [Field], [&'static [Field]; 2])>,
    paid: Option<Paid>,
}

impl Fields {
    /// A batch with room for the fields that its effects write, and no other.
    pub fn new(rays: Vec<Ray>, pixels: Vec<UVec2>, samples: Vec<u32>, written: &[Field]) -> Self {
        let count = rays.len();
        let mut fields = Fields {
            rays,
            pixels,
            samples,
            surfaces: Vec::new(),
            values: Default::default(),
            named: None,
            paid: None,
        };
        for &field in written {
            match field {
                Field::Surface => fields.surfaces = vec![Surface::NOTHING; count],
                _ => fields.values[field as usize] = Some(vec![field.unwritten(); count]),
            }
        }
        fields
    }

    /// Says what the effect that is at work now reads, and what it writes and alters.
    pub(crate) fn name(&mut self, reads: &'static [Field], changes: [&'static [Field]; 2]) {
        self.named = Some((reads, changes));
    }

    /// Counts the rays that the effect at work paid for.
    pub fn pay(&mut self, paid: Paid) {
        self.paid = Some(self.paid.unwrap_or_default().and(paid));
    }

    /// What was counted since the last call, if anything was.
    pub(crate) fn take_paid(&mut self) -> Option<Paid> {
        self.paid.take()
    }

    /// Whether the effect at work may have a field, to read it or to change it.
    fn is_named(&self, field: Field, to_change: bool) -> bool {
        let named = self.named.is_none_or(|(reads, changes)| {
            let changed = changes.iter().any(|fields| fields.contains(&field));
            changed || !to_change && reads.contains(&field)
        });
        debug_assert!(named, "{:?} is not named", field);
        named
    }

    /// The values of a field, one a ray; `None` when no effect of the plan writes it, or the effect at work does not name it.
    pub fn get(&self, field: Field) -> Option<&[DVec3]> {
        match self.is_named(field, false) {
            true => self.found(field),
            false => None,
        }
    }

    /// The values of a field, whoever asks.
    pub(crate) fn found(&self, field: Field) -> Option<&[DVec3]> {
        self.values[field as usize].as_deref()
    }

    /// Sets every value of a field to what `value` makes of the ray, the pixel, the surface and the present value. A field that
    /// no effect of the plan writes, or that the effect at work does not name, is left alone.
    pub fn update(
        &mut self,
        field: Field,
        mut value: impl FnMut(&Ray, UVec2, &Surface, DVec3) -> DVec3,
    ) {
        if !self.is_named(field, true) {
            return;
        }
        let Some(values) = self.values[field as usize].as_mut() else {
            return;
        };
        for (i, present) in values.iter_mut().enumerate() {
            *present = value(&self.rays[i], self.pixels[i], &self.surfaces[i], *present);
        }
    }

    /// The same with the value of another field, the last argument: one where nobody wrote that field and it is a share of light,
    /// else zero.
    pub fn update_by(
        &mut self,
        field: Field,
        by: Field,
        mut value: impl FnMut(&Ray, UVec2, &Surface, DVec3, DVec3) -> DVec3,
    ) {
        let other: Option<Vec<DVec3>> = self.get(by).map(<[DVec3]>::to_vec);
        let mut other = other.into_iter().flatten();
        self.update(field, |ray, pixel, surface, present| {
            let by = other.next().unwrap_or(by.unwritten());
            value(ray, pixel, surface, present, by)
        });
    }

    /// Puts values in the place of a field's, one a ray, as a backend does with what others have found.
    pub(crate) fn put(&mut self, field: Field, found: Vec<DVec3>) {
        self.values[field as usize] = Some(found);
    }

    /// Multiplies one field by another.
    pub fn multiply(&mut self, field: Field, by: Field) {
        if !self.is_named(field, true) || !self.is_named(by, false) {
            return;
        }
        let Some(factors) = self.values[by as usize].take() else {
            return;
        };
        if let Some(values) = self.values[field as usize].as_mut() {
            for (value, factor) in values.iter_mut().zip(&factors) {
                *value *= *factor;
            }
        }
        self.values[by as usize] = Some(factors);
    }
}
