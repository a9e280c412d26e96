#include "bench/output_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "datasets/files.h"
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

FolderLock::FolderLock(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / ".lock";
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0) throw InputError(fmt::format("{}: cannot be opened: {}", path.string(), std::strerror(errno)));
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(file_);
    throw InputError(
        fmt::format("{}: another run writes into this folder; wait for it, or choose another --out", folder.string()));
  }
}

FolderLock::~FolderLock() { ::close(file_); }

}  // namespace touchstone
