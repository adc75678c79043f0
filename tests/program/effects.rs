//! `armtwin effects`.

use std::fs;
use std::path::Path;

use armtwin::effects::{CATALOGUE, Parameter};
use armtwin::simulation::Scenario;
use armtwin::twin::Twin;

use crate::armtwin;

#[test]
fn every_effect_and_parameter_is_listed() {
    let out = armtwin(&["effects"]);
    assert_eq!(out.code, 0);
    for about in CATALOGUE.iter().map(|e| e.about()) {
        assert!(out.stdout.contains(about.law), "{}", about.name);
        for p in about.parameters {
            assert!(out.stdout.contains(p.name) && out.stdout.contains(p.unit), "{}", p.name);
        }
    }
    assert!(out.stdout.lines().all(|l| l.chars().count() <= 100), "{}", out.stdout);
}

#[test]
fn one_effect_is_shown_in_full() {
    for about in CATALOGUE.iter().map(|e| e.about()) {
        let out = armtwin(&["effects", about.name]);
        let words = out.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
        for text in [about.cause, about.remedy, about.source] {
            assert!(words.contains(text), "{}: {text}", about.name);
        }
        assert!(out.stdout.contains(&format!("[effects.{}]", about.name)));
        assert!(out.stdout.lines().all(|l| l.chars().count() <= 100), "{}", out.stdout);
    }
}

#[test]
fn json_is_the_catalogue() {
    let out = armtwin(&["effects", "--json"]);
    let all: serde_json::Value = serde_json::from_str(&out.stdout).unwrap();
    let all = all.as_array().unwrap();
    assert_eq!(all.len(), CATALOGUE.len());
    for (json, about) in all.iter().zip(CATALOGUE.iter().map(|e| e.about())) {
        assert_eq!(json["name"], about.name);
        for key in ["cause", "remedy", "source", "law", "scope"] {
            assert!(json[key].is_string(), "{}: {key}", about.name);
        }
        let parameters = json["parameters"].as_array().unwrap();
        assert_eq!(parameters.len(), about.parameters.len());
        for p in parameters {
            let in_order = p["min"].as_f64().unwrap() < p["max"].as_f64().unwrap();
            assert!(in_order && p["typical"].is_number() && p["unit"].is_string());
            assert!(p["role"] == "linear" || p["role"] == "nonlinear");
        }
    }
}

#[test]
fn an_unknown_effect_is_wrong_usage() {
    let out = armtwin(&["effects", "magic"]);
    assert_eq!(out.code, 2);
    assert!(out.stderr.contains("magic") && out.stderr.contains("stribeck"), "{}", out.stderr);
}

/// Scenarios and twins take every effect by its name and the names of its parameters.
#[test]
fn files_take_every_effect() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for effect in CATALOGUE {
        let about = effect.about();
        let file = root.join("scenarios/effects").join(about.name).with_extension("toml");
        let made = Scenario::load(&file).unwrap().work_out("test").unwrap();
        let hidden = made.setup.effects.iter().map(|i| i.effect.about().name);
        assert!(hidden.into_iter().any(|name| name == about.name), "{}", about.name);
        let given = |p: &&Parameter| !p.is_reference();
        let values: String = about
            .parameters
            .iter()
            .filter(given)
            .map(|p| format!("{} = {:?}\n", p.name, p.typical))
            .collect();
        let current = Twin::default().can_have(*effect);
        let drive = if current { "" } else { "[servo]\nmodel = \"sts3215\"\n" };
        let name = about.name;
        let text = format!("{drive}[twin]\neffects = [\"{name}\"]\n[twin.values]\n{values}");
        let twin = Twin::parse(&text, Path::new("TWIN.toml")).unwrap();
        let known: Vec<_> = twin.known().map(|e| e.about().name).collect();
        assert_eq!(known, [about.name]);
        let read_back = Twin::parse(&twin.to_toml(), Path::new("TWIN.toml")).unwrap();
        assert_eq!(read_back.values, twin.values, "{}", about.name);
    }
}

/// A file that implements an effect is in the list; what is in the list is in the docs.
#[test]
fn files_list_and_docs_agree() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = fs::read_dir(root.join("src/effects")).unwrap().map(|f| f.unwrap().path());
    let effects: Vec<String> = files
        .filter(|f| f.is_file())
        .filter(|f| fs::read_to_string(f).unwrap().contains("impl Effect for"))
        .map(|f| f.file_stem().unwrap().to_str().unwrap().to_string())
        .collect();
    assert_eq!(effects.len(), CATALOGUE.len());
    for about in CATALOGUE.iter().map(|e| e.about()) {
        assert!(effects.iter().any(|e| e == about.name), "{}: file and name differ", about.name);
    }
    let docs = fs::read_to_string(root.join("docs/effects.md")).unwrap();
    let printed = armtwin(&["effects"]).stdout;
    let cure = "run: (sed '/^```/q' docs/effects.md; armtwin effects; echo '```') > new";
    assert!(docs.contains(printed.trim_end()), "docs/effects.md is old; {cure}");
}
