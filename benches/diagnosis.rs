//! Whole diagnoses: a simulated pair of 2 x 60 s, one whose torque is recorded late, and, where the
//! recordings are at hand (`../shared/recordings`, or `ARMTWIN_SHARED`), a real UR10e and a real UR5
//! against the paper's twin.

use std::path::{Path, PathBuf};
use std::time::Duration;

use armtwin::diagnosis::{Settings, conditioning, diagnose};
use armtwin::recording::{self, Recording};
use armtwin::signals::{Samples, condition};
use armtwin::simulation::{Scenario, Simulation};
use armtwin::twin::Twin;
use criterion::{Criterion, criterion_group, criterion_main};

struct Pair {
    twin: Twin,
    samples: [Samples; 2],
}

impl Pair {
    fn new(twin: Twin, recordings: [Recording; 2]) -> Self {
        let dof = twin.robot.dof();
        let samples = recordings.map(|r| {
            let how = conditioning(&r, dof);
            condition(&r, &twin.drive, dof, &how).expect("a recording of this arm")
        });
        Self { twin, samples }
    }

    fn simulated(effect: &str) -> Self {
        let file = format!("scenarios/effects/{effect}.toml");
        let scenario = Scenario::load(Path::new(&file)).expect("a scenario of the repository");
        let made = scenario.work_out(&file).expect("a scenario that works");
        let mut simulation = Simulation::new(&made.setup).expect("an arm that can be simulated");
        let runs = [&made.fit, &made.check].map(|motion| {
            let run = simulation.run(motion, made.seed, 0, &mut |_| true);
            run.expect("a run that ends").recording
        });
        Self::new(Twin::load(Path::new("scenarios/twins/ur5.toml")).expect("the UR5's twin"), runs)
    }

    fn real(twin: &str, columns: Option<&str>, files: [&str; 2]) -> Option<Self> {
        let shared = std::env::var("ARMTWIN_SHARED").unwrap_or_else(|_| "../shared".into());
        let folder = PathBuf::from(shared).join("recordings");
        let columns = columns.map(Path::new);
        let [fit, check] = files.map(|file| recording::read(&folder.join(file), columns).ok());
        let twin = Twin::load(Path::new(twin)).expect("a twin of the repository");
        Some(Self::new(twin, [fit?, check?]))
    }
}

fn diagnoses(c: &mut Criterion) {
    let ur10e = "shamilmamedov-dynamic_calibration/identification_data/ur-20_02_1";
    let ur10e = [format!("{ur10e}0-30sec_12harm.csv.gz"), format!("{ur10e}2-40sec_12harm.csv.gz")];
    let ur5 = "kkufieta-ur5_modeling_force_estimate/Movement_No";
    let ur5 =
        [format!("{ur5}6_Acc_slow_Verify_Model"), format!("{ur5}7_Acc_slow_Verify_Model_short")];
    let columns = Some("scenarios/columns/ur10e_shamilmamedov.toml");
    let pairs = [
        ("simulated, a payload", Some(Pair::simulated("payload"))),
        ("simulated, a delay", Some(Pair::simulated("time_delay"))),
        (
            "UR10e, unloaded",
            Pair::real("scenarios/twins/ur10e.toml", columns, ur10e.each_ref().map(|s| &**s)),
        ),
        (
            "UR5, the paper's twin",
            Pair::real("scenarios/twins/ur5_paper.toml", None, ur5.each_ref().map(|s| &**s)),
        ),
    ];
    let mut group = c.benchmark_group("diagnose");
    group.sample_size(10).measurement_time(Duration::from_secs(60));
    for (name, pair) in pairs {
        let Some(Pair { twin, samples: [fit, check] }) = pair else {
            println!("{name}: skipped, no recordings beside the repository");
            continue;
        };
        let settings = Settings::default();
        group.bench_function(name, |b| {
            b.iter(|| diagnose(&twin, &fit, &check, &settings).expect("recordings with motion"));
        });
    }
    group.finish();
}

criterion_group!(benches, diagnoses);
criterion_main!(benches);
