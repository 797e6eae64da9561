//! Models, domains and scenes in files.

use brdf_core::scene::{Azimuth, Coordinates, Domain, Scene};
use brdf_core::{AnyBrdf, Family, ModelParameters, Parameters};

#[test]
fn models_and_scenes_are_read_as_they_were_written() {
    for family in Family::ALL {
        let p = if family == Family::Power { 1.7 } else { 1.0 };
        let at = ModelParameters {
            k2: 0.3,
            kd: 0.1,
            k1: 0.2,
            n: 1.5,
            p,
        };
        let brdf = AnyBrdf::new(family, &at).unwrap();
        let json = serde_json::to_string(&brdf).unwrap();
        assert!(json.contains(&format!("\"family\":\"{family}\"")), "{json}");
        assert_eq!(serde_json::from_str::<AnyBrdf>(&json).unwrap(), brdf);
    }
    let scene = Scene {
        domain: Domain::new((0.1, 1.0), (0.0, 1.2), Azimuth::InPlane).unwrap(),
        coordinates: Coordinates::Directions,
        ..Scene::default()
    };
    let json = serde_json::to_string(&scene).unwrap();
    assert_eq!(serde_json::from_str::<Scene>(&json).unwrap(), scene);
}

#[test]
fn values_outside_the_domain_are_errors() {
    let error = |json| serde_json::from_str::<Parameters>(json).unwrap_err();
    let error = error(r#"{"k2": -1.0, "kd": 0.1, "k1": 0.2}"#).to_string();
    assert!(error.contains("k2 = -1"), "{error}");
    let json = r#"{"family": "power", "k2": 0.3, "kd": 0.1, "k1": 0.2, "n": 1.5, "p": 99.0}"#;
    let error = serde_json::from_str::<AnyBrdf>(json).unwrap_err();
    assert!(error.to_string().contains("p = 99"), "{error}");
    let json = r#"{"incidence": [0.0, 2.0], "view": [0.0, 1.0], "azimuth": "full"}"#;
    let error = serde_json::from_str::<Domain>(json).unwrap_err();
    assert!(error.to_string().contains("from 0 to 2"), "{error}");
}
