// What a person can do about a problem, by its code (docs/api.md, "Errors").

const remedies = {
  "format-unknown": "Facetless reads STEP (.step, .stp), IGES (.iges, .igs) and BREP. Export the model in one of these formats; STEP AP214 or AP242 keeps the most.",
  "format-broken": "The file is damaged or was cut off. Copy it again from where it came from, or export it again.",
  "nothing-usable": "The file holds no faces that can be read. Export the solid or its surfaces, not only sketches, curves or a mesh; STEP AP214 or AP242 keeps the most.",
  "not-finite": "The file has a number that is none. Repair the entity that is named in the program that made the file, or export it again.",
  "file-unreadable": "Send the file again.",
  "unit-mismatch": "Say under Options which unit the mesh has, and which axis points up.",
  "limit-exceeded": "Ask for less: a smaller size, fewer samples or views, a coarser mesh. Whoever runs the service can raise its limits.",
  "importer-crashed": "This file ends the library that reads it; the service is unharmed. Try another export of it: another version of STEP, or IGES.",
  "bad-usage": "Change the option that is named, and compare again.",
  "payload-too-large": "The file is larger than the service takes. Whoever runs it can raise --max-upload.",
  "timeout": "It took longer than the service allows. Ask for less: a smaller size, fewer views, a coarser mesh.",
  "busy": "Others wait, too. Try again in some seconds.",
  "rate-limited": "Wait a minute, then try again.",
  "unauthorized": "Enter a key of this service. Whoever runs it makes keys with: facetless keys create",
  "forbidden": "This key may not do that. Ask whoever runs the service for one with the scopes read and submit.",
  "not-found": "It is not kept any more, or belongs to another key. Send the file again.",
  "given-up": "Send the file again.",
  "cancelled": "Send it again if it is still wanted.",
  "write-failed": "The service's disk is full. Whoever runs it has to make room.",
  "gave-up": "Send it again; if it fails again, this file is too much for the service.",
  "connection-lost": "See that facetless serve still runs and that the network is there, then try again: what was sent is not lost.",
  "internal": "This is a defect. Send the job's number to whoever runs the service.",
};

// Problems that may be gone when the same is asked again; others stay as long as file and options do.
const passing = ["busy", "rate-limited", "timeout", "connection-lost", "internal", "gave-up", "given-up", "cancelled", "write-failed", "shutting-down", "file-unreadable", "unauthorized", ""];

export const mayPass = (code) => passing.includes(code);
export const remedyOf = (code) => remedies[code] || "Try again.";
