// Reads scripts with the tokenizer of VS Code: tokens.mjs EXTENSION SCRIPTS
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import assert from "node:assert/strict";
import oniguruma from "vscode-oniguruma";
import textmate from "vscode-textmate";

const [extension, scripts] = process.argv.slice(2);
const wasm = createRequire(import.meta.url).resolve("vscode-oniguruma/release/onig.wasm");
await oniguruma.loadWASM(readFileSync(wasm).buffer);
const source = path.join(extension, "syntaxes/rhai.tmLanguage.json");
const registry = new textmate.Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async () => textmate.parseRawGrammar(readFileSync(source, "utf8"), source),
});
const grammar = await registry.loadGrammar("source.rhai");

/** Tokens of a text: [text, scopes], and the depth of the rules that are open at its end. */
function read(text) {
  let state = textmate.INITIAL;
  const tokens = [];
  for (const line of text.split("\n")) {
    const found = grammar.tokenizeLine(line, state);
    for (const { startIndex, endIndex, scopes } of found.tokens) tokens.push([line.slice(startIndex, endIndex), scopes]);
    state = found.ruleStack;
  }
  return { tokens, depth: state.depth };
}
function scope(text, word) {
  const found = read(text).tokens.find(([token]) => token.trim() === word);
  assert.ok(found, `${word} is a token of ${text}`);
  return found[1].at(-1);
}

for (const [text, word, expected] of [
  ["let x = 1.5e-3;", "1.5e-3", "constant.numeric.rhai"],
  ["let x = 1.5e-3;", "let", "keyword.declaration.rhai"],
  ["fn area(a) { a }", "area", "entity.name.function.rhai"],
  ["simulate_all(list)", "simulate_all", "support.function.droptower.rhai"],
  ["scenario(path).with(#{ a: 1 })", "with", "support.function.droptower.rhai"],
  ["#{ mass: 2 }", "mass", "variable.other.property.rhai"],
  ["`a ${minimize(x)} b`", "minimize", "support.function.droptower.rhai"],
  ["`a ${#{ b: `c` }.b} d` + x.mean()", "mean", "support.function.droptower.rhai"],
  ["/* a /* b */ while */ 1", "1", "constant.numeric.rhai"],
  ["//! what it does", "//! what it does", "comment.line.documentation.rhai"],
  ['let a = "let // x"; // y', 'let // x', "string.quoted.double.rhai"],
  ['"a \\" b".len()', "len", "support.function.droptower.rhai"],
  ["for i in 0..3 { break; }", "break", "keyword.control.rhai"],
]) {
  assert.equal(scope(text, word), expected, text);
}

let known = 0;
for (const name of readdirSync(scripts, { recursive: true }).filter((name) => name.endsWith(".rhai"))) {
  const { tokens, depth } = read(readFileSync(path.join(scripts, name), "utf8"));
  assert.equal(depth, 1, `${name}: a string, comment or brace does not end`);
  known += tokens.filter(([, scopes]) => scopes.at(-1) === "support.function.droptower.rhai").length;
}
assert.ok(known > 100, "functions of droptower are seen in its scripts");
