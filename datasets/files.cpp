#include "datasets/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <thread>

#include "touchstone/error.h"

namespace touchstone {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* what) {
  throw InputError(fmt::format("{}: cannot be {}: {}", path.string(), what, std::strerror(errno)));
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = ::write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return true;
}

// A pipe or a device (/dev/stdout, /dev/null) takes the bytes itself: a file in its place would be the end of it.
bool is_pipe_or_device(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_other(path, error);
}

void write_into(const std::filesystem::path& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) fail(path, "written");
  const bool written = write_all(file, bytes);
  const int reason = errno;
  const bool closed = ::close(file) == 0;
  if (!written) errno = reason;
  if (!written || !closed) fail(path, "written");
}

}  // namespace

void write_atomically(const std::filesystem::path& asked, std::string_view bytes) {
  if (is_pipe_or_device(asked)) return write_into(asked, bytes);
  std::error_code dangling;
  const std::filesystem::path real = std::filesystem::canonical(asked, dangling);
  const std::filesystem::path& path = dangling ? asked : real;  // a link stays a link
  const std::string temporary = path.string() + ".XXXXXX";
  std::string name = temporary;
  const int file = ::mkstemp(name.data());
  if (file < 0) fail(path, "written");
  const bool written = write_all(file, bytes) && ::fchmod(file, 0644) == 0 && ::fsync(file) == 0;
  const int reason = errno;
  if ((::close(file) != 0 && written) || !written || ::rename(name.c_str(), path.c_str()) != 0) {
    if (!written) errno = reason;
    const int why = errno;
    ::unlink(name.c_str());
    errno = why;
    fail(path, "written");
  }
}

OpenFile::OpenFile(const std::filesystem::path& path) : path_(path), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  struct stat status = {};
  if (file_ < 0 || ::fstat(file_, &status) != 0) fail(path, "read");
  if (S_ISREG(status.st_mode)) size_ = static_cast<std::size_t>(status.st_size);
  if (S_ISDIR(status.st_mode)) {
    ::close(file_);  // no destructor runs after a throw
    throw InputError(fmt::format("{}: is a folder, not a file", path.string()));
  }
}

OpenFile::~OpenFile() {
  if (file_ >= 0) ::close(file_);
}

std::string OpenFile::read() const {
  std::string bytes;
  char part[1 << 16];
  for (;;) {
    const ssize_t got = ::read(file_, part, sizeof part);
    if (got == 0) return bytes;
    if (got > 0) bytes.append(part, static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) fail(path_, "read");
  }
}

std::string read_whole(const std::filesystem::path& path) { return OpenFile(path).read(); }

FileLock::FileLock(const std::filesystem::path& path, const std::function<void()>& busy)
    : file_(::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
  if (file_ < 0) fail(path, "opened as a lock");
  try {
    while (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) continue;
      if (errno != EWOULDBLOCK) fail(path, "locked");
      busy();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  } catch (...) {
    ::close(file_);
    throw;
  }
}

FileLock::~FileLock() { ::close(file_); }

}  // namespace touchstone
