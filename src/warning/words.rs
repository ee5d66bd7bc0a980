//! What each [`Warning`] says, as one sentence.

use super::Warning;
use std::collections::BTreeMap;
use std::fmt;

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::LeftOut { file, things } => {
                write!(f, "{file}: left out, with how often: {}", with_counts(things))
            }
            Warning::Mended { problem, instead }
            | Warning::Weather {
                problem, instead, ..
            } => write!(f, "{problem}; {instead}"),
            Warning::SameCameraName { file, name, count } => write!(
                f,
                "{file}: {count} cameras are called `{name}`; the name chooses the first"
            ),
            Warning::AssumedReflectances { file, triangles } => {
                let [floors, walls, ceilings] = triangles;
                write!(
                    f,
                    "{file}: {} triangles have no colour; their reflectances are those that EN 17037 assumes: floors 0.2 ({floors} triangles), \
                     walls 0.5 ({walls}), ceilings 0.7 ({ceilings}), told apart by their slope",
                    floors + walls + ceilings
                )
            }
            Warning::OddSize { file, size, scale } => {
                let [x, y, z] = size.map(length);
                let reason = match scale {
                    0.001 => "is it in millimetres",
                    0.01 => "is it in centimetres",
                    _ => "was it made smaller",
                };
                write!(
                    f,
                    "{file}: the model is {x} wide, {y} high and {z} deep: {reason} (--scale {scale})?"
                )
            }
            Warning::FarPoints { count, scale } => {
                let [far, all] = count;
                let unit = if *scale < 0.01 { "milli" } else { "centi" };
                write!(
                    f,
                    "{far} of {all} points lie far outside the scene: are they in {unit}metres?"
                )
            }
            Warning::OnItsSide {
                file,
                facing: [_, y, z],
            } => write!(
                f,
                "{file}: the model seems to lie on its side: {:.0} % of its surface faces along Z, {:.0} % up and down: does its Z axis point up (--up z)?",
                100.0 * z,
                100.0 * y
            ),
            Warning::IgnoredMaterialProperties { file, properties } => write!(
                f,
                "{file}: surfaces are Lambertian with their base colour; left out, with how often: {}",
                with_counts(properties)
            ),
            Warning::MissingMaterials { file, problem, .. } => {
                write!(f, "{file}: {problem}; its materials left out")
            }
            Warning::UnknownMaterials { file, materials } => write!(
                f,
                "{file}: no file of materials defines these, with how many faces name them: {}; the faces are grey",
                with_counts(materials)
            ),
            Warning::DoubtfulLines {
                file,
                lines,
                problem,
            } => write!(f, "{file}:{lines}: {problem} (`{}`)", lines.example),
            Warning::UnreadStatements { file, statements } => write!(
                f,
                "{file}: statements that are not read, with how often: {}",
                with_counts(statements)
            ),
            Warning::UntexturedFaces { file, count } => write!(
                f,
                "{file}: {} of textured materials without texture coordinates; plain colour there",
                counted(*count, "face")
            ),
            Warning::FoundElsewhere { file, count, first } => {
                let list: Vec<String> = first
                    .iter()
                    .map(|(named, taken)| format!("{taken} taken for {named}"))
                    .collect();
                write!(
                    f,
                    "{file}: not there as named: {} ({})",
                    counted(*count, "file"),
                    list.join(", ")
                )
            }
            Warning::OutsideFolder { file, named } => {
                write!(f, "{file} names {named}, which lies outside its folder")
            }
            Warning::MissingTexture { problem, .. } => write!(f, "{problem}; texture left out"),
            Warning::UnsupportedTextureFormat { place, extensions } => write!(
                f,
                "{place}: left out, its picture is in a format that is not read ({})",
                if extensions.is_empty() {
                    "no source".to_owned()
                } else {
                    extensions.join(", ")
                }
            ),
            Warning::DegenerateTriangles { file, count } => write!(
                f,
                "{file}: {} without an area left out",
                counted(*count, "triangle")
            ),
            Warning::WhollySeeThrough { materials } => {
                let list: Vec<String> = materials
                    .iter()
                    .map(|(name, count)| {
                        let (count, are) = (counted(*count, "triangle"), are(*count));
                        format!("`{name}` (its {count} {are} not there)")
                    })
                    .collect();
                write!(f, "wholly see-through: {}", listed(&list))
            }
            Warning::PartlySeeThrough { materials } => write!(
                f,
                "these let a part of the light through, straight on and uncoloured, and a GPU leaves sunlight to the CPU for them (exact, and slower): {}",
                quoted(materials)
            ),
            Warning::Panes { materials } => write!(
                f,
                "panes let light straight through and show nothing of themselves: what they reflect is left out: {}",
                quoted(materials)
            ),
            Warning::GradualAlpha { materials } => write!(
                f,
                "alpha that fades is cut at half of its greatest: {}",
                quoted(materials)
            ),
            Warning::InvalidVertexAttributes { file, count } => write!(
                f,
                "{file}: {} (normal, texture coordinate, colour or weight) not finite or out of range; taken as absent, or colours as the nearest valid one",
                counted(*count, "vertex attribute")
            ),
            Warning::UnusedLights { lights } => {
                let list: Vec<String> = lights
                    .iter()
                    .map(|l| format!("`{}` ({}, {:.0} {})", l.name, l.kind, l.intensity, l.unit))
                    .collect();
                write!(
                    f,
                    "lights of the file that are not used: {}",
                    list.join(", ")
                )
            }
            Warning::Photometry { file, problem, .. } => write!(f, "{file}: {problem}"),
            Warning::ClockFarFromSun {
                offset,
                hours,
                longitude_deg,
            } => write!(
                f,
                "the clock ({offset}) is {hours:.1} hours off the sun's at longitude {longitude_deg:.3}"
            ),
            Warning::PerhapsSwapped { place, zone } => write!(
                f,
                "{place}: with latitude and longitude swapped the place would be in {zone}; were they?"
            ),
            Warning::PreethamLuminance => f.write_str(
                "the Preetham sky's luminance is 1.5 to 2.8 times too high by day; its colours are usable",
            ),
            Warning::OutsidePerezData {
                clearness,
                brightness,
            } => write!(
                f,
                "these irradiances are outside the Perez model's data: held at clearness {clearness:.3}, brightness {brightness:.3}"
            ),
            Warning::IrradianceOfLowSun { elevation_deg } => write!(
                f,
                "measured irradiance under a sun {elevation_deg:.1} degrees high: it sets the sky's illuminance; distribution and colour go over to a computed clear twilight between 10 and 2 degrees"
            ),
            Warning::IrradianceWithoutSun {
                elevation_deg,
                direct_normal,
                illuminance,
                clear,
            } => {
                write!(
                    f,
                    "measured irradiance with the sun down ({elevation_deg:.1} degrees): the diffuse one sets the sky's illuminance, {} lx where a clear sky has {} lx",
                    figure(*illuminance),
                    figure(*clear)
                )?;
                match *direct_normal > 0.0 {
                    true => write!(
                        f,
                        "; the direct one, {} W/m2, is left out",
                        figure(*direct_normal)
                    ),
                    false => Ok(()),
                }
            }
            Warning::NoDiffuseIrradiance { elevation_deg } => write!(
                f,
                "a measured diffuse irradiance of 0 with the sun at {elevation_deg:.1} degrees is less than an instrument tells apart: the sky has the level of twilight"
            ),
            Warning::UnusedSky { keys } => write!(
                f,
                "the sun's illuminance is given and no sky is named, so there is none; not used: {}",
                keys.join(", ")
            ),
            Warning::UnusedWithSun { names } => write!(
                f,
                "the sun is given, so these have no effect: {}",
                names.join(", ")
            ),
            Warning::UnusedWithoutSun { names } => write!(
                f,
                "lamps alone light the scene, so these have no effect: {}",
                names.join(", ")
            ),
            Warning::DarkLamps { lamps } => {
                let lamps = lamps.iter();
                let list: Vec<String> = lamps.map(|(name, why)| format!("`{name}` ({why})")).collect();
                write!(f, "lamps that give little or no light: {}", listed(&list))
            }
            Warning::FaintEmission {
                materials,
                brightest,
                beside,
            } => write!(
                f,
                "emission of at most {} cd/m2 is little beside the {} cd/m2 of open ground under sun and sky, and left out: {}",
                figure(*brightest),
                figure(*beside),
                quoted(materials)
            ),
            Warning::UnusedGround { keys } => write!(
                f,
                "the scene's ground is not there (enabled = false), so these have no effect: {}",
                keys.join(", ")
            ),
            Warning::UnusedMedia { media } => {
                let list: Vec<String> = media
                    .iter()
                    .map(|(number, why)| format!("medium {number} ({why})"))
                    .collect();
                write!(f, "media that add nothing: {}", listed(&list))
            }
            Warning::OddExposure {
                picture,
                ev100,
                is_dark,
                causes,
            } => {
                match is_dark {
                    true => write!(f, "nothing lights {picture}: ")?,
                    false => write!(f, "{picture} is brighter than snow in the sun: ")?,
                }
                f.write_str(&causes.join("; "))?;
                match ev100 {
                    Some(ev100) => write!(f, " (EV100 {ev100:.1})"),
                    None => f.write_str(" (it is black)"),
                }
            }
            Warning::NoDaylight => f.write_str(
                "no daylight reaches any sensor: no pane and no opening is found through which it could",
            ),
            Warning::PerezFitBreaks => f.write_str(
                "the Perez fit breaks at this clearness and brightness (b > 0 or negative luminance): b is held at 0, luminance at 0 and above",
            ),
        }
    }
}

/// `Ks (3), map_Bump (1)`.
fn with_counts(counts: &BTreeMap<String, usize>) -> String {
    let list: Vec<String> = counts
        .iter()
        .map(|(what, n)| format!("{what} ({n})"))
        .collect();
    list.join(", ")
}

/// A length with the unit that people would use.
fn length(metres: f64) -> String {
    match metres {
        m if m >= 1e6 => format!("{m:.1e} m"),
        m if m >= 1000.0 => format!("{:.1} km", m / 1000.0),
        m if m >= 1.0 => format!("{m:.1} m"),
        m if m >= 0.001 => format!("{:.1} mm", m * 1000.0),
        0.0 => "0 m".into(),
        m => format!("{m:.1e} m"),
    }
}

/// The first of a list, and how many more there are.
fn listed(items: &[String]) -> String {
    const MOST: usize = 8;
    let shown = items[..items.len().min(MOST)].join(", ");
    match items.len().saturating_sub(MOST) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// Names in backquotes.
fn quoted(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    listed(&quoted)
}

/// What many or one do.
fn are(n: usize) -> &'static str {
    if n == 1 { "is" } else { "are" }
}

/// A number of four digits, with an exponent where it is very small or large.
fn figure(x: f64) -> String {
    if !(1e-3..1e7).contains(&x) {
        return format!("{x:.3e}");
    }
    let decimals = (3.0 - x.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{x:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// `1 triangle`, `2 triangles`.
fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
