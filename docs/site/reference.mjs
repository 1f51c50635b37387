// Pages of reference, written from what the program tells of itself.
import { execFileSync } from "node:child_process";

/** Files with keys, besides scenarios: the word of `explain`, and what they are. */
const FILES = { expect: "expect.toml" };
const SCHEMAS = ["scenario", "material", "expect"];

/** Markdown of a sentence with `code`: what else Markdown would read is escaped. */
function prose(text) {
  const parts = text.replace(/\s+/g, " ").split(/(`[^`]*`)/);
  return parts.map((part, at) => (at % 2 ? part : part.replace(/[\\<>*_[\]$]/g, "\\$&"))).join("").replaceAll("|", "\\|");
}

const code = (text) => (text.includes("`") ? `\`\` ${text} \`\`` : `\`${text}\``).replaceAll("|", "\\|");
const anchor = (name) => name.replaceAll(".", "-").replace(/[^\w-]/g, "");
const row = (cells) => `| ${cells.join(" | ")} |`;

/** Keys by the table that holds them, in the order of the program. */
function tables(keys) {
  const found = new Map();
  for (const key of keys) {
    const table = key.key.split(".").slice(0, -1).join(".");
    if (!found.has(table)) found.set(table, []);
    found.get(table).push(key);
  }
  return found;
}

/** What may be written, in words. */
function value({ expected, unit, range, likely, default: given, required }) {
  const facts = [prose(expected)];
  if (unit && unit !== "1") facts.push(`a bare number is in ${prose(unit)}`);
  if (range) facts.push(prose(range));
  if (likely) facts.push(`usually ${prose(likely)}`);
  if (given !== null) facts.push(`default ${code(typeof given === "string" ? given : JSON.stringify(given))}`);
  if (required) facts.push("**required**");
  return facts.join("; ");
}

function meaning({ sentence, choices, refused_beside: beside }) {
  const words = choices.filter(({ sentence }) => sentence).map(({ word, sentence }) => `${code(word)}: ${prose(sentence)}`);
  const refused = beside.length ? `Refused beside: ${prose(beside.join("; "))}.` : "";
  return [prose(sentence ?? ""), ...words, refused].filter(Boolean).join("<br>");
}

/** A page of the keys under `root`, and of those that `seen` knows a link to them. */
function keyPage(root, keys, page, seen) {
  const byTable = tables(keys);
  const lines = [`# ${code(root)}`, ""];
  const own = keys.find(({ key }) => key === root);
  if (own) lines.push(prose(own.sentence ?? ""), "", `${value(own)}.`, "");
  if (own && meaning(own) !== prose(own.sentence ?? "")) lines.push(meaning(own), "");
  const skipped = [];
  for (const [table, members] of byTable) {
    if (table === "") continue;
    if (skipped.some((other) => table.startsWith(`${other}.`))) continue;
    const below = keys.filter(({ key }) => key.startsWith(`${table}.`));
    const content = JSON.stringify(below.map((key) => ({ ...key, key: key.key.slice(table.length) })));
    if (table !== root) lines.push(`## ${code(table)} {#${anchor(table)}}`, "");
    const same = seen.get(content);
    if (same && table !== root) {
      lines.push(`Has the keys of [${code(same.table)}](${same.page}#${anchor(same.table)}).`, "");
      skipped.push(table);
      continue;
    }
    seen.set(content, { table, page });
    lines.push(row(["Key", "Value", "Meaning"]), row(["---", "---", "---"]));
    for (const key of members) {
      const name = key.key.slice(table.length + 1);
      const holds = byTable.has(key.key);
      const shown = holds ? `[${code(name)}](#${anchor(key.key)})` : `<a id="${anchor(key.key)}"></a>${code(name)}`;
      lines.push(row([shown, value(key), meaning(key)]));
    }
    lines.push("");
  }
  return lines.join("\n");
}

function keyPages(ask) {
  const keys = ask("explain", "keys", "--json");
  const tops = keys.filter(({ key }) => !key.includes("."));
  const under = (root) => keys.filter(({ key }) => key === root || key.startsWith(`${root}.`));
  const seen = new Map();
  const pages = [];
  const index = ["# Keys", "", "Keys of a scenario. A value is a number in the SI unit, or a string with its unit: `\"12 um\"`.", ""];
  index.push(row(["Key", "Value", "Meaning"]), row(["---", "---", "---"]));
  for (const top of tops) {
    const held = under(top.key);
    if (held.length > 1) {
      pages.push([top.key, keyPage(top.key, held, `${top.key}.md`, seen)]);
      index.push(row([`[${code(top.key)}](${top.key}.md)`, value(top), meaning(top)]));
    } else {
      index.push(row([`<a id="${anchor(top.key)}"></a>${code(top.key)}`, value(top), meaning(top)]));
    }
  }
  index.push("", "Other files have keys too:", "");
  for (const [word, file] of Object.entries(FILES)) {
    pages.push([file, keyPage(word, ask("explain", word, "--json"), `${file}.md`, seen).replace(/^# .*/, `# ${code(file)}`)]);
    index.push(`- [${code(file)}](${file}.md)`);
  }
  index.push("", "Schemas for editors, as `droptower schema` prints them: ");
  index.push(SCHEMAS.map((kind) => `[${kind}](schema/${kind}.json)`).join(", "), "");
  return { index: index.join("\n"), pages };
}

function functionPage(ask) {
  const lines = ["# Functions of scripts", "", "What a script can call, each with an example that runs. The language is that of [Rhai](https://rhai.rs);", "[Studies](../docs/studies.md) introduces it.", ""];
  let last = "";
  for (const { chapter, call, gives, example } of ask("explain", "functions", "--json")) {
    if (chapter !== last) lines.push(`## ${prose(chapter)}`, "");
    last = chapter;
    const level = example.split("\n").slice(1).filter((line) => line.trim()).map((line) => line.search(/\S/));
    const indent = level.length ? Math.min(...level) : 0;
    const [first, ...others] = example.split("\n");
    const shown = [first, ...others.map((line) => `    ${line.slice(indent)}`)].join("\n");
    lines.push(`<div class="call">\n\n${code(call)}\n\n</div>\n`, `${prose(gives)}.`, "", "```rhai", shown, "```", "");
  }
  return lines.join("\n");
}

function findingPage(ask) {
  const lines = ["# Findings", "", "What a run, a search or a reduction reports although it continues.", ""];
  for (const { name, severity, meaning, remedy } of ask("explain", "findings", "--json")) {
    lines.push(`## ${code(name)} {#${name}}`, "", `${prose(severity)}: ${prose(meaning)}.`, "", `What to do: ${prose(remedy)}.`, "");
  }
  return lines.join("\n");
}

function columnPage(ask) {
  const lines = ["# Columns", "", "The columns of a run. Of several impactors, each column of an impactor begins with its name:", "`head_displacement_m`.", ""];
  let last = "";
  for (const { column, file, unit, sentence, when, script } of ask("explain", "columns", "--json")) {
    if (file !== last) lines.push("", `## ${code(file)}`, "", row(["Column", "Unit", "Meaning", "In scripts"]), row(["---", "---", "---", "---"]));
    last = file;
    const shown = `<a id="${column}"></a>${code(column)}`;
    lines.push(row([shown, prose(unit), `${prose(sentence)} It is there ${prose(when)}.`, code(script)]));
  }
  return lines.join("\n");
}

/** The help of a command: [what stands before its options, its options]. */
function help(tell, command) {
  const text = tell("help", ...command).trimEnd();
  const at = text.indexOf("\nOptions:\n");
  const options = at < 0 ? "" : text.slice(at + "\nOptions:\n".length);
  return [at < 0 ? text : text.slice(0, at).trimEnd(), options.split(/\n(?= {2,6}-)/).map((option) => option.trimEnd())];
}

function commandPage(tell) {
  const [top, common] = help(tell, []);
  const nameOf = (option) => /--[a-z-]+/.exec(option)?.[0];
  const shared = new Set(common.map(nameOf).filter((name) => name !== "--version"));
  const block = (text) => ["```text", text, "```", ""];
  const lines = ["# Commands and options", "", "What `droptower help` prints; [Results](../docs/results.md#exit-status) has the exit status.", ""];
  lines.push(...block(`${top}\n\nOptions of every command:\n${common.join("\n\n")}`));
  const describe = (command, depth) => {
    const [text, options] = help(tell, command);
    lines.push(`${"#".repeat(depth)} ${code(command.join(" "))} {#${command.join("-")}}`, "");
    const own = options.filter((option) => option && !shared.has(nameOf(option)));
    const [uses, list] = text.split(/\n(?=Commands:\n)/);
    const names = [...(list ?? "").matchAll(/^ {2}([a-z][\w-]*)/gm)].map(([, name]) => name).filter((name) => name !== "help");
    lines.push(...block([uses.trimEnd(), own.length ? `Options:\n${own.join("\n\n")}` : ""].filter(Boolean).join("\n\n")));
    for (const name of names) describe([...command, name], Math.min(depth + 1, 4));
  };
  const commands = [...top.matchAll(/^ {2}([a-z][\w-]*)/gm)].map(([, name]) => name).filter((name) => name !== "help");
  for (const name of commands) describe([name], 2);
  return lines.join("\n");
}

/** Pages of reference by path, and their lines of the summary. */
export function reference(droptower) {
  const tell = (...words) => execFileSync(droptower, words, { encoding: "utf8", maxBuffer: 1 << 26 });
  const ask = (...words) => JSON.parse(tell(...words));
  const keys = keyPages(ask);
  const pages = [
    ["reference/keys.md", keys.index],
    ...keys.pages.map(([name, text]) => [`reference/${name}.md`, text]),
    ["reference/functions.md", functionPage(ask)],
    ["reference/findings.md", findingPage(ask)],
    ["reference/columns.md", columnPage(ask)],
    ["reference/options.md", commandPage(tell)],
    ...SCHEMAS.map((kind) => [`reference/schema/${kind}.json`, tell("schema", kind)]),
  ];
  const summary = [
    "- [Keys](reference/keys.md)",
    ...keys.pages.map(([name]) => `    - [${name}](reference/${name}.md)`),
    "- [Functions of scripts](reference/functions.md)",
    "- [Columns](reference/columns.md)",
    "- [Findings](reference/findings.md)",
    "- [Commands and options](reference/options.md)",
  ];
  return { pages, summary: summary.join("\n") };
}
