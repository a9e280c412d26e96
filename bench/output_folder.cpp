#include "bench/output_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include "touchstone/error.h"

namespace touchstone {

void require_writable_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  const std::filesystem::path probe = folder / fmt::format(".write-probe.{}", ::getpid());
  write_atomically(probe, "probe\n");
  std::filesystem::remove(probe, error);
}

void require_writable_file(const std::filesystem::path& file) {
  std::error_code unreachable;
  if (std::filesystem::is_other(file, unreachable)) return;  // a pipe or a device: nothing is put beside it
  if (std::filesystem::is_directory(file, unreachable)) throw InputError(fmt::format("{}: a folder, not a file", file.string()));
  require_writable_folder(file.has_parent_path() ? file.parent_path() : ".");
}

void require_space(const std::filesystem::path& folder, std::uintmax_t bytes) {
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
  if (!unknown && space.available < bytes)
    throw InputError(fmt::format("{}: {} MB free, {} MB needed for the results; make room, or choose another --out",
                                 folder.string(), space.available >> 20, (bytes >> 20) + 1));
}

FolderLock::FolderLock(const std::filesystem::path& folder)
    : FileLock(folder / ".lock", [&folder] {
        throw InputError(
            fmt::format("{}: another run writes into this folder; wait for it, or choose another --out", folder.string()));
      }) {}

}  // namespace touchstone
