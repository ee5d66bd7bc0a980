//! Light comes in beams: parallel, from a place on the sun's disc, or local, from a place on a lamp.
//!
//! A beam stands for a cell of what shines, with its share of the light and its extent; an extent of zero is a point. Shadow
//! maps, the curtain of [`crate::scene::curtain`] and [`crate::medium::Scattering`] take beams, whatever they come from.

use glam::DVec3;

/// No place is nearer to a local beam than a micrometre [m2].
const NEAREST: f64 = 1e-12;

/// Light from one direction or one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beam {
    /// From so far away that direction and illuminance are the same everywhere.
    Parallel {
        /// Unit vector toward where it comes from.
        toward: DVec3,
        /// On a plane that faces it, before any medium of the scene [lx, RGB].
        illuminance: DVec3,
        /// Angular radius of the cell that it stands for [rad]; 0 is a point.
        angular_radius: f64,
    },
    /// From a place near by, the same in all directions.
    Local {
        /// Where it comes from [m], scene axes.
        position: DVec3,
        /// Luminous intensity [cd, RGB].
        intensity: DVec3,
        /// Radius of the cell that it stands for [m]; 0 is a point.
        radius: f64,
    },
}

impl Beam {
    /// Parallel light from a point infinitely far away, in the direction of the unit vector `toward`, of an illuminance [lx, RGB].
    pub fn parallel(toward: DVec3, illuminance: DVec3) -> Self {
        Beam::Parallel {
            toward,
            illuminance,
            angular_radius: 0.0,
        }
    }

    /// Light from a point at `position` [m] of a luminous intensity [cd, RGB].
    pub fn local(position: DVec3, intensity: DVec3) -> Self {
        Beam::Local {
            position,
            intensity,
            radius: 0.0,
        }
    }

    /// Unit vector from a point toward where the light comes from; straight up at that place itself.
    pub fn toward_from(&self, point: DVec3) -> DVec3 {
        match *self {
            Beam::Parallel { toward, .. } => toward,
            Beam::Local { position, .. } => (position - point).try_normalize().unwrap_or(DVec3::Y),
        }
    }

    /// Distance from a point to where the light comes from [m]; infinite for parallel light.
    pub fn distance_from(&self, point: DVec3) -> f64 {
        match *self {
            Beam::Parallel { .. } => f64::INFINITY,
            Beam::Local { position, .. } => position.distance(point),
        }
    }

    /// Illuminance on a plane that faces the light, without shadow and media [lx, RGB]. Nearer to a local beam than its radius (a
    /// micrometre for a point) it does not grow any more.
    pub fn illuminance_at(&self, point: DVec3) -> DVec3 {
        match *self {
            Beam::Parallel { illuminance, .. } => illuminance,
            Beam::Local {
                position,
                intensity,
                radius,
            } => {
                let square = position.distance_squared(point).max(radius * radius);
                intensity / square.max(NEAREST)
            }
        }
    }

    /// What its light is measured by, in red, green and blue: the illuminance of parallel light [lx], the luminous intensity of a local beam [cd].
    pub fn strength(&self) -> DVec3 {
        match *self {
            Beam::Parallel { illuminance, .. } => illuminance,
            Beam::Local { intensity, .. } => intensity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_lamp_is_a_parallel_beam() {
        let toward = DVec3::new(0.36, 0.48, 0.8);
        let far = 1e9;
        let lamp = Beam::local(far * toward, DVec3::splat(5.0 * far * far));
        let sun = Beam::parallel(toward, DVec3::splat(5.0));
        for point in [DVec3::ZERO, DVec3::new(3.0, -2.0, 7.0)] {
            assert!((lamp.toward_from(point) - sun.toward_from(point)).length() < 1e-8);
            let relative = lamp.illuminance_at(point) / sun.illuminance_at(point);
            assert!((relative - 1.0).abs().max_element() < 1e-7);
        }
        // At the lamp itself everything is finite.
        assert!(lamp.toward_from(far * toward).is_finite());
        let there = lamp.illuminance_at(far * toward);
        assert!(there.is_finite() && there.x > 0.0);
    }
}
