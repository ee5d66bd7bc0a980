//! Light from sky and surfaces, everywhere: progressive radiosity over the patches of a scene.
//!
//! What a place receives from each direction comes from a patch of the sky, a patch of a surface, the open ground, or nothing:
//! an [`Arrival`]. Which it is, and what the air on the way lets through, depends on geometry, materials and media alone and
//! lives in [`Transport`]; how bright each source is at a moment lives in [`Light`]. Another time of day over the same scene is
//! another [`Light`] over the same transport.

pub mod air;
mod arrival;
mod build;
mod cells;
mod coefficients;
mod cover;
mod direct;
mod dome;
mod exchange;
mod gaps;
mod gather;
mod hemicube;
mod lamps;
mod lattice;
mod light;
mod openings;
mod patches;
mod planes;
mod points;
mod pools;
mod shards;
mod sun;
mod tiles;
mod transport;

pub use arrival::{Arrival, Care, Source};
pub use coefficients::Coefficients;
pub use dome::Dome;
pub use hemicube::{Drawer, Eye, FACES, Hemicube, Target};
pub use lattice::{Lattice, Received};
pub use light::{Account, Light};
pub use tiles::Tile;
pub use transport::{Detail, Transport};
