//! Where the sun stands, and sunlight at the ground: the extraterrestrial spectrum through the clear atmosphere, and the disc.
//!
//! E(lambda) = E0(lambda) / R^2 * Tr * Ta * To * Tw * Tg, the parametric model of Leckner 1978, Iqbal 1983 and Bird &
//! Riordan 1986 (SPECTRL2), which Preetham et al. 1999 (appendix A.1) use as well:
//! - molecules: exp(-m' / (L^4 (115.6406 - 1.335 / L^2))), L in micrometres;
//! - aerosol: exp(-beta L^-1.3 m), beta = 0.04608366 T - 0.04586026 (Preetham 1999, from turbidity T);
//! - ozone: exp(-k l m_o), m_o the air mass of a layer 22 km up;
//! - water vapour: exp(-0.2385 k w m / (1 + 20.07 k w m)^0.45);
//! - mixed gases: exp(-1.41 k m' / (1 + 118.93 k m')^0.45).
//!
//! m is the relative optical air mass of Kasten & Young 1989 at the apparent elevation, m' the same times pressure over
//! 1013.25 hPa. While the disc crosses the horizon, m is taken at the centroid of the part that is above it, so that it
//! never exceeds its value at the horizon (37.9) and everything is finite and smooth down to the last ray.

use super::angles::elevation_of;
use crate::colour::{cie1931, into_gamut, working_from_xyz};
use crate::error::{Error, Result};
use crate::units::{DEG, LUMINOUS_EFFICACY, STANDARD_PRESSURE_HPA, SUN_DIAMETER};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// One cell of the solar spectrum with the absorption of the gases there.
struct Cell {
    wavelength_um: f64,
    width_nm: f64,
    irradiance: f64,
    ozone: f64,
    water: f64,
    gas: f64,
    bar: DVec3,
}

static SPECTRUM: LazyLock<Vec<Cell>> = LazyLock::new(|| {
    include_str!("../../data/sun_spectrum.csv")
        .lines()
        .skip(1)
        .map(|line| {
            let mut cells = line.split(',').map(|c| c.parse().unwrap_or(f64::NAN));
            let [wavelength_nm, width_nm, irradiance, ozone, water, gas] =
                [(); 6].map(|()| cells.next().unwrap_or(f64::NAN));
            Cell {
                wavelength_um: wavelength_nm / 1000.0,
                width_nm,
                irradiance,
                ozone,
                water,
                gas,
                bar: cie1931::matching_functions(wavelength_nm),
            }
        })
        .collect()
});

/// Where the sun stands for a sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunAt {
    /// Unit vector toward the apparent sun in scene axes (+Y up).
    pub toward_sun: DVec3,
    /// True (geometric) elevation [rad]: what models and the twilight curve go by.
    pub elevation_true: f64,
    /// Distance [au].
    pub distance_au: f64,
    /// The site's height above sea level [m].
    pub site_elevation: f64,
}

impl SunAt {
    /// A sun without refraction, one astronomical unit away, over sea level. `toward_sun` is a unit vector.
    pub fn unrefracted(toward_sun: DVec3) -> Self {
        SunAt {
            toward_sun,
            elevation_true: elevation_of(toward_sun),
            distance_au: 1.0,
            site_elevation: 0.0,
        }
    }

    /// Unit vector toward the sun's azimuth in the horizontal plane; +X for a sun in the zenith.
    pub(super) fn toward_azimuth(&self) -> DVec3 {
        let flat = DVec3::new(self.toward_sun.x, 0.0, self.toward_sun.z);
        flat.try_normalize().unwrap_or(DVec3::X)
    }
}

/// Where the sun is and what its light passes through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPath {
    /// Apparent elevation of the disc's centre [rad], refraction included, -pi/2 to pi/2.
    pub elevation_apparent: f64,
    /// Distance [au], positive.
    pub distance_au: f64,
    /// Air pressure at the site [hPa], 0 to 1100; 0 is above the atmosphere's molecules.
    pub pressure_hpa: f64,
    /// Turbidity [1], 1 (molecules alone) to 30.
    pub turbidity: f64,
    /// Precipitable water [cm], 0 to 10.
    pub water_cm: f64,
    /// Ozone column [atm-cm], 0 to 1.
    pub ozone_cm: f64,
}

impl SunPath {
    /// At one astronomical unit over sea level, with 2 cm of water and 0.35 atm-cm of ozone (Preetham 1999).
    pub fn standard(elevation_apparent: f64, turbidity: f64) -> Self {
        SunPath {
            elevation_apparent,
            distance_au: 1.0,
            pressure_hpa: STANDARD_PRESSURE_HPA,
            turbidity,
            water_cm: 2.0,
            ozone_cm: 0.35,
        }
    }

    fn check(&self) -> Result<()> {
        let within = |name: &str, value: f64, unit: &str, low: f64, high: f64, remedy: &str| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(Error::domain(
                    name,
                    format!("{value}{unit}"),
                    format!("{low} to {high}{unit}"),
                    remedy,
                ))
            }
        };
        within(
            "the sun's elevation",
            self.elevation_apparent / DEG,
            " degrees",
            -90.0,
            90.0,
            "give the elevation above the horizon",
        )?;
        within(
            "the sun's distance",
            self.distance_au,
            " au",
            0.5,
            2.0,
            "give about 1",
        )?;
        within(
            "the pressure",
            self.pressure_hpa,
            " hPa",
            0.0,
            1100.0,
            "give hPa at the site, not at sea level",
        )?;
        within(
            "the turbidity",
            self.turbidity,
            "",
            1.0,
            30.0,
            "2 is a very clear day, 10 is haze",
        )?;
        within(
            "the precipitable water",
            self.water_cm,
            " cm",
            0.0,
            10.0,
            "2 is usual",
        )?;
        within(
            "the ozone column",
            self.ozone_cm,
            " atm-cm",
            0.0,
            1.0,
            "0.35 is usual",
        )
    }
}

/// Direct sunlight at the site, before the scene's own media.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunLight {
    /// Illuminance [lx], RGB in the working space, on a plane that faces the sun, from the part of the disc above the horizon.
    pub illuminance: DVec3,
    /// The same as if the whole disc were above the horizon: what the disc's luminance follows.
    pub full_illuminance: DVec3,
    /// Share of the disc above the horizon [1], 0 to 1.
    pub visible_share: f64,
    /// Direct-normal irradiance of the visible part [W/m2], 0.3 to 4 micrometres; `None` for a sun that the user gave.
    pub irradiance: Option<f64>,
    /// Angular radius of the disc [rad].
    pub angular_radius: f64,
    /// Apparent elevation [rad] of the centroid of the visible part, not negative.
    pub visible_elevation: f64,
    /// Relative optical air mass [1] of the visible part, at standard pressure; `None` for a sun that the user gave.
    pub air_mass: Option<f64>,
}

impl SunLight {
    /// Sunlight through a clear atmosphere.
    ///
    /// Errors: [`Error::Domain`] when a quantity of `path` is outside its range.
    /// Model error: the illuminance at the ground agrees within 5 % with SPECTRL2 and Preetham's own figures.
    pub fn new(path: &SunPath) -> Result<Self> {
        path.check()?;
        let radius = (0.5 * SUN_DIAMETER / path.distance_au).asin();
        let (visible_share, elevation) = visible_part(path.elevation_apparent, radius);
        let air_mass = relative_air_mass(elevation);
        let (xyz, irradiance) = through_air(&SPECTRUM, path, elevation, air_mass);
        let full_illuminance = into_gamut(working_from_xyz(xyz));
        Ok(SunLight {
            illuminance: full_illuminance * visible_share,
            full_illuminance,
            visible_share,
            irradiance: Some(irradiance * visible_share),
            angular_radius: radius,
            visible_elevation: elevation,
            air_mass: Some(air_mass),
        })
    }

    /// A sun of given illuminance [lx, RGB in the working space], angular radius and elevation [rad], wholly visible; radius 0 is a point.
    pub fn of_illuminance(illuminance: DVec3, angular_radius: f64, elevation: f64) -> Self {
        SunLight {
            illuminance,
            full_illuminance: illuminance,
            visible_share: 1.0,
            irradiance: None,
            angular_radius,
            visible_elevation: elevation.max(0.0),
            air_mass: None,
        }
    }

    /// Illuminance [lx] on the horizontal plane: RGB in the working space.
    pub fn horizontal_illuminance(&self) -> DVec3 {
        self.illuminance * self.visible_elevation.sin()
    }

    /// The same sun with its light times `factor` [1], not negative.
    pub fn dimmed(self, factor: f64) -> Self {
        SunLight {
            illuminance: self.illuminance * factor,
            full_illuminance: self.full_illuminance * factor,
            irradiance: self.irradiance.map(|i| i * factor),
            ..self
        }
    }

    /// Solid angle of the whole disc [sr].
    pub fn solid_angle(&self) -> f64 {
        // 1 - cos r loses all digits for a small r.
        4.0 * PI * (0.5 * self.angular_radius).sin().powi(2)
    }

    /// Luminance [cd/m2], RGB in the working space, of the disc at `rho` of its radius, 0 (centre) to 1 (limb).
    ///
    /// Its mean over the disc times the disc's solid angle is [`SunLight::full_illuminance`]. Infinite for a point sun.
    pub fn disc_luminance(&self, rho: f64) -> DVec3 {
        self.full_illuminance / self.solid_angle() * limb(rho)
    }
}

/// Exponents of limb darkening at 630, 532 and 467 nm: the (monochromatic) primaries of the working space.
///
/// Source: Hestroffer & Magnan 1998 (A&A 333, 338), alpha = -0.023 + 0.292 / L for 416 to 1099 nm, L in micrometres.
pub const LIMB_EXPONENT: DVec3 = DVec3::new(
    -0.023 + 0.292 / 0.630,
    -0.023 + 0.292 / 0.532,
    -0.023 + 0.292 / 0.467,
);

/// Places spread evenly over a disc, as the seeds of a sunflower: distance from its middle and place [its radii], each for the
/// same share of its area (Vogel 1979).
pub fn sunflower(count: usize) -> impl Iterator<Item = (f64, DVec2)> {
    let golden = PI * (3.0 - 5f64.sqrt());
    (0..count).map(move |i| {
        let rho = ((i as f64 + 0.5) / count as f64).sqrt();
        (rho, rho * DVec2::from_angle(golden * i as f64))
    })
}

/// The `i`th of `count` unit vectors that are spread evenly over the sphere, from +Y down: Fibonacci's lattice (Swinbank & Purser 2006).
pub fn fibonacci_sphere(i: usize, count: usize) -> DVec3 {
    let y = 1.0 - (2 * i + 1) as f64 / count as f64;
    let (sin, cos) = (PI * (3.0 - 5f64.sqrt()) * i as f64).sin_cos();
    let level = (1.0 - y * y).sqrt();
    DVec3::new(level * cos, y, level * sin)
}

/// Luminance of the disc over its mean [1], per channel, at `rho` of its radius, 0 to 1; its mean over the disc is 1.
///
/// mu^alpha (1 + alpha / 2) with mu = sqrt(1 - rho^2), alpha from [`LIMB_EXPONENT`].
pub fn limb(rho: f64) -> DVec3 {
    let mu_squared = (1.0 - rho * rho).max(0.0);
    let half = 0.5 * LIMB_EXPONENT;
    DVec3::new(
        mu_squared.powf(half.x),
        mu_squared.powf(half.y),
        mu_squared.powf(half.z),
    ) * (DVec3::ONE + half)
}

/// Relative optical air mass [1] at an apparent elevation [rad], 0 to pi/2: 1 at the zenith, 37.9 at the horizon.
///
/// Source: Kasten & Young 1989 (Applied Optics 28, 4735).
pub fn relative_air_mass(elevation: f64) -> f64 {
    1.0 / (elevation.sin() + 0.505_72 * (elevation / DEG + 6.079_95).powf(-1.6364))
}

/// Share of a disc above the horizon, and the elevation [rad] of that part's centroid, from the centre's elevation and the radius.
pub(crate) fn visible_part(centre: f64, radius: f64) -> (f64, f64) {
    let x = centre / radius;
    if x >= 1.0 {
        return (1.0, centre);
    }
    if x <= -1.0 {
        return (0.0, 0.0);
    }
    let chord = (1.0 - x * x).sqrt();
    let area = FRAC_PI_2 + x.asin() + x * chord;
    // The segment's first moment about the disc's centre is 2/3 (1 - x^2)^(3/2); area is of the same order where both vanish.
    let centroid = x + 2.0 / 3.0 * chord.powi(3) / area.max(1e-12);
    (area / PI, (radius * centroid).max(0.0))
}

/// Vertical optical depth of the molecules over a place at standard pressure [1], L in micrometres.
fn molecules(l: f64) -> f64 {
    let l2 = l * l;
    1.0 / (l2 * l2 * (115.6406 - 1.335 / l2))
}

/// Vertical optical depth of the aerosol over a place [1], L in micrometres.
fn aerosol(l: f64, turbidity: f64) -> f64 {
    (0.046_083_658_220_50 * turbidity - 0.045_860_259_285_22) * l.powf(-1.3)
}

/// Vertical optical depths of the clear air over a site [1], in the channels of the working space.
///
/// A channel's value is the mean over wavelengths, weighted by the sun's spectrum outside the atmosphere times the channel's
/// response (a combination of the CIE 1931 functions, negative here and there): what a thin layer scatters of that sunlight, or
/// takes from it, has exactly the colour of the spectrum's own product. Under the redder light of a lower sun the truth is
/// less: down to 5 degrees by at most 12 % for molecules and 3 % for aerosol.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Molecules, at the site's pressure.
    pub molecules: DVec3,
    /// Aerosol.
    pub aerosol: DVec3,
}

impl Column {
    /// The column of which a sun's path crosses relative air masses.
    ///
    /// # Errors
    /// [`Error::Domain`] when a quantity of `path` is outside its range.
    pub fn new(path: &SunPath) -> Result<Self> {
        path.check()?;
        let pressure = path.pressure_hpa / STANDARD_PRESSURE_HPA;
        Ok(Column {
            molecules: pressure * channel_mean(molecules),
            aerosol: channel_mean(|l| aerosol(l, path.turbidity)),
        })
    }
}

/// The mean of a function of the wavelength [micrometres] in each channel, under the sun outside the atmosphere.
fn channel_mean(f: impl Fn(f64) -> f64) -> DVec3 {
    let (mut sum, mut all) = (DVec3::ZERO, DVec3::ZERO);
    for cell in SPECTRUM.iter() {
        let light = cell.bar * (cell.irradiance * cell.width_nm);
        sum += light * f(cell.wavelength_um);
        all += light;
    }
    working_from_xyz(sum) / working_from_xyz(all)
}

/// Illuminance [lx], RGB in the working space, on a plane that faces the sun outside the atmosphere, `distance_au` away [au].
pub fn outside_the_atmosphere(distance_au: f64) -> DVec3 {
    let light = |cell: &Cell| cell.bar * (cell.irradiance * cell.width_nm);
    let xyz: DVec3 = SPECTRUM.iter().map(light).sum();
    working_from_xyz(xyz * LUMINOUS_EFFICACY) / (distance_au * distance_au)
}

/// XYZ [lx] of the whole disc's light on a plane that faces the sun, with every `merged` cells of the spectrum (5 nm in the
/// visible) made one: what coarser bands would give. [`SunLight`] merges none.
///
/// Errors: [`Error::Domain`] when a quantity of `path` is outside its range, or `merged` is 0.
pub fn in_bands(path: &SunPath, merged: usize) -> Result<DVec3> {
    path.check()?;
    if merged == 0 {
        return Err(Error::domain(
            "the cells of a band",
            merged,
            "1 and more",
            "give 1 for 5 nm",
        ));
    }
    let radius = (0.5 * SUN_DIAMETER / path.distance_au).asin();
    let (_, elevation) = visible_part(path.elevation_apparent, radius);
    let bands: Vec<Cell> = SPECTRUM.chunks(merged).map(Cell::merged).collect();
    Ok(through_air(&bands, path, elevation, relative_air_mass(elevation)).0)
}

impl Cell {
    /// One for several: what they hold of sunlight weighs their wavelengths and absorptions.
    fn merged(cells: &[Cell]) -> Cell {
        let width_nm = cells.iter().map(|c| c.width_nm).sum();
        let energy: f64 = cells.iter().map(|c| c.irradiance * c.width_nm).sum();
        let mean = |of: &dyn Fn(&Cell) -> f64| {
            let sum: f64 = cells
                .iter()
                .map(|c| of(c) * c.irradiance * c.width_nm)
                .sum();
            sum / energy
        };
        Cell {
            wavelength_um: mean(&|c| c.wavelength_um),
            width_nm,
            irradiance: energy / width_nm,
            ozone: mean(&|c| c.ozone),
            water: mean(&|c| c.water),
            gas: mean(&|c| c.gas),
            bar: DVec3::new(mean(&|c| c.bar.x), mean(&|c| c.bar.y), mean(&|c| c.bar.z)),
        }
    }
}

/// XYZ [lx] and irradiance [W/m2] on a plane facing the sun.
fn through_air(spectrum: &[Cell], path: &SunPath, elevation: f64, air_mass: f64) -> (DVec3, f64) {
    let pressure_mass = air_mass * path.pressure_hpa / STANDARD_PRESSURE_HPA;
    let layer = 22.0 / 6370.0;
    let ozone_mass = (1.0 + layer) / (elevation.sin().powi(2) + 2.0 * layer).sqrt();
    let beyond = 1.0 / (path.distance_au * path.distance_au);
    let mut xyz = DVec3::ZERO;
    let mut total = 0.0;
    for cell in spectrum {
        let rayleigh = pressure_mass * molecules(cell.wavelength_um);
        let aerosol = aerosol(cell.wavelength_um, path.turbidity) * air_mass;
        let ozone = cell.ozone * path.ozone_cm * ozone_mass;
        let wet = cell.water * path.water_cm * air_mass;
        let water = 0.2385 * wet / (1.0 + 20.07 * wet).powf(0.45);
        let mixed = cell.gas * pressure_mass;
        let gas = 1.41 * mixed / (1.0 + 118.93 * mixed).powf(0.45);
        let e = cell.irradiance * beyond * (-(rayleigh + aerosol + ozone + water + gas)).exp();
        xyz += cell.bar * (e * cell.width_nm);
        total += e * cell.width_nm;
    }
    (xyz * LUMINOUS_EFFICACY, total)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is left of light of one wavelength [micrometres], as an optical depth.
    fn depth(wavelength_um: f64, path: &SunPath) -> f64 {
        let cell = Cell {
            wavelength_um,
            width_nm: 1.0,
            irradiance: 1.0,
            ozone: 0.0,
            water: 0.0,
            gas: 0.0,
            bar: DVec3::ONE,
        };
        -through_air(&[cell], path, FRAC_PI_2, 1.0).1.ln()
    }

    #[test]
    fn molecules_scatter_as_others_say() {
        // Hansen & Travis 1974 (Space Science Reviews 16, 527), eq. 2.30, at 1013.25 hPa; Leckner's is 1 to 1.5 % above it.
        let published =
            |l: f64| 0.008_569 / l.powi(4) * (1.0 + 0.0113 / l.powi(2) + 0.000_13 / l.powi(4));
        let path = |pressure_hpa: f64| SunPath {
            pressure_hpa,
            ..SunPath::standard(FRAC_PI_2, 2.0)
        };
        for l in [0.3, 0.35, 0.4, 0.45, 0.55, 0.8] {
            let depth = depth(l, &path(STANDARD_PRESSURE_HPA)) - depth(l, &path(0.0));
            let ratio = depth / published(l);
            assert!((ratio - 1.0).abs() < 0.02, "{l} um: {ratio}");
        }
    }

    #[test]
    fn aerosol_follows_angstrom_s_law() {
        // Without molecules: beta L^-1.3, the exponent by which turbidity is defined (Preetham 1999, appendix A.1).
        let path = |turbidity: f64| SunPath {
            pressure_hpa: 0.0,
            ..SunPath::standard(FRAC_PI_2, turbidity)
        };
        let exponent = (depth(0.4, &path(3.0)) / depth(0.8, &path(3.0))).log2();
        assert!((exponent - 1.3).abs() < 1e-9, "{exponent}");
        // Preetham's beta at turbidity 2 and 6.
        for (turbidity, beta) in [(2.0, 0.046_307), (6.0, 0.230_642)] {
            let found = depth(1.0, &path(turbidity));
            assert!((found - beta).abs() < 1e-6, "{turbidity}: {found}");
        }
    }

    #[test]
    fn light_is_split_by_the_share_of_the_disc() {
        // Half a disc on the horizon: its centroid stands 4 / (3 pi) of the radius above; all of it and none of it beyond.
        let (share, elevation) = visible_part(0.0, 0.01);
        assert!((share - 0.5).abs() < 1e-12);
        assert!((elevation - 0.04 / (3.0 * PI)).abs() < 1e-12);
        assert_eq!(visible_part(0.02, 0.01), (1.0, 0.02));
        assert_eq!(visible_part(-0.02, 0.01), (0.0, 0.0));
        // A segment and the one across the horizon fill the disc, and their moments cancel.
        let (above, high) = visible_part(0.006, 0.01);
        let (below, low) = visible_part(-0.006, 0.01);
        assert!((above + below - 1.0).abs() < 1e-12);
        assert!((above * (high - 0.006) - below * (low + 0.006)).abs() < 1e-12);
    }
}
