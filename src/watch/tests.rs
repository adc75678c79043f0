//! Run lengths against published and simulated ones; gaps against what was put in.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::cusum::REFERENCE;
use super::self_starting::FARTHEST;
use super::*;
use crate::simulation::{Experiment, Scenario, Simulation};

/// Siegmund, *Sequential Analysis*, 1985, eq. 2.57, an approximation: for one side
/// (exp(2 k b) - 1 - 2 k b) / (2 k^2) with b = h + 1.166.
fn siegmund(h: f64) -> f64 {
    let (k, b) = (REFERENCE, h + 1.166);
    ((2.0 * k * b).exp() - 1.0 - 2.0 * k * b) / (2.0 * k * k)
}

#[test]
fn run_lengths_are_those_of_the_tables() {
    // Montgomery, Introduction to Statistical Quality Control, table 9.3: two sides of h = 4 and 5 with
    // k = 1/2 run for 168 and 465 steps, one side for twice as long.
    for (h, both) in [(4.0, 168.0), (5.0, 465.0)] {
        let one = run_length(h);
        assert!((one / (2.0 * both) - 1.0).abs() < 0.01, "{h}: {one}");
    }
    for h in [3.0, 8.0, 12.0] {
        let share = run_length(h) / siegmund(h);
        assert!((share - 1.0).abs() < 0.06, "{h}: {share}");
    }
    for steps in [500.0, 1e5, 1e7] {
        assert!((run_length(threshold(steps)) / steps - 1.0).abs() < 1e-3);
    }
}

/// Autocorrelated features of unknown mean and spread: the numbers are standard normal, and charts on them
/// run as long as stated although they learn while they run.
#[test]
fn false_alarms_are_as_stated_without_a_learning_period() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let limit = threshold(300.0);
    let (mut alarms, mut steps, mut squares, mut lagged, mut before) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for _ in 0..400 {
        let (mut chart, mut side, mut x) = (SelfStarting::default(), Cusum::default(), 0.0);
        for n in 0..800 {
            let e: f64 = StandardNormal.sample(&mut rng);
            x = 0.5 * x + e;
            let Some(z) = chart.add(7.0 + 0.03 * x) else { continue };
            assert!(z.abs() <= FARTHEST);
            squares += z * z;
            lagged += z * before;
            before = z;
            steps += 1.0;
            if side.add(z, f64::from(n), limit) {
                alarms += 1.0;
                side = Cusum::default();
            }
        }
    }
    assert!((squares / steps - 1.0).abs() < 0.02, "variance {}", squares / steps);
    assert!((lagged / steps).abs() < 0.02, "correlation {}", lagged / steps);
    let runs = steps / alarms;
    // Charts that have just begun run a little shorter: 266 here.
    assert!((240.0..360.0).contains(&runs), "runs for {runs} steps, 300 are stated");
}

fn experiment(effects: &str, duration_s: f64) -> Experiment {
    let text = format!(
        "[noise]\nsnr_db = 34\nposition_rad = 2e-5\nvelocity_rad_s = 1.5e-3\n\
         [motion]\nkind = \"random_frequency\"\nduration_s = {duration_s}\n\
         [effects.viscous]\nviscous = [9, 11, 7, 1.9, 1.4, 1.1]\n\
         [effects.coulomb]\ncoulomb = {effects}\n"
    );
    Scenario::parse(&text, "test").unwrap().work_out("test").unwrap()
}

fn twin() -> Twin {
    let text = "[twin]\neffects = [\"coulomb\", \"viscous\"]\n[twin.values]\n\
                coulomb = [6, 7, 5, 1.5, 1.2, 1.0]\nviscous = [9, 11, 7, 1.9, 1.4, 1.1]\n";
    Twin::parse(text, std::path::Path::new("test")).unwrap()
}

fn recorded(effects: &str, duration_s: f64) -> (Recording, Vec<f64>) {
    let made = experiment(effects, duration_s);
    let run = Simulation::new(&made.setup).unwrap().run(&made.fit, 1, 0, &mut |_| true).unwrap();
    let per_ampere = (0..6).map(|j| made.setup.drive.torque_per_ampere(j));
    let noise = per_ampere.zip(&run.current_noise_a).map(|(nm, a)| nm * a).collect();
    (run.recording, noise)
}

fn columns(recording: &Recording) -> Vec<String> {
    let names = recording.channels.iter().map(|c| c.name.clone());
    std::iter::once("timestamp".into()).chain(names).collect()
}

/// The streamed residual is that of the whole recording, and figures are what was hidden.
#[test]
fn the_gap_is_that_of_a_diagnosis_and_as_large_as_what_is_hidden() {
    let (usual, noise) = recorded("[6, 7, 5, 1.5, 1.2, 1.0]", 20.0);
    let (changed, _) = recorded("[6, 7, 6.5, 1.5, 1.2, 1.0]", 20.0);
    let settings = Settings { figures_s: 1e9, ..Settings::default() };
    let mut watch = Watch::new(twin(), &columns(&usual), &settings).unwrap();
    watch.learn(&usual).unwrap();
    let whole = Stretch::of(&changed, None, &twin()).unwrap();
    let mut seen = 0;
    for row in changed.rows() {
        let Some(Seen { stretch, .. }) = watch.row(&row).unwrap() else { continue };
        let first = whole.time.iter().position(|t| (t - stretch.time[0]).abs() < 1e-6).unwrap();
        for (j, noise) in noise.iter().enumerate() {
            let counted = (0..stretch.len()).filter(|&k| stretch.counts[j][k]);
            let off = |k: usize| (stretch.left(j, k) - whole.left(j, first + k)).powi(2);
            let squares: Vec<f64> = counted.map(off).collect();
            let rms = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
            assert!(rms < 0.1 * noise, "joint {j}: {rms} beside {noise}");
        }
        seen += stretch.len();
        assert!(watch.held() < 10_000, "{}", watch.held());
    }
    assert!(seen > 2000, "{seen}");
    let level = watch.figures().level();
    for (j, noise) in noise.iter().enumerate() {
        let (now, level) = (watch.figures().now(j)[0].unwrap(), level.0[j][0].unwrap());
        let more = now.along_nm - level.along_nm;
        let expected = if j == 2 { 1.5 } else { 0.0 };
        assert!((more - expected).abs() < 0.15, "joint {j}: {more}");
        assert!((level.rms_nm / noise - 1.0).abs() < 0.6, "joint {j}: {level:?} {noise}");
    }
    let alarm = Alarm { joint: 2, feature: 0, more: true, since: 0.0, noticed: 1.0 };
    let words = alarm.words(&watch.figures().now(2), &level.0[2]);
    assert!(words.starts_with("joint 3 needs 1.") && words.contains("N.m more"), "{words}");
}

/// A load that was there before anybody watched is none of the first minutes' if a recording says what is usual.
#[test]
fn what_changed_before_the_first_row_is_noticed_where_a_recording_says_what_is_usual() {
    let (usual, _) = recorded("[6, 7, 5, 1.5, 1.2, 1.0]", 90.0);
    let (changed, _) = recorded("[6, 7, 6.5, 1.5, 1.2, 1.0]", 40.0);
    let noticed = |learned: bool| {
        let mut watch = Watch::new(twin(), &columns(&usual), &Settings::default()).unwrap();
        if learned {
            watch.learn(&usual).unwrap();
        }
        let mut rows = changed.rows();
        rows.find_map(|row| watch.row(&row).unwrap().and_then(|seen| seen.alarm))
    };
    assert_eq!(noticed(true).map(|alarm| alarm.joint), Some(2));
    assert_eq!(noticed(false), None);
}

#[test]
fn gaps_in_time_and_clocks_that_go_back_begin_anew() {
    let (usual, _) = recorded("[6, 7, 5, 1.5, 1.2, 1.0]", 20.0);
    let mut watch = Watch::new(twin(), &columns(&usual), &Settings::default()).unwrap();
    for (begins, skip) in [(0.0, 400..500), (-50.0, 900..1500)] {
        for (k, mut row) in usual.rows().enumerate() {
            row[0] += begins;
            if !skip.contains(&k) && watch.row(&row).unwrap().is_some() {
                assert!(watch.held() < 10_000);
            }
        }
    }
}

#[test]
fn a_twin_without_values_is_refused_and_told_how_to_get_some() {
    let Err(refused) = Watch::new(Twin::default(), &["timestamp".into()], &Settings::default())
    else {
        panic!()
    };
    let refused = refused.to_string();
    assert!(
        refused.contains("coulomb has no values") && refused.contains("--save-twin"),
        "{refused}"
    );
}

#[test]
fn what_is_remembered_is_bounded() {
    let names = ["timestamp".to_string(), "actual_q_0".into()];
    let mut memory = Memory::new(&names, 10.0, 100.0);
    for k in 0..100_000 {
        memory.add(&[f64::from(k) * 0.01, 1.0]);
        // A clock that hardly moves is no reason to keep more.
        memory.add(&[f64::from(k) * 0.01 + 1e-9, 1.0]);
    }
    let (held, most) = memory.held();
    assert!(held <= most && most == 1501, "{held}");
    assert_eq!(memory.now(), Some(999.99 + 1e-9));
    let part = memory.between(995.0, 996.0);
    assert!(part.time[0] >= 995.0 && part.channels[0].values.len() == part.time.len());
}
