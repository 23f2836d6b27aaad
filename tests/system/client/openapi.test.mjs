// A linter must find no fault in openapi.json, and a client that is generated from it must work.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, readFileSync, symlinkSync, writeFileSync } from "node:fs";
import path from "node:path";
import test from "node:test";
import { folder, load, packages, require, sample, Server, source } from "../../support/node.mjs";
import { rules } from "./rules.mjs";

const document = path.join(source, "server/web/openapi.json");
const here = path.join(source, "tests/system/client");
const { createConfig, lint } = load("@redocly/openapi-core");

const faultsOf = async (file) => (await lint({ ref: file, config: await createConfig(rules) })).map(({ ruleId, severity, message, location }) => `${severity} ${ruleId}: ${message} (${location[0]?.pointer})`);

// Runs a program of the packages. If it fails, its output becomes the error's message.
const program = (file, ...words) => {
  try {
    return execFileSync(process.execPath, [path.join(packages, "node_modules", file), ...words], { cwd: packages, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
  } catch (error) {
    throw new Error(`${file}: ${error.stdout}${error.stderr}`);
  }
};

test("a linter finds neither errors nor warnings", async () => {
  assert.deepEqual(await faultsOf(document), []);
});

test("the linter finds what is wrong", async () => {
  const broken = JSON.parse(readFileSync(document, "utf8"));
  delete broken.paths["/v1/models"].get.operationId;
  broken.components.schemas.Job.properties.state.type = "word";
  const file = path.join(folder(), "openapi.json");
  writeFileSync(file, JSON.stringify(broken));
  const faults = await faultsOf(file);
  assert.ok(faults.some((fault) => fault.includes("operation-operationId")), faults.join("\n"));
  assert.ok(faults.some((fault) => fault.includes("struct")), faults.join("\n"));
});

test("a generated client posts, waits, reads, lists and deletes", async () => {
  // Generate the client, and compile it together with journey.ts, with the strictest options.
  require.resolve("typescript");
  const made = folder();
  program("@hey-api/openapi-ts/bin/index.cjs", "--input", document, "--output", path.join(made, "generated"), "--client", "@hey-api/client-fetch", "--no-log-file", "--silent");
  copyFileSync(path.join(here, "journey.ts"), path.join(made, "journey.ts"));
  symlinkSync(path.join(packages, "node_modules"), path.join(made, "node_modules"));
  writeFileSync(path.join(made, "package.json"), '{"type": "commonjs"}');
  const compilerOptions = { strict: true, noUncheckedIndexedAccess: true, target: "es2022", module: "commonjs", moduleResolution: "node10", lib: ["es2022", "dom", "dom.iterable"], types: [], outDir: "built" };
  writeFileSync(path.join(made, "tsconfig.json"), JSON.stringify({ compilerOptions, files: ["journey.ts"] }));
  program("typescript/bin/tsc", "--project", made);
  const { travel } = require(path.join(made, "built/journey.js"));

  const server = await Server.start();
  const file = new File([readFileSync(sample("bracket.step"))], "bracket.step");
  const found = await travel(server.address.replace(/\/$/, ""), file);
  assert.equal(found.model.name, "bracket.step");
  assert.equal(found.model.model.faces_shown, 30);
  assert.equal(found.accepted.kind, "comparison");
  assert.equal(found.done.state, "done");
  assert.deepEqual(found.done.result, found.answer);
  assert.ok(found.answer.views[0].baseline.triangles > 0);
  assert.equal(found.picture.type, "image/png");
  assert.deepEqual(found.models, [found.model.id]);
  assert.ok(found.jobs.includes(found.accepted.id));
  assert.deepEqual(found.left, []);
  assert.equal(found.gone.type, "urn:facetless:problem:not-found");
  assert.equal(found.refused.type, "urn:facetless:problem:bad-usage");
});
