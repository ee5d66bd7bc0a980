//! Jobs that make a time-lapse on a cluster: a batch file for Slurm, manifests for Kubernetes.
//!
//! The engine spreads the work; tyndall knows only `--shard I/N` and exit statuses. N stands in the job, since part of an array that is
//! submitted again counts otherwise than the whole. A task that exits with [`AGAIN`] (its time was up, or its node was wanted) is begun again
//! at most [`RETRIES`] times and goes on where it was; after the last one a job of its own makes film, sheet and page.

use crate::error::{Error, Result};
use std::fmt::Write;

/// The exit status of a process that was interrupted, or that lacks frames: the same command goes on.
pub const AGAIN: u8 = 75;

/// How often a task that asks for it is begun again.
pub const RETRIES: u32 = 2;

/// How long before its end a task is told [s]: enough to finish a tile and to write the frames that are whole.
const NOTICE: u32 = 60;

/// What is to be done.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Job {
    /// A name of letters, digits and hyphens.
    name: String,
    /// The folder in which the commands run, seen alike by all nodes.
    folder: String,
    /// The command that makes the frames, program first, without `--shard`.
    render: Vec<String>,
    /// The command that puts them together.
    assemble: Vec<String>,
    /// Into how many parts the frames go.
    shards: u64,
}

impl Job {
    /// A job in a folder: `render` makes the frames, given a `--shard`, and `assemble` puts them together; both begin with the program.
    ///
    /// # Errors
    /// [`Error::Domain`] unless there are 1 to 10 000 shards; [`Error::Input`] for a word that holds a line break or another control
    /// character, which no batch file carries safely.
    pub fn new(
        name: &str,
        folder: &str,
        render: &[String],
        assemble: &[String],
        shards: u64,
    ) -> Result<Self> {
        if !(1..=10_000).contains(&shards) {
            return Err(Error::domain(
                "--shards",
                shards,
                "1 to 10000",
                "choose as many as there are nodes, or a few times as many",
            ));
        }
        let words = render.iter().chain(assemble).map(String::as_str);
        for word in words.chain([folder]) {
            if word.chars().any(char::is_control) {
                return Err(Error::input(
                    format!("{word:?}"),
                    "it holds a line break or another control character",
                    "rename the file or folder",
                ));
            }
        }
        Ok(Job {
            name: label(name),
            folder: folder.into(),
            render: render.to_vec(),
            assemble: assemble.to_vec(),
            shards,
        })
    }

    /// A batch file for Slurm. Run by `bash` where jobs are submitted it submits both jobs; given to `sbatch` it is the array of shards.
    pub fn slurm(&self) -> String {
        let Job { name, shards, .. } = self;
        let folder = shell(&self.folder);
        let render = shell_line(&self.render);
        let assemble = shell_line(&self.assemble);
        format!(
            "#!/usr/bin/env bash\n\
             #SBATCH --job-name={name}\n\
             #SBATCH --array=1-{shards}\n\
             #SBATCH --ntasks=1\n\
             #SBATCH --requeue\n\
             #SBATCH --open-mode=append\n\
             #SBATCH --signal=B:TERM@{NOTICE}\n\
             \n\
             # A time-lapse in {shards} shards, and what puts them together. Submit both with\n\
             #     bash THIS_FILE\n\
             # Lines for your site (partition, account, time, memory, processors) belong among those above.\n\
             # What is finished is not made again: submit as often as you like, all of it or a part (sbatch --array=5,7 THIS_FILE).\n\
             set -euo pipefail\n\
             \n\
             if [[ -z \"${{SLURM_ARRAY_TASK_ID:-}}\" ]]; then\n    \
                 frames=\"$(sbatch --parsable \"$0\")\"\n    \
                 frames=\"${{frames%%;*}}\"\n    \
                 together=\"$(sbatch --parsable --dependency=\"afterok:$frames\" --array=0 \"$0\" assemble)\"\n    \
                 echo \"frames: job $frames; film, sheet and page: job ${{together%%;*}}, after the last of them\"\n    \
                 exit\n\
             fi\n\
             \n\
             cd {folder}\n\
             if [[ -n \"${{SLURM_CPUS_PER_TASK:-}}\" ]]; then\n    \
                 export RAYON_NUM_THREADS=\"$SLURM_CPUS_PER_TASK\"\n\
             fi\n\
             \n\
             if [[ \"${{1:-}}\" == assemble ]]; then\n    \
                 exec {assemble}\n\
             fi\n\
             \n\
             # Shards count from 1, wherever the array begins. Of a part that is submitted again the indices are those of the whole.\n\
             shards={shards}\n\
             first=1\n\
             if [[ \"${{SLURM_ARRAY_TASK_COUNT:-$shards}}\" == \"$shards\" ]]; then\n    \
                 first=\"${{SLURM_ARRAY_TASK_MIN:-1}}\"\n\
             fi\n\
             shard=$((SLURM_ARRAY_TASK_ID - first + 1))\n\
             \n\
             # Slurm tells this shell, which tells the program: it saves what is whole and exits with {AGAIN}.\n\
             {render} --shard \"$shard/$shards\" &\n\
             task=$!\n\
             told=\n\
             trap 'told=1; kill -TERM \"$task\" 2>/dev/null || true' TERM\n\
             wait \"$task\" && status=0 || status=$?\n\
             # A signal ends the waiting, not the task.\n\
             while [[ -n \"$told\" ]]; do\n    \
                 told=\n    \
                 wait \"$task\" && real=0 || real=$?\n    \
                 [[ \"$real\" == 127 ]] || status=\"$real\"\n\
             done\n\
             \n\
             if [[ \"$status\" == {AGAIN} && \"${{SLURM_RESTART_COUNT:-0}}\" -lt {RETRIES} ]]; then\n    \
                 scontrol requeue \"$SLURM_JOB_ID\"\n    \
                 # Slurm ends this shell when it takes the task back.\n    \
                 sleep {NOTICE}\n\
             fi\n\
             exit \"$status\"\n"
        )
    }

    /// Two manifests for Kubernetes: an indexed job of shards, and a job that puts them together and waits for the last of them by itself.
    ///
    /// `image` holds the program; `claim` is a volume claim that all nodes can write, mounted as the folder.
    pub fn kubernetes(&self, image: &str, claim: &str) -> String {
        let Job { name, shards, .. } = self;
        let part = format!("exec \"$0\" \"$@\" --shard \"$((JOB_COMPLETION_INDEX + 1))/{shards}\"");
        let shell = ["/bin/sh".to_owned(), "-c".to_owned(), part];
        let command: Vec<String> = shell.into_iter().chain(self.render.clone()).collect();
        let mut text = format!(
            "# A time-lapse in {shards} shards, and what puts them together: kubectl apply -f THIS_FILE\n\
             # Set the image, the claim and what a task may use. What is finished is not made again: delete the jobs and apply again.\n"
        );
        let again = |action: &str| {
            format!(
                "  podFailurePolicy:\n    rules:\n      \
                 # {AGAIN}: interrupted, or frames are missing.\n      \
                 - action: {action}\n        onExitCodes:\n          operator: In\n          values: [{AGAIN}]\n      \
                 - action: Ignore\n        onPodConditions:\n          - type: DisruptionTarget\n"
            )
        };
        let frames = format!(
            "  completionMode: Indexed\n  completions: {shards}\n  parallelism: {shards}\n  backoffLimitPerIndex: {RETRIES}\n  \
             maxFailedIndexes: {shards}\n{}",
            again("Count")
        );
        self.manifest(&mut text, name, &frames, &command, image, claim);
        let together = format!(
            "  # It is begun again, at longer and longer intervals, until all frames are there.\n  backoffLimit: {RETRIES}\n{}",
            again("Ignore")
        );
        let other = format!("{name}-assemble");
        self.manifest(&mut text, &other, &together, &self.assemble, image, claim);
        text
    }

    /// One manifest. Strings stand as JSON has them, which is YAML too.
    fn manifest(
        &self,
        text: &mut String,
        name: &str,
        policy: &str,
        command: &[String],
        image: &str,
        claim: &str,
    ) {
        let string = |word: &str| serde_json::Value::from(word).to_string();
        let folder = string(&self.folder);
        // Nothing that is written into a string fails.
        let _ = write!(
            text,
            "---\napiVersion: batch/v1\nkind: Job\nmetadata:\n  name: {name}\nspec:\n{policy}  template:\n    spec:\n      \
             restartPolicy: Never\n      terminationGracePeriodSeconds: {}\n      containers:\n        - name: tyndall\n          \
             image: {}\n          workingDir: {folder}\n          command:\n",
            2 * NOTICE,
            string(image),
        );
        for word in command {
            // $(NAME) is Kubernetes' own, and $$ a dollar sign in front of it.
            let word = word.replace("$(", "$$(");
            let _ = writeln!(text, "            - {}", string(&word));
        }
        let _ = write!(
            text,
            "          resources:\n            requests:\n              cpu: \"4\"\n              memory: 4Gi\n          \
             volumeMounts:\n            - name: frames\n              mountPath: {folder}\n      volumes:\n        - name: frames\n          \
             persistentVolumeClaim:\n            claimName: {}\n",
            string(claim),
        );
    }
}

/// A name of lower-case letters, digits and hyphens, of at most 40 characters, as both engines allow.
fn label(name: &str) -> String {
    let plain = |c: char| match c.to_ascii_lowercase() {
        c if c.is_ascii_alphanumeric() => c,
        _ => '-',
    };
    let name: String = format!("tyndall-{name}")
        .chars()
        .map(plain)
        .take(40)
        .collect();
    name.trim_end_matches('-').to_owned()
}

/// A word as a POSIX shell reads it back.
pub fn shell(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// Words as a POSIX shell reads them back.
pub fn shell_line<S: AsRef<str>>(words: &[S]) -> String {
    let words = words.iter().map(|word| shell(word.as_ref()));
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_words_back() {
        for (word, quoted) in [
            ("out/frame_####.exr", "'out/frame_####.exr'"),
            ("48.85,2.29", "48.85,2.29"),
            ("", "''"),
            ("it's", "'it'\\''s'"),
            ("a b", "'a b'"),
            ("~", "'~'"),
            ("$(x)`y`\\", "'$(x)`y`\\'"),
            ("sunset+40m", "sunset+40m"),
            ("{frame:04}", "'{frame:04}'"),
        ] {
            assert_eq!(shell(word), quoted);
        }
        assert_eq!(shell_line(&["a b", "c"]), "'a b' c");
    }

    #[test]
    fn names_that_engines_take() {
        assert_eq!(label("Nave"), "tyndall-nave");
        assert_eq!(label("a room, by day"), "tyndall-a-room--by-day");
        assert_eq!(label("--"), "tyndall");
        assert!(label(&"x".repeat(99)).len() <= 40);
    }

    #[test]
    fn what_no_job_can_hold_is_refused() {
        let job = |word: &str, shards| {
            let words = ["tyndall".to_owned(), word.to_owned()];
            Job::new("x", ".", &words, &words, shards)
        };
        assert!(job("a.png", 1).is_ok());
        assert!(job("a\n#SBATCH --x", 1).is_err_and(|e| e.is_input()));
        assert!(job("a.png", 0).is_err_and(|e| e.is_input()));
        assert!(job("a.png", 10_001).is_err_and(|e| e.is_input()));
    }
}
