//! Blinds of a group of windows: the table `[[shade]]` of a scene file.

use super::Scene;
use super::filling::Wrong;
use crate::error::Result;
use schemars::JsonSchema;
use serde::Deserialize;

/// What a closed blind reflects where nothing else is said, as far as what it lets through leaves so much [1].
const REFLECTANCE: f64 = 0.5;

/// The most groups: each that is closed or not by itself may double the work of a year.
const MOST: usize = 8;

/// What hangs behind the panes of a group of windows in hours in which it is closed; at all other times it is not there.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowShade {
    /// Names of materials, objects and groups whose panes are the group.
    pub windows: Vec<String>,
    /// The share of the light on it that it scatters into the room, evenly to all sides, 0 to 1.
    pub transmittance: f64,
    /// The share that goes straight through, whatever its angle, 0 to 1.
    pub openness: f64,
    /// The share that it throws back, on either side, 0 to 1; the three sum to 1 at most.
    pub reflectance: f64,
}

impl WindowShade {
    /// The group as it is shown: the names.
    pub fn name(&self) -> String {
        self.windows.join(" + ")
    }
}

/// Blinds of a group of windows, which `tyndall daylight --weather` closes in hours with too much sun; nothing else closes them.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ShadeTable {
    /// The group: names of materials, or of objects and groups, whose panes (`[[pane]]`) it closes together.
    windows: Vec<String>,
    /// The share of the light behind the glass that the closed blind scatters into the room, evenly to all sides.
    #[schemars(range(min = 0.0, max = 1.0))]
    transmittance: f64,
    /// The share that goes straight through it; 0 when absent.
    #[schemars(range(min = 0.0, max = 1.0))]
    openness: Option<f64>,
    /// The share that it throws back, on either side; when absent 0.5, or what the other two leave.
    #[schemars(range(min = 0.0, max = 1.0))]
    reflectance: Option<f64>,
}

/// Reads the tables into the scene, whose panes are known; `wrong` names a key of one of them.
pub(super) fn read(tables: Vec<ShadeTable>, scene: &mut Scene, wrong: Wrong) -> Result<()> {
    if tables.len() > MOST {
        return Err(wrong(
            &format!("shade[{MOST}]"),
            format!("there are {} groups of windows", tables.len()),
            "put windows that face one way into one group, 8 groups at most",
        ));
    }
    let mut taken = vec![false; scene.mesh.triangles.len()];
    for (i, table) in tables.into_iter().enumerate() {
        let wrong = |key: &str, problem: String, remedy: &str| {
            wrong(&format!("shade[{i}].{key}"), problem, remedy)
        };
        if table.windows.is_empty() {
            let remedy = "name a material or an object that has panes";
            return Err(wrong("windows", "it names nothing".into(), remedy));
        }
        for name in &table.windows {
            if scene.triangles_named(name).is_empty() {
                let remedy = match scene.nearest_name(name) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => "name a material or an object that has panes".into(),
                };
                let problem = format!("the scene has no material and no object `{name}`");
                return Err(wrong("windows", problem, &remedy));
            }
            let panes = scene.panes_named(name);
            if panes.is_empty() {
                let problem = format!("nothing of `{name}` is glass");
                let remedy = "say in a [[pane]] table which material is";
                return Err(wrong("windows", problem, remedy));
            }
            for pane in panes {
                if std::mem::replace(&mut taken[pane as usize], true) {
                    let problem = format!("panes of `{name}` are in a group already");
                    return Err(wrong("windows", problem, "name each pane once"));
                }
            }
        }
        let (transmittance, openness) = (table.transmittance, table.openness.unwrap_or(0.0));
        let left = 1.0 - transmittance - openness;
        let reflectance = table.reflectance.unwrap_or(REFLECTANCE.min(left).max(0.0));
        // Decimal fractions do not sum exactly.
        if reflectance > left + 1e-9 {
            return Err(wrong(
                "transmittance",
                "transmittance, openness and reflectance sum to more than 1".into(),
                "they are shares of the same light",
            ));
        }
        scene.shades.push(WindowShade {
            windows: table.windows,
            transmittance,
            openness,
            reflectance,
        });
    }
    Ok(())
}

impl Scene {
    /// The triangles of glass among those of a material, object or group, in order.
    pub fn panes_named(&self, name: &str) -> Vec<u32> {
        let is_pane = |triangle: &u32| {
            let material = self.mesh.triangles[*triangle as usize].material;
            self.materials[material as usize].pane.is_some()
        };
        let mut panes = self.triangles_named(name);
        panes.retain(is_pane);
        panes
    }
}
