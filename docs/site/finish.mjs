// Finishes the pages that mdBook wrote: finish.mjs SITE
//
// Formulas become what KaTeX makes of them, so that a page needs no script for them; of the themes two are left.
import { copyFileSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import katex from "katex";

const [site] = process.argv.slice(2);
const KATEX = path.dirname(createRequire(import.meta.url).resolve("katex/dist/katex.min.css"));
const ENTITIES = { "&lt;": "<", "&gt;": ">", "&amp;": "&", "&quot;": '"', "&#39;": "'", "&#x27;": "'" };
// Languages of listings that the highlighter of mdBook does not know, and one of its own that reads them.
const LANGUAGES = { rhai: "javascript", obj: "text", vim: "text" };
const THEMES_LEFT_OUT = ["rust", "navy", "ayu"];

const plain = (html) => html.replace(/&(?:lt|gt|amp|quot|#39|#x27);/g, (entity) => ENTITIES[entity]);
const formula = (html, displayMode) =>
  katex.renderToString(plain(html), { displayMode, throwOnError: true, strict: "error", output: "htmlAndMathml" });

/** The page with its formulas drawn. */
function withFormulas(page, html) {
  let found = 0;
  const draw = (displayMode) => (written, source) => {
    found += 1;
    try {
      return formula(source, displayMode);
    } catch (error) {
      throw new Error(`${page}: ${written}: ${error.message}`);
    }
  };
  const drawn = html
    .replace(/<pre><code class="language-math">([^]*?)<\/code><\/pre>/g, draw(true))
    .replace(/\$<code>([^]*?)<\/code>\$/g, draw(false));
  if (!found) return html;
  const style = `${path.relative(path.dirname(page), "katex")}/katex.min.css`;
  return drawn.replace("</head>", `<link rel="stylesheet" href="${style}">\n</head>`);
}

function withTwoThemes(html) {
  const leftOut = new RegExp(`<li role="none"><button[^>]*id="mdbook-theme-(?:${THEMES_LEFT_OUT.join("|")})"[^]*?</li>`, "g");
  return html.replace(leftOut, "").replace(/(id="mdbook-theme-coal">)Coal</, "$1Dark<");
}

function withLanguages(html) {
  const known = (whole, name) => (name in LANGUAGES ? `"language-${LANGUAGES[name]}"` : whole);
  return html.replace(/"language-([a-z]+)"/g, known);
}

/** Fonts of formulas: the one format that every browser of today reads. */
function copyFonts() {
  const fonts = path.join(site, "katex/fonts");
  mkdirSync(fonts, { recursive: true });
  const style = readFileSync(path.join(KATEX, "katex.min.css"), "utf8");
  const others = /,url\([^)]*\.(?:woff|ttf)\) format\("[a-z]*"\)/g;
  writeFileSync(path.join(site, "katex/katex.min.css"), style.replace(others, ""));
  for (const name of readdirSync(path.join(KATEX, "fonts")).filter((name) => name.endsWith(".woff2"))) {
    copyFileSync(path.join(KATEX, "fonts", name), path.join(fonts, name));
  }
}

copyFonts();
for (const page of readdirSync(site, { recursive: true }).filter((name) => name.endsWith(".html"))) {
  const file = path.join(site, page);
  const html = readFileSync(file, "utf8");
  writeFileSync(file, withLanguages(withTwoThemes(withFormulas(page, html))));
}
