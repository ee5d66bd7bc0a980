//! What a new moment and another view make anew, and that what is kept is never stale: on both backends.

mod common;

use common::build::conditions;
use glam::DVec3;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tyndall::backend::gpu::{Device, Gpu};
use tyndall::backend::{Backend, Limits, Made, PICTURE, Rendered, Step, Wanted};
use tyndall::colour::luminance;
use tyndall::conditions::{Conditions, GroundPlane, Receiver, Request, View};
use tyndall::error::Error;
use tyndall::frame::Frame;
use tyndall::plan::{Overrules, Plan, Quality};
use tyndall::scene::{Projection, Scene};
use tyndall::sky::{Model, Sky, SunAt};
use tyndall::studies::scenes::{hills, slats};

/// Knobs and values.
type Settings<'a> = &'a [(&'a str, f64)];

/// What belongs to a moment, and what to a scene at any moment.
const LIGHT: &str = "the light of all patches";
const TRANSPORT: &str = "who sees whom";
/// What belongs to the view.
const AIR: &str = "the air's light in the picture";

/// Whether light was found anew, and who sees whom was not.
fn of_a_moment(made: &Made) -> bool {
    made.products.contains(&LIGHT) && !made.products.contains(&TRANSPORT)
}
const LATER: &str = "2026-10-22T11:01:00+02:00";

/// The built-in scene, whose sun stands by place and time.
fn nave(size: [u32; 2]) -> Conditions {
    let request = Request {
        size: Some(size),
        samples: Some(1),
        ..Request::default()
    };
    Conditions::new(Scene::builtin("nave").expect("it is sound"), &request).expect("it is sound")
}

/// Hills under a sky, this far along X from the origin [m].
fn hills_at(x: f64) -> Conditions {
    let mut view = hills();
    for p in &mut view.scene.mesh.positions {
        p.x += x;
    }
    view.camera.eye.x += x;
    conditions(view.scene, view.camera, [96, 64])
}

/// The same from an eye that has moved [m].
fn moved(conditions: &Conditions, by: DVec3) -> Conditions {
    let mut view = conditions.view.clone();
    view.camera.eye += by;
    conditions.seen_from(view).expect("the camera is sound")
}

fn plan(conditions: &Conditions) -> Plan<'_> {
    plan_with(conditions, &[])
}

fn plan_with<'c>(conditions: &'c Conditions, set: Settings) -> Plan<'c> {
    let overrules = Overrules {
        quality: Quality::Draft,
        set: [("visibility.silhouettes", 1.0)]
            .iter()
            .chain(set)
            .map(|(knob, value)| (knob.to_string(), *value))
            .collect(),
        ..Overrules::default()
    };
    Plan::new(conditions, &overrules).expect("the plan is sound")
}

fn by(backend: &mut Backend, plan: &Plan) -> Rendered {
    let rendered = backend.render(plan, &Limits::default(), &|_| {});
    let rendered = rendered.expect("the backend works");
    rendered.frame.check().expect("every value is sound");
    rendered
}

/// What a backend that has seen nothing before makes.
fn afresh(wanted: Wanted, plan: &Plan) -> Rendered {
    by(&mut Backend::open(wanted).expect("it can be opened"), plan)
}

/// Relative RMSE of the pictures' luminance.
fn apart(found: &Frame, truth: &Frame) -> f64 {
    let at = |frame: &Frame, i| luminance(frame.picture(i));
    let pixels = truth.pixels() as f64;
    let mean = (0..truth.pixels()).map(|i| at(truth, i)).sum::<f64>() / pixels;
    let square = |i| (at(found, i) - at(truth, i)).powi(2);
    ((0..truth.pixels()).map(square).sum::<f64>() / pixels).sqrt() / mean
}

/// The same of each layer.
fn layers_apart(found: &Frame, truth: &Frame) -> Vec<(&'static str, f64)> {
    let alone = |frame: &Frame, layer: usize| Frame {
        layers: vec![frame.layers[layer].clone()],
        ..Frame::new(frame.width, frame.height).expect("room for it")
    };
    assert_eq!(found.layers.len(), truth.layers.len());
    let apart = |i| apart(&alone(found, i), &alone(truth, i));
    let names = truth.layers.iter().map(|layer| layer.name);
    names.zip(0..).map(|(name, i)| (name, apart(i))).collect()
}

/// What the corners of a scene's triangles take once, in f32 [bytes].
fn corner_bytes(conditions: &Conditions) -> u64 {
    36 * conditions.geometry.triangle_count() as u64
}

/// The backends that there are.
fn backends(test: &str) -> Vec<Wanted> {
    match common::gpu(test) {
        true => vec![Wanted::Gpu, Wanted::Reference],
        false => vec![Wanted::Reference],
    }
}

#[test]
fn conditions_of_a_moment_are_those_of_a_scene_of_that_time() {
    let before = nave([12, 8]);
    let mut scene = (*before.scene).clone();
    scene.air = Some(Default::default());
    let request = Request {
        size: Some([12, 8]),
        ..Request::default()
    };
    let before = Conditions::new(scene.clone(), &request).expect("it is sound");
    for time in [
        LATER,
        "2026-10-22T17:50:00+02:00",
        "2026-01-02T03:00:00+01:00",
        "JD2461336.9",
    ] {
        let found = before.at(time).expect("the time is sound");
        scene.time = Some(time.to_owned());
        let truth = Conditions::new(scene.clone(), &request).expect("it is sound");
        assert!(Arc::ptr_eq(&found.scene, &before.scene), "{time}");
        assert!(Arc::ptr_eq(&found.geometry, &before.geometry), "{time}");
        assert_eq!(found.sun, truth.sun, "{time}");
        assert_ne!(found.sun, before.sun, "{time}");
        assert_eq!(found.air, truth.air, "{time}");
        assert_ne!(found.air, before.air, "the air holds the sun's path");
        assert_eq!(found.view, before.view);
        assert_eq!(found.ground, before.ground);
        let told = |c: &Conditions| format!("{:?} {:?}", c.warnings, c.instant);
        assert_eq!(told(&found), told(&truth));
        let sky = |c: &Conditions| {
            let sky = c.sky.clone().expect("a place has a sky");
            [
                DVec3::Y,
                DVec3::X,
                DVec3::new(0.6, 0.48, 0.64),
                c.sun.toward,
            ]
            .map(|direction| sky.radiance(direction))
        };
        assert_eq!(sky(&found), sky(&truth), "{time}");
        assert_ne!(sky(&found), sky(&before), "{time}");
    }
    assert!(before.at("half past nine").is_err());
}

#[test]
fn a_sun_that_stands_in_for_place_and_time_has_no_other_moment() {
    let conditions = hills_at(0.0);
    let Err(error) = conditions.at(LATER) else {
        panic!("it has no place");
    };
    assert!(error.is_input());
    assert!(error.remedy().contains("[sun]"), "{}", error.remedy());
}

#[test]
fn conditions_of_another_view_share_everything_else() {
    let before = nave([12, 8]);
    let found = moved(&before, DVec3::new(0.1, 0.0, -1.0));
    assert!(Arc::ptr_eq(&found.scene, &before.scene));
    assert!(Arc::ptr_eq(&found.geometry, &before.geometry));
    let sky = |c: &Conditions| c.sky.clone().expect("a place has a sky");
    assert!(Arc::ptr_eq(&sky(&found), &sky(&before)));
    assert_eq!(found.sun, before.sun);
    assert_eq!(found.air, before.air);
    assert_ne!(found.view, before.view);
    // The moment stays that of the conditions at hand, not the scene's.
    let later = before.at(LATER).expect("the time is sound");
    assert_eq!(moved(&later, DVec3::X).sun, later.sun);
}

#[test]
fn views_outside_their_domain_are_refused() {
    let conditions = nave([12, 8]);
    let good = conditions.view.clone();
    let refused = |view: View, word: &str| {
        let Err(error) = conditions.seen_from(view) else {
            panic!("{word}: it was taken");
        };
        assert!(error.is_input(), "{error}");
        let told = format!("{error} {}", error.remedy());
        assert!(told.contains(word), "{word}: {told}");
    };
    type Spoil = fn(&mut View);
    let spoilt: [(&str, Spoil); 6] = [
        ("--eye", |v| v.camera.eye.x = f64::NAN),
        ("--target", |v| v.camera.forward = DVec3::ZERO),
        ("fov_y", |v| {
            v.camera.projection = Projection::Perspective { fov_y: 4.0 };
        }),
        ("height", |v| {
            v.camera.projection = Projection::Orthographic { height: 0.0 };
        }),
        ("size", |v| v.size = [0, 8]),
        ("samples", |v| v.samples = 0),
    ];
    for (word, spoil) in spoilt {
        let mut view = good.clone();
        spoil(&mut view);
        refused(view, word);
    }
    let point = |position: DVec3, normal: DVec3| Receiver { position, normal };
    let sound = point(DVec3::ONE, DVec3::Y);
    let none: [Receiver; 0] = [];
    refused(View::of_points(none), "at least one");
    refused(
        View::of_points([sound, point(DVec3::splat(f64::NAN), DVec3::Y)]),
        "point 2",
    );
    refused(
        View::of_points([sound, sound, point(DVec3::ZERO, 2.0 * DVec3::Y)]),
        "point 3",
    );
    let mut small = View::of_points([sound; 5]);
    small.size = [2, 2];
    refused(small, "5 points");
    let view = View::of_points([sound; 5]);
    assert!(conditions.seen_from(view).is_ok());
}

#[test]
fn start_up_and_rays_are_all_of_the_time() {
    for wanted in backends("start_up_and_rays_are_all_of_the_time") {
        let now = nave([36, 22]);
        let mut backend = Backend::open(wanted).expect("it can be opened");
        let mut prepared = Duration::MAX;
        for _ in 0..2 {
            let plan = plan(&now);
            let begin = Instant::now();
            let rendered = by(&mut backend, &plan);
            let wall = begin.elapsed();
            let told = rendered.start_up.time() + rendered.elapsed;
            eprintln!("{wanted:?}: {wall:?}, {told:?}, {:?}", rendered.start_up);
            assert!(told <= wall, "{told:?} of {wall:?}");
            let least = wall.mul_f64(0.95).saturating_sub(Duration::from_millis(20));
            assert!(told >= least, "{told:?} of {wall:?}");
            let named: Vec<&str> = rendered.start_up.stages().map(|(name, _)| name).collect();
            assert!(named.contains(&"radiosity.prepare"), "{named:?}");
            let compiles = named.contains(&"pipelines") && named.contains(&"scene to device");
            assert_eq!(compiles, wanted == Wanted::Gpu, "{named:?}");
            // What lasts is there for the second.
            let time = rendered.start_up.time();
            assert!(time < prepared / 2, "{time:?} after {prepared:?}");
            prepared = time;
        }
    }
}

#[test]
fn what_lasts_over_pictures_is_made_once() {
    let test = "what_lasts_over_pictures_is_made_once";
    for wanted in backends(test) {
        let size = match wanted {
            Wanted::Gpu => [120, 75],
            _ => [36, 22],
        };
        let now = nave(size);
        let mut backend = Backend::open(wanted).expect("it can be opened");
        let first = by(&mut backend, &plan(&now));
        for name in [LIGHT, TRANSPORT] {
            assert!(first.made.products.contains(&name), "{:?}", first.made);
        }
        let again = by(&mut backend, &plan(&now));
        assert!(again.frame == first.frame, "{wanted:?}");
        assert_eq!(again.made, Made::default(), "{wanted:?}");
        // A plan of conditions made from these is the same too.
        let same = now.seen_from(now.view.clone()).expect("it is sound");
        let again = by(&mut backend, &plan(&same));
        assert!(again.frame == first.frame, "{wanted:?}");
        assert_eq!(again.made, Made::default(), "{wanted:?}");

        let later = now.at(LATER).expect("the time is sound");
        let minute = by(&mut backend, &plan(&later));
        let truth = afresh(wanted, &plan(&later));
        assert!(minute.frame == truth.frame, "{wanted:?}");
        let seen = apart(&first.frame, &truth.frame);
        eprintln!("{wanted:?}: a minute changes the picture by {seen:.1e}");
        assert!(seen > 1e-3, "a stale picture would be noticed: {seen}");
        assert!(of_a_moment(&minute.made), "{wanted:?}: {:?}", minute.made);
        assert_eq!(minute.made.pipelines, 0);
        assert!(!minute.made.scene);
        if wanted == Wanted::Gpu {
            assert!(first.made.scene && first.made.pipelines > 0);
            assert!(first.made.maps > 0 && minute.made.maps > 0);
            assert_eq!(first.traffic.allocated, again.traffic.allocated);
            let [first, again, minute] = [first, again, minute].map(|r| r.traffic.uploaded);
            let corners = corner_bytes(&now);
            eprintln!("uploaded {first}, {again}, {minute} bytes; corners {corners}");
            assert!(again + corners < first && minute < again + corners);
        }
    }
}

#[test]
fn a_moved_eye_keeps_the_scene_and_the_skys_light() {
    let test = "a_moved_eye_keeps_the_scene_and_the_skys_light";
    if !common::gpu(test) {
        return;
    }
    let ways = |direction: DVec3, beyond: f64| [0.5, 5.0, beyond].map(|far| far * direction);
    let ahead = DVec3::new(0.05, 0.02, -1.0).normalize();
    for (name, from, ways) in [
        ("nave", nave([120, 75]), ways(ahead, 13.0)),
        ("hills", hills_at(0.0), ways(ahead, 90.0)),
        ("hills far away", hills_at(6.4e6), ways(ahead, 90.0)),
    ] {
        let mut backend = Backend::open(Wanted::Gpu).expect("it can be opened");
        let first = by(&mut backend, &plan(&from));
        let again = by(&mut backend, &plan(&from)).traffic.uploaded;
        let corners = corner_bytes(&from);
        for (way, number) in ways.into_iter().zip(0..) {
            let to = moved(&from, way);
            let found = by(&mut backend, &plan(&to));
            let truth = afresh(Wanted::Gpu, &plan(&to));
            let error = apart(&found.frame, &truth.frame);
            let seen = apart(&first.frame, &truth.frame);
            // A bright layer hides nothing of the others. Where a texel's centre lies on an edge to f32's last digit, the shadow
            // map may have the edge's other side: single pixels of sunlight differ by a per cent.
            let layers = layers_apart(&found.frame, &truth.frame);
            // A point of surfaces that two cells share is looked at for the one that asks first, some millimetres from the other's.
            let most = |layer: &str| match layer {
                "sky" | "indirect" => 5e-3,
                _ => 5e-4,
            };
            let near = layers.iter().all(|(layer, error)| *error <= most(layer));
            assert!(near, "{name}, {way}: {layers:?}");
            let uploaded = found.traffic.uploaded;
            eprintln!(
                "{name}, {:.1} m: {error:.1e} (the old picture {seen:.1e}), {} maps, {uploaded} bytes; {layers:?}",
                way.length(),
                found.made.maps
            );
            assert!(error <= 5e-3, "{name}, {way}: {error}");
            assert!(seen > 1e-2, "{name}, {way}: {seen}");
            assert!(found.made.maps > 0);
            let made = Made {
                maps: found.made.maps,
                ..Made::default()
            };
            let mut of_scene = found.made.clone();
            of_scene.products.retain(|name| *name != AIR);
            assert_eq!(of_scene, made, "{name}, {way}");
            // Beyond the reach the corners come anew, relative to another anchor; nothing else of the scene does.
            match number {
                2 => assert!(uploaded > again + corners && uploaded < first.traffic.uploaded),
                _ => assert!(uploaded < again + corners, "{uploaded} {again} {corners}"),
            }
        }
    }
}

#[test]
fn a_moved_eye_keeps_the_skys_light_of_the_reference() {
    let from = nave([36, 22]);
    let mut backend = Backend::open(Wanted::Reference).expect("it can be opened");
    by(&mut backend, &plan(&from));
    for way in [0.5, 5.0, 13.0] {
        let to = moved(&from, way * DVec3::NEG_Z);
        let found = by(&mut backend, &plan(&to));
        assert!(
            found.made.products.iter().all(|name| *name == AIR),
            "{:?}",
            found.made
        );
        assert!(found.frame == afresh(Wanted::Reference, &plan(&to)).frame);
    }
}

#[test]
fn what_other_conditions_make_stale_is_made_again() {
    let test = "what_other_conditions_make_stale_is_made_again";
    for wanted in backends(test) {
        let size = match wanted {
            Wanted::Gpu => [60, 38],
            _ => [30, 19],
        };
        let first = {
            let mut view = hills();
            view.scene.ground.enabled = true;
            view.scene.ground.height = Some(-200.0);
            conditions(view.scene, view.camera, size)
        };
        let with = |change: &dyn Fn(&mut Conditions)| {
            let mut other = first.clone();
            change(&mut other);
            other
        };
        let another_scene = |change: &dyn Fn(&mut Scene)| {
            let mut scene = (*first.scene).clone();
            change(&mut scene);
            conditions(scene, first.view.camera, size)
        };
        let ground = |c: &mut Conditions| {
            c.ground = Some(GroundPlane {
                height: -200.0,
                albedo: DVec3::splat(0.9),
            });
        };
        let sky = |c: &mut Conditions| {
            let model = Model::Uniform { luminance: 9e3 };
            let sky = Sky::new(model, SunAt::unrefracted(c.sun.toward));
            c.sky = Some(Arc::new(sky.expect("the model is sound")));
        };
        let light = |c: &mut Conditions| c.sun.light.illuminance *= 0.5;
        let media = |c: &mut Conditions| c.air.media[0].absorption *= 20.0;
        let dark = |scene: &mut Scene| scene.materials[0].base_color *= 0.3;
        let others: [(&str, Conditions, Settings); 8] = [
            ("more rays", first.clone(), &[("radiosity.rays", 256.0)]),
            // What the air's places have seen names patches that there are no more.
            (
                "fewer patches",
                first.clone(),
                &[("radiosity.patches", 100.0)],
            ),
            ("a white ground", with(&ground), &[]),
            ("another sky", with(&sky), &[]),
            ("a weaker sun", with(&light), &[]),
            ("more absorption", with(&media), &[]),
            ("other materials", another_scene(&dark), &[]),
            (
                "another albedo",
                another_scene(&|scene| scene.ground.albedo = 0.9),
                &[],
            ),
        ];
        let mut backend = Backend::open(wanted).expect("it can be opened");
        let before = by(&mut backend, &plan(&first)).frame;
        for (what, other, set) in &others {
            let found = by(&mut backend, &plan_with(other, set));
            let truth = afresh(wanted, &plan_with(other, set)).frame;
            let seen = apart(&before, &truth);
            eprintln!("{wanted:?}, {what}: changes the picture by {seen:.1e}");
            assert!(found.frame == truth, "{wanted:?}, {what}");
            assert!(seen > 1e-5, "{what}: a stale picture would not be noticed");
            assert!(found.made.products.contains(&LIGHT), "{what}");
            // Who sees whom is the same under every sky.
            if ["another sky", "a weaker sun"].contains(what) {
                assert!(of_a_moment(&found.made), "{what}: {:?}", found.made);
            }
            assert_eq!(by(&mut backend, &plan(&first)).frame, before, "{what}");
        }
    }
}

#[test]
fn a_stopped_rendering_says_so_and_leaves_the_backend_sound() {
    let test = "a_stopped_rendering_says_so_and_leaves_the_backend_sound";
    for wanted in backends(test) {
        // More than one sample and more than one band of rows, so that there is something to go on with.
        let mut conditions = conditions(hills().scene, hills().camera, [30, 70]);
        conditions.view.samples = 3;
        let plan = plan(&conditions);
        let mut backend = Backend::open(wanted).expect("it can be opened");
        let stop = AtomicBool::new(false);
        let limits = Limits {
            stop: Some(&stop),
            ..Limits::default()
        };
        let stopped = backend.render(&plan, &limits, &|step| {
            if step.stage == PICTURE {
                assert!(step.share < 1.0, "{step:?}");
                stop.store(true, Ordering::Relaxed);
            }
        });
        assert!(matches!(stopped, Err(Error::Stopped)), "{wanted:?}");
        // Nobody took the flag back: nothing begins.
        let begun = AtomicBool::new(false);
        let stopped = backend.render(&plan, &limits, &|_| begun.store(true, Ordering::Relaxed));
        assert!(matches!(stopped, Err(Error::Stopped)));
        assert!(!begun.load(Ordering::Relaxed));
        let found = by(&mut backend, &plan);
        assert!(found.frame == afresh(wanted, &plan).frame, "{wanted:?}");
        // What the stopped rendering made was not made for this one.
        assert_eq!(found.made.products, [""; 0], "{wanted:?}");
    }
}

#[test]
fn what_is_stopped_while_it_is_made_ends_at_once_and_is_not_kept() {
    let test = "what_is_stopped_while_it_is_made_ends_at_once_and_is_not_kept";
    let conditions = nave([20, 12]);
    let plan = plan(&conditions);
    let stages = [
        (TRANSPORT, 0.0),
        (TRANSPORT, 0.15),
        (TRANSPORT, 0.5),
        (TRANSPORT, 0.95),
        (LIGHT, 0.2),
        (LIGHT, 0.6),
    ];
    for wanted in backends(test) {
        let whole = afresh(wanted, &plan);
        for (stage, share) in stages {
            let mut backend = Backend::open(wanted).expect("it can be opened");
            let stop = AtomicBool::new(false);
            let limits = Limits {
                stop: Some(&stop),
                ..Limits::default()
            };
            let after = Mutex::new(Vec::new());
            let stopped = backend.render(&plan, &limits, &|step: Step| {
                if stop.load(Ordering::Relaxed) {
                    after.lock().expect("nobody panicked").push(step);
                } else if step.stage == stage && step.share >= share {
                    stop.store(true, Ordering::Relaxed);
                }
            });
            assert!(matches!(stopped, Err(Error::Stopped)), "{stage} {share}");
            // At most what other threads had begun is still told: of some hundred times that the stage tells how far it is.
            let after = after.into_inner().expect("nobody panicked");
            assert!(after.iter().all(|step| step.stage == stage), "{after:?}");
            assert!(after.len() < rayon::current_num_threads(), "{after:?}");
            let found = by(&mut backend, &plan);
            assert!(found.frame == whole.frame, "{wanted:?} {stage} {share}");
            let made = |name| found.made.products.contains(&name);
            assert!(made(LIGHT) && made(TRANSPORT) == (stage == TRANSPORT));
        }
    }
}

#[test]
fn many_moments_go_through_one_backend_until_told_to_stop() {
    let test = "many_moments_go_through_one_backend_until_told_to_stop";
    for wanted in backends(test) {
        let start = nave([20, 12]);
        let asked = std::cell::Cell::new(0);
        let moments = (0..5).map(|minute| {
            asked.set(asked.get() + 1);
            start.at(&format!("2026-10-22T11:{minute:02}:00+02:00"))
        });
        let mut backend = Backend::open(wanted).expect("it can be opened");
        let mut frames: Vec<Frame> = Vec::new();
        let overrules = Overrules {
            quality: Quality::Draft,
            ..Overrules::default()
        };
        let limits = Limits::default();
        let result = backend.render_all(
            moments,
            &overrules,
            &limits,
            &|_| {},
            |number, plan, found| {
                assert_eq!(number, frames.len());
                let late = plan.conditions.sun != start.sun;
                assert_eq!(late, number > 0);
                assert_eq!(of_a_moment(&found.made), late, "{:?}", found.made);
                assert_eq!(
                    found.made.pipelines > 0,
                    number == 0 && wanted == Wanted::Gpu
                );
                assert_eq!(found.made.scene, number == 0 && wanted == Wanted::Gpu);
                frames.push(found.frame);
                Ok(match number {
                    2 => ControlFlow::Break(()),
                    _ => ControlFlow::Continue(()),
                })
            },
        );
        result.expect("the backend works");
        assert_eq!((frames.len(), asked.get()), (3, 3), "{wanted:?}");
        assert!(frames[0] != frames[1] && frames[1] != frames[2]);
        // A moment that cannot be read ends it, and what came before is there already.
        let mut seen = 0;
        let moments = [start.at(LATER), start.at("noon"), start.at(LATER)];
        let result = backend.render_all(moments, &overrules, &limits, &|_| {}, |_, _, _| {
            seen += 1;
            Ok(ControlFlow::Continue(()))
        });
        assert!(result.is_err_and(|error| error.is_input()));
        assert_eq!(seen, 1);
    }
}

/// A device that the test itself opens, as a viewer does.
fn own_device() -> (wgpu::Adapter, wgpu::Device, wgpu::Queue) {
    let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = backends;
    let instance = wgpu::Instance::new(descriptor);
    let adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let adapter = adapters.into_iter().next().expect("there is an adapter");
    let request = adapter.request_device(&wgpu::DeviceDescriptor {
        required_limits: adapter.limits(),
        ..Default::default()
    });
    let (device, queue) = pollster::block_on(request).expect("it opens");
    (adapter, device, queue)
}

/// What stands in a buffer of floats.
fn read_back(device: &wgpu::Device, queue: &wgpu::Queue, buffer: &wgpu::Buffer) -> Vec<f32> {
    let copy = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: buffer.size(),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
    queue.submit([encoder.finish()]);
    copy.map_async(wgpu::MapMode::Read, .., |_| {});
    let polled = device.poll(wgpu::PollType::wait_indefinitely());
    polled.expect("the device works");
    let bytes = copy.get_mapped_range(..).expect("it is mapped");
    bytemuck::pod_collect_to_vec(&bytes)
}

#[test]
fn a_picture_that_stays_on_the_device_is_the_one_that_comes_back() {
    let test = "a_picture_that_stays_on_the_device_is_the_one_that_comes_back";
    if !common::gpu(test) {
        return;
    }
    let (adapter, device, queue) = own_device();
    let mut gpu = Gpu::new(
        Device::from_wgpu(&adapter, device.clone(), queue.clone()).expect("it takes enough"),
    );
    // Two tiles, the second of which is narrow.
    let view = slats(1.0);
    let mut conditions = conditions(view.scene, view.camera, [530, 40]);
    conditions.view.samples = 2;
    for at in [0.0, 0.3] {
        let conditions = moved(&conditions, at * DVec3::X);
        let plan = plan(&conditions);
        let limits = Limits::default();
        gpu.render_on_device(&plan, &limits, &|_| {})
            .expect("it works");
        let before = gpu.device().traffic().allocated;
        let (kept, _) = gpu
            .render_on_device(&plan, &limits, &|_| {})
            .expect("it works");
        // The next picture needs its own pixels and nothing else.
        let allocated = gpu.device().traffic().allocated - before;
        assert_eq!(allocated, 16 * u64::from(kept.width * kept.height));
        let truth = gpu.render(&plan, &limits, &|_| {}).expect("it works");
        // What was handed out is not touched by pictures that follow.
        let found = read_back(&device, &queue, &kept.buffer);
        let frame = &truth.frame;
        assert_eq!([kept.width, kept.height], [frame.width, frame.height]);
        assert!(found.len() >= 4 * frame.pixels());
        let mean = (0..frame.pixels()).map(|i| frame.picture(i).y).sum::<f64>();
        let mean = mean / frame.pixels() as f64;
        assert!(mean > 1.0, "{mean}");
        let mut worst = 0.0f64;
        for (texel, i) in found.chunks_exact(4).zip(0..frame.pixels()) {
            let truth = frame.picture(i);
            let found = DVec3::new(texel[0].into(), texel[1].into(), texel[2].into());
            let error = (found - truth).abs().max_element() / truth.max_element().max(mean);
            worst = worst.max(error);
            assert_eq!(texel[3], 1.0);
        }
        eprintln!("on the device and back: {worst:.1e}");
        assert!(worst <= 1e-6, "{worst}");
    }
}
