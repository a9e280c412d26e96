#include "bench/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "touchstone/error.h"

namespace touchstone {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw InputError(fmt::format("{}: {}: {}", path.string(), what, std::strerror(errno)));
}

void write_all(int file, std::string_view text, const std::filesystem::path& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int cause = errno;
      ::close(file);
      ::unlink(path.c_str());
      errno = cause;
      fail(path, "cannot be written");
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

void write_atomically(const std::filesystem::path& path, std::string_view text) {
  const std::filesystem::path temporary = path.string() + fmt::format(".{}.tmp", ::getpid());
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) fail(temporary, "cannot be opened for writing");
  write_all(file, text, temporary);
  if (::fsync(file) != 0 || ::close(file) != 0) fail(temporary, "cannot be flushed to the disk");
  if (::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "cannot be replaced");
  const std::filesystem::path folder = path.parent_path().empty() ? "." : path.parent_path();
  if (const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); directory >= 0) {
    ::fsync(directory);  // the rename itself must last
    ::close(directory);
  }
}

std::string read_file(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    if (errno == 0) errno = EISDIR;
    fail(path, "cannot be read");
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

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
  if (file_ < 0) fail(path, "cannot be opened");
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
    ::close(file_);
    throw InputError(
        fmt::format("{}: another run writes into this folder; wait for it, or choose another --out", folder.string()));
  }
}

FolderLock::~FolderLock() { ::close(file_); }

}  // namespace touchstone
