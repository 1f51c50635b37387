// Writes grammar and snippets of Rhai, and the syntax of Vim, with the functions that the program knows.
//
//     node editors/vscode/generate.mjs [--check] < <(droptower explain functions --json)
//
// With --check it writes nothing, and fails where the files differ.
import { readFileSync, writeFileSync } from "node:fs";

const here = new URL(".", import.meta.url);
const functions = JSON.parse(readFileSync(0, "utf8"));
const names = new Set(functions.flatMap(({ call }) => [...call.matchAll(/([a-z_][a-z0-9_]*)\(/g)].map((found) => found[1])));

const words = (list) => `\\b(?:${list.join("|")})\\b`;
const grammar = {
  name: "Rhai",
  scopeName: "source.rhai",
  patterns: [{ include: "#code" }],
  repository: {
    code: {
      patterns: [
        "comments", "strings", "numbers", "declarations", "keywords", "constants", "maps", "calls", "operators", "braces",
      ].map((name) => ({ include: `#${name}` })),
    },
    comments: {
      patterns: [
        { name: "comment.line.documentation.rhai", match: "//[/!].*$" },
        { name: "comment.line.double-slash.rhai", match: "//.*$" },
        { name: "comment.block.rhai", begin: "/\\*", end: "\\*/", patterns: [{ include: "#nested" }] },
      ],
    },
    nested: { begin: "/\\*", end: "\\*/", patterns: [{ include: "#nested" }] },
    strings: {
      patterns: [
        { name: "string.quoted.double.rhai", begin: '"', end: '"', patterns: [{ include: "#escapes" }] },
        {
          name: "string.quoted.other.template.rhai",
          begin: "`",
          end: "`",
          patterns: [
            { match: "``" },
            { name: "meta.embedded.rhai", begin: "\\$\\{", end: "\\}", patterns: [{ include: "#code" }] },
          ],
        },
        { name: "string.quoted.single.rhai", match: "'(?:\\\\.[^']*|[^'\\\\])'" },
      ],
    },
    escapes: {
      name: "constant.character.escape.rhai",
      match: '\\\\(?:x[0-9A-Fa-f]{2}|u[0-9A-Fa-f]{4}|U[0-9A-Fa-f]{8}|[\\\\"ntr]|$)|""',
    },
    numbers: {
      name: "constant.numeric.rhai",
      match: "\\b(?:0[xX][0-9A-Fa-f_]+|0[oO][0-7_]+|0[bB][01_]+|[0-9][0-9_]*(?:\\.[0-9][0-9_]*)?(?:[eE][+-]?[0-9]+)?)\\b",
    },
    declarations: {
      patterns: [
        {
          match: "\\b(fn)\\s+([A-Za-z_][A-Za-z0-9_]*)",
          captures: { 1: { name: "keyword.declaration.rhai" }, 2: { name: "entity.name.function.rhai" } },
        },
        {
          match: "\\b(let|const)\\s+([A-Za-z_][A-Za-z0-9_]*)",
          captures: { 1: { name: "keyword.declaration.rhai" }, 2: { name: "variable.other.rhai" } },
        },
      ],
    },
    keywords: {
      patterns: [
        {
          name: "keyword.control.rhai",
          match: words("if else switch while loop do until for in continue break return throw try catch import export as".split(" ")),
        },
        { name: "keyword.declaration.rhai", match: words(["let", "const", "fn", "private", "global"]) },
        { name: "variable.language.rhai", match: "\\bthis\\b" },
      ],
    },
    constants: { name: "constant.language.rhai", match: "\\b(?:true|false)\\b|\\(\\)" },
    maps: { begin: "#\\{", end: "\\}", patterns: [{ include: "#keys" }, { include: "#code" }] },
    keys: { name: "variable.other.property.rhai", match: "[A-Za-z_][A-Za-z0-9_]*(?=\\s*:)" },
    calls: {
      patterns: [
        { name: "support.function.droptower.rhai", match: `\\b(?:${[...names].sort().join("|")})(?=\\s*!?\\()` },
        { name: "entity.name.function.call.rhai", match: "\\b[a-z_][A-Za-z0-9_]*(?=\\s*!?\\()" },
      ],
    },
    // Braces nest, so that the end of an interpolation is found.
    braces: { begin: "\\{", end: "\\}", patterns: [{ include: "#code" }] },
    operators: { name: "keyword.operator.rhai", match: "[-+*/%=<>!&|^~?]+|\\.\\.=?" },
  },
};

/** The calls of an entry, which lists several between commas. */
function calls(text) {
  const found = [""];
  let depth = 0;
  for (const letter of text) {
    depth += "([{".includes(letter) ? 1 : ")]}".includes(letter) ? -1 : 0;
    if (depth === 0 && letter === ",") found.push("");
    else found[found.length - 1] += letter;
  }
  return found.map((call) => call.trim()).filter((call) => /[a-z_][a-z0-9_]*\(/.test(call) && !call.startsWith("#{"));
}

const snippets = {};
for (const { call: entry, gives, example } of functions) {
  for (const call of calls(entry)) {
    const [, name, inner] = /([a-z_][a-z0-9_]*)\((.*)\)/s.exec(call);
    const argument = inner && `\${1:${inner.replace(/[\\$}]/g, "\\$&")}}`;
    snippets[call] = { prefix: name, body: `${name}(${argument})`, description: `${gives}\n\n${example}` };
  }
}

const vim = `" Functions of droptower, written by editors/vscode/generate.mjs.
syntax match rhaiDroptower "\\<\\%(${[...names].sort().join("\\|")}\\)\\ze\\s*!\\=("
`;
const json = (content) => `${JSON.stringify(content, null, 2)}\n`;

let differs = false;
for (const [path, text] of [
  ["syntaxes/rhai.tmLanguage.json", json(grammar)],
  ["snippets/rhai.json", json(snippets)],
  ["../vim/syntax/rhai-droptower.vim", vim],
]) {
  const file = new URL(path, here);
  if (!process.argv.includes("--check")) writeFileSync(file, text);
  else if (readFileSync(file, "utf8") !== text) {
    console.error(`editors/vscode/${path} is not what generate.mjs makes of the functions of this build`);
    differs = true;
  }
}
process.exitCode = differs ? 1 : 0;
