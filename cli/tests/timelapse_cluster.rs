//! Time-lapse over many machines: the jobs that are emitted, run as an engine runs them, and over a real Slurm.

mod common;

use common::timelapse::{SEQUENCE, python};
use common::{not_run, stderr, tyndall};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tyndall::timelapse::cluster::Job;

/// A job whose words are hard to quote.
fn job(folder: &Path, program: &Path) -> Job {
    let words = |last: &str| {
        let words = [
            &*program.to_string_lossy(),
            "timelapse",
            "it's $(a) \"scene\".toml",
            last,
        ];
        words.map(str::to_owned)
    };
    let folder = folder.to_string_lossy();
    Job::new("Nave", &folder, &words("`#### \\"), &words("--assemble"), 8).expect("it is one")
}

/// A program of a shell's lines.
#[cfg(unix)]
fn script(path: &Path, lines: &str) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::write(path, format!("#!/bin/bash\n{lines}\n")).expect("a file");
    let mode = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(path, mode).expect("it is ours");
}

/// Slurm's part in the test: a folder with programs that note their words, and the batch file in it.
#[cfg(unix)]
struct Slurm {
    folder: tempfile::TempDir,
    batch: PathBuf,
}

#[cfg(unix)]
impl Slurm {
    fn new(program: &str) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let here = folder.path().join("it's a \"folder\"");
        std::fs::create_dir(&here).expect("a folder");
        let noting = "printf '%s\\n' \"${0##*/}\" \"$@\" >> \"$NOTES\"";
        script(
            &here.join("tyndall"),
            &format!("{noting}; pwd >> \"$NOTES\"\n{program}"),
        );
        script(&here.join("scontrol"), noting);
        script(
            &here.join("sbatch"),
            &format!("{noting}; echo '17;a cluster'"),
        );
        script(&here.join("sleep"), "exit 0");
        let batch = here.join("job of the day.sh");
        let text = job(&here, &here.join("tyndall")).slurm();
        std::fs::write(&batch, text).expect("a file");
        Slurm { folder, batch }
    }

    /// The batch file in a shell with these variables.
    fn command(&self, variables: &[(&str, &str)], arguments: &[&str]) -> Command {
        let here = self.batch.parent().expect("it is in a folder");
        let mut path = OsString::from(here);
        path.push(":/usr/bin:/bin");
        let mut command = Command::new("bash");
        command
            .arg(&self.batch)
            .args(arguments)
            .env_clear()
            .env("PATH", path)
            .env("NOTES", self.folder.path().join("notes"))
            .envs(variables.iter().copied())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// Its exit status and what the programs noted.
    fn run(&self, variables: &[(&str, &str)], arguments: &[&str]) -> (i32, Vec<String>) {
        let output = self.command(variables, arguments).output().expect("bash");
        let status = output.status.code().expect("it was not killed");
        assert_eq!(stderr(&output), "");
        (status, self.notes())
    }

    fn notes(&self) -> Vec<String> {
        let path = self.folder.path().join("notes");
        let notes = std::fs::read_to_string(&path).unwrap_or_default();
        let _ = std::fs::remove_file(path);
        notes.lines().map(str::to_owned).collect()
    }
}

#[cfg(unix)]
#[test]
fn slurm_runs_each_shard_and_begins_those_again_that_ask_for_it() {
    let slurm = Slurm::new("exit \"${STATUS:-0}\"");
    let checked = Command::new("bash").arg("-n").arg(&slurm.batch).output();
    let checked = checked.expect("bash starts");
    assert!(checked.status.success(), "{}", stderr(&checked));
    let here = slurm
        .batch
        .parent()
        .expect("a folder")
        .to_string_lossy()
        .into_owned();

    let task = |id, least, more: &[(&'static str, &'static str)]| {
        let all = [
            &[
                ("SLURM_JOB_ID", "17"),
                ("SLURM_ARRAY_TASK_ID", id),
                ("SLURM_ARRAY_TASK_MIN", least),
            ],
            more,
        ];
        slurm.run(&all.concat(), &[])
    };
    let shard = |shard: &str| {
        let words = [
            "tyndall",
            "timelapse",
            "it's $(a) \"scene\".toml",
            "`#### \\",
            "--shard",
            shard,
            &here,
        ];
        words.map(str::to_owned).to_vec()
    };
    // An array that begins anywhere.
    assert_eq!(task("1", "1", &[]), (0, shard("1/8")));
    assert_eq!(task("7", "0", &[]), (0, shard("8/8")));
    assert_eq!(
        task("3", "1", &[("SLURM_ARRAY_TASK_COUNT", "8")]),
        (0, shard("3/8"))
    );
    // A part of it that is submitted again.
    assert_eq!(
        task("5", "5", &[("SLURM_ARRAY_TASK_COUNT", "2")]),
        (0, shard("5/8"))
    );

    // Interrupted: begun again twice, then no more; what failed otherwise is not.
    for (status, restarts, again) in [
        ("75", "0", true),
        ("75", "1", true),
        ("75", "2", false),
        ("2", "0", false),
    ] {
        let more = [("STATUS", status), ("SLURM_RESTART_COUNT", restarts)];
        let (left, notes) = task("1", "1", &more);
        assert_eq!(left.to_string(), status);
        let asked = notes[7..].join(" ") == "scontrol requeue 17";
        assert_eq!(asked, again, "{notes:?}");
    }

    // What puts them together.
    let (status, notes) = slurm.run(
        &[("SLURM_JOB_ID", "18"), ("SLURM_ARRAY_TASK_ID", "0")],
        &["assemble"],
    );
    assert_eq!(status, 0);
    assert_eq!(notes[3..], ["--assemble", &here]);

    // Where jobs are submitted: the array, then what waits for all of it.
    let (status, notes) = slurm.run(&[], &[]);
    assert_eq!(status, 0);
    let batch = slurm.batch.to_string_lossy();
    let expected = [
        "sbatch",
        "--parsable",
        &batch,
        "sbatch",
        "--parsable",
        "--dependency=afterok:17",
        "--array=0",
        &batch,
        "assemble",
    ];
    assert_eq!(notes, expected);
}

#[cfg(unix)]
#[test]
fn a_shard_that_slurm_ends_saves_what_it_has() {
    // Takes a second to save after it was told.
    let slurm = Slurm::new(
        "trap 'echo saved >> \"$NOTES\"; exit 75' TERM; touch \"$NOTES.begun\"; for ((;;)); do read -t 0.05 < /dev/zero; done",
    );
    let variables = [
        ("SLURM_JOB_ID", "17"),
        ("SLURM_ARRAY_TASK_ID", "1"),
        ("SLURM_RESTART_COUNT", "2"),
    ];
    let child = slurm.command(&variables, &[]).spawn().expect("bash starts");
    let begun = slurm.folder.path().join("notes.begun");
    for _ in 0..200 {
        if begun.exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    assert!(begun.exists());
    let killed = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(killed.expect("kill starts").success());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(75), "{}", stderr(&output));
    assert_eq!(slurm.notes().last().map(String::as_str), Some("saved"));
}

#[test]
fn kubernetes_gets_two_jobs() {
    let test = "kubernetes_gets_two_jobs";
    let folder = Path::new("/a \"folder\": #1");
    let text = job(folder, Path::new("tyndall")).kubernetes("tyndall:latest", "frames");
    let script = "import json, sys, yaml\nprint(json.dumps(list(yaml.safe_load_all(sys.stdin))))";
    let Some(json) = python(script, &text) else {
        return not_run(test, "there is no Python with PyYAML");
    };
    let jobs: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    let [frames, together] = [&jobs[0], &jobs[1]];
    assert_eq!(jobs.as_array().map(Vec::len), Some(2));
    for job in [frames, together] {
        assert_eq!(
            (&job["apiVersion"], &job["kind"]),
            (&"batch/v1".into(), &"Job".into())
        );
        let pod = &job["spec"]["template"]["spec"];
        assert_eq!(pod["restartPolicy"], "Never");
        let container = &pod["containers"][0];
        assert_eq!(
            container["workingDir"],
            folder.to_str().expect("it is UTF-8")
        );
        assert_eq!(
            container["volumeMounts"][0]["name"],
            pod["volumes"][0]["name"]
        );
    }
    let spec = &frames["spec"];
    assert_eq!(spec["completionMode"], "Indexed");
    assert_eq!(
        (&spec["completions"], &spec["backoffLimitPerIndex"]),
        (&8.into(), &2.into())
    );
    assert_eq!(frames["metadata"]["name"], "tyndall-nave");
    assert_eq!(together["metadata"]["name"], "tyndall-nave-assemble");
    let again = &together["spec"]["podFailurePolicy"]["rules"][0];
    assert_eq!(
        (&again["action"], &again["onExitCodes"]["values"][0]),
        (&"Ignore".into(), &75.into())
    );

    // What a node runs, as Kubernetes unescapes it, with a program that prints its words.
    let words = |job: &serde_json::Value| -> Vec<String> {
        let words = job["spec"]["template"]["spec"]["containers"][0]["command"].as_array();
        let words = words.expect("a list").iter();
        words
            .map(|w| w.as_str().expect("a word").replace("$$(", "$("))
            .collect()
    };
    let mut command = words(frames);
    assert_eq!(command[3], "tyndall");
    command[3] = "printf".into();
    command.insert(4, "%s\n".into());
    let printed = Command::new(&command[0])
        .args(&command[1..])
        .env("JOB_COMPLETION_INDEX", "2")
        .output();
    let printed = String::from_utf8(printed.expect("sh starts").stdout).expect("it is UTF-8");
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(
        lines,
        [
            "timelapse",
            "it's $(a) \"scene\".toml",
            "`#### \\",
            "--shard",
            "3/8"
        ]
    );
    assert_eq!(
        words(together).last().map(String::as_str),
        Some("--assemble")
    );
}

#[cfg(unix)]
#[test]
fn an_emitted_job_makes_the_frames_and_puts_them_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = tyndall(
        folder.path(),
        &[
            &SEQUENCE,
            &[
                "--quality",
                "draft",
                "--film",
                "day.mp4",
                "--emit",
                "slurm",
                "--shards",
                "2",
            ][..],
        ]
        .concat(),
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let batch = folder.path().join("job.sh");
    std::fs::write(&batch, output.stdout).expect("a file");
    let run = |variables: &[(&str, &str)], arguments: &[&str]| {
        let output = Command::new("bash")
            .arg(&batch)
            .args(arguments)
            .current_dir("/")
            .env("SLURM_JOB_ID", "17")
            .envs(variables.iter().copied())
            .output()
            .expect("bash starts");
        (output.status.code(), stderr(&output))
    };
    let shard = |id: &'static str| {
        [
            ("SLURM_ARRAY_TASK_ID", id),
            ("SLURM_ARRAY_TASK_MIN", "1"),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
        ]
    };
    let (status, said) = run(&shard("1"), &[]);
    assert_eq!(status, Some(0), "{said}");
    // Half of them are there, and the film waits.
    let (status, said) = run(&[("SLURM_ARRAY_TASK_ID", "0")], &["assemble"]);
    assert_eq!(status, Some(75), "{said}");
    assert!(!folder.path().join("day.mp4").exists());
    let (status, said) = run(&shard("2"), &[]);
    assert_eq!(status, Some(0), "{said}");
    let (status, said) = run(&[("SLURM_ARRAY_TASK_ID", "0")], &["assemble"]);
    assert_eq!(status, Some(0), "{said}");
    assert!(folder.path().join("day.mp4").exists());
    assert_eq!(
        folder
            .path()
            .join("out")
            .read_dir()
            .expect("a folder")
            .count(),
        6
    );
}

/// The processes of a node of this Slurm: its daemon, what watches over tasks, and the tasks, in this order.
#[cfg(target_os = "linux")]
fn of_node(slurm: &Path, node: &str) -> Vec<String> {
    let read = |path: PathBuf| std::fs::read(path).unwrap_or_default();
    let ours = format!("SLURM_CONF={}", slurm.join("slurm.conf").display());
    let name = format!("SLURMD_NODENAME={node}");
    let daemon = read(slurm.join(format!("{node}.pid")));
    let mut found = vec![String::from_utf8_lossy(&daemon).trim().to_owned()];
    let mut tasks = Vec::new();
    for entry in Path::new("/proc")
        .read_dir()
        .expect("it is there")
        .flatten()
    {
        let environment = read(entry.path().join("environ"));
        let has = |wanted: &str| {
            let mut variables = environment.split(|b| *b == 0);
            variables.any(|v| v == wanted.as_bytes())
        };
        if has(&ours) && has(&name) {
            let status = read(entry.path().join("status"));
            let status = String::from_utf8_lossy(&status).into_owned();
            let parent = status.lines().find_map(|line| line.strip_prefix("PPid:"));
            let parent = parent.unwrap_or_default().trim().to_owned();
            let command = read(Path::new("/proc").join(&parent).join("comm"));
            if command.starts_with(b"slurmstepd") && !found.contains(&parent) {
                found.push(parent);
            }
            tasks.push(entry.file_name().to_string_lossy().into_owned());
        }
    }
    found.extend(tasks);
    found
}

#[cfg(target_os = "linux")]
#[test]
fn a_real_slurm_makes_all_frames_although_a_node_is_lost() {
    use std::time::{Duration, Instant};

    let test = "a_real_slurm_makes_all_frames_although_a_node_is_lost";
    let Some(slurm) = std::env::var_os("TYNDALL_SLURM").map(PathBuf::from) else {
        return not_run(
            test,
            "TYNDALL_SLURM does not name the folder of a Slurm that runs",
        );
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut words = SEQUENCE.map(str::to_owned).to_vec();
    let frames = words.iter().position(|w| w == "5").expect("it is there");
    words[frames] = "64".into();
    words.extend(
        [
            "--quality",
            "draft",
            "--exposure",
            "10",
            "--film",
            "day.mp4",
            "--emit",
            "slurm",
            "--shards",
            "8",
        ]
        .map(str::to_owned),
    );
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let output = tyndall(folder.path(), &words);
    assert!(output.status.success(), "{}", stderr(&output));
    std::fs::write(folder.path().join("job.sh"), output.stdout).expect("a file");
    let command = |program: &str| {
        let mut command = Command::new(program);
        command
            .env("SLURM_CONF", slurm.join("slurm.conf"))
            .current_dir(folder.path());
        command
    };
    let submitted = command("bash").arg("job.sh").output().expect("bash starts");
    assert!(submitted.status.success(), "{}", stderr(&submitted));

    let out = folder.path().join("out");
    let there = || {
        let entries = out.read_dir().into_iter().flatten().flatten();
        entries
            .filter(|e| e.path().extension().is_some_and(|e| e == "png"))
            .count()
    };
    let begun = Instant::now();
    let wait = |what: &str, done: &dyn Fn() -> bool| {
        while !done() {
            if begun.elapsed() > Duration::from_secs(240) {
                let queue = command("squeue").output().expect("squeue starts");
                panic!(
                    "{what}: {} frames; {}",
                    there(),
                    String::from_utf8_lossy(&queue.stdout)
                );
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    // Both nodes are at work.
    wait("frames", &|| {
        there() >= 4 && of_node(&slurm, "n2").len() > 1
    });
    let killed = of_node(&slurm, "n2");
    for process in &killed {
        let _ = Command::new("kill").args(["-KILL", process]).status();
    }
    let before = there();
    wait("a film", &|| folder.path().join("day.mp4").exists());
    assert_eq!(there(), 64);
    let nodes = command("sinfo")
        .args(["-h", "-N", "-o", "%N %t"])
        .output()
        .expect("sinfo starts");
    let nodes = String::from_utf8_lossy(&nodes.stdout).into_owned();
    println!(
        "{before} frames when {} processes of n2 were killed, all after {:?}; {nodes}",
        killed.len(),
        begun.elapsed()
    );
    assert!(before < 64 && nodes.contains("n2 down"), "{nodes}");
}
