// The folder a run writes into: proved writable before the first case, one writer at a time.
#pragma once

#include <cstdint>
#include <filesystem>

#include "datasets/files.h"

namespace touchstone {

// Makes the folder and proves that files can be written there. Throws InputError.
void require_writable_folder(const std::filesystem::path& folder);

// The same for a file that is written at the end of the work.
void require_writable_file(const std::filesystem::path& file);

// Throws InputError if the folder's disk has fewer bytes free than these; where that cannot be told, nothing is asked.
void require_space(const std::filesystem::path& folder, std::uintmax_t bytes);

// The lock of a run on its folder. Throws InputError at once if another run holds it.
class FolderLock : public FileLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
};

}  // namespace touchstone
