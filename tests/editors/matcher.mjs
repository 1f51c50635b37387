// Finds the place of a mistake with the problem matcher: matcher.mjs PACKAGE PRINTED MESSAGE FILE LINE COLUMN
import { readFileSync } from "node:fs";
import assert from "node:assert/strict";

const [manifest, printed, message, ...expected] = process.argv.slice(2);
const [{ pattern }] = JSON.parse(readFileSync(manifest, "utf8")).contributes.problemMatchers;
const [first, second] = pattern.map(({ regexp }) => new RegExp(regexp));
const lines = readFileSync(printed, "utf8").split("\n");
const start = lines.findIndex((text) => first.exec(text)?.[pattern[0].message] === message);
assert.ok(start >= 0, `no message: ${message}`);
assert.deepEqual(second.exec(lines[start + 1])?.slice(1), expected);
