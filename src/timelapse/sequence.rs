//! A sequence: frames over a range of times, from one scene, one view and one backend.
//!
//! Everything is decided by the sequence as a whole, and nothing by the frames that a process happens to render or by their order: so
//! shards, resumed runs and repeated ones give the same files.

use super::exposure::{self, Curve};
use super::key::{self, Settings};
use super::plan::{ExposurePlan, FORMAT, FrameLine, Header, KeyFrame, Place, Reader};
use super::resume::Outputs;
use super::select::{Only, Shard};
use super::template::Template;
use super::when::{When, utc_text};
use crate::backend::{Backend, Limits, Rendered};
use crate::colour::{exposure::auto, luminance};
use crate::conditions::{Conditions, SolarGeometry, View, toward};
use crate::ephemeris::{Instant, Weather, civil, sun_position};
use crate::error::{Error, Result};
use crate::frame::Frame;
use crate::output::{self, Format, OutputSpace};
use crate::plan::{Overrules, Plan};
use crate::task::Progress;
use crate::warning::Warning;
use chrono::{DateTime, Utc};
use glam::DVec3;
use std::path::Path;

/// What is asked of a sequence.
pub struct Asked {
    /// The scene and the view, at any moment of the sequence ([`When::text`]).
    pub conditions: Conditions,
    /// The instants.
    pub when: When,
    /// What the user wants otherwise of the plans.
    pub overrules: Overrules,
    /// The names of the frames' files, one or more.
    pub outputs: Vec<Template>,
    /// The layers of an EXR, in each frame ([`output::layers_of`], [`output::select_layers`]).
    pub layers: Vec<&'static str>,
    /// The colour space of EXR and HDR.
    pub space: OutputSpace,
    /// The exposure of all frames [EV100]; absent: planned.
    pub exposure: Option<f64>,
    /// How many stops brighter than metered frames are whose exposure is planned.
    pub stops: f64,
    /// The index of the first frame.
    pub first: u64,
    /// The command line that makes the whole sequence.
    pub command: String,
}

/// A sequence, ready to be planned and rendered.
pub struct Sequence {
    asked: Asked,
    site: SolarGeometry,
    outputs: Outputs,
    scene_hash: String,
}

/// How a sequence is exposed, and how long its frames may take.
pub struct Planned {
    /// The first line of the plan file.
    pub header: Header,
    exposure: Curve,
    seconds: Curve,
}

/// What one key frame has told.
struct Metered {
    /// [EV100]; nothing of a black picture.
    ev100: Option<f64>,
    sun_elevation_deg: f64,
    /// What is done once for the whole picture [s], and what grows with its pixels.
    seconds: [f64; 2],
}

impl Sequence {
    /// Takes what is asked for.
    ///
    /// # Errors
    /// [`Error::Input`] where a sun stands in for place and time; those of [`Outputs::new`].
    pub fn new(asked: Asked) -> Result<Self> {
        let site = asked.conditions.instant.clone().ok_or_else(|| {
            Error::input(
                &asked.conditions.scene.name,
                "its sun stands still, or it has none: all frames would be the same",
                "give --at LAT,LON, and leave out --sun",
            )
        })?;
        if asked.first.checked_add(asked.when.count()).is_none() {
            return Err(Error::domain(
                "the first index",
                asked.first,
                format!("0 to {}", u64::MAX - asked.when.count()),
                "choose a smaller --start-number",
            ));
        }
        Ok(Sequence {
            scene_hash: key::of_scene(&asked.conditions.scene),
            outputs: Outputs::new(asked.outputs.clone())?,
            site,
            asked,
        })
    }

    /// The files of its frames.
    pub fn outputs(&self) -> &Outputs {
        &self.outputs
    }

    /// The instants of its frames.
    pub fn when(&self) -> &When {
        &self.asked.when
    }

    /// The conditions of an instant.
    ///
    /// # Errors
    /// Those of [`Conditions::at`].
    pub fn conditions(&self, utc: DateTime<Utc>) -> Result<Conditions> {
        self.asked.conditions.at(&self.asked.when.text(utc))
    }

    /// The conditions of a frame, by its line of the plan.
    ///
    /// # Errors
    /// Those of [`Conditions::at`].
    pub fn conditions_of(&self, line: &FrameLine) -> Result<Conditions> {
        let number = line.index - self.asked.first;
        self.conditions(self.asked.when.get(number)?)
    }

    /// What overrules the plans of its frames.
    pub fn overrules(&self) -> &Overrules {
        &self.asked.overrules
    }

    /// Where the sun stands at a frame, as a unit vector: much cheaper than all conditions.
    fn toward_sun(&self, number: u64) -> Result<DVec3> {
        let request = self.asked.conditions.request();
        let utc = self.asked.when.get(number)?;
        let instant = match request.delta_t {
            Some(delta_t) => Instant::from_utc_with(utc, delta_t)?,
            None => Instant::from_utc(utc)?,
        };
        let weather = Weather::standard(&self.site.site);
        let sun = sun_position(self.site.tier, &instant, &self.site.site, &weather);
        Ok(toward(sun.azimuth, sun.elevation_apparent, 0.0))
    }

    /// The header of its plan file, under an exposure.
    fn header(&self, backend: &Backend, exposure: ExposurePlan) -> Result<Header> {
        let Asked {
            conditions,
            when,
            overrules,
            outputs,
            layers,
            space,
            exposure: fixed,
            stops,
            first,
            command,
        } = &self.asked;
        let clock = match when.clock().name() {
            Some(name) => name.to_owned(),
            None => civil::offset_text(when.clock().offset_seconds(when.get(0)?)),
        };
        let settings = Settings {
            conditions,
            overrules,
            clock: &clock,
            layers,
            space,
            backend: &backend.identity(),
            exposure: *fixed,
            stops: *stops,
        };
        let site = &self.site.site;
        Ok(Header {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            scene: conditions.scene.name.clone(),
            scene_hash: self.scene_hash.clone(),
            settings_hash: key::of_settings(&settings),
            time_zones: civil::tz_database(),
            time_zones_hash: key::of_time_zones(),
            site: Place {
                latitude_deg: site.latitude_deg(),
                longitude_deg: site.longitude_deg(),
                elevation: site.elevation(),
            },
            outputs: outputs.iter().map(|o| o.text().to_owned()).collect(),
            from: utc_text(when.get(0)?),
            to: utc_text(when.get(when.count() - 1)?),
            step: when.step().to_owned(),
            first: *first,
            frames: when.count(),
            size: conditions.view.size,
            exposure,
            command: command.clone(),
        })
    }

    /// The plan that is there already, if it is one of this sequence under this backend.
    ///
    /// # Errors
    /// [`Error::Input`] for a sequence that has no instants.
    pub fn planned(&self, path: &Path, backend: &Backend) -> Result<Option<Reader>> {
        let Ok(reader) = Reader::open(path) else {
            return Ok(None);
        };
        let header = self.header(backend, reader.header.exposure.clone())?;
        Ok(header.is_of_the_same(&reader.header).then_some(reader))
    }

    /// Plans it: meters key frames with this backend. `told` is given the number of key frames that are done, and of all.
    ///
    /// # Errors
    /// Those of the conditions, of [`Plan::new`] and [`Backend::render`].
    pub fn plan(
        &self,
        backend: &mut Backend,
        limits: &Limits,
        progress: Progress,
        told: &mut dyn FnMut(usize, usize),
    ) -> Result<Planned> {
        let count = self.asked.when.count();
        let key_frames = match self.asked.exposure {
            None => exposure::key_frames((0..count).map(|number| self.toward_sun(number)))?,
            // Only to learn how long frames take.
            Some(_) => {
                let mut few = vec![0, count / 2, count - 1];
                few.dedup();
                few
            }
        };
        let mut metered = Vec::with_capacity(key_frames.len());
        let size = self.asked.conditions.view.size;
        let small = exposure::small(size);
        for (done, number) in key_frames.iter().enumerate() {
            told(done, key_frames.len());
            metered.push(self.meter(*number, small, backend, limits, progress)?);
        }
        told(key_frames.len(), key_frames.len());
        // What lasts for the whole sequence was made for the first.
        if let [first, second, ..] = &mut metered[..] {
            for (own, next) in first.seconds.iter_mut().zip(second.seconds) {
                *own = own.min(next);
            }
        }
        // Light is found at places that many pixels share: how time grows with pixels is looked at once.
        let larger = small.map(|side| 2 * side);
        let growth = match (key_frames.last(), metered.last()) {
            (Some(number), Some(last)) if larger[0] <= size[0] && larger[1] <= size[1] => {
                let more = self.meter(*number, larger, backend, limits, progress)?;
                let ratio = more.seconds[1] / last.seconds[1].max(f64::MIN_POSITIVE);
                (ratio.ln() / 4f64.ln()).clamp(0.0, 1.0)
            }
            _ => 1.0,
        };
        let ratio = (pixels(size) / pixels(small)).powf(growth);
        let numbers = || key_frames.iter().map(|number| *number as f64).zip(&metered);
        let exposure = match self.asked.exposure {
            Some(ev100) => vec![[0.0, ev100]],
            None => {
                let seen =
                    numbers().filter_map(|(number, m)| Some([number, m.ev100? - self.asked.stops]));
                seen.collect()
            }
        };
        let seconds = numbers().map(|(number, m)| [number, m.seconds[0] + ratio * m.seconds[1]]);
        let seconds = Curve::new(seconds.collect());
        let exposure = Curve::new(exposure);
        let said = match self.asked.exposure {
            Some(ev100) => ExposurePlan::Fixed(ev100),
            None => {
                let key_frame = |(number, metered): (&u64, &Metered)| {
                    Ok(KeyFrame {
                        index: self.asked.first + number,
                        instant: utc_text(self.asked.when.get(*number)?),
                        sun_elevation_deg: metered.sun_elevation_deg,
                        ev100: exposure.at(*number as f64),
                        is_black: metered.ev100.is_none(),
                    })
                };
                let all = key_frames.iter().zip(&metered).map(key_frame);
                ExposurePlan::Curve(all.collect::<Result<_>>()?)
            }
        };
        Ok(Planned {
            header: self.header(backend, said)?,
            exposure,
            seconds,
        })
    }

    /// Meters a small picture of a frame.
    fn meter(
        &self,
        number: u64,
        size: [u32; 2],
        backend: &mut Backend,
        limits: &Limits,
        progress: Progress,
    ) -> Result<Metered> {
        let conditions = self.conditions(self.asked.when.get(number)?)?;
        let view = View {
            size,
            samples: 1,
            ..conditions.view.clone()
        };
        let conditions = conditions.seen_from(view)?;
        let plan = Plan::new(&conditions, &self.asked.overrules)?;
        let Rendered {
            frame,
            start_up,
            elapsed,
            ..
        } = backend.render(&plan, limits, progress)?;
        Ok(Metered {
            ev100: meter(&frame),
            sun_elevation_deg: conditions.sun_elevation_deg(),
            seconds: [start_up.time(), elapsed].map(|time| time.as_secs_f64()),
        })
    }

    /// The line of a frame in the plan file, by its place in the sequence from 0.
    ///
    /// # Errors
    /// Those of the conditions and of [`Plan::new`].
    pub fn line(&self, planned: &Planned, number: u64) -> Result<FrameLine> {
        let utc = self.asked.when.get(number)?;
        let conditions = self.conditions(utc)?;
        let plan = Plan::new(&conditions, &self.asked.overrules)?;
        let effects = |run: bool| {
            let steps = plan.steps.iter().filter(|step| step.decision.run == run);
            steps.map(|step| step.effect.name.to_owned()).collect()
        };
        let ev100 = planned.exposure.at(number as f64);
        let Header {
            scene_hash,
            settings_hash,
            ..
        } = &planned.header;
        let local = self.asked.when.local_text(utc);
        Ok(FrameLine {
            index: self.asked.first + number,
            instant: utc_text(utc),
            key: key::of_frame(scene_hash, settings_hash, (utc, &local), ev100),
            local,
            sun_azimuth_deg: conditions.sun_azimuth_deg(),
            sun_elevation_deg: conditions.sun_elevation_deg(),
            ev100,
            run: effects(true),
            skipped: effects(false),
            predicted_seconds: planned.seconds.at(number as f64),
        })
    }

    /// All lines of the plan file.
    pub fn lines<'s>(
        &'s self,
        planned: &'s Planned,
    ) -> impl Iterator<Item = Result<FrameLine>> + 's {
        (0..self.asked.when.count()).map(|number| self.line(planned, number))
    }

    /// What is said of the darkest and the brightest of its key frames, where they are darker or brighter than pictures are.
    ///
    /// # Errors
    /// Those of the conditions.
    pub fn odd_exposures(&self, exposure: &ExposurePlan) -> Result<Vec<Warning>> {
        let ExposurePlan::Curve(frames) = exposure else {
            return Ok(Vec::new());
        };
        let metered =
            |frame: &KeyFrame| (!frame.is_black).then_some(frame.ev100 + self.asked.stops);
        let level = |frame: &&KeyFrame| metered(frame).unwrap_or(f64::NEG_INFINITY);
        let by_level = |a: &&KeyFrame, b: &&KeyFrame| level(a).total_cmp(&level(b));
        // The first of equals.
        let darkest = frames.iter().min_by(by_level);
        let brightest = frames.iter().rev().max_by(by_level);
        let mut found = Vec::new();
        for frame in darkest.into_iter().chain(brightest) {
            let utc = self.asked.when.get(frame.index - self.asked.first)?;
            let local = self.asked.when.local_text(utc);
            let name = format!("frame {}, {local}", frame.index);
            let left_out = self.asked.overrules.lights_left_out();
            let conditions = self.conditions(utc)?;
            let odd = conditions.odd_exposure(metered(frame), &name, &left_out);
            if let Some(odd) = odd
                && !found.contains(&odd)
            {
                found.push(odd);
            }
        }
        Ok(found)
    }

    /// Whether a frame is among those that a process is to look after.
    pub fn is_wanted(&self, index: u64, only: Option<&Only>, shard: Option<Shard>) -> bool {
        let named = match only {
            None => true,
            Some(Only::Missing) => !self.outputs.are_there(index),
            Some(only) => only.names(index),
        };
        named && shard.is_none_or(|shard| shard.holds(index - self.asked.first))
    }

    /// Renders a frame and writes its files, which hold its key.
    ///
    /// # Errors
    /// Those of the conditions, of [`Plan::new`], [`Backend::render`] and [`output::picture::write`].
    pub fn render(
        &self,
        line: &FrameLine,
        backend: &mut Backend,
        limits: &Limits,
        progress: Progress,
    ) -> Result<Rendered> {
        self.render_if(line, backend, limits, progress, &mut |_, _| Ok(()))
    }

    /// The same; the picture is shown to `accept` before, and what that refuses is not written.
    ///
    /// # Errors
    /// Those of [`Sequence::render`] and of `accept`.
    pub fn render_if(
        &self,
        line: &FrameLine,
        backend: &mut Backend,
        limits: &Limits,
        progress: Progress,
        accept: &mut dyn FnMut(&Conditions, &Frame) -> Result<()>,
    ) -> Result<Rendered> {
        let Asked {
            overrules,
            layers,
            space,
            ..
        } = &self.asked;
        let conditions = self.conditions_of(line)?;
        let plan = Plan::new(&conditions, overrules)?;
        let mut rendered = backend.render(&plan, limits, progress)?;
        accept(&conditions, &rendered.frame)?;
        let record = &mut rendered.frame.record;
        backend.record(&plan, record);
        record.set("exposure_ev100", line.ev100);
        record.set("key", line.key.clone());
        for (path, format) in self.outputs.of(line.index) {
            output::picture::write(&path, format, &rendered.frame, space, layers, line.ev100)?;
        }
        Ok(rendered)
    }

    /// What a frame's files hold at most, before they are compressed [bytes].
    pub fn bytes(&self) -> u64 {
        let colours = self.asked.layers.len() as u64 + 1;
        let of = |format: Format| match format {
            Format::Exr => 4 * (3 * colours + 1),
            Format::Png | Format::Jpeg => 3,
            Format::Hdr => 4,
        };
        let each: u64 = self.outputs.of(0).map(|(_, format)| of(format)).sum();
        each * pixels(self.asked.conditions.view.size) as u64
    }
}

fn pixels([width, height]: [u32; 2]) -> f64 {
    f64::from(width) * f64::from(height)
}

/// EV100 for a picture; nothing of a black one.
fn meter(frame: &Frame) -> Option<f64> {
    auto((0..frame.pixels()).map(|pixel| luminance(frame.picture(pixel))))
}
