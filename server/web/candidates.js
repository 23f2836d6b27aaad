// What the exact surfaces of a view are compared with: the baseline mesh, and what --with names. Each has a picture, a difference and,
// where the view is not too large, pixel data; their roles are those of the report's files.
import { planeRoles } from "./pixels.js";

// Planes that depend on the candidate. The first candidate's have no prefix, and those that are the same for all are the first one's.
const ownPlanes = ["pixel-deviation", "pixel-status"];

const withRoles = (candidate, first) => ({
  ...candidate,
  planeOf: (plane) => (first || !ownPlanes.includes(plane) ? plane : `${candidate.name}-${plane}`),
  roles: [candidate.name, candidate.differenceRole, ...(first ? planeRoles : ownPlanes.map((plane) => `${candidate.name}-${plane}`))],
});

// In the order of the report, the baseline first; empty for a view that was compared with nothing.
export const candidatesOf = (view) => [
  ...(view.baseline ? [{ name: "baseline", title: "Baseline", what: "triangle mesh", noun: "mesh", ends: ["mesh nearer", "mesh farther"], differenceRole: "difference", costs: view.baseline, difference: view.difference }] : []),
  ...(view.candidates || []).map((one) => ({ name: one.name, title: one.title, what: one.name, ends: ["nearer", "farther"], noun: one.title.toLowerCase(), differenceRole: `${one.name}-difference`, costs: one, difference: one.difference })),
].map((candidate, i) => withRoles(candidate, i === 0));
