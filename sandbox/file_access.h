// Restricts the files that a process can reach. The kernel enforces the restriction (Landlock), whatever code
// runs in the process.
//
//  1. Only the files that FileAccess names can be reached: no other file can be opened, no other directory
//     listed, and no program outside `runnable` started. File permissions still apply; the restriction only
//     removes access.
//  2. A name that does not exist is ignored. A directory includes everything below it. A symbolic link refers
//     to its target.
//  3. The process cannot create symbolic links, pipes, sockets or devices, not even in `writable`, and it
//     cannot link or move files between directories.
//  4. The process and its threads cannot send signals to other processes or reach abstract sockets, if the
//     kernel supports these restrictions.
//  5. A kernel without Landlock (before 5.13, or with Landlock disabled) restricts nothing.
#pragma once

#include <string>
#include <vector>

namespace facetless {

struct FileAccess {
  std::vector<std::string> readable;  // files and directories that may be read
  std::vector<std::string> runnable;  // files and directories that may be read and executed
  std::vector<std::string> writable;  // directories in which files may be read, written, created and removed
  std::vector<std::string> opened;    // files and directories whose existing files may be read and written

  bool empty() const { return readable.empty() && runnable.empty() && writable.empty() && opened.empty(); }
};

// The version of Landlock in this kernel; 0: none.
int LandlockVersion();

// Restricts the calling thread and the program that it executes. The function makes only system calls, so it
// may run between fork and exec. Requires no_new_privs. Returns false, with errno set, if the kernel has
// Landlock but refuses.
bool ConfineFileAccess(const FileAccess& access);

}  // namespace facetless
