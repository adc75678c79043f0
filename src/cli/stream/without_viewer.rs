//! In place of the links, where the program is built without the viewer: there are none.

use super::StreamArgs;
use crate::robot::Robot;
use crate::simulation::{Command, Glimpse};

pub enum Link {}
pub enum Following {}
pub enum Delivery {}

#[derive(Default)]
pub struct Deliveries {}

impl StreamArgs {
    pub fn open(&self) -> anyhow::Result<Option<Link>> {
        anyhow::ensure!(
            self.stream.is_none() && self.serve.is_none(),
            "--stream, --serve: this armtwin was built without the viewer; build it with its \
             default features"
        );
        Ok(None)
    }
}

impl Link {
    pub fn follow(&self, _: String, _: &Robot, _: &dyn Command) -> anyhow::Result<Following> {
        match *self {}
    }
}

impl Link {
    pub fn watch(&self, _: String, _: &Robot) -> anyhow::Result<Watched> {
        match *self {}
    }
}

pub enum Watched {}

impl Watched {
    pub fn see(&mut self, _: &crate::watch::Stretch) {
        match *self {}
    }

    pub fn end(self) -> Delivery {
        match self {}
    }
}

impl Following {
    pub fn see(&mut self, _: &Glimpse) {
        match *self {}
    }

    pub fn end(self) -> Delivery {
        match self {}
    }
}

impl Deliveries {
    pub fn push(&mut self, delivery: Delivery) {
        match delivery {}
    }

    pub fn end(self, _: Option<Link>) -> anyhow::Result<()> {
        Ok(())
    }
}
