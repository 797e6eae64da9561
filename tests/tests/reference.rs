use brdf_core::*;
#[test]
fn t() {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/data/brdf_reference.csv"
    ))
    .unwrap();
    let mut worst: std::collections::BTreeMap<String, [f64; 4]> = Default::default();
    for line in text.lines().skip(1) {
        let f: Vec<&str> = line.split(',').collect();
        let v: Vec<f64> = f[1..].iter().map(|x| x.parse().unwrap()).collect();
        let g = Geometry::new(v[0], v[1], v[2]).unwrap();
        let b = ThreeParameterBrdf::new(Parameters::new(v[3], v[4], v[5]).unwrap(), v[6]).unwrap();
        let rel = |a: f64, b: f64| {
            if b == 0.0 {
                a.abs()
            } else {
                ((a - b) / b).abs() / f64::EPSILON
            }
        };
        let w = worst.entry(f[0].into()).or_insert([0.0; 4]);
        let gr = b.gradient(&g);
        for (i, e) in [
            rel(b.value(&g), v[7]),
            rel(gr[0], v[8]),
            rel(gr[2], v[9]),
            rel(
                b.value(&g),
                b.value(&Geometry::new(v[1], v[0], v[2]).unwrap()),
            ),
        ]
        .into_iter()
        .enumerate()
        {
            if e > w[i] {
                w[i] = e;
            }
        }
    }
    println!("{worst:#?}");
}
