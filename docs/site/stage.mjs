// Lays out the sources of the book: stage.mjs REPOSITORY FOLDER DROPTOWER
//
// Documents keep their paths, so that their links hold as they are. Files of the repository that they name become pages;
// pictures are copied.
import { cpSync, mkdirSync, readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import path from "node:path";
import { reference } from "./reference.mjs";

const [repository, folder, droptower] = process.argv.slice(2);
const PICTURES = [".png", ".svg", ".webp"];
// Names of languages as the highlighter of mdBook knows them; its `javascript` reads Rhai.
const LANGUAGES = { ".toml": "toml", ".rhai": "javascript", ".rs": "rust", ".json": "json", ".py": "python" };

function write(page, text) {
  const file = path.join(folder, page);
  mkdirSync(path.dirname(file), { recursive: true });
  writeFileSync(file, text);
}

/** Replaces the targets of links outside of code: `change` is given a target without its fragment. */
function relink(text, change) {
  const parts = text.split(/(^(?:```|~~~)[^]*?^(?:```|~~~)|`[^`\n]*`)/m);
  const link = (_, target, fragment = "") => `](${change(target)}${fragment})`;
  return parts.map((part, at) => (at % 2 ? part : part.replace(/\]\(([^)\s#]+)(#[^)\s]*)?\)/g, link))).join("");
}

const isOutside = (target) => /^[a-z]+:/.test(target);
const pageOf = (file) => `${file}.md`;

/** The page of a file, or of the files in a folder. */
function filePage(file) {
  const whole = path.join(repository, file);
  if (statSync(whole).isDirectory()) {
    const names = readdirSync(whole).filter((name) => statSync(path.join(whole, name)).isFile()).sort();
    names.forEach((name) => named.add(path.join(file, name)));
    return `# ${file}\n\n${names.map((name) => `- [${name}](${path.basename(file)}/${pageOf(name)})`).join("\n")}\n`;
  }
  const text = readFileSync(whole, "utf8");
  const language = LANGUAGES[path.extname(file)] ?? "text";
  return `# ${file}\n\n\`\`\`\`\`${language}\n${text.trimEnd()}\n\`\`\`\`\`\n`;
}

const summary = relink(readFileSync(path.join(repository, "docs/site/SUMMARY.md"), "utf8"), (target) =>
  path.normalize(path.join("docs/site", target)),
);
const chapters = [...summary.matchAll(/\]\(([^)]+)\)/g)].map(([, target]) => target);
/** Files that are not chapters, in the order in which they are named. */
const named = new Set();
for (const chapter of chapters) {
  const text = readFileSync(path.join(repository, chapter), "utf8");
  const linked = relink(text, (target) => {
    if (isOutside(target)) return target;
    const file = path.normalize(path.join(path.dirname(chapter), target));
    if (chapters.includes(file)) return target;
    if (PICTURES.includes(path.extname(file))) {
      cpSync(path.join(repository, file), path.join(folder, file));
      return target;
    }
    if (file.endsWith(".md")) throw new Error(`${chapter} names ${file}, which docs/site/SUMMARY.md does not list`);
    named.add(file.replace(/\/$/, ""));
    return pageOf(target.replace(/\/$/, ""));
  });
  write(chapter, linked);
}

// A set is iterated to the members that are added meanwhile.
const files = [];
for (const file of named) {
  write(pageOf(file), filePage(file));
  files.push(`- [${file}](${pageOf(file)})`);
}
const written = reference(droptower);
for (const [page, text] of written.pages) write(page, text);
const [before, between, after] = summary.split(/<!--[^]*?-->/);
write("SUMMARY.md", [before, written.summary, between, files.sort().join("\n"), after].join("\n"));
