//! `armtwin serve`: a simulated arm that every client of RTDE takes for a UR.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};

use super::{interrupt, out, progress};
use crate::live::{Arm, Served, Server};
use crate::rtde::{Heard, Level, PORT};
use crate::simulation::{Scenario, Switch};
use crate::twin::Twin;

/// Be an arm: the scenario's motion without end, for every client of RTDE
#[derive(clap::Args)]
#[command(after_help = "Examples:
  armtwin serve --scenario scenarios/ur5_friction.toml
  armtwin serve --scenario scenarios/ur5_friction.toml --rate 500 --at 60s load_friction.joint2=0.1
  armtwin serve --twin twin.toml --scenario scenarios/ur5_clean.toml --port 30005

Protocols 1 and 2, all quantities with their types, text messages, start and pause. The first time through,
the values on the wire are those of the fit.csv that `armtwin simulate` writes of the scenario, to the last
bit; then the arm goes back to where it began and does it again, with fresh noise. What a simulated arm has
not (inputs and outputs, safety) reads as of a controller that is well; registers read back what was written.
--at switches an effect on while clients are connected: EFFECT[.PARAMETER][.jointN]=VALUE, the first parameter
where none is named, the others typical.")]
pub struct Args {
    /// What the arm does, and what is hidden in it (TOML; copy one from scenarios/)
    #[arg(long, value_name = "SCENARIO")]
    scenario: PathBuf,
    /// Twin whose robot, drive and effects with values are the arm's [default: the scenario's]
    #[arg(long, value_name = "TWIN.toml")]
    twin: Option<PathBuf>,
    /// Address to listen at; 0.0.0.0 lets other machines in
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    host: String,
    /// Port to listen at; 0 takes any
    #[arg(long, value_name = "N", default_value_t = PORT)]
    port: u16,
    /// Rows per second [default: the scenario's]
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Length of the motion in seconds [default: the scenario's]
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// From this time on, s after the first row, an effect acts [default: none]
    #[arg(long, num_args = 2, value_names = ["TIME", "EFFECT"], action = clap::ArgAction::Append)]
    at: Vec<String>,
    /// Stop after so many seconds [default: never]
    #[arg(long, value_name = "S", value_parser = super::source::seconds)]
    seconds: Option<f64>,
    /// Send nothing before a client has asked for rows: the first one gets them from the first on
    #[arg(long)]
    wait: bool,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let stop = interrupt::flag();
    let file = args.scenario.display().to_string();
    let scenario = args.scenario()?;
    let made = scenario.work_out(&file)?;
    out::notes(&scenario.robot, &made.notes);
    let dof = made.setup.robot.dof();
    if dof != 6 {
        bail!("{file}: RTDE has six joints, and this arm has {dof}");
    }
    let switches = args.switches()?;
    let mut later = scenario.clone();
    let mut switched = Vec::new();
    for (at_s, switch) in &switches {
        later = later.switched(switch, dof);
        let made = later.work_out(&file).with_context(|| format!("--at {at_s}s {switch}"))?;
        switched.push((*at_s, made));
    }
    let spinner = progress::spinner("simulating the motion");
    let going = || !stop.load(Ordering::Relaxed);
    let mut arm = Arm::new(&made, &switched, &mut || going()).with_context(|| file.clone())?;
    spinner.finish_and_clear();
    let server = Server::start(&format!("{}:{}", args.host, args.port), Arc::clone(&arm.offer))?;
    println!(
        "serving {} at rtde://{}, {} Hz, {:.1} s of motion again and again, until Ctrl-C",
        scenario.robot,
        server.address,
        arm.rate_hz(),
        arm.round_s()
    );
    if server.address.ip().is_loopback() {
        println!("only this machine can connect (--host 0.0.0.0 lets others in)");
    }
    serve(args, &mut arm, &server, &switches, &going)
}

/// Rows at their time. Where the machine was busy, they follow each other until time is caught up with.
fn serve(
    args: &Args,
    arm: &mut Arm,
    server: &Server,
    switches: &[(f64, Switch)],
    going: &dyn Fn() -> bool,
) -> anyhow::Result<()> {
    let mut told = 0;
    let mut begun = Instant::now();
    let mut waits = args.wait;
    loop {
        for event in server.events() {
            waits &= !matches!(event, Served::Heard(_, Heard::Started { .. }));
            say(&event);
        }
        if !going() {
            return Ok(());
        }
        if waits {
            begun = Instant::now();
            std::thread::sleep(Duration::from_millis(5));
            continue;
        }
        let (k, row) = arm.next_row();
        server.send(k, row);
        let time = k as f64 / arm.rate_hz();
        while let Some((at_s, switch)) = switches.get(told).filter(|(at_s, _)| *at_s <= time) {
            println!("{at_s} s: {switch} acts from now on");
            server.say(Level::Info, "the arm has changed");
            told += 1;
        }
        if args.seconds.is_some_and(|s| time >= s) {
            return Ok(());
        }
        let due = Duration::from_secs_f64((k + 1) as f64 / arm.rate_hz());
        if let Some(left) = due.checked_sub(begun.elapsed()) {
            std::thread::sleep(left);
        }
    }
}

fn say(event: &Served) {
    match event {
        Served::Came(peer) => println!("{peer} connected"),
        Served::Went(peer, None) => println!("{peer} went"),
        Served::Went(peer, Some(why)) => println!("{peer} was dropped: {why}"),
        Served::Heard(peer, Heard::Text(text)) => {
            println!("{peer} {}: {} {}", text.level.word(), text.source, text.message);
        }
        Served::Heard(peer, Heard::Started { quantities, rate_hz }) => {
            println!("{peer} takes {quantities} quantities at {rate_hz} Hz");
        }
        Served::Heard(peer, Heard::Paused) => println!("{peer} paused"),
    }
}

impl Args {
    fn scenario(&self) -> anyhow::Result<Scenario> {
        let mut scenario = Scenario::load(&self.scenario)?;
        if let Some(rate) = self.rate {
            scenario.rate_hz = rate;
        }
        if let Some(duration) = self.duration {
            scenario.shorten(duration);
        }
        if let Some(path) = &self.twin {
            let twin = Twin::load(path)?;
            if let Some(open) = twin.open().next() {
                bail!(
                    "{}: {} has no values, and an arm needs some: take a twin that `armtwin identify \
                     --save-twin` wrote",
                    path.display(),
                    open.about().name
                );
            }
            scenario.is_of(&twin);
        }
        Ok(scenario)
    }

    /// In the order of their times.
    fn switches(&self) -> anyhow::Result<Vec<(f64, Switch)>> {
        let mut all = Vec::new();
        for pair in self.at.chunks(2) {
            let [time, effect] = pair else { bail!("--at takes a time and an effect") };
            let at_s =
                super::source::seconds(time).map_err(|e| anyhow::anyhow!("--at {time}: {e}"))?;
            let switch =
                effect.parse::<Switch>().map_err(|e| anyhow::anyhow!("--at {time} {e}"))?;
            all.push((at_s, switch));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(all)
    }
}
