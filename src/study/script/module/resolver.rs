//! Gives the interpreter the modules of the program that it runs.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rhai::{
    AST, ASTFlags, Engine, EvalAltResult, FnNamespace, GlobalRuntimeState, Module, ModuleResolver, Position, Scope,
    Shared, Stmt,
};

use super::{SourceText, Unit};

type Resolved = Result<Shared<Module>, Box<EvalAltResult>>;

/// The program that an engine runs. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub(in crate::script) struct Programs(Arc<Mutex<State>>);

#[derive(Debug, Default)]
struct State {
    units: Vec<Unit>,
    /// Modules by their names, once their constants have values.
    evaluated: BTreeMap<String, Shared<Module>>,
}

impl Programs {
    /// Runs these from now on. Modules that stay the same keep their constants.
    pub fn install(&self, units: &[Unit]) {
        let mut state = self.state();
        let same = |name: &str| {
            let text =
                |units: &[Unit]| units.iter().find(|unit| unit.name == name).map(|unit| unit.source.text.clone());
            text(units) == text(&state.units)
        };
        let is_same: Vec<bool> = units.iter().skip(1).map(|unit| same(&unit.name)).collect();
        if !is_same.into_iter().all(|same| same) {
            state.evaluated.clear();
        }
        state.units = units.to_vec();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The text whose interpreter's name is `id`, or in which a function without a name is written, whatever the interpreter takes for its
/// text: where a module calls it, that of the module.
pub(in crate::script) fn find<'u>(units: &'u [Unit], id: Option<&str>, function: Option<&str>) -> Option<&'u Unit> {
    let closure = function.filter(|name| Unit::is_closure(name));
    let writes = |unit: &&Unit| closure.is_some_and(|name| unit.program.iter_functions().any(|own| own.name == name));
    units.iter().find(writes).or_else(|| units.iter().find(|unit| id.is_some_and(|id| unit.source.id() == id)))
}

/// The resolver of an engine whose session has these programs.
pub(in crate::script) struct Resolver(pub Programs);

impl ModuleResolver for Resolver {
    fn resolve(&self, engine: &Engine, _: Option<&str>, name: &str, position: Position) -> Resolved {
        let mut global = engine.new_global_runtime_state();
        self.resolve_raw(engine, &mut global, &mut Scope::new(), name, position)
    }

    fn resolve_raw(
        &self,
        engine: &Engine,
        global: &mut GlobalRuntimeState,
        _: &mut Scope,
        name: &str,
        position: Position,
    ) -> Resolved {
        let unit = {
            let state = self.0.state();
            if let Some(module) = state.evaluated.get(name) {
                return Ok(Shared::clone(module));
            }
            state.units.iter().skip(1).find(|unit| unit.name == name).cloned()
        };
        let unit = unit.ok_or_else(|| EvalAltResult::ErrorModuleNotFound(name.into(), position))?;
        let module = evaluate(engine, global, &exported(&unit.program, &unit.source))
            .map_err(|error| EvalAltResult::ErrorInModule(unit.source.id(), error, position))?;
        let module = Shared::new(module);
        self.0.state().evaluated.insert(name.into(), Shared::clone(&module));
        Ok(module)
    }
}

/// The program with all its constants exported.
fn exported(program: &AST, source: &SourceText) -> AST {
    let export = |statement: &Stmt| match statement {
        Stmt::Var(variable, flags, position) => Stmt::Var(variable.clone(), *flags | ASTFlags::EXPORTED, *position),
        other => other.clone(),
    };
    let mut program = AST::new(program.statements().iter().map(export), program.shared_lib().clone());
    program.set_source(source.id());
    program
}

fn evaluate(engine: &Engine, global: &mut GlobalRuntimeState, program: &AST) -> Result<Module, Box<EvalAltResult>> {
    let mut module = Module::eval_ast_as_new_raw(engine, &mut Scope::new(), global, program)?;
    // A function without a name that is returned to the script is found there by this.
    for closure in program.iter_fn_def().filter(|function| Unit::is_closure(&function.name)) {
        let hash = Module::new().set_script_fn(closure.clone());
        // Deprecated in favour of an interface for functions of the host.
        #[allow(deprecated)]
        module.update_fn_namespace(hash, FnNamespace::Global);
    }
    module.build_index();
    Ok(module)
}
