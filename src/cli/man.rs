//! `armtwin man`: manual pages from the help texts.

use std::path::PathBuf;

use anyhow::Context;
use clap_mangen::Man;

use super::{out, outputs, save};

/// Print the manual page, or write those of all commands
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin man | man -l -
  armtwin man --out ~/.local/share/man/man1")]
pub struct Args {
    /// Folder for the pages of all commands [default: one page on standard output]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut whole = super::command();
    // So that pages of commands name the program.
    whole.build();
    let Some(out) = &args.out else {
        out::document(&String::from_utf8_lossy(&page(whole, "armtwin")?));
        return Ok(());
    };
    let mut pages = vec![("armtwin".to_string(), whole.clone())];
    collect(&whole, "armtwin", &mut pages);
    let names: Vec<String> = pages.iter().map(|(name, _)| format!("{name}.1")).collect();
    outputs::ask_in(out, &names)?;
    std::fs::create_dir_all(out).with_context(|| format!("--out {}", out.display()))?;
    for (name, command) in &pages {
        let path = out.join(format!("{name}.1"));
        let text = page(command.clone(), name)?;
        save::text(&path, &String::from_utf8_lossy(&text))?;
    }
    println!("{}: {} pages", out.display(), pages.len());
    Ok(())
}

/// Commands and their commands, `help` left out.
fn collect(of: &clap::Command, name: &str, pages: &mut Vec<(String, clap::Command)>) {
    for command in of.get_subcommands().filter(|c| c.get_name() != "help") {
        let name = format!("{name}-{}", command.get_name());
        pages.push((name.clone(), command.clone()));
        collect(command, &name, pages);
    }
}

fn page(command: clap::Command, title: &str) -> anyhow::Result<Vec<u8>> {
    let mut text = Vec::new();
    Man::new(command).title(title).render(&mut text)?;
    Ok(text)
}
