// Whole files, and nothing in between: a reader sees the old content or the new.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchstone {

// Writes beside `path`, flushes to the disk and renames. Throws InputError naming the path and the system's reason.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

// All bytes of a regular file. Throws InputError.
std::string read_whole(const std::filesystem::path& path);

// An exclusive lock held as long as the object lives; waits for another process that has it. The lock file stays.
class FileLock {
 public:
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace touchstone
