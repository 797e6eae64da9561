use brdf_core::*;
use brdf_fit::{criterion::Criterion, measurement::*, profile::*, solver::*, weights::Weights};
use std::time::Instant;
struct Rng(u64);
impl Rng {
    fn u(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn logu(&mut self, a: f64, b: f64) -> f64 {
        (a.ln() + (b.ln() - a.ln()) * self.u()).exp()
    }
}
fn all() -> Vec<(String, f64, Vec<f64>, Criterion, Criterion)> {
    let text = std::fs::read_to_string("/work/shared/data/expected_optima.csv").unwrap();
    text.lines()
        .skip(1)
        .map(|l| {
            let f: Vec<&str> = l.split(',').collect();
            let v: Vec<f64> = f[1..].iter().map(|x| x.parse().unwrap()).collect();
            let m = Measurements::read_csv(format!("/work/shared/data/{}", f[0])).unwrap();
            let m = m
                .by_wavelength()
                .into_iter()
                .find(|m| m.wavelengths()[0] == Some(v[0]))
                .unwrap();
            let c = Criterion::new(m.readings(), 1.5, &Weights::default()).unwrap();
            let lim = 60f64.to_radians() + 1e-9;
            let s = c.subset(|i| m.readings()[i].psi <= lim).unwrap();
            (f[0].to_string(), v[0], v, c, s)
        })
        .collect()
}
#[test]
fn profile() {
    for (name, wl, v, c, s) in all() {
        let t = Instant::now();
        let p = Profile::search(&c);
        let g = p.global_minimum(&c);
        let dt = t.elapsed();
        let gs = Profile::search(&s).global_minimum(&s);
        let nmin = (1..p.points.len() - 1)
            .filter(|&i| {
                p.points[i].error < p.points[i - 1].error
                    && p.points[i].error <= p.points[i + 1].error
            })
            .count();
        println!(
            "{name} {wl} {} {:?} ratio-1 {:.1e} {:.1e} k1 {:.4} {:.4} nmin {nmin}",
            v[2],
            dt,
            g.error * 100. / v[3] - 1.,
            gs.error * 100. / v[8] - 1.,
            g.parameters.k1,
            v[6]
        );
    }
}
#[test]
fn starts() {
    for (name, wl, v, c, _) in all()
        .into_iter()
        .filter(|x| std::env::args().any(|a| a == "all") || x.0.contains("blacklab"))
    {
        for m in [Method::LevenbergMarquardt, Method::NelderMead] {
            let mut rng = Rng(88172645463325252);
            let (mut ok, mut it, mut ev, mut mx) = (0, 0, 0, 0);
            let mut bad = vec![];
            let t = Instant::now();
            for _ in 0..1000 {
                let p = Parameters {
                    k2: rng.logu(1e-3, 10.),
                    kd: rng.logu(1e-3, 10.),
                    k1: rng.logu(1e-3, 10.),
                };
                let r = minimise(&c, m, p, 10000).unwrap();
                it += r.iterations;
                ev += r.evaluations;
                mx = mx.max(r.iterations);
                if r.error * 100. <= v[3] * (1.0 + 1e-6) {
                    ok += 1
                } else if bad.len() < 2 {
                    bad.push((p, r))
                }
            }
            println!(
                "{name} {wl} {m} ok {ok} iter {} eval {} max {mx} time/fit {:?} {bad:?}",
                it as f64 / 1000.,
                ev as f64 / 1000.,
                t.elapsed() / 1000
            );
        }
    }
}
#[test]
fn kernels() {
    let (_, _, _, c, _) = all()
        .into_iter()
        .find(|x| x.0.contains("z307_on_aluminium.csv"))
        .unwrap();
    let n = 100000;
    let mut p = Parameters {
        k2: 0.02,
        kd: 0.01,
        k1: 0.2,
    };
    let t = Instant::now();
    let mut s = 0.;
    for _ in 0..n {
        p.k1 *= 1.0000001;
        s += c.normal_equations(&p).error;
    }
    println!("csv normal {:?} {s}", t.elapsed() / n);
    let t = Instant::now();
    let mut s = 0.;
    for _ in 0..n {
        p.k1 *= 1.0000001;
        s += c.error(&p);
    }
    println!("csv error {:?} {s}", t.elapsed() / n);
    let t = Instant::now();
    let mut s = 0.;
    for _ in 0..n {
        p.k1 *= 1.0000001;
        s += best_weights(&c, p.k1).error;
    }
    println!("csv profile {:?} {s}", t.elapsed() / n);
}
#[test]
fn fits() {
    use brdf_fit::*;
    let text = std::fs::read_to_string("/work/shared/data/expected_optima.csv").unwrap();
    for l in text.lines().skip(1) {
        let f: Vec<&str> = l.split(',').collect();
        if f[0].contains("ansys") && f[1] != "0.5" {
            continue;
        }
        let v: Vec<f64> = f[1..].iter().map(|x| x.parse().unwrap()).collect();
        let m = Measurements::read_csv(format!("/work/shared/data/{}", f[0])).unwrap();
        let m = m
            .by_wavelength()
            .into_iter()
            .find(|m| m.wavelengths()[0] == Some(v[0]))
            .unwrap();
        let mut o = FitOptions {
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..Default::default()
        };
        let r = fit(&m, &o).unwrap();
        let t = Instant::now();
        for _ in 0..100 {
            fit(&m, &o).unwrap();
        }
        let dt = t.elapsed() / 100;
        println!(
            "csv {} {} {dt:?} init {:?} {} | s1 {} {:.1e} {:?} {:.1}us | s2 {} {:.1e} {:?} {:.1}us gc {:.1}us {}",
            f[0],
            f[1],
            r.initial.parameters,
            r.initial,
            r.stage1.unwrap().iterations,
            r.stage1.unwrap().e_percent.own / v[8] - 1.,
            r.stage1.unwrap().ending,
            r.stage1.unwrap().seconds * 1e6,
            r.stage2.iterations,
            r.stage2.e_percent.own / v[3] - 1.,
            r.stage2.ending,
            r.stage2.seconds * 1e6,
            r.global_check.as_ref().unwrap().seconds * 1e6,
            r.global_check.as_ref().unwrap().lower_minimum_taken
        );
        for s1 in [Method::NelderMead, Method::LevenbergMarquardt] {
            for s2 in [Method::NelderMead, Method::LevenbergMarquardt] {
                o.stage1 = Some(s1);
                o.stage2 = s2;
                o.global_check = false;
                let r = fit(&m, &o).unwrap();
                let (a, b) = (
                    r.stage1.unwrap().e_percent.own / v[8] - 1.,
                    r.stage2.e_percent.own / v[3] - 1.,
                );
                if a > 1e-7 || b > 1e-7 {
                    println!(
                        "csv   BAD {s1} {s2} {a:.1e} {b:.1e} {:?} {:?}",
                        r.stage1, r.stage2
                    )
                }
            }
        }
    }
}
