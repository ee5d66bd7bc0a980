//! Light of sky and surfaces that the air scatters once toward the eye.
//!
//! L(T) = sum over kinds of media of integral_0^T sigma_s(t) e^-tau(t) J(x(t), w) dt,
//! J(x, w) = integral over the sphere of p(w, w') L_in(x, w') dw'
//!
//! Media of one phase function are one kind ([`crate::medium::Kind`]); tau is the optical depth of all media from the eye. What
//! comes in, L_in, has passed the media on its way. J is smooth where the media are not: so each ray has its own exact weight
//! W(T) = integral sigma_s e^-tau dt ([`crate::medium::Sight`]), and J a mean that is found on fewer rays and interpolated:
//!
//! | file | what |
//! |---|---|
//! | `fineness` | how finely it is found |
//! | `lobe` | phase functions averaged over what one arrival stands for |
//! | `sphere` | the light of what comes from each cell of the sphere |
//! | `source` | J from what comes in |
//! | `lattice` | places that stand still in the world, and what comes to them |
//! | `enclosed` | J near the scene, interpolated on the lattice between places that see each other |
//! | `open` | J far from the scene, by height and direction |
//! | `around` | both, blended |
//! | `knots`, `column` | J along one eye ray |
//! | `picture` | its mean all over a picture |
//!
//! Light that is scattered more than once is neglected: in air of optical depth tau and single-scattering albedo w, about w tau / 2
//! of what is found here.

mod around;
mod column;
mod enclosed;
mod fineness;
mod knots;
mod lattice;
mod lobe;
mod open;
mod picture;
mod source;
mod sphere;

pub use fineness::Fineness;
pub use lattice::Lattice;
pub use picture::Picture;

use super::light::Light;
use crate::conditions::Conditions;
use crate::medium::{Medium, kinds};
use around::{Around, bounds};
use enclosed::{Enclosed, Eye, surroundings};
use knots::Knots;
use open::OpenAir;
use source::Lobes;
use std::sync::Arc;

/// The air's light in the picture of one view, at a moment: found as rays ask for it. `lattice` is that of the same geometry, materials and media, `light` that of
/// the moment.
pub fn picture(
    conditions: &Conditions,
    lattice: Arc<Lattice>,
    light: Arc<Light>,
    fineness: Fineness,
) -> Picture {
    let kinds = kinds(&conditions.air);
    let lobes = Arc::new(Lobes::new(&kinds));
    let eye = Eye::new(conditions);
    let size = bounds(conditions).map_or(100.0, |[low, high]| (high - low).length());
    // J changes over a box of fog as it does among walls.
    let bounded = conditions.air.media.iter().filter_map(Medium::bounds);
    let narrowest = bounded.map(|[min, max]| 0.25 * (max - min).min_element());
    let otherwise = narrowest.fold(0.3 * size, f64::min).max(1e-9 * size);
    let near = surroundings(conditions, eye, otherwise);
    // J is looked up more often along a ray than it is found.
    let step = 0.5 * fineness.spacing;
    let knots = match eye {
        Eye::At(place) => {
            let dense = conditions.air.extinction_at(place).max_element();
            Knots::new(step, near, dense)
        }
        Eye::Parallel(_, height) => Knots::new(step, 0.5 * height, 0.0),
    };
    let open = OpenAir::new(conditions, &light, lobes.clone());
    let enclosed = Enclosed::new(lattice, light, lobes, conditions, fineness, near);
    let around = Around::new(conditions, enclosed, open);
    Picture::new(conditions, around, kinds, knots, fineness.columns)
}
