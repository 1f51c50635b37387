// Tasks and commands: each calls the program on the file that is open.
const path = require("node:path");
const vscode = require("vscode");

const COMMANDS = { toml: ["check", "run", "watch"], rhai: ["check", "script"] };

/** The arguments of the program for a command on a file. */
function argumentsOf(command, file, more = []) {
  const isScript = file.endsWith(".rhai");
  const words = isScript ? (command === "check" ? ["script", "--check"] : ["script"]) : [command];
  return [...words, file, ...more];
}

/** A task that runs the program in the folder of the workspace and shows mistakes where they are. */
function task(definition, folder) {
  const program = vscode.workspace.getConfiguration("droptower").get("program", "droptower");
  const words = argumentsOf(definition.command, definition.file, definition.arguments);
  const execution = new vscode.ProcessExecution(program, words, { cwd: folder.uri.fsPath });
  const name = `${definition.command} ${definition.file}`;
  const made = new vscode.Task(definition, folder, name, "droptower", execution, "$droptower");
  made.group = definition.command === "check" ? vscode.TaskGroup.Build : undefined;
  made.isBackground = definition.command === "watch";
  return made;
}

/** The open file and the folder of its workspace; undefined where it belongs to none. */
function open() {
  const document = vscode.window.activeTextEditor?.document;
  const folder = document && vscode.workspace.getWorkspaceFolder(document.uri);
  if (!folder || !(document.languageId in COMMANDS)) return undefined;
  return { document, folder, file: path.relative(folder.uri.fsPath, document.uri.fsPath) };
}

function tasks() {
  const found = open();
  if (!found) return [];
  const { document, folder, file } = found;
  return COMMANDS[document.languageId].map((command) => task({ type: "droptower", command, file }, folder));
}

async function execute(command) {
  const found = open();
  if (!found) {
    vscode.window.showInformationMessage("droptower: open a scenario or a script of the workspace");
    return;
  }
  await found.document.save();
  const chosen = command === "run" && found.document.languageId === "rhai" ? "script" : command;
  await vscode.tasks.executeTask(task({ type: "droptower", command: chosen, file: found.file }, found.folder));
}

function activate(context) {
  context.subscriptions.push(
    vscode.tasks.registerTaskProvider("droptower", {
      provideTasks: tasks,
      resolveTask: (given) => (given.scope?.uri ? task(given.definition, given.scope) : undefined),
    }),
    vscode.commands.registerCommand("droptower.check", () => execute("check")),
    vscode.commands.registerCommand("droptower.run", () => execute("run")),
  );
}

module.exports = { activate, argumentsOf };
