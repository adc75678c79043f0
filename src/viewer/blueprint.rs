//! Blueprints: how the views are arranged when a file is opened.
//!
//! The library's own builders cannot set the camera, legend or axes of a view, so the blueprint
//! store is written directly: a tree of containers and views, each with its properties.

use nalgebra::Vector3;
use rerun::external::re_log_types::{BlueprintActivationCommand, LogMsg};
use rerun::external::re_sdk_types::blueprint::archetypes as bp;
use rerun::external::re_sdk_types::blueprint::components::{
    BackgroundKind, ContainerKind, Corner2D, PanelState, RootContainer,
};
use rerun::external::re_sdk_types::datatypes::Uuid;
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder};

use super::{Error, arm, log_error, palette, plots};

/// A view or a container of views.
pub enum Node {
    View { class: &'static str, name: String, origin: String, properties: Vec<Property> },
    Container { kind: ContainerKind, name: String, children: Vec<Node>, shape: Shape },
}

/// An archetype of a view, by the name under which the viewer looks for it.
type Property = (&'static str, Box<dyn AsComponents>);

/// Relative widths or heights of the children, or the number of columns.
pub enum Shape {
    Even,
    Columns(Vec<f32>),
    Rows(Vec<f32>),
    Grid(u32),
}

/// Sends the arrangement along with the recording, active as soon as the file is opened.
pub fn send(stream: &RecordingStream, application: &'static str, root: &Node) -> Result<(), Error> {
    let messages = blueprint(application, root)?;
    let Some(LogMsg::SetStoreInfo(info)) = messages.first() else {
        return Err(Error::Log("the blueprint is empty".into()));
    };
    let blueprint_id = info.info.store_id.clone();
    let activation =
        BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true };
    stream.send_blueprint(messages, activation);
    Ok(())
}

/// Side by side.
pub fn columns(name: &str, children: Vec<Node>, shares: Vec<f32>) -> Node {
    container(ContainerKind::Horizontal, name, children, Shape::Columns(shares))
}

/// One above the other.
pub fn rows(name: &str, children: Vec<Node>, shares: Vec<f32>) -> Node {
    container(ContainerKind::Vertical, name, children, Shape::Rows(shares))
}

pub fn tabs(name: &str, children: Vec<Node>) -> Node {
    container(ContainerKind::Tabs, name, children, Shape::Even)
}

/// Two columns.
pub fn grid(name: &str, children: Vec<Node>) -> Node {
    container(ContainerKind::Grid, name, children, Shape::Grid(2))
}

/// One above the other, equally high.
pub fn stack(name: &str, children: Vec<Node>) -> Node {
    container(ContainerKind::Vertical, name, children, Shape::Even)
}

/// Curves over time.
pub fn time_series(name: String, origin: String, legend: bool) -> Node {
    let legend = bp::PlotLegend::new().with_corner(Corner2D::RightTop).with_visible(legend);
    Node::View {
        class: "TimeSeries",
        name,
        origin,
        properties: vec![("PlotLegend", Box::new(legend))],
    }
}

/// The arms, all of `frame` from the side.
pub fn arms(name: &str, frame: &arm::Frame) -> Node {
    space(name, "arm", frame)
}

/// What is below `origin` in space, all of `frame` from the side.
pub fn space(name: &str, origin: &str, frame: &arm::Frame) -> Node {
    let arm::Frame { centre, ahead, size } = frame;
    let side = ahead.cross(&Vector3::z());
    let eye = centre + *size * (0.85 * side + 0.3 * ahead + 0.35 * Vector3::z());
    let eye = bp::EyeControls3D::new()
        .with_position(arm::xyz(&eye))
        .with_look_target(arm::xyz(centre))
        .with_eye_up([0.0, 0.0, 1.0]);
    let background =
        bp::Background::new(BackgroundKind::SolidColor).with_color(palette::BACKGROUND);
    Node::View {
        class: "3D",
        name: name.into(),
        origin: origin.into(),
        properties: vec![("EyeControls3D", Box::new(eye)), ("Background", Box::new(background))],
    }
}

pub fn text(name: &str, origin: &str) -> Node {
    Node::View {
        class: "TextDocument",
        name: name.into(),
        origin: origin.into(),
        properties: Vec::new(),
    }
}

fn container(kind: ContainerKind, name: &str, children: Vec<Node>, shape: Shape) -> Node {
    Node::Container { kind, name: name.into(), children, shape }
}

/// The messages of a blueprint store that holds `root`.
fn blueprint(application: &'static str, root: &Node) -> Result<Vec<LogMsg>, Error> {
    let (stream, storage) = RecordingStreamBuilder::new(application)
        .enabled(true)
        .blueprint()
        .memory()
        .map_err(log_error)?;
    stream.set_time_sequence("blueprint", 0);
    let mut ids = 0;
    let root = log_node(&stream, root, &mut ids)?;
    let viewport = bp::ViewportBlueprint::new()
        .with_root_container(RootContainer(root.id))
        .with_auto_layout(false)
        .with_auto_views(false);
    stream.log("viewport", &viewport).map_err(log_error)?;
    let collapsed = bp::PanelBlueprint::new().with_state(PanelState::Collapsed);
    stream.log("blueprint_panel", &collapsed).map_err(log_error)?;
    stream.log("selection_panel", &collapsed).map_err(log_error)?;
    let time_panel = bp::TimePanelBlueprint::new()
        .with_state(PanelState::Collapsed)
        .with_timeline(plots::TIMELINE);
    stream.log("time_panel", &time_panel).map_err(log_error)?;
    Ok(storage.take())
}

/// A node once it is in the store.
struct Logged {
    id: Uuid,
    path: String,
}

/// Logs `node` and all below it.
fn log_node(stream: &RecordingStream, node: &Node, ids: &mut u128) -> Result<Logged, Error> {
    *ids += 1;
    let id = Uuid { bytes: ids.to_be_bytes() };
    match node {
        Node::View { class, name, origin, properties } => {
            let path = format!("view/{}", hyphenated(*ids));
            log_view(stream, &path, class, name, origin, properties)?;
            Ok(Logged { id, path })
        }
        Node::Container { kind, name, children, shape } => {
            let path = format!("container/{}", hyphenated(*ids));
            let children = children
                .iter()
                .map(|child| log_node(stream, child, ids).map(|logged| logged.path))
                .collect::<Result<Vec<_>, _>>()?;
            log_container(stream, &path, *kind, name, children, shape)?;
            Ok(Logged { id, path })
        }
    }
}

fn log_view(
    stream: &RecordingStream,
    path: &str,
    class: &str,
    name: &str,
    origin: &str,
    properties: &[Property],
) -> Result<(), Error> {
    let view = bp::ViewBlueprint::new(class).with_display_name(name).with_space_origin(origin);
    stream.log(path, &view).map_err(log_error)?;
    let contents = bp::ViewContents::new(["$origin/**"]);
    stream.log(format!("{path}/ViewContents"), &contents).map_err(log_error)?;
    for (name, property) in properties {
        stream.log(format!("{path}/{name}"), property.as_ref()).map_err(log_error)?;
    }
    Ok(())
}

fn log_container(
    stream: &RecordingStream,
    path: &str,
    kind: ContainerKind,
    name: &str,
    children: Vec<String>,
    shape: &Shape,
) -> Result<(), Error> {
    let container =
        bp::ContainerBlueprint::new(kind).with_display_name(name).with_contents(children);
    let container = match shape {
        Shape::Even => container,
        Shape::Columns(shares) => container.with_col_shares(shares.clone()),
        Shape::Rows(shares) => container.with_row_shares(shares.clone()),
        Shape::Grid(columns) => container.with_grid_columns(*columns),
    };
    stream.log(path, &container).map_err(log_error)
}

/// The usual 8-4-4-4-12 form of a UUID.
fn hyphenated(id: u128) -> String {
    let hex = format!("{id:032x}");
    [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-")
}
