// Says what the user can do about a problem, by its code (docs/api.md, "Errors").

const remedies = {
  "format-unknown": "Facetless reads STEP (.step, .stp), IGES (.iges, .igs) and BREP. Export the model in one of these formats; STEP AP214 or AP242 keeps the most.",
  "format-broken": "The file is damaged or was cut off. Copy it again from its source, or export it again.",
  "nothing-usable": "The file has no readable faces. Export the solid or its surfaces, not only sketches, curves or a mesh; STEP AP214 or AP242 keeps the most.",
  "not-finite": "The file contains a value that is not a finite number. Repair the named entity in the program that made the file, or export the file again.",
  "file-unreadable": "Send the file again.",
  "unit-mismatch": "Select the unit of the mesh and its up axis under Options.",
  "limit-exceeded": "Reduce the work: choose a smaller size, fewer samples or views, or a coarser mesh. The operator of the service can raise its limits.",
  "importer-crashed": "The library that reads CAD files crashed on this file; the service still works. Export the file differently: as another version of STEP, or as IGES.",
  "bad-usage": "Change the named option, and try again.",
  "payload-too-large": "The file is larger than the service accepts. The operator of the service can raise --max-upload.",
  "timeout": "The work took longer than the service allows. Choose a smaller size, fewer views, or a coarser mesh.",
  "busy": "The service has too many jobs waiting. Try again in a few seconds.",
  "rate-limited": "This key has sent too many requests. Wait a minute, then try again.",
  "unauthorized": "Enter a key of this service. Its operator creates keys with: facetless keys create",
  "forbidden": "This key does not permit the request. Ask the operator of the service for a key with the scopes read and submit.",
  "not-found": "The service no longer stores it, or it belongs to another key. Send the file again.",
  "given-up": "Send the file again.",
  "cancelled": "Send the file again if you still need the result.",
  "write-failed": "The service's disk is full. Its operator must free space.",
  "gave-up": "Send the file again. If that fails, too, the service cannot process this file.",
  "connection-lost": "Check that facetless serve is running and that the network works, then try again. The data that were sent are not lost.",
  "internal": "This is a defect. Report the job's number to the operator of the service.",
};

// Problems that may be gone when the request is repeated. The others remain until the file or the options change.
const passing = ["busy", "rate-limited", "timeout", "connection-lost", "internal", "gave-up", "given-up", "cancelled", "write-failed", "shutting-down", "file-unreadable", "unauthorized", ""];

export const mayPass = (code) => passing.includes(code);
export const remedyOf = (code) => remedies[code] || "Try again.";
