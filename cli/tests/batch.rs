//! Batches as streams: rows come out as they go in, in bounded memory, whatever is behind the name.

mod common;

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const ROW: &str = "2026-06-21T12:00:00Z,48.85,2.29,35\n";
const HEAD: &str = "time,latitude,longitude,elevation\n";

fn start(arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("tyndall starts")
}

fn with_input(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = start(arguments);
    let mut stdin = child.stdin.take().expect("it is piped");
    let input = input.to_vec();
    // It may end before it has read everything.
    let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().expect("tyndall ends");
    writer.join().expect("all is written");
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_row_comes_out_while_no_more_come_in() {
    for (arguments, head, row) in [
        (["sun", "--batch", "-"], HEAD, ROW),
        (
            ["sky", "--batch", "-"],
            "model,sun_elevation,view_azimuth,view_elevation\n",
            "hosek,30,10,20\n",
        ),
    ] {
        let mut child = start(&arguments);
        let mut stdin = child.stdin.take().expect("it is piped");
        let mut stdout = BufReader::new(child.stdout.take().expect("it is piped"));
        let mut line = String::new();
        stdin.write_all(head.as_bytes()).expect("it reads");
        stdout.read_line(&mut line).expect("it writes");
        assert!(line.starts_with(head.trim_end()), "{line}");
        for _ in 0..3 {
            stdin.write_all(row.as_bytes()).expect("it reads");
            let since = Instant::now();
            line.clear();
            stdout.read_line(&mut line).expect("it writes");
            assert!(line.starts_with(row.trim_end()), "{line}");
            assert!(
                since.elapsed() < Duration::from_secs(5),
                "it waits for more"
            );
        }
        drop(stdin);
        assert!(child.wait().expect("it ends").success());
    }
}

#[test]
fn a_closed_pipe_ends_it_quietly_though_more_could_come() {
    let mut child = start(&["sun", "--batch", "-"]);
    let mut stdin = child.stdin.take().expect("it is piped");
    stdin.write_all(HEAD.as_bytes()).expect("it reads");
    stdin.write_all(ROW.as_bytes()).expect("it reads");
    let mut stdout = BufReader::new(child.stdout.take().expect("it is piped"));
    let mut line = String::new();
    stdout.read_line(&mut line).expect("it writes");
    stdout.read_line(&mut line).expect("it writes");
    drop(stdout);
    // The next row finds nobody; the input stays open. Another test's child may hold the pipe too for as long as it takes to
    // start, so that one row more is needed.
    for _ in 0..1000 {
        let _ = stdin.write_all(ROW.as_bytes());
        if child.try_wait().expect("it can be asked").is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let status = child.wait().expect("it ends");
    assert!(status.success());
    let mut errors = String::new();
    let mut stderr = child.stderr.take().expect("it is piped");
    stderr.read_to_string(&mut errors).expect("text");
    assert!(errors.is_empty(), "{errors}");
}

#[cfg(target_os = "linux")]
#[test]
fn memory_does_not_grow_with_the_input() {
    let most = |rows: usize, strict: bool| {
        let arguments: &[&str] = match strict {
            true => &["sky", "--batch", "-", "--strict"],
            false => &["sky", "--batch", "-"],
        };
        let head = "model,sun_elevation,view_azimuth,view_elevation\n";
        let block = "preetham,30,10,20.5\n".repeat(1000);
        let (peak, bytes) = common::peak_memory(start(arguments), head, &block, rows / 1000);
        assert!(bytes > 50 * rows as u64);
        peak
    };
    // 0.6 million rows are 60 MB of output; what waits with --strict waits in a file beyond 16 MiB.
    assert!(most(600_000, false) < 60 << 10);
    assert!(most(600_000, true) < 80 << 10);
}

#[test]
fn what_has_no_lines_is_refused_with_the_line() {
    let endless = with_input(&["sun", "--batch", "-"], &vec![b'x'; 3 << 20]);
    assert_eq!(endless.status.code(), Some(2));
    assert!(text(&endless.stderr).contains("standard input:1: the line is longer"));
    let later = [HEAD.as_bytes(), ROW.as_bytes(), &vec![b'1'; 3 << 20]].concat();
    let later = with_input(&["sun", "--batch", "-"], &later);
    assert!(text(&later.stderr).contains("standard input:3: the line is longer"));
    assert_eq!(text(&later.stdout).lines().count(), 2);
    if cfg!(unix) {
        let zeros = with_input(&["sun", "--batch", "/dev/zero"], b"");
        assert_eq!(zeros.status.code(), Some(2));
        assert!(text(&zeros.stderr).contains("/dev/zero:1: the line is longer"));
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_with_a_name_is_a_stream_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rows");
    let made = Command::new("mkfifo").arg(&path).status();
    if !made.is_ok_and(|status| status.success()) {
        return;
    }
    let child = start(&["sun", "--batch", path.to_str().expect("a name")]);
    let mut pipe = std::fs::OpenOptions::new()
        .write(true)
        .open(&path)
        .expect("it reads");
    pipe.write_all((HEAD.to_owned() + ROW).as_bytes())
        .expect("it reads");
    drop(pipe);
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success());
    assert_eq!(text(&output.stdout).lines().count(), 2);
}

#[test]
fn texts_of_other_encodings_are_named() {
    let wide = |bytes: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
        let words = mark
            .then_some(0xfeff)
            .into_iter()
            .chain(HEAD.encode_utf16());
        words.flat_map(bytes).collect()
    };
    for input in [
        wide(u16::to_le_bytes, true),
        wide(u16::to_be_bytes, true),
        wide(u16::to_le_bytes, false),
        wide(u16::to_be_bytes, false),
    ] {
        let output = with_input(&["sun", "--batch", "-"], &input);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            text(&output.stderr).contains("UTF-16"),
            "{}",
            text(&output.stderr)
        );
    }
    // A mark of byte order before UTF-8 is none of the column's name.
    let marked = [b"\xef\xbb\xbf", HEAD.as_bytes(), ROW.as_bytes()].concat();
    let output = with_input(&["sun", "--batch", "-"], &marked);
    assert!(output.status.success(), "{}", text(&output.stderr));
    // One row in Latin-1 costs that row.
    let latin = [
        b"time,latitude,longitude,name\n2026-06-21T12:00:00Z,48.85,2.29,Z\xfcrich\n".as_slice(),
        b"2026-06-21T12:00:00Z,48.85,2.29,Z\xc3\xbcrich\n",
    ]
    .concat();
    let output = with_input(&["sun", "--batch", "-"], &latin);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("standard input:2: the line is not UTF-8"));
    assert_eq!(text(&output.stdout).lines().count(), 2);
}

#[test]
fn columns_and_cells_that_are_not_needed_may_be_absent() {
    let without = "time,latitude,longitude\n2026-06-21T12:00:00Z,48.85,2.29\n";
    let with = "time,latitude,longitude,elevation,pressure,temperature,delta_t\n2026-06-21T12:00:00Z,48.85,2.29,,,,\n";
    let at_sea = "time,latitude,longitude,elevation\n2026-06-21T12:00:00Z,48.85,2.29,0\n";
    let results = |input: &str| {
        let output = with_input(&["sun", "--batch", "-"], input.as_bytes());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let csv = text(&output.stdout);
        let cells: Vec<String> = csv
            .lines()
            .last()
            .expect("a row")
            .split(',')
            .map(str::to_owned)
            .collect();
        cells[cells.len() - 11..].to_vec()
    };
    assert_eq!(results(without), results(at_sea));
    assert_eq!(results(with), results(at_sea));
}

#[test]
fn rows_without_a_zone_are_counted() {
    let rows = [
        "2026-06-21T12:00:00,48.85,2.29,0\n",
        "2026-06-21T12:00:00[u-ca=gregory],48.85,2.29,0\n",
        "2026-06-21T12:00:00+02:00,48.85,2.29,0\n",
        "2026-06-21T12:00:00[Europe/Paris],48.85,2.29,0\n",
        "JD2451545.0,48.85,2.29,0\n",
        ROW,
    ];
    let said = |rows: &[&str], more: &[&str]| {
        let arguments = [&["sun", "--batch", "-"], more].concat();
        let output = with_input(&arguments, (HEAD.to_owned() + &rows.concat()).as_bytes());
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    let local = said(&rows, &[]);
    assert!(local.contains("2 rows have times without"), "{local}");
    assert!(said(&rows[..1], &[]).contains("1 row has a time without"));
    assert_eq!(said(&rows[2..], &[]), "");
    assert_eq!(said(&rows[..3], &["--tz", "+02:00"]), "");
}

#[test]
fn a_batch_has_the_columns_and_the_numbers_of_a_single_position() {
    let single = with_input(
        &[
            "sun",
            "--at",
            "48.85,2.29,35",
            "--time",
            "2026-06-21T12:00:00Z",
            "--csv",
        ],
        b"",
    );
    let batch = with_input(&["sun", "--batch", "-"], (HEAD.to_owned() + ROW).as_bytes());
    let (single, batch) = (text(&single.stdout), text(&batch.stdout));
    for (one, other) in single.lines().zip(batch.lines()) {
        let results = |line: &str, skip: usize| {
            line.split(',')
                .skip(skip)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(results(one, 1), results(other, 4));
    }
    assert_eq!(single.lines().count(), batch.lines().count());
}

#[test]
fn many_rows_keep_their_order_and_quotes_their_cells() {
    let mut input = "note,time,latitude,longitude\n".to_owned();
    for i in 0..30_000 {
        let note = if i % 1000 == 0 {
            format!("\"{i}, \"\"quoted\"\"\"")
        } else {
            i.to_string()
        };
        input += &format!("{note}, 2026-06-21T12:00:00Z ,48.85,2.29\r\n");
    }
    let output = with_input(&["sun", "--batch", "-"], input.as_bytes());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let csv = text(&output.stdout);
    for (i, line) in csv.lines().skip(1).enumerate() {
        let note = if i % 1000 == 0 {
            format!("\"{i}, \"\"quoted\"\"\"")
        } else {
            i.to_string()
        };
        assert!(
            line.starts_with(&format!("{note},2026-06-21T12:00:00Z,48.85,2.29,18")),
            "{line}"
        );
    }
    assert_eq!(csv.lines().count(), 30_001);
}
