// The candidates of a view: the representations with which the exact surfaces are compared. They are the baseline mesh
// and those that --with names. Each has a picture, a difference and, if the view is not too large, pixel data. Their
// roles are those of the report's files.
import { planeRoles } from "./pixels.js";

// Planes that depend on the candidate. Those of the first candidate have no prefix. Planes that are the same for all
// candidates are stored once, with the first.
const ownPlanes = ["pixel-deviation", "pixel-status"];

const withRoles = (candidate, first) => ({
  ...candidate,
  planeOf: (plane) => (first || !ownPlanes.includes(plane) ? plane : `${candidate.name}-${plane}`),
  roles: [candidate.name, candidate.differenceRole, candidate.lightRole, ...(first ? planeRoles : ownPlanes.map((plane) => `${candidate.name}-${plane}`))],
});

// Returns the candidates in the order of the report, the baseline first; empty for a view without a comparison.
export const candidatesOf = (view) => [
  ...(view.baseline ? [{ name: "baseline", title: "Baseline", what: "triangle mesh", noun: "mesh", ends: ["mesh nearer", "mesh farther"], differenceRole: "difference", lightRole: "light", costs: view.baseline, difference: view.difference }] : []),
  ...(view.candidates || []).map((one) => ({ name: one.name, title: one.title, what: one.name, ends: ["nearer", "farther"], noun: one.title.toLowerCase(), differenceRole: `${one.name}-difference`, lightRole: `${one.name}-light`, costs: one, difference: one.difference })),
].map((candidate, i) => withRoles(candidate, i === 0));
