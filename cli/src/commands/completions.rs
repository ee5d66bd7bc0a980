//! `tyndall completions` and `tyndall man`: made from the definitions that the command line itself is read with.

use crate::tables::stdout;
use clap::{Arg, Args, Command};
use clap_complete::Shell;
use std::path::PathBuf;
use tyndall::Error;
use tyndall::output::atomic;

/// What the program's exit status means.
pub const EXIT_STATUS: [(&str, &str); 5] = [
    ("0", "All is done."),
    (
        "1",
        "It failed: a file, memory, a device, a defect; or a --check is above --fail-above.",
    ),
    (
        "2",
        "What was written is wrong: flags, a scene, rows of a table.",
    ),
    (
        "75",
        "Something is left to be done, by the same command: asked to end (SIGTERM), or frames are missing.",
    ),
    ("130", "Interrupted (Ctrl-C)."),
];

/// Print completions for a shell
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

/// Prints the completions of `command`.
pub fn run(args: &CompletionsArgs, mut command: Command) -> tyndall::Result<()> {
    let name = command.get_name().to_owned();
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, name, &mut script);
    match args.shell {
        Shell::Bash => stdout::print(with_colons(&String::from_utf8_lossy(&script))),
        _ => stdout::print(script),
    }
}

/// Bash takes words apart at colons, as in `cie:12`: they are put together for the function that clap makes, and only what stands
/// behind the last colon is given back.
const WHOLE_WORDS: &str = r#"
_tyndall_whole_words() {
    local line=$COMP_LINE words=() last=-1 current=0 i word rest
    for i in "${!COMP_WORDS[@]}"; do
        word=${COMP_WORDS[i]}
        rest=${line#"${line%%[![:space:]]*}"}
        if [[ $last -ge 0 && $rest == "$line" && ( $word == :* || ${words[last]} == *: ) ]]; then
            words[last]+=$word
        else
            last=$((last + 1))
            words[last]=$word
        fi
        line=${rest#"$word"}
        if [[ $i -eq $COMP_CWORD ]]; then
            current=$last
        fi
    done
    local COMP_WORDS=("${words[@]}") COMP_CWORD=$current
    word=${words[current]}
    _tyndall "$1" "$word" "${words[current - 1]}"
    if [[ $word == *:* && $COMP_WORDBREAKS == *:* ]]; then
        word=${word%"${word##*:}"}
        COMPREPLY=("${COMPREPLY[@]#"$word"}")
    fi
}

"#;

/// The script for Bash with [`WHOLE_WORDS`] in between.
fn with_colons(script: &str) -> String {
    let script = script.replace("complete -F _tyndall ", "complete -F _tyndall_whole_words ");
    match script.rfind("\nif [[ ") {
        Some(end) => format!("{}{WHOLE_WORDS}{}", &script[..end], &script[end + 1..]),
        None => format!("{WHOLE_WORDS}{script}"),
    }
}

/// Print the manual page, or write all pages to a folder
#[derive(Debug, Args)]
pub struct ManArgs {
    /// The command whose page to print; without one, that of the program
    command: Option<String>,
    /// Write the pages of the program and of every command to this folder instead
    #[arg(long, value_name = "FOLDER", conflicts_with = "command")]
    out: Option<PathBuf>,
}

/// Prints or writes the manual of `command`.
pub fn man(args: &ManArgs, command: Command) -> tyndall::Result<()> {
    let pages = pages(command);
    if let Some(folder) = &args.out {
        for (name, page) in &pages {
            let path = folder.join(format!("{name}.1"));
            atomic::write(&path, |file| {
                std::io::Write::write_all(file, page.as_bytes())
            })?;
        }
        return Ok(());
    }
    let (program, _) = &pages[0];
    let wanted = match &args.command {
        Some(command) => format!("{program}-{command}"),
        None => program.clone(),
    };
    match pages.iter().find(|(name, _)| *name == wanted) {
        Some((_, page)) => stdout::print(page),
        None => {
            let names: Vec<&str> = pages[1..]
                .iter()
                .map(|(name, _)| &name[program.len() + 1..])
                .collect();
            Err(Error::input(
                "man",
                format!("there is no command `{}`", &wanted[program.len() + 1..]),
                format!("there are {}", names.join(", ")),
            ))
        }
    }
}

/// The names and texts of all pages, that of the program first.
fn pages(command: Command) -> Vec<(String, String)> {
    // A page for "help" would say what every page says.
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let source = format!(
        "{} {}",
        command.get_name(),
        command.get_version().unwrap_or_default()
    );
    let commands = command.get_subcommands().filter(|sub| !sub.is_hide_set());
    std::iter::once(&command)
        .chain(commands)
        .map(|command| {
            // Its full name, as `man` finds it: tyndall-render.
            let name = command.get_display_name().unwrap_or(command.get_name());
            let synopsis = synopsis(command);
            let described = command.clone().override_usage(synopsis);
            let man = clap_mangen::Man::new(described).source(source.trim());
            let mut page = Vec::new();
            // Writing to memory does not fail.
            let _ = man.render(&mut page);
            page.extend(exit_status().into_bytes());
            (name.to_owned(), String::from_utf8_lossy(&page).into_owned())
        })
        .collect()
}

/// The name of a command with all that may follow it, values included.
fn synopsis(command: &Command) -> String {
    let mut words = vec![
        command
            .get_bin_name()
            .unwrap_or(command.get_name())
            .to_owned(),
    ];
    let shown = || command.get_arguments().filter(|a| !a.is_hide_set());
    let optional = |argument: &Arg, text: String| match argument.is_required_set() {
        true => text,
        false => format!("[{text}]"),
    };
    for flag in shown().filter(|a| !a.is_positional()) {
        let long = flag.get_long().map(|long| format!("--{long}"));
        let short = flag.get_short().map(|short| format!("-{short}"));
        let name = [short, long].into_iter().flatten().collect::<Vec<_>>();
        let mut text = name.join("|");
        if flag.get_action().takes_values() {
            for value in flag.get_value_names().unwrap_or_default() {
                text += &format!(" {value}");
            }
        }
        words.push(optional(flag, text));
    }
    for positional in shown().filter(|a| a.is_positional()) {
        let names = positional.get_value_names().unwrap_or_default();
        let names: Vec<&str> = names.iter().map(|name| name.as_str()).collect();
        words.push(optional(positional, names.join(" ")));
    }
    if command.has_subcommands() {
        words.push("COMMAND".into());
    }
    words.join(" ")
}

/// A section of a page, as roff.
fn exit_status() -> String {
    // A minus sign of a flag is no hyphen.
    let row =
        |(code, meaning): &(&str, &str)| format!(".TP\n{code}\n{}\n", meaning.replace('-', "\\-"));
    let rows: String = EXIT_STATUS.iter().map(row).collect();
    format!(".SH \"EXIT STATUS\"\n{rows}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command() -> Command {
        let shafts = clap::arg!(--shafts <N> "how many beams");
        Command::new("tyndall")
            .about("light in the air")
            .subcommand(Command::new("render").about("a picture").arg(shafts))
            .subcommand(Command::new("secret").hide(true))
    }

    #[test]
    fn a_page_for_each_command() {
        let pages = pages(command());
        let names: Vec<&str> = pages.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["tyndall", "tyndall-render"]);
        assert!(pages[0].1.contains("light in the air"), "{}", pages[0].1);
        assert!(pages[1].1.contains("how many beams"), "{}", pages[1].1);
        assert!(
            pages[1].1.contains(".TH tyndall-render 1"),
            "{}",
            pages[1].1
        );
        let line = pages[1]
            .1
            .lines()
            .find(|line| line.contains("tyndall render"));
        let line = line.expect("a synopsis").replace('\\', "");
        assert!(line.contains("[--shafts N]"), "{line}");
        assert!(pages[1].1.contains("EXIT STATUS"), "{}", pages[1].1);
    }

    #[test]
    fn pages_are_written_to_a_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut args = ManArgs {
            command: None,
            out: Some(folder.path().to_owned()),
        };
        man(&args, command()).expect("the folder can be written");
        assert!(folder.path().join("tyndall-render.1").is_file());
        args.out = Some(folder.path().join("missing"));
        assert!(man(&args, command()).is_err_and(|e| !e.is_input()));
        args.out = None;
        args.command = Some("rendr".into());
        assert!(man(&args, command()).is_err_and(|e| e.is_input()));
    }
}
