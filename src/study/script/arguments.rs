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
            .register_fn("number", Arguments::number)
            .register_fn("numbers", Arguments::numbers)
            .register_fn("text", Arguments::text)
            .register_fn("contains", |args: &mut Arguments, name: &str| args.0.contains_key(name))
            .register_fn("keys", |args: &mut Arguments| {
                args.0.keys().map(|name| name.as_str().into()).collect::<Array>()
            });
    }

    /// The number `name`, or else `otherwise`.
    fn number(&mut self, name: &str, otherwise: Dynamic) -> HostResult<Dynamic> {
        match self.0.get(name) {
            None => Ok(otherwise),
            Some(value) if value.is_int() || value.is_float() => Ok(value.clone()),
            Some(value) => Err(refuse(format!("--arg {name}: expected a number, found `{value}`{}", comma(value)))),
        }
    }

    /// The numbers `name`, as many as `otherwise` has, which these are where the argument is not given.
    fn numbers(&mut self, name: &str, otherwise: Array) -> HostResult<Array> {
        let Some(value) = self.0.get(name) else { return Ok(otherwise) };
        let text = value.to_string();
        let numbers: Option<Array> =
            text.split(',').map(|number| number.trim().parse::<f64>().ok().map(Dynamic::from)).collect();
        let count = otherwise.len();
        numbers.filter(|numbers| numbers.len() == count).ok_or_else(|| {
            let example = otherwise.iter().map(Dynamic::to_string).collect::<Vec<_>>().join(", ");
            refuse(format!("--arg {name}: expected {count} numbers, such as {example}, found `{text}`"))
        })
    }

    /// The text `name`, or else `otherwise`.
    fn text(&mut self, name: &str, otherwise: &str) -> ImmutableString {
        self.0.get(name).map_or_else(|| otherwise.into(), |value| value.to_string().into())
    }

    fn get(&mut self, name: ImmutableString) -> HostResult<Dynamic> {
        let how = if name == "scenario" { "--scenario FILE".into() } else { format!("--arg {name}=…") };
        self.0.get(name.as_str()).cloned().ok_or_else(|| refuse(format!("the script needs `{name}`: give {how}")))
    }
}

/// A hint where the value is a number with a decimal comma.
fn comma(value: &Dynamic) -> &'static str {
    let text = value.to_string();
    let is_decimal = text.matches(',').count() == 1 && text.replace(',', ".").parse::<f64>().is_ok();
    if is_decimal { " (write a decimal point)" } else { "" }
}
