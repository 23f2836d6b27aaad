// The part of the service's interface (docs/api.md) that the page uses. Every request carries the key, if there is one,
// and no request goes to another address. After a broken connection, a request is repeated. A POST carries an
// Idempotency-Key, so that the service executes it once.

const keyName = "facetless-key";
const retrySeconds = 1, mostRetries = 45;

export const key = {
  get: () => sessionStorage.getItem(keyName) || "",
  set: (text) => (text ? sessionStorage.setItem(keyName, text) : sessionStorage.removeItem(keyName)),
};

// The problem document that the service sent, or the failure of the connection.
export class Problem extends Error {
  constructor({ type = "", title = "", status = 0, detail = "" }) {
    super(title);
    Object.assign(this, { code: type.replace("urn:facetless:problem:", ""), title, status, detail });
  }
}

const lost = () => new Problem({ type: "connection-lost", title: "The service does not answer", detail: "" });
const pause = (seconds) => new Promise((resolve) => { setTimeout(resolve, seconds * 1000); });
const headers = (more = {}) => (key.get() ? { ...more, Authorization: `Bearer ${key.get()}` } : more);

const problemOf = async (response) => {
  const json = await response.json().catch(() => ({}));
  return new Problem({ title: `The service answered with status ${response.status}`, status: response.status, ...json });
};

export class Service {
  // trouble(n) is called when the connection is lost and the n-th attempt begins, trouble(0) when it works again.
  constructor(trouble) { this.trouble = trouble; this.stopped = new AbortController(); }
  stop() { this.stopped.abort(); }

  async persist(attempt) {
    for (let tries = 0; ; ++tries) {
      try {
        const result = await attempt();
        if (tries > 0) this.trouble(0);
        return result;
      } catch (error) {
        if (this.stopped.signal.aborted) throw error;
        const again = error instanceof TypeError || (error instanceof Problem && ["shutting-down", "connection-lost"].includes(error.code)) || error.status === 502 || error.status === 504;
        if (!again) throw error;
        if (tries >= mostRetries) throw lost();
        this.trouble(tries + 1);
        await pause(retrySeconds);
      }
    }
  }
  // The service's links begin with a slash, but the page may be served below another path.
  async fetch(link, options = {}) {
    const response = await fetch(link.replace(/^\//, ""), { ...options, headers: headers(options.headers), signal: this.stopped.signal });
    if (!response.ok) throw await problemOf(response);
    return response;
  }
  json(link) { return this.persist(async () => (await this.fetch(link)).json()); }
  blob(link) { return this.persist(async () => (await this.fetch(link)).blob()); }

  // Sends a body. Returns the answer if it is known already, otherwise the job. sent(fraction) reports a large upload.
  post(path, body, sent = () => {}) {
    const token = crypto.randomUUID?.() || `${Date.now()}-${Math.random()}`;
    return this.persist(() => new Promise((resolve, reject) => {
      // fetch cannot report how much of a body has been sent.
      const request = new XMLHttpRequest();
      request.open("POST", path);
      for (const [name, value] of Object.entries(headers({ Prefer: "wait=0", "Idempotency-Key": token }))) request.setRequestHeader(name, value);
      if (typeof body === "string") request.setRequestHeader("Content-Type", "application/json");
      request.responseType = "json";
      request.upload.onprogress = (event) => sent(event.loaded / event.total);
      request.onload = () => {
        const json = request.response || {};
        if (request.status >= 200 && request.status < 300) resolve(json);
        else reject(new Problem({ title: `The service answered with status ${request.status}`, status: request.status, ...json }));
      };
      request.onerror = () => reject(lost());
      this.stopped.signal.addEventListener("abort", () => request.abort(), { once: true });
      request.onabort = () => reject(new DOMException("stopped", "AbortError"));
      request.send(body);
    }));
  }
  // Follows a job to its end and returns its result. progress(stage, fraction, text) reports the stages. An answer that
  // was already known is returned as it is.
  async follow(job, progress = () => {}) {
    if (job.state === undefined) return job;
    const self = job.links.self;
    while (job.state === "queued" || job.state === "running") {
      progress(job.state === "queued" ? "queued" : job.stage, job.fraction);
      // The stream of events ends with the job, or because the service restarts. In both cases, the job's state is read
      // again.
      const ended = await this.listen(job.links.events, progress).catch((error) => {
        if (this.stopped.signal.aborted || (error instanceof Problem && error.code !== "busy")) throw error;
        return null;
      });
      if (ended) { job = ended; break; }
      await pause(0.3);
      job = await this.json(self);
    }
    if (job.state === "done" && job.result) return job.result;
    if (job.state === "done") throw new Problem({ type: "given-up", title: "The result is no longer stored", detail: "The service deleted it to free space." });
    if (job.state === "cancelled") throw new Problem({ type: "cancelled", title: "The job was cancelled", detail: "" });
    throw new Problem(job.problem || { title: "The job failed" });
  }
  async listen(link, progress) {
    const reader = (await this.fetch(link)).body.pipeThrough(new TextDecoderStream()).getReader();
    let held = "";
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return null;
      held += value;
      const events = held.split("\n\n");
      held = events.pop();
      for (const event of events) {
        const name = /^event: (.*)$/m.exec(event)?.[1], data = /^data: (.*)$/m.exec(event)?.[1];
        if (!name || !data) continue;
        const content = JSON.parse(data);
        if (name === "end") return content;
        if (name === "progress") progress(content.stage || "queued", content.fraction);
        if (name === "message") progress(null, 0, content.text);
      }
    }
  }
  async cancel(job) { await this.fetch(job, { method: "DELETE" }).catch(() => {}); }
}
