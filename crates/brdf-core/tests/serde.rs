//! Models, domains and scenes in files.

use brdf_core::scene::{Azimuth, Coordinates, Domain, Scene};
use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters, Parameters};

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

#[test]
fn a_geometry_is_read_as_it_was_written_and_checked() {
    for (psi, theta, phi) in [
        (0.0, 0.0, 0.0),
        (0.5, -0.5, 0.0),
        (1.2, 0.3, 2.0),
        (1.57, 1.57, 0.1),
    ] {
        let geometry = Geometry::new(psi, theta, phi).unwrap();
        let json = serde_json::to_string(&geometry).unwrap();
        assert_eq!(serde_json::from_str::<Geometry>(&json).unwrap(), geometry);
        let damaged = json.replacen("\"sec_alpha\":", "\"sec_alpha\":1", 1);
        let error = serde_json::from_str::<Geometry>(&damaged).unwrap_err();
        assert!(
            error.to_string().contains("one pair of directions"),
            "{error}"
        );
    }
    let json = serde_json::to_string(&Geometry::new(0.5, 0.2, 0.0).unwrap()).unwrap();
    let below = json.replacen("\"cos_psi\":", "\"cos_psi\":-", 1);
    let error = serde_json::from_str::<Geometry>(&below).unwrap_err();
    assert!(
        error.to_string().contains("cosine of a zenith angle"),
        "{error}"
    );
}
