//! What is written is what was computed, for the exr crate and for OpenEXR's own library, and nothing is left of
//! what could not be written.

mod common;

use glam::{DMat3, DVec2, DVec3, Vec3};
use serde_json::Value as Json;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tyndall::colour::display;
use tyndall::frame::{Field, Frame, Layer, NO_HIT};
use tyndall::output::{
    Format, HALF_MOST, Numbers, OutputSpace, Units, atomic, check_targets, exr, hdr, picture, png,
    report, select_layers, space,
};

/// Linear Rec. 709, by the matrix of ITU-R BT.2087 inverted: dark Rec. 2020 greens become negative in it.
fn rec709() -> OutputSpace {
    OutputSpace {
        name: "rec709",
        from_working: DMat3::from_cols(
            DVec3::new(1.660_491, -0.124_550_5, -0.018_150_8),
            DVec3::new(-0.587_641_1, 1.132_899_9, -0.100_578_9),
            DVec3::new(-0.072_849_9, -0.008_349_4, 1.118_729_7),
        ),
        primaries: [
            DVec2::new(0.64, 0.33),
            DVec2::new(0.30, 0.60),
            DVec2::new(0.15, 0.06),
        ],
        white: DVec2::new(0.3127, 0.3290),
        numbers: Numbers::default(),
    }
}

/// Values of every size, from a shadow's to the sun's disc, in six of the eight layers.
fn frame(width: u32, height: u32) -> Frame {
    let mut frame = Frame::new(width, height).expect("room for it");
    let pixels = frame.pixels();
    for (k, name) in Field::layers().map(Field::name).enumerate() {
        if ["lights", "inscatter_lights"].contains(&name) {
            continue;
        }
        let value = |i: usize, c: usize| ((7 * i + 3 * k + 5 * c) % 11) as f32 * 123.456;
        let mut rgb: Vec<Vec3> = (0..pixels)
            .map(|i| Vec3::new(value(i, 0), value(i, 1), value(i, 2)))
            .collect();
        if name == "background" {
            rgb[pixels / 2] = Vec3::splat(1.6e9);
        }
        frame.layers.push(Layer { name, rgb });
    }
    for i in 0..pixels {
        frame.depth[i] = if i % 3 == 0 { NO_HIT } else { 0.25 * i as f32 };
        frame.normal[i] = Vec3::new(0.6, -0.8, 0.0);
        frame.transmittance[i] = Vec3::new(0.9, 0.8, 0.7);
    }
    frame.record.set("utc", "2026-06-21T16:30:00Z");
    frame.record.set("scene", "Kölner Dom");
    frame.record.set("sun_azimuth_deg", 0.1 + 0.2);
    frame
}

/// What a reader found in a file.
#[derive(Debug, Clone, Default)]
struct Found {
    layout: BTreeMap<String, Json>,
    channels: BTreeMap<String, Vec<f32>>,
    texts: BTreeMap<String, String>,
    numbers: BTreeMap<String, f64>,
}

/// As the exr crate reads it.
fn by_crate(path: &Path) -> Found {
    use ::exr::prelude::*;
    let image = read_all_flat_layers_from_file(path).expect("the exr crate reads the file");
    let mut found = Found::default();
    let layer = &image.layer_data[0];
    let encoding = layer.encoding;
    let layout = [
        ("parts", Json::from(image.layer_data.len())),
        ("width", layer.size.0.into()),
        ("height", layer.size.1.into()),
        ("zip16", (encoding.compression == Compression::ZIP16).into()),
        ("scan_lines", (encoding.blocks == Blocks::ScanLines).into()),
        (
            "increasing",
            (encoding.line_order == LineOrder::Increasing).into(),
        ),
    ];
    assert!(
        layer.attributes.layer_name.is_none(),
        "the layer has a name"
    );
    found.layout = layout.map(|(name, value)| (name.into(), value)).into();
    for channel in &layer.channel_data.list {
        let FlatSamples::F32(values) = &channel.sample_data else {
            panic!("{} is not 32-bit float", channel.name);
        };
        let name = channel.name.to_string();
        assert!(!channel.quantize_linearly, "{name}");
        found.channels.insert(name, values.clone());
    }
    for (name, value) in &layer.attributes.other {
        match value {
            AttributeValue::Text(text) => {
                let text = std::str::from_utf8(text.as_slice()).expect("texts are UTF-8");
                found.texts.insert(name.to_string(), text.into());
            }
            AttributeValue::F64(number) => {
                found.numbers.insert(name.to_string(), *number);
            }
            _ => panic!("{name} is neither text nor a number"),
        }
    }
    let white = layer.attributes.white_luminance.unwrap_or(f32::NAN);
    found.numbers.insert("whiteLuminance".into(), white.into());
    let chromaticities = image.attributes.chromaticities.expect("there are some");
    let attribute::Chromaticities {
        red,
        green,
        blue,
        white,
    } = chromaticities;
    for (i, v) in [red, green, blue, white]
        .iter()
        .flat_map(|xy| [xy.0, xy.1])
        .enumerate()
    {
        found
            .numbers
            .insert(format!("chromaticities.{i}"), v.into());
    }
    found
}

/// As OpenEXR's own library reads it, or `None` where there is no Python for the tests.
fn by_openexr(test: &str, path: &Path) -> Option<Found> {
    let printed = common::python(test, "exr.py", path.to_str().expect("the path is UTF-8"))?;
    let json: Json = serde_json::from_str(&printed).expect("the script prints JSON");
    let read = |key: &str| json[key].as_object().expect("a table").clone();
    let mut layout: BTreeMap<String, Json> = json
        .as_object()
        .expect("a table")
        .clone()
        .into_iter()
        .collect();
    layout.retain(|key, _| !["channels", "texts", "numbers"].contains(&key.as_str()));
    let float = |v: &Json| v.as_f64().expect("a number");
    let text = |v: &Json| v.as_str().expect("a text").to_owned();
    Some(Found {
        layout,
        channels: read("channels")
            .into_iter()
            .map(|(k, v)| {
                let values = v.as_array().expect("a list").iter();
                (k, values.map(|v| float(v) as f32).collect())
            })
            .collect(),
        texts: read("texts")
            .into_iter()
            .map(|(k, v)| (k, text(&v)))
            .collect(),
        numbers: read("numbers")
            .into_iter()
            .map(|(k, v)| (k, float(&v)))
            .collect(),
    })
}

/// What a file must hold to be `frame` in `space`, or what is wrong with it.
fn compare(found: &Found, frame: &Frame, space: &OutputSpace) -> Result<(), String> {
    let layout = [
        ("parts", Json::from(1)),
        ("width", frame.width.into()),
        ("height", frame.height.into()),
        ("zip16", true.into()),
        ("scan_lines", true.into()),
        ("increasing", true.into()),
    ];
    for (name, value) in layout {
        if found.layout.get(name) != Some(&value) {
            return Err(format!("{name} is {:?}", found.layout.get(name)));
        }
    }
    let channel = |name: &str| {
        let values = found
            .channels
            .get(name)
            .ok_or(format!("no channel {name}"))?;
        if values.len() == frame.pixels() {
            Ok(values)
        } else {
            Err(format!("{name} has {} values", values.len()))
        }
    };
    let count = 4 + 3 * (Field::layers().count() + 2);
    if found.channels.len() != count {
        return Err(format!("{} channels", found.channels.len()));
    }
    for i in 0..frame.pixels() {
        for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
            let mut sum = 0.0;
            let mut size = 0f64;
            for name in Field::layers().map(Field::name) {
                let value = f64::from(channel(&format!("{name}.{letter}"))?[i]);
                let rgb = frame
                    .layer(name)
                    .map_or(DVec3::ZERO, |l| l.rgb[i].as_dvec3());
                let expected = (space.from_working * rgb)[c];
                // Half a unit in the last place of f32.
                if (value - expected).abs() > 6e-8 * expected.abs() {
                    return Err(format!("{name}.{letter} is {value}, not {expected}"));
                }
                sum += value;
                size = size.max(value.abs());
            }
            let picture = f64::from(channel(letter)?[i]);
            if (picture - sum).abs() > 1e-5 * size {
                return Err(format!("{letter} is {picture}, its layers are {sum}"));
            }
            if channel(&format!("transmittance.{letter}"))?[i] != frame.transmittance[i][c] {
                return Err(format!("transmittance.{letter} at {i}"));
            }
            let axis = ["X", "Y", "Z"][c];
            if channel(&format!("normal.{axis}"))?[i] != frame.normal[i][c] {
                return Err(format!("normal.{axis} at {i}"));
            }
        }
        if channel("Z")?[i] != frame.depth[i] {
            return Err(format!("Z is {} at {i}", channel("Z")?[i]));
        }
    }
    let texts = [
        ("tyndall:utc", "2026-06-21T16:30:00Z"),
        ("tyndall:scene", "Kölner Dom"),
        ("tyndall:color_space", space.name),
    ];
    for (name, text) in texts {
        if found.texts.get(name).map(String::as_str) != Some(text) {
            return Err(format!("{name} is {:?}", found.texts.get(name)));
        }
    }
    let [red, green, blue] = space.primaries;
    let xy = [red, green, blue, space.white]
        .map(|v| v.to_array())
        .concat();
    let numbers = xy
        .iter()
        // The format keeps chromaticities as f32.
        .map(|v| f64::from(*v as f32))
        .enumerate()
        .map(|(i, v)| (format!("chromaticities.{i}"), v))
        .chain([
            ("whiteLuminance".into(), 1.0),
            ("tyndall:sun_azimuth_deg".into(), 0.1 + 0.2),
        ]);
    for (name, number) in numbers {
        if found.numbers.get(&name) != Some(&number) {
            return Err(format!(
                "{name} is {:?}, not {number}",
                found.numbers.get(&name)
            ));
        }
    }
    Ok(())
}

fn write_exr(path: &Path, frame: &Frame) {
    let all = select_layers::<&str>(&[]).expect("no names are all names");
    exr::write(path, frame, &rec709(), &all).expect("the file is written");
}

#[test]
fn the_exr_holds_the_frame() {
    let test = "output::the_exr_holds_the_frame";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    // One pixel; a row; fewer, as many and more rows than a block of 16.
    let sizes = [(1, 1), (5, 1), (37, 15), (3, 16), (8, 33)];
    let mut python = true;
    for (width, height) in sizes {
        let frame = frame(width, height);
        write_exr(&path, &frame);
        let mut readings = vec![by_crate(&path)];
        if python {
            match by_openexr(test, &path) {
                Some(found) => readings.push(found),
                None => python = false,
            }
        }
        for found in readings {
            compare(&found, &frame, &rec709()).expect("the file holds the frame");
            assert_eq!(found.channels["lights.G"], vec![0.0; frame.pixels()]);
        }
    }
}

#[test]
fn a_jpeg_shows_what_the_png_shows_and_holds_its_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let rgb = (0..96 * 48).map(|i| {
        let (x, y) = ((i % 96) as f32 / 96.0, (i / 96) as f32 / 48.0);
        100.0 * Vec3::new(0.2 + x, 0.3 + 0.5 * y, 0.9 - 0.5 * x)
    });
    let mut frame = Frame::map(96, 48, rgb.collect());
    frame.record.set("key", "0123abc");
    let paths = ["a.png", "a.jpg"].map(|name| folder.path().join(name));
    for path in &paths {
        let format = Format::of(path).expect("a format");
        picture::write(path, format, &frame, &rec709(), &[], 7.0).expect("it is written");
        assert_eq!(picture::key_of(path, format).as_deref(), Some("0123abc"));
    }
    let [png, jpeg] = paths
        .each_ref()
        .map(|path| image::open(path).expect("a picture").to_rgb8());
    assert_eq!(png.dimensions(), jpeg.dimensions());
    let pairs = png.as_raw().iter().zip(jpeg.as_raw());
    let apart: Vec<f64> = pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).collect();
    let mean = apart.iter().sum::<f64>() / apart.len() as f64;
    assert!(mean < 2.0, "{mean} codes in the mean");
    assert!(apart.iter().all(|d| *d <= 20.0), "{apart:?}");
    // A side has 16 bits there.
    let wide = Frame::map(65_536, 1, vec![Vec3::ONE; 65_536]);
    let refused = picture::write(&paths[1], Format::Jpeg, &wide, &rec709(), &[], 0.0);
    assert!(refused.is_err_and(|e| e.is_input()));
}

/// What was cut off on the way, or goes on where it ought to end, is not the picture of any key.
#[test]
fn a_picture_that_is_cut_off_has_no_key() {
    let folder = tempfile::tempdir().expect("a folder");
    // Rows that are written flat, in runs, and in bytes and runs.
    for width in [5, 8, 200] {
        let rgb = (0..width * 70).map(|i| match i % width < width / 2 {
            true => Vec3::splat(3.0),
            false => Vec3::new(1.0, 0.7, 0.3) * (1.0 + (0.1 * i as f32).sin()),
        });
        let mut frame = Frame::map(width, 70, rgb.collect());
        frame.record.set("key", "0123abc");
        for name in ["a.exr", "a.hdr", "a.png", "a.jpg"] {
            let path = folder.path().join(name);
            let format = Format::of(&path).expect("a format");
            picture::write(&path, format, &frame, &rec709(), &[], 1.0).expect("it is written");
            let key = || picture::key_of(&path, format);
            assert_eq!(key().as_deref(), Some("0123abc"), "{name}, {width}");
            let bytes = std::fs::read(&path).expect("it is there");
            for left in [bytes.len() - 1, bytes.len() - 2, bytes.len() / 2, 40, 0] {
                std::fs::write(&path, &bytes[..left]).expect("it is written");
                assert_eq!(key(), None, "{left} of {} bytes of {name}", bytes.len());
            }
            std::fs::write(&path, [&bytes[..], b"more"].concat()).expect("it is written");
            assert_eq!(key(), None, "more than {name}");
        }
    }
}

#[test]
fn a_map_is_its_colours_alone() {
    let test = "output::a_map_is_its_colours_alone";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("map.exr");
    // More rows than a block has, and a sun.
    let mut rgb: Vec<Vec3> = (0..96 * 48)
        .map(|i| Vec3::new(1.0, 0.7, 0.3) * (1.0 + (0.01 * i as f32).sin()))
        .collect();
    rgb[1234] = Vec3::splat(1.6e9);
    let map = Frame::map(96, 48, rgb.clone());
    exr::write(&path, &map, &rec709(), &[]).expect("the map is written");
    for found in [Some(by_crate(&path)), by_openexr(test, &path)]
        .into_iter()
        .flatten()
    {
        let names: Vec<&str> = found.channels.keys().map(String::as_str).collect();
        assert_eq!(names, ["B", "G", "R"]);
        for (k, row) in ["R", "G", "B"].into_iter().zip(0..3) {
            let row = rec709().from_working.row(row);
            for (value, v) in found.channels[k].iter().zip(&rgb) {
                // To the last bit: the compression loses nothing.
                assert_eq!(*value, row.dot(v.as_dvec3()) as f32);
            }
        }
    }
    assert!(map.check().is_ok());
    let mut short = map.clone();
    short.layers[0].rgb.pop();
    assert!(short.check().is_err());
}

#[test]
fn another_frame_is_noticed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    let right = frame(6, 20);
    let spoil: [fn(&mut Frame); 5] = [
        |f| f.layers[1].rgb[77].y *= 1.000_01,
        |f| f.depth[3] = 1e9,
        |f| f.normal.swap(0, 1),
        |f| f.transmittance[119].z = 0.699,
        |f| f.record.set("utc", "2026-06-21T18:30:00Z"),
    ];
    for (index, spoil) in spoil.into_iter().enumerate() {
        let mut wrong = right.clone();
        wrong.normal[0].z = 0.1;
        let mut right = right.clone();
        right.normal[0].z = 0.1;
        spoil(&mut wrong);
        write_exr(&path, &wrong);
        let found = by_crate(&path);
        assert!(compare(&found, &right, &rec709()).is_err(), "spoil {index}");
        compare(&found, &wrong, &rec709())
            .or_else(|e| if index == 4 { Ok(()) } else { Err(e) })
            .expect("it is the spoilt frame");
    }
    // The layers may be right and the picture not their sum, or the space another one.
    write_exr(&path, &right);
    let mut found = by_crate(&path);
    compare(&found, &right, &rec709()).expect("nothing is wrong with it");
    let mut space = rec709();
    space.white.x += 1e-3;
    assert!(compare(&found, &right, &space).is_err());
    found.channels.get_mut("R").expect("red")[7] *= 1.000_1;
    assert!(compare(&found, &right, &rec709()).is_err());
}

#[test]
fn the_same_picture_is_the_same_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (folder.path().join("a.exr"), folder.path().join("b.exr"));
    let mut frame = frame(9, 9);
    for i in 0..40 {
        frame.record.set(format!("knob_{i}"), f64::from(i));
    }
    write_exr(&a, &frame);
    write_exr(&b, &frame);
    let (a, b) = (fs::read(a).expect("a"), fs::read(b).expect("b"));
    assert!(a == b, "two writes differ");
}

#[test]
fn layers_left_out_are_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    let layers = select_layers(&["sun", "normal"]).expect("both are known");
    let frame = frame(4, 4);
    exr::write(&path, &frame, &rec709(), &layers).expect("the file is written");
    let found = by_crate(&path);
    let names: Vec<&str> = found.channels.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "B", "G", "R", "Z", "normal.X", "normal.Y", "normal.Z", "sun.B", "sun.G", "sun.R"
        ]
    );
    // The picture is whole whatever is listed beside it.
    let red = rec709().from_working.row(0).dot(frame.picture(3));
    assert_eq!(found.channels["R"][3], red as f32);
}

#[test]
fn the_png_decodes_to_the_bytes_given() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    let frame = frame(13, 7);
    let bytes = png::encode(&frame, 12.0);
    for (pixel, found) in bytes.chunks_exact(3).enumerate() {
        let at = [pixel % 13, pixel / 13].map(|n| n as u32);
        let codes = display::encode(frame.picture(pixel), 12.0, at, true);
        assert_eq!(found, codes);
    }
    png::write(&path, 13, 7, &bytes).expect("the file is written");
    let decoded = image::open(&path).expect("image reads it").into_rgb8();
    assert_eq!(decoded.dimensions(), (13, 7));
    assert!(decoded.into_raw() == bytes, "other bytes came back");
    let file = fs::read(&path).expect("the file");
    let has = |chunk: &[u8]| file.windows(4).any(|w| w == chunk);
    assert!(has(b"sRGB") && !has(b"iCCP"), "it is marked as sRGB");
    // Too few bytes: an error, and the picture that was there still is.
    let error = png::write(&path, 13, 8, &bytes).expect_err("bytes are missing");
    assert!(!error.is_input(), "{error}");
    assert!(fs::read(&path).expect("the file") == file);
}

#[test]
fn the_hdr_is_within_its_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.hdr");
    // 7 is below what is run-length encoded; 300 has long runs, made here.
    for width in [1, 7, 8, 300] {
        let mut frame = frame(width, 3);
        for layer in &mut frame.layers {
            layer.rgb[(width as usize)..][..width as usize / 2].fill(Vec3::splat(5.0));
        }
        hdr::write(&path, &frame, &rec709()).expect("the file is written");
        let decoded = image::open(&path).expect("image reads it").into_rgb32f();
        assert_eq!(decoded.dimensions(), (width, 3));
        for (i, pixel) in decoded.pixels().enumerate() {
            let expected = (rec709().from_working * frame.picture(i)).max(DVec3::ZERO);
            for c in 0..3 {
                let found = f64::from(pixel.0[c]) * space::WHITE_EFFICACY;
                // A mantissa of at least 128 of the largest component, rounded down, or read at its middle.
                let step = expected.max_element() / 127.0;
                assert!(
                    (found - expected[c]).abs() <= step,
                    "{found} for {expected}"
                );
            }
        }
        let text = fs::read(&path).expect("the file");
        let header = String::from_utf8_lossy(&text[..160.min(text.len())]).into_owned();
        assert!(
            header.contains("PRIMARIES= 0.6400 0.3300 0.3000"),
            "{header}"
        );
    }
}

#[test]
fn reports_are_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.json");
    report::write(&path, &frame(1, 1).record).expect("the file is written");
    let text = fs::read_to_string(&path).expect("the file");
    assert!(text.starts_with("{\n  \"utc\": \"2026-06-21T16:30:00Z\"") && text.ends_with("}\n"));
    let json: Json = serde_json::from_str(&text).expect("it is JSON");
    assert_eq!(json["sun_azimuth_deg"].as_f64(), Some(0.1 + 0.2));
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder is there");
    let name = |e: std::io::Result<fs::DirEntry>| e.expect("an entry").file_name();
    let mut names: Vec<String> = entries.map(|e| name(e).to_string_lossy().into()).collect();
    names.sort();
    names
}

#[test]
fn nothing_is_left_of_what_failed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    let mut bad = frame(5, 5);
    let background = bad.layers.iter_mut().find(|l| l.name == "background");
    background.expect("it is there").rgb[13].z = f32::NAN;
    let error = exr::write(&path, &bad, &rec709(), &[]).expect_err("NaN is not written");
    assert!(error.to_string().contains("background is") && error.to_string().contains("(3, 2)"));
    assert!(names(folder.path()).is_empty(), "something was left");

    fs::write(&path, "before").expect("the folder can be written");
    let full = |file: &mut fs::File| {
        std::io::Write::write_all(file, b"half a fi")?;
        Err(std::io::ErrorKind::StorageFull.into())
    };
    let error = atomic::write(&path, full).expect_err("the disk is full");
    assert!(
        !error.is_input() && error.to_string().contains("a.exr"),
        "{error}"
    );
    assert_eq!(names(folder.path()), ["a.exr"]);
    assert_eq!(fs::read_to_string(&path).expect("the file"), "before");

    atomic::write(&path, |f| std::io::Write::write_all(f, b"after")).expect("there is room");
    assert_eq!(names(folder.path()), ["a.exr"]);
    assert_eq!(fs::read_to_string(&path).expect("the file"), "after");
}

#[test]
fn what_cannot_be_written_is_known_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = |name: &str| folder.path().join(name);
    check_targets(&[here("a.exr"), here("b.png")]).expect("both can be written");
    assert!(names(folder.path()).is_empty(), "the check left something");

    fs::write(here("file"), "").expect("the folder can be written");
    fs::create_dir(here("folder.exr")).expect("the folder can be written");
    fs::write(here("protected.exr"), "mine").expect("the folder can be written");
    let mut protected = fs::metadata(here("protected.exr"))
        .expect("it is there")
        .permissions();
    protected.set_readonly(true);
    fs::set_permissions(here("protected.exr"), protected).expect("it is ours");
    let before = names(folder.path());
    let mut bad = vec![
        here("missing/a.exr"),
        here("file/a.exr"),
        here("folder.exr"),
        here("protected.exr"),
    ];
    if cfg!(target_os = "linux") {
        // A folder that even root cannot write.
        bad.push("/proc/a.exr".into());
    }
    for path in bad {
        let error = check_targets(std::slice::from_ref(&path)).expect_err("it cannot be written");
        assert!(!error.is_input(), "the work fails, with status 1: {error}");
        assert!(
            error.to_string().contains(path.to_str().expect("UTF-8")),
            "{error}"
        );
        let error = exr::write(&path, &frame(2, 2), &rec709(), &[]).expect_err("nor is it");
        assert!(!error.is_input(), "{error}");
    }
    assert_eq!(names(folder.path()), before);
    assert_eq!(
        fs::read_to_string(here("protected.exr")).ok().as_deref(),
        Some("mine")
    );

    let twice = check_targets(&[here("a.exr"), here("a.exr")]).expect_err("it is named twice");
    assert!(twice.is_input());
}

#[cfg(unix)]
#[test]
fn links_stay_and_devices_are_left_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, link) = (folder.path().join("a"), folder.path().join("b"));
    fs::write(&file, "before").expect("the folder can be written");
    std::os::unix::fs::symlink(&file, &link).expect("the folder can be written");
    atomic::write(&link, |f| std::io::Write::write_all(f, b"after")).expect("there is room");
    assert!(
        fs::symlink_metadata(&link)
            .expect("it is there")
            .is_symlink()
    );
    assert_eq!(fs::read_to_string(&file).expect("the file"), "after");
    assert!(atomic::check(Path::new("/dev/null")).is_err());
    assert!(!fs::metadata("/dev/null").expect("it is there").is_file());
}

#[test]
fn numbers_are_in_the_units_that_are_asked_for() {
    let plain = rec709();
    let with = |numbers: Numbers| OutputSpace { numbers, ..plain };
    let colour = DVec3::new(900.0, 1000.0, 700.0);
    // Each format's own unit, and the other's; Radiance takes 179 lm/W.
    let own = plain.colour(Units::Photometric, colour);
    assert_eq!(own, plain.from_working * colour);
    let radiance = with(Numbers {
        units: Some(Units::Radiance),
        multiply: 2.0,
        ..Numbers::default()
    });
    for (found, factor) in [
        (plain.colour(Units::Radiance, colour), 1.0 / 179.0),
        (radiance.colour(Units::Photometric, colour), 2.0 / 179.0),
        (radiance.colour(Units::Radiance, colour), 2.0 / 179.0),
    ] {
        assert!((found / own - factor).abs().max_element() < 1e-15);
    }
    assert_eq!(radiance.per_candela(Units::Photometric), 2.0 / 179.0);
    // A red sun of Rec. 2020 has no Rec. 709; moved toward grey it keeps its luminance and the order of its channels.
    let inside = with(Numbers {
        inside_gamut: true,
        ..Numbers::default()
    });
    let red = DVec3::new(1e9, 2e8, 1e7);
    assert!(plain.colour(Units::Photometric, red).min_element() < 0.0);
    let moved = inside.colour(Units::Photometric, red);
    let luminance_709 = DVec3::new(0.2126, 0.7152, 0.0722).dot(moved);
    assert!((luminance_709 / tyndall::colour::luminance(red) - 1.0).abs() < 1e-3);
    assert!(moved.min_element() == 0.0 && moved.x > moved.y && moved.y > moved.z);
    assert_eq!(inside.colour(Units::Photometric, colour), own);
    // What a half float cannot hold keeps its hue.
    let clamped = with(Numbers {
        clamp_half: true,
        ..Numbers::default()
    });
    let held = clamped.colour(Units::Photometric, 1e4 * colour);
    assert!((held.max_element() / HALF_MOST - 1.0).abs() < 1e-15);
    assert!((held / held.x - own / own.x).abs().max_element() < 1e-12);
    assert_eq!(clamped.colour(Units::Photometric, colour), own);
}
