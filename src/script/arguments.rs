use rhai::{Array, Dynamic, Engine, ImmutableString, Map};

use super::{HostResult, refuse};

/// The arguments of a script on the command line, which it reads as `args`.
#[derive(Clone, Debug, Default)]
pub struct Arguments(Map);

impl Arguments {
    /// The arguments by name.
    pub fn new(values: Map) -> Arguments {
        Arguments(values)
    }

    /// Offers the type of `args` to scripts: `args.name`, `"name" in args`, `args.keys()`.
    pub fn register(engine: &mut Engine) {
        engine
            .register_type_with_name::<Arguments>("arguments")
            .register_indexer_get(Arguments::get)
            .register_fn("contains", |args: &mut Arguments, name: &str| args.0.contains_key(name))
            .register_fn("keys", |args: &mut Arguments| {
                args.0.keys().map(|name| name.as_str().into()).collect::<Array>()
            });
    }

    fn get(&mut self, name: ImmutableString) -> HostResult<Dynamic> {
        let how = if name == "scenario" { "--scenario FILE".into() } else { format!("--arg {name}=…") };
        self.0.get(name.as_str()).cloned().ok_or_else(|| refuse(format!("the script needs `{name}`: give {how}")))
    }
}
