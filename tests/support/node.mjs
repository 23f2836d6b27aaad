// Shared by tests that node runs: the packages that they need, a service for each test, files.
//
//   FACETLESS_SOURCE, FACETLESS_BIN   where the samples and the programs are
//   FACETLESS_PACKAGES                the folder whose node_modules has the packages
import { spawn } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import path from "node:path";
import { after } from "node:test";

const need = (name) => {
  if (!process.env[name]) throw new Error(`${name} is not set; run these tests through ctest`);
  return process.env[name];
};
export const source = need("FACETLESS_SOURCE"), packages = need("FACETLESS_PACKAGES");
const bin = need("FACETLESS_BIN");
export const require = createRequire(path.join(packages, "package.json"));

// Ends the process with the status that means "skipped" to ctest, and prints the reason.
export const skip = (why) => {
  console.log(`SKIPPED ${path.basename(process.argv[1])}: ${why}`);
  process.exit(77);
};

// Loads a package, or skips the test.
export const load = (name) => {
  try { return require(name); } catch (error) { return skip(`the package ${name} is not in ${packages}; build again on a machine that can reach the npm registry`); }
};

const folders = [];
const servers = [];
after(async () => {
  for (const server of servers) await server.stop();
  for (const folder of folders) rmSync(folder, { recursive: true, force: true });
});

export const folder = () => {
  const made = mkdtempSync(path.join(tmpdir(), "facetless-node-"));
  folders.push(made);
  return made;
};
export const sample = (name) => path.join(source, "samples", name);
// Returns the path of a real CAD file, or null if there is none.
export const cadFile = (name) => {
  const file = path.join(process.env.FACETLESS_CAD || path.join(source, "../shared/cad"), name);
  return existsSync(file) ? file : null;
};

export const run = (...words) => new Promise((resolve) => {
  const child = spawn(path.join(bin, "facetless"), words, { stdio: ["ignore", "pipe", "pipe"] });
  let out = "", errors = "";
  child.stdout.on("data", (text) => { out += text; });
  child.stderr.on("data", (text) => { errors += text; });
  child.on("close", (code) => resolve({ code, out, errors }));
});

const freePort = () => new Promise((resolve) => {
  const server = createServer().listen(0, "127.0.0.1", () => { const { port } = server.address(); server.close(() => resolve(port)); });
});

// A running `facetless serve`. It can be killed, and started again on the same port with the same data.
export class Server {
  static program = "facetless";
  static async start(...options) {
    const server = await Server.prepared(...options);
    await server.start();
    return server;
  }
  // Prepares a service without starting it, so that a test can create keys first.
  static async prepared(...options) {
    const server = new Server();
    server.port = await freePort();
    server.data = path.join(folder(), "data");
    server.options = options;
    servers.push(server);
    return server;
  }
  get address() { return `http://127.0.0.1:${this.port}/`; }
  start() {
    this.child = spawn(path.join(bin, Server.program), ["serve", "--listen", `127.0.0.1:${this.port}`, "--data", this.data, ...this.options], { stdio: ["ignore", "pipe", "ignore"] });
    return new Promise((resolve, reject) => {
      this.child.stdout.once("data", resolve);
      this.child.once("exit", (code) => reject(new Error(`the service ended with ${code}`)));
    });
  }
  async stop(signal = "SIGKILL") {
    if (!this.child || this.child.exitCode !== null || this.child.signalCode !== null) return;
    const ended = new Promise((resolve) => { this.child.once("exit", resolve); });
    this.child.kill(signal);
    await ended;
  }
}
