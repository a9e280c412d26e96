// Whole files, and nothing in between: a reader sees the old content or the new.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace touchstone {

// Writes beside `path`, or beside what it links to, flushes and renames; a pipe or device is written into. Throws InputError.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

// All bytes of a regular file. Throws InputError.
std::string read_whole(const std::filesystem::path& path);

// An exclusive lock, held as long as the object lives and by one process at a time; gone when the process ends, however it ends.
// The lock file stays.
class FileLock {
 public:
  // Tries ten times a second. `busy` is called after each try that found another process holding the lock: it throws to give up,
  // and returns to go on waiting. Throws InputError if the file cannot be opened or locked at all.
  FileLock(const std::filesystem::path& path, const std::function<void()>& busy);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace touchstone
