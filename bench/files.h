// Files a run must not lose: whole or not at all, one writer at a time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace touchstone {

// Writes to a temporary file beside `path`, flushes it to the disk, renames. Throws InputError naming the path and the cause.
void write_atomically(const std::filesystem::path& path, std::string_view text);

// Whole content; throws InputError naming the path and the cause.
std::string read_file(const std::filesystem::path& path);

// Makes the folder and proves that files can be written there. Throws InputError.
void require_writable_folder(const std::filesystem::path& folder);

// Held by one process at a time; released when the process ends, however it ends. Throws InputError if another holds it.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_ = -1;
};

}  // namespace touchstone
