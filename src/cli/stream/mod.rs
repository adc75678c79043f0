//! `--stream` and `--serve`: what is worked out, sent to a viewer meanwhile.

#[cfg(feature = "viewer")]
mod with_viewer;
#[cfg(not(feature = "viewer"))]
mod without_viewer;

#[cfg(feature = "viewer")]
pub use with_viewer::{Deliveries, Link, Watched};
#[cfg(not(feature = "viewer"))]
pub use without_viewer::{Deliveries, Link, Watched};

/// Where a viewer listens unless told otherwise.
const ADDRESS: &str = "127.0.0.1:9876";

#[derive(clap::Args, Default)]
#[command(next_help_heading = "Live")]
pub struct StreamArgs {
    /// Send to a viewer that is open while the work runs [default address: 127.0.0.1:9876]
    #[arg(
        long,
        value_name = "HOST:PORT",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = ADDRESS,
        value_parser = host_and_port,
        conflicts_with = "serve"
    )]
    stream: Option<String>,
    /// Keep it for viewers that join while the work runs or later, until Ctrl-C [default address:
    /// 127.0.0.1:9876]
    #[arg(
        long,
        value_name = "HOST:PORT",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = ADDRESS,
        value_parser = host_and_port
    )]
    serve: Option<String>,
}

fn host_and_port(text: &str) -> Result<String, String> {
    let port = text.rsplit_once(':').filter(|(host, _)| !host.is_empty()).map(|(_, port)| port);
    match port.map(str::parse::<u16>) {
        Some(Ok(_)) => Ok(text.to_string()),
        _ => Err(format!("give a host and a port, for example {ADDRESS}")),
    }
}

#[cfg(test)]
mod tests {
    use super::host_and_port;

    #[test]
    fn an_address_has_a_host_and_a_port() {
        for good in ["127.0.0.1:9876", "[::1]:80", "lab-pc:9000"] {
            assert_eq!(host_and_port(good).as_deref(), Ok(good));
        }
        for bad in ["", "9876", ":9876", "host", "host:", "host:70000"] {
            assert!(host_and_port(bad).unwrap_err().contains("127.0.0.1:9876"), "{bad}");
        }
    }
}
