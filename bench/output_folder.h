// The folder a run writes into: proved writable before the first case, one writer at a time.
#pragma once

#include <filesystem>

namespace touchstone {

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
