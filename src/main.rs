//! The `armtwin` program: see `armtwin --help`.

fn main() -> std::process::ExitCode {
    armtwin::cli::main()
}
