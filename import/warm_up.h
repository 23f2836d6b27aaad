// What OpenCASCADE initialises with the first file of a process: tables of entities, message texts, resources, and
// the addresses of the functions that are called.
//
//  1. WarmUp imports and meshes a small part that is built into the program, in a temporary directory of its own. It
//     reads no other file, leaves no thread and no open file, and its failure has no consequence but time.
//  2. Files that are imported afterwards, in a child that is forked, give the same bytes as in a new process.
#pragma once

namespace facetless {

void WarmUp();

}  // namespace facetless
