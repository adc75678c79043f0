//! What `--help` owes its reader.

use clap::{Arg, Command};

/// All commands and their commands, by name.
fn commands(command: &Command, before: &str, found: &mut Vec<(String, Command)>) {
    for inner in command.get_subcommands() {
        let name = format!("{before} {}", inner.get_name());
        commands(inner, &name, found);
        found.push((name, inner.clone()));
    }
}

/// Flags whose names say that they are written only if they are given.
const PLAIN: [&str; 3] = ["json", "stream", "serve"];

fn says_its_default(arg: &Arg) -> bool {
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    let given_by_clap = !arg.get_default_values().is_empty() || arg.is_required_set();
    given_by_clap || help.contains("[default") || help.contains("needed with")
}

#[test]
fn every_flag_with_a_value_says_what_holds_without_it() {
    let mut all = Vec::new();
    commands(&super::command(), "armtwin", &mut all);
    for (name, command) in &all {
        let flags = command.get_arguments().filter(|a| a.get_long().is_some());
        for flag in flags.filter(|a| a.get_action().takes_values()) {
            let long = flag.get_long().unwrap_or_default();
            assert!(
                PLAIN.contains(&long) || says_its_default(flag),
                "{name} --{long}: no default is said"
            );
        }
    }
}
