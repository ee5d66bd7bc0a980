//! A Slurm of two nodes on this machine, so that the jobs which tyndall prints run under the real one.
//!
//! Debian's packages, daemons of our own without systemd, in a folder below `target` with ports, a socket and a key of its own: a cluster
//! that is there already is neither asked nor disturbed. The daemons end with the tests.

use super::{apt, quietly, say};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

/// The controller's port, and from the next on those of the nodes.
const PORT: u16 = 16_820;

const PACKAGES: [&str; 2] = ["slurm-wlm", "munge"];

/// How long the daemons may take to be ready.
const READY: Duration = Duration::from_secs(20);

/// A cluster that runs, until it is dropped.
pub struct Slurm {
    folder: PathBuf,
}

impl Slurm {
    /// Starts one, or says why not. `TYNDALL_SLURM` names its folder to the tests.
    pub fn start(target: &Path) -> Result<Self, String> {
        may_start()?;
        if !present() {
            apt::install(&PACKAGES)?;
        }
        let folder = std::path::absolute(target.join("slurm"))
            .map_err(|e| format!("no folder for Slurm: {e}"))?;
        let slurm = Slurm { folder };
        // What a test run that was killed has left.
        slurm.end();
        slurm.begin()?;
        Ok(slurm)
    }

    /// The folder: `slurm.conf`, `n1.pid` and `n2.pid` of the nodes, logs.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn begin(&self) -> Result<(), String> {
        let wrong = |e: std::io::Error| format!("cannot write {}: {e}", self.folder.display());
        let _ = fs::remove_dir_all(&self.folder);
        for folder in ["state", "n1", "n2"] {
            fs::create_dir_all(self.folder.join(folder)).map_err(wrong)?;
        }
        let host = Command::new("hostname").arg("-s").output();
        let host = host.map_err(|e| format!("hostname does not start: {e}"))?;
        let host = String::from_utf8_lossy(&host.stdout).trim().to_owned();
        fs::write(self.folder.join("slurm.conf"), self.settings(&host)).map_err(wrong)?;
        let key = self.folder.join("munge.key");
        fs::write(&key, seed()?).map_err(wrong)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(&key, fs::Permissions::from_mode(0o400)).map_err(wrong)?;
        }
        let path = |name: &str| self.folder.join(name).display().to_string();
        let munged = [
            format!("--socket={}", path("munge.socket")),
            format!("--key-file={}", path("munge.key")),
            format!("--pid-file={}", path("munged.pid")),
            format!("--log-file={}", path("munged.log")),
            format!("--seed-file={}", path("munge.seed")),
            // The folders above belong to root and others may write some.
            "--force".into(),
        ];
        quietly(Command::new("munged").args(munged))?;
        quietly(self.command("slurmctld").arg("-c"))?;
        for node in ["n1", "n2"] {
            quietly(self.command("slurmd").args(["-N", node]))?;
        }
        let begun = Instant::now();
        while begun.elapsed() < READY {
            let nodes = self
                .command("sinfo")
                .args(["-h", "-N", "-o", "%t"])
                .output();
            if nodes.is_ok_and(|n| n.stdout.trim_ascii() == b"idle\nidle") {
                return Ok(());
            }
            std::thread::sleep(Duration::from_millis(200));
        }
        Err(format!(
            "Slurm was not ready in {READY:?}: see {}",
            self.folder.display()
        ))
    }

    fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("SLURM_CONF", self.folder.join("slurm.conf"));
        command
    }

    fn settings(&self, host: &str) -> String {
        let folder = self.folder.display();
        let nodes = [1, 2].map(|n| {
            format!(
                "NodeName=n{n} NodeHostname={host} NodeAddr=127.0.0.1 Port={} CPUs=2 State=UNKNOWN\n",
                PORT + n
            )
        });
        format!(
            "ClusterName=tyndall\nSlurmctldHost={host}(127.0.0.1)\nSlurmctldPort={PORT}\nSlurmUser=root\nSlurmdUser=root\n\
             AuthType=auth/munge\nCredType=cred/munge\nSlurmctldPidFile={folder}/slurmctld.pid\nSlurmdPidFile={folder}/%n.pid\n\
             StateSaveLocation={folder}/state\nSlurmdSpoolDir={folder}/%n\nSlurmctldLogFile={folder}/slurmctld.log\n\
             SlurmdLogFile={folder}/%n.log\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\n\
             MpiDefault=none\nReturnToService=2\nJobAcctGatherType=jobacct_gather/none\n\
             AccountingStorageType=accounting_storage/none\nJobCompType=jobcomp/filetxt\nJobCompLoc={folder}/jobs.txt\n\
             SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n\
             # A task that is begun again waits until its credential is void, 120 s by default; a node is lost after 300 s.\n\
             AuthInfo=socket={folder}/munge.socket,cred_expire=5\nSlurmdTimeout=5\nKillWait=2\n\
             {}{}PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP\n",
            nodes[0], nodes[1]
        )
    }

    /// Ends what runs, by the numbers that the daemons wrote down, and only where those are still ours.
    fn end(&self) {
        for name in ["n1", "n2", "slurmctld", "munged"] {
            let Ok(number) = fs::read_to_string(self.folder.join(format!("{name}.pid"))) else {
                continue;
            };
            let number = number.trim();
            // Of a process that has ended, and that nobody asked about, the line is empty.
            let runs = || {
                let line = fs::read(format!("/proc/{number}/cmdline")).unwrap_or_default();
                let line = String::from_utf8_lossy(&line);
                line.contains("slurm") || line.contains("munged")
            };
            let begun = Instant::now();
            for signal in ["-TERM", "-KILL"] {
                if runs() {
                    let _ = quietly(Command::new("kill").args([signal, number]));
                }
                while runs() && begun.elapsed() < Duration::from_secs(5) {
                    std::thread::sleep(Duration::from_millis(50));
                }
            }
        }
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        self.end();
    }
}

/// Why none can be started here.
fn may_start() -> Result<(), String> {
    if cfg!(not(target_os = "linux")) {
        return Err("Slurm is tried on Linux only".into());
    }
    let id = Command::new("id").arg("-u").output();
    match id.is_ok_and(|id| id.stdout.trim_ascii() == b"0") {
        true => Ok(()),
        false => Err("a Slurm is started by root only".into()),
    }
}

/// What [`prepare`] will install.
pub fn missing() -> Option<String> {
    let wanted = may_start().is_ok() && !present();
    wanted.then(|| apt::plan(&PACKAGES)).flatten()
}

/// Whether the programs are there.
fn present() -> bool {
    ["munged", "slurmctld", "slurmd", "sbatch"]
        .iter()
        .all(|program| {
            let mut command = Command::new(program);
            command.arg("-V");
            command.output().is_ok_and(|said| said.status.success())
        })
}

/// A key for munge.
fn seed() -> Result<Vec<u8>, String> {
    use std::io::Read;
    let mut key = vec![0; 128];
    let read = fs::File::open("/dev/urandom").and_then(|mut file| file.read_exact(&mut key));
    read.map_err(|e| format!("no key for munge: {e}"))?;
    Ok(key)
}

/// Starts one, and says so where there is none.
pub fn prepare(target: &Path) -> Option<Slurm> {
    match Slurm::start(target) {
        Ok(slurm) => Some(slurm),
        Err(problem) => {
            say(&problem);
            say("the test of jobs under a real Slurm does not run");
            None
        }
    }
}
