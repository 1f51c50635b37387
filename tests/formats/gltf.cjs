// Checks files of glTF by the validator of Khronos: no error, no warning.
const { readFileSync } = require("node:fs");
const { validateBytes } = require("gltf-validator");

async function main() {
  for (const path of process.argv.slice(2)) {
    const { issues, info } = await validateBytes(new Uint8Array(readFileSync(path)));
    if (issues.numErrors + issues.numWarnings > 0) {
      throw new Error(`${path}: ${JSON.stringify(issues.messages.slice(0, 5), null, 1)}`);
    }
    console.log(`  ${path.split("/").pop()}: ${info.drawCallCount} parts, ${info.totalTriangleCount} triangles`);
  }
  console.log("glTF: valid by the validator of Khronos");
}

main().catch((error) => {
  console.error(error.message);
  process.exit(1);
});
