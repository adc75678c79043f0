//! Links to viewers, and what is on its way to them.

use std::sync::atomic::Ordering;
use std::time::Duration;

use super::StreamArgs;
use crate::cli::interrupt;
use crate::robot::Robot;
use crate::series::JointSeries;
use crate::simulation::{Command, Glimpse, Target};
use crate::viewer::live::{self, Address, Delivery, Moving, Server, Watching};
use crate::watch::Stretch;

/// To a viewer that listens, or to a server of our own.
pub struct Link {
    pub address: Address,
    server: Option<Server>,
}

impl StreamArgs {
    /// `None` if nothing was asked for, or if nobody listens, which is said and hinders nothing.
    pub fn open(&self) -> anyhow::Result<Option<Link>> {
        if let Some(address) = &self.serve {
            return Link::serve(&Address::new(address)).map(Some);
        }
        let Some(address) = self.stream.as_deref().map(Address::new) else { return Ok(None) };
        if let Err(error) = address.reach() {
            eprintln!(
                "note: --stream: {error}, the work goes on without; open it before (`rerun`, by \
                 pip install rerun-sdk==0.36.3), or take --serve and let it join later"
            );
            return Ok(None);
        }
        Ok(Some(Link { address, server: None }))
    }
}

impl Link {
    fn serve(address: &Address) -> anyhow::Result<Self> {
        let server = Server::start(address)?;
        eprintln!("serving until Ctrl-C; look at it with: rerun {}", server.address.url());
        Ok(Self { address: server.address.clone(), server: Some(server) })
    }

    /// Begins to show an arm that is about to follow `command`.
    pub fn follow<'c>(
        &self,
        title: String,
        robot: &Robot,
        command: &'c (dyn Command + Sync),
    ) -> anyhow::Result<Following<'c>> {
        let planned = coarse(command, robot.dof());
        let moving = Moving::begin(&self.address, title, robot.clone(), planned)?;
        Ok(Following { moving, command, target: Target::still(robot.dof()) })
    }
}

impl Link {
    /// Begins to show an arm that is watched.
    pub fn watch(&self, title: String, robot: &Robot) -> anyhow::Result<Watched> {
        Ok(Watched(Watching::begin(&self.address, title, robot.clone())?))
    }
}

/// An arm that is shown while it is watched.
pub struct Watched(Watching);

impl Watched {
    pub fn see(&mut self, stretch: &Stretch) {
        let shown = live::Watched {
            time: stretch.time.clone(),
            q: stretch.q.clone(),
            measured: stretch.measured.clone(),
            predicted: stretch.predicted.clone(),
        };
        self.0.add(&shown, stretch.dt);
    }

    pub fn end(self) -> Delivery {
        self.0.end()
    }
}

/// Instants of a motion that are enough for its path.
const COARSE: usize = 600;

/// Positions along `command`, rad, evenly in time.
fn coarse(command: &dyn Command, dof: usize) -> JointSeries {
    let mut target = Target::still(dof);
    let mut series = JointSeries::zeros(dof, COARSE);
    for k in 0..COARSE {
        target.aim(command, command.duration() * k as f64 / (COARSE - 1) as f64);
        series.set_sample(k, &target.q);
    }
    series
}

/// A simulated arm that is shown while it moves.
pub struct Following<'c> {
    moving: Moving,
    command: &'c (dyn Command + Sync),
    target: Target,
}

impl Following<'_> {
    pub fn see(&mut self, now: &Glimpse) {
        self.target.aim(self.command, now.time_s);
        self.moving.add(now.time_s, now.q, now.tau, &self.target.q);
    }

    pub fn end(self) -> Delivery {
        self.moving.end()
    }
}

/// What is on its way, for the end of the work.
#[derive(Default)]
pub struct Deliveries(Vec<Delivery>);

impl Deliveries {
    pub fn push(&mut self, delivery: Delivery) {
        self.0.push(delivery);
    }

    /// Waits until the viewer has everything, and for Ctrl-C if it is to be served further. What
    /// did not arrive is said, but is no failure of the work.
    pub fn end(self, link: Option<Link>) -> anyhow::Result<()> {
        for delivery in self.0 {
            match delivery.wait() {
                Ok(0) => {}
                Ok(n) => eprintln!("note: the viewer was too slow for {n} stretches of it"),
                Err(error) => {
                    eprintln!("note: --stream: not all was shown, {error}");
                    break;
                }
            }
        }
        link.and_then(|link| link.server).map_or(Ok(()), serve_on)
    }
}

fn serve_on(server: Server) -> anyhow::Result<()> {
    let stop = interrupt::flag();
    eprintln!("done; still serving, Ctrl-C ends it");
    while !stop.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(50));
    }
    drop(server);
    Ok(())
}
