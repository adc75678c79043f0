//! `armtwin completions`: what a shell needs to complete commands and flags.

use clap_complete::Shell;

/// Print the completions of a shell
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin completions bash > ~/.local/share/bash-completion/completions/armtwin
  armtwin completions zsh > ~/.zfunc/_armtwin
  armtwin completions fish > ~/.config/fish/completions/armtwin.fish")]
pub struct Args {
    /// Which shell
    shell: Shell,
}

pub fn run(args: &Args) {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut super::command(), "armtwin", &mut script);
    super::out::document(&String::from_utf8_lossy(&script));
}
