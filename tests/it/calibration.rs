//! `calibrate` in scripts: several tests, verdicts, closed forms of the posterior, mistakes.

use droptower::calibrate;
use droptower::functions;
use droptower::identify::{self, SearchHost};
use droptower::scenario_functions::{self, Scenarios};
use droptower::script::{Limits, OutputCollector, ScriptOutput};
use rhai::{Dynamic, Engine};

/// An interpreter with `calibrate`, and what it leaves.
fn engine() -> (Engine, OutputCollector) {
    let (collector, host) = (OutputCollector::new(Vec::new()), SearchHost::new(None, |_| {}));
    let mut engine = functions::engine(Limits::STUDY);
    functions::register_output(&mut engine, &collector);
    functions::register_reading(&mut engine);
    scenario_functions::register(&mut engine, &Scenarios::default());
    identify::register(&mut engine, &host);
    calibrate::register(&mut engine, &Scenarios::default(), &host, &collector);
    (engine, collector)
}

/// What a script gives, and its output. `pulled` is a strip that is pulled to 20 %, `recorded` its force over the travel.
fn run(text: &str) -> Result<(Dynamic, ScriptOutput), String> {
    let (engine, collector) = engine();
    let helpers = r#"
        fn strip(direction) {
            scenario("scenarios/stretch/single-element.toml").with(#{
                "loading.stretch.direction": direction, "loading.stretch.until": 0.2 })
        }
        fn recorded(test, noise, seed) {
            let run = test.simulate();
            let random = random(seed);
            let travel = run.displacement.values();
            let places = [];
            let forces = [];
            let last = -1.0;
            for (force, place) in run.force.values() {
                if travel[place] > last {
                    last = travel[place];
                    places.push(last);
                    forces.push(force + noise * random.normal());
                }
            }
            #{ force: signal(places, forces) }
        }
    "#;
    let found = engine.eval::<Dynamic>(&format!("{helpers}\n{text}")).map_err(|error| error.to_string())?;
    Ok((found, collector.output()))
}

fn numbers(text: &str) -> Vec<f64> {
    let (found, _) = run(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let list = found.into_array().expect("a list");
    list.into_iter().map(|item| item.as_float().expect("a number")).collect()
}

/// The force is proportional to the thickness, so that with noise of a share s of the signal and n bins the relative standard
/// deviation of the thickness is s/√n, of the linear model and of the posterior.
#[test]
fn the_deviation_of_a_linear_parameter_is_that_of_the_closed_form() {
    let found = numbers(
        r#"let test = strip("MD");
           let found = calibrate(#{
               tests: [#{ scenario: test, recordings: recorded(test, 0.0, 1), noise: 0.02 }],
               parameters: #{ thickness: #{ key: "specimen.material.thickness", start: "11 um", within: ["6 um", "20 um"] } },
               discrepancy: 0 });
           let after = found.posterior()[0];
           [found.x.thickness, found.parameters[0].half_width, after.median, after.deviation, after.lower_95, after.upper_95,
               found.tests[0].bins * 1.0]"#,
    );
    let expected = 0.02 / found[6].sqrt();
    assert!((found[0] - 12.0).abs() < 1e-3 * 12.0, "{found:?}");
    assert!((found[1] / (1.96 * expected) - 1.0).abs() < 0.01, "{found:?}");
    // Of a thousand independent samples and more.
    assert!((found[2] / 12.0 - 1.0).abs() < 0.2 * expected, "{found:?}");
    assert!((found[3] / 12.0 / expected - 1.0).abs() < 0.08, "{found:?}");
    let half = 0.5 * (found[5] - found[4]) / 12.0;
    assert!((half / (1.96 * expected) - 1.0).abs() < 0.1, "{found:?}");
}

/// A strip in MD and one in TD share ky; each has a thickness of its own, one of them logarithmic and with a prior.
#[test]
fn tests_share_parameters_and_have_their_own() {
    let text = r#"
        let md = strip("MD");
        let td = strip("TD");
        let truth = #{ "specimen.material.thickness": "13 um", "specimen.material.fabric.scale.ky": 1.2 };
        let found = calibrate(#{
            name: "both",
            tests: [
                #{ scenario: md, name: "md", recordings: [recorded(md.with(truth), 2e-3, 1), recorded(md.with(truth), 2e-3, 2)],
                   own: ["thickness"] },
                #{ scenario: td, name: "td", recordings: recorded(td.with(truth + #{ "specimen.material.thickness": "11 um" }), 2e-3, 3),
                   own: ["thickness"], weight: 2 },
            ],
            parameters: #{
                thickness: #{ key: "specimen.material.thickness", start: "12 um", within: ["6 um", "20 um"], log: true,
                    prior: #{ normal: #{ mean: 12, deviation: 3 } } },
                ky: #{ key: "specimen.material.fabric.scale.ky", start: 1, within: [0.5, 2] },
            },
        });
        [found.x["thickness of md"], found.x["thickness of td"], found.x.ky, found.tests.len() * 1.0, found.test("td").model.thickness[0] * 1e6]"#;
    let found = numbers(text);
    for (value, expected) in found.iter().zip([13.0, 11.0, 1.2, 3.0, 11.0]) {
        assert!((value / expected - 1.0).abs() < 0.02, "{found:?}");
    }
    let (_, output) = run(text).unwrap();
    let tables: Vec<&str> = output.tables.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(tables, ["both_parameters", "both_tests"]);
}

/// Of a strip in MD: the thickness and a stiffness multiply each other, and a curve of TD does not act at all.
#[test]
fn verdicts_say_what_the_tests_do_not_determine() {
    let text = r#"
        let md = strip("MD");
        let found = calibrate(#{
            tests: [#{ scenario: md, recordings: recorded(md, 5e-3, 1) }],
            parameters: #{
                thickness: #{ key: "specimen.material.thickness", start: "12 um", within: ["6 um", "20 um"] },
                width: #{ key: "specimen.material.fabric.td.scale.k1", start: 1, within: [0.5, 2] },
                ky: #{ key: "specimen.material.fabric.md.scale.ky", start: 1, within: [0.5, 2] },
            }, discrepancy: 0.02, starts: 1, max_evaluations: 60 });
        let settled = found.settles([#{ scenario: strip("TD"), name: "td" }]);
        [found.parameters.map(|row| row.verdict), found.findings.map(|found| found.code),
         settled.map(|row| row.candidate + " " + row.parameter), settled.map(|row| row.reduction)]"#;
    let (found, _) = run(text).unwrap_or_else(|error| panic!("{error}"));
    let found = found.into_array().unwrap();
    let texts = |index: usize| -> Vec<String> {
        found[index].clone().into_array().unwrap().into_iter().map(|item| item.to_string()).collect()
    };
    println!("{found:?}");
    let verdicts = texts(0);
    assert_eq!(verdicts.len(), 3);
    let of = |name: &str| texts(2).iter().position(|own| own.ends_with(name)).unwrap();
    assert_eq!(verdicts[of("width")], "not determined by these tests", "{verdicts:?}");
    assert!(texts(1).contains(&"not-determined".to_owned()), "{:?}", texts(1));
    let reduction: f64 = texts(3)[of("width")].parse().unwrap();
    assert!(reduction > 0.5, "a strip in TD tells its stiffness: {reduction}");
}

/// One mistake each, and the words that name it.
#[test]
fn mistakes_are_named_before_any_search() {
    let test = r#"let md = strip("MD"); let own = #{ scenario: md, name: "md", recordings: recorded(md, 0.0, 1) };
        let k = #{ key: "specimen.material.fabric.scale.k1", start: 1, within: [0.5, 2] };"#;
    for (call, expected) in [
        ("#{ tests: [], parameters: #{ k: k } }", "`tests` of calibrate is a list of one test or more"),
        ("#{ tests: [own], parameters: #{} }", "`parameters` of calibrate is a map of names and their `key`s"),
        ("#{ tests: [own], parameter: #{ k: k } }", "calibrate has no option `parameter`"),
        ("#{ tests: [own, own], parameters: #{ k: k } }", "two tests are called `md`"),
        ("#{ tests: [own + #{ own: \"q\" }], parameters: #{ k: k } }", "has its own `q`, which is no parameter"),
        ("#{ tests: [own], parameters: #{ k: k + #{ key: \"impactor.mas\" } } }", "test `md` at the start"),
        ("#{ tests: [own], parameters: #{ k: k + #{ tests: [\"mf\"] } } }", "names the test `mf`; there are md"),
        (
            "#{ tests: [own + #{ compare: \"forse\" }], parameters: #{ k: k } }",
            "no signal `forse` (did you mean `force`?)",
        ),
        ("#{ tests: [own + #{ distance: \"far\" }], parameters: #{ k: k } }", "there is no distance `far`"),
        ("#{ tests: [own], parameters: #{ k: k }, discrepancy: 2 }", "the share of `discrepancy`"),
        ("#{ tests: [own], parameters: #{ k: k }, stages: [#{ a: 1 }] }", "the last of `stages` is #{}"),
        ("#{ tests: [own], parameters: #{ k: k }, noise: \"little\" }", "`noise` is \"from the recordings\""),
        ("#{ tests: [#{ scenario: md }], parameters: #{ k: k } }", "name its `recordings`"),
    ] {
        let error = run(&format!("{test} calibrate({call})")).unwrap_err();
        assert!(error.contains(expected), "{call}: {error}");
    }
}
