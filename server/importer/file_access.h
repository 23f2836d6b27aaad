// Which files a process may reach, kept by the kernel itself (Landlock), whatever code runs in the process.
//
//  1. Reachable is what FileAccess names and nothing else: no other file can be opened, no other directory
//     listed, no program outside `runnable` started. Permissions still hold: this only takes away.
//  2. A name that does not exist is left out; a directory stands for all below it; a symbolic link for what
//     it leads to.
//  3. No symbolic links, pipes, sockets or devices can be made, also not in `writable`; files can't be linked
//     or moved between directories.
//  4. The process and its threads can't signal processes outside, nor reach abstract sockets, where the
//     kernel knows how to keep them from it.
//  5. A kernel without Landlock (before 5.13, or built or told not to have it) confines nothing.
#pragma once

#include <string>
#include <vector>

namespace facetless {

struct FileAccess {
  std::vector<std::string> readable;  // files, and directories with all below them
  std::vector<std::string> runnable;  // the same; may be run, too
  std::vector<std::string> writable;  // directories: files in them are read, written, made and removed
  std::vector<std::string> opened;    // files and directories whose existing files are read and written

  bool empty() const { return readable.empty() && runnable.empty() && writable.empty() && opened.empty(); }
};

// The version of Landlock that this kernel has; 0: none.
int LandlockVersion();

// Confines the calling thread and what it becomes. It calls nothing but the system, so it may run between
// fork and exec. Requires no_new_privs. False, with errno set, if the kernel has Landlock and refuses.
bool ConfineFileAccess(const FileAccess& access);

}  // namespace facetless
