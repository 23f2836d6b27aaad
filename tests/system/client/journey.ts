// Uses a generated client as a caller would. The compiler checks it against the generated types. It posts a sample, waits for
// the comparison, reads it, lists it and deletes it.
import { client } from "./generated/client.gen";
import { createComparison, createModel, getAnswer, getHealth, getJob, getModel, listJobs, listModels, removeModel } from "./generated/sdk.gen";
import type { Job, Model, Problem, Report } from "./generated/types.gen";

export type Journey = {
  model: Model; accepted: Job; done: Job; answer: Report; picture: Blob; models: string[]; jobs: string[]; left: string[]; gone: Problem; refused: Problem;
};

const wanted = <T>(value: T | undefined, what: string): T => {
  if (value === undefined) throw new Error(`there is no ${what}`);
  return value;
};

// The address of an answer ends with its id.
const idOf = (address: string): string => wanted(address.split("/").pop(), "id");

export const travel = async (baseUrl: string, file: File): Promise<Journey> => {
  client.setConfig({ baseUrl });
  const lives = await getHealth({ throwOnError: true });
  if (lives.response.status !== 200) throw new Error("the service is not healthy");

  // Post the file, then ask for a comparison without waiting.
  const posted = await createModel({ body: { file }, headers: { Prefer: "wait=60" }, throwOnError: true });
  const model = posted.data as Model;
  const asked = await createComparison({ body: { model: model.id, view: "iso", size: "64x48", samples: 1, mesh_timeout: 60 }, headers: { Prefer: "wait=0" }, throwOnError: true });
  const accepted = asked.data as Job;

  // Wait for the end of the job.
  let done = accepted;
  while (done.state === "queued" || done.state === "running") {
    await new Promise<void>((resume) => { setTimeout(resume, 20); });
    done = (await getJob({ path: { id: accepted.id }, throwOnError: true })).data;
  }

  // Read the answer and a picture of it.
  const answer = (await getAnswer({ path: { id: idOf(wanted(done.links.result, "result")) }, throwOnError: true })).data;
  const address = (answer.views[0]?.links as { direct?: string } | undefined)?.direct;
  const picture = await (await fetch(new URL(wanted(address, "picture"), baseUrl))).blob();

  // List the answer, delete it, and check that it is gone.
  const models = async () => (await listModels({ throwOnError: true })).data.models.map(({ id }) => id);
  const before = await models();
  const jobs = (await listJobs({ query: { limit: 10 }, throwOnError: true })).data.jobs.map(({ id }) => id);
  await removeModel({ path: { id: model.id }, throwOnError: true });
  const gone = wanted((await getModel({ path: { id: model.id } })).error, "problem");
  const refused = wanted((await createComparison({ body: { model: "none" } })).error, "problem");
  return { model, accepted, done, answer, picture, models: before, jobs, left: await models(), gone, refused };
};
