/// One line of the scripting reference.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// How it is written, e.g. `signal.at(t)`.
    pub call: &'static str,
    /// What it gives, with units.
    pub gives: &'static str,
    /// A script that ends in `true`; the tests run it.
    pub example: &'static str,
}

/// The lines of the reference that belong together.
#[derive(Clone, Copy, Debug)]
pub struct Chapter {
    pub title: &'static str,
    pub entries: &'static [Entry],
}

#[cfg(test)]
pub(super) mod check {
    use rhai::Engine;

    use crate::script::{Limits, OutputCollector, register_recordings};

    /// The interpreter with everything that the module offers.
    pub fn engine() -> Engine {
        let mut engine = crate::script::engine(Limits::POST);
        register_recordings(&mut engine);
        OutputCollector::new(vec!["steps".into()], |_| {}).register(&mut engine);
        engine
    }

    /// Every script is refused with the words beside it.
    pub fn assert_refused(engine: &Engine, cases: &[(&str, &str)]) {
        for (text, expected) in cases {
            let error = engine.run(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{text} gave: {error}");
        }
    }
}

#[cfg(test)]
mod tests {
    use rhai::{Map, Scope};

    use super::check::engine;
    use crate::script::REFERENCE;

    #[test]
    fn the_examples_hold() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.csv");
        std::fs::write(&path, "time [ms],acceleration [g]\n0,1\n1,2\n").unwrap();
        let mut scope = Scope::new();
        scope.push_constant("args", Map::from([("recording".into(), path.to_string_lossy().into_owned().into())]));
        let engine = engine();
        for entry in REFERENCE.iter().flat_map(|chapter| chapter.entries) {
            let held = engine.eval_with_scope::<bool>(&mut scope.clone(), entry.example);
            assert!(matches!(held, Ok(true)), "{}: {held:?}", entry.call);
        }
    }
}
